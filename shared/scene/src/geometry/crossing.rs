//! Where lines in the plane cross.

/// Two lines in the plane cross; one that ends on the other does.
pub fn crosses([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let side =
        |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    // Two on one line may lie apart.
    let meet = |k: usize| a[k].min(b[k]) <= c[k].max(d[k]) && c[k].min(d[k]) <= a[k].max(b[k]);
    let across = side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0;
    across && meet(0) && meet(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_cross_by_hand() {
        let crack = [[0.0, 0.0], [2.0, 0.0]];
        assert!(crosses([[1.0, -0.5], [1.0, 0.5]], crack));
        assert!(crosses([[1.5, -0.5], [2.4, 0.5]], crack));
        assert!(!crosses([[1.8, -0.5], [2.6, 0.5]], crack), "beyond the end");
        assert!(!crosses([[1.0, 0.5], [1.0, 1.5]], crack), "above it");
        assert!(!crosses([[2.5, 0.0], [3.0, 0.0]], crack), "on its line, beyond the end");
        assert!(crosses([[1.5, 0.0], [2.5, 0.0]], crack), "along it");
    }
}
