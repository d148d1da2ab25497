//! Which settings nobody beats in both cost and error.

/// For each point (cost, error) whether no other is as cheap and as accurate, and better in one of the two. Points that
/// are not finite are never on the front.
pub fn front(points: &[(f64, f64)]) -> Vec<bool> {
    let finite = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let beats = |a: &(f64, f64), b: &(f64, f64)| a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1);
    points.iter().map(|p| finite(p) && !points.iter().any(|q| finite(q) && beats(q, p))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_that_another_one_beats_are_not_on_the_front() {
        let points = [(1.0, 9.0), (2.0, 4.0), (3.0, 5.0), (4.0, 1.0), (4.0, 2.0), (f64::NAN, 0.0)];
        assert_eq!(front(&points), [true, true, false, true, false, false]);
    }

    #[test]
    fn settings_of_equal_error_and_cost_are_both_on_the_front() {
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)]), [true, true]);
        assert!(front(&[]).is_empty());
    }
}
