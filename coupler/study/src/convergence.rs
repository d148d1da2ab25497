//! Richardson extrapolation (Richardson 1911; Roache 1994; with unequal ratios Celik et al. 2008).
//!
//! A result with error C dx^p at three spacings dx_1 < dx_2 < dx_3 gives
//! (f_3 - f_2) / (f_2 - f_1) = (dx_3^p - dx_2^p) / (dx_2^p - dx_1^p), which is solved for p, and
//! f_0 = f_1 - (f_2 - f_1) dx_1^p / (dx_2^p - dx_1^p).

use serde::Serialize;

/// Orders above this are no orders: the three spacings do not show one.
const HIGHEST: f64 = 10.0;
const LOWEST: f64 = 0.05;

/// What three spacings say about a result at zero spacing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "verdict")]
pub enum Convergence {
    /// Differences shrink in one direction.
    Ordered {
        /// Observed order p.
        order: f64,
        /// Result at zero spacing.
        extrapolated: f64,
    },
    /// The differences have opposite signs.
    NotMonotone,
    /// The differences do not shrink as any positive order up to ten would make them.
    NotShrinking,
    /// Fewer than three spacings.
    TooFew,
}

impl Convergence {
    /// In words.
    pub fn verdict(&self) -> String {
        match self {
            Self::Ordered { order, .. } => format!("observed order {order:.2}"),
            Self::NotMonotone => "no order: the three finest do not converge monotonically".into(),
            Self::NotShrinking => "no order: the differences of the three finest do not shrink".into(),
            Self::TooFew => "no order: it takes three resolutions".into(),
        }
    }

    /// The result at zero spacing.
    pub fn extrapolated(&self) -> Option<f64> {
        match self {
            Self::Ordered { extrapolated, .. } => Some(*extrapolated),
            _ => None,
        }
    }
}

/// From points (spacing, result) in any order, of which the three finest count.
pub fn richardson(points: &[(f64, f64)]) -> Convergence {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &[(h1, f1), (h2, f2), (h3, f3), ..] = &points[..] else { return Convergence::TooFew };
    let (fine, coarse) = (f2 - f1, f3 - f2);
    if fine * coarse <= 0.0 {
        return Convergence::NotMonotone;
    }
    let ratio = coarse / fine;
    // In units of dx_2, where no power overflows; rises with p.
    let (a, b) = (h1 / h2, h3 / h2);
    let excess = |p: f64| (b.powf(p) - 1.0) / (1.0 - a.powf(p)) - ratio;
    let (mut low, mut high) = (LOWEST, HIGHEST);
    if excess(low) > 0.0 || excess(high) < 0.0 {
        return Convergence::NotShrinking;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 { low = middle } else { high = middle }
    }
    let order = 0.5 * (low + high);
    let part = a.powf(order);
    Convergence::Ordered { order, extrapolated: f1 - fine * part / (1.0 - part) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exact_power_is_found_with_its_limit() {
        // 3 + 2 h at 1, 2, 4: 5, 7, 11. 1 - h² at 1, 1.5, 2, 3: 0, -1.25, -3, -8; the coarsest does not count.
        let Convergence::Ordered { order, extrapolated } = richardson(&[(4.0, 11.0), (1.0, 5.0), (2.0, 7.0)])
        else {
            panic!()
        };
        assert!((order - 1.0).abs() < 1e-12 && (extrapolated - 3.0).abs() < 1e-12);
        let Convergence::Ordered { order, extrapolated } =
            richardson(&[(3.0, 99.0), (1.0, 0.0), (1.5, -1.25), (2.0, -3.0)])
        else {
            panic!()
        };
        assert!((order - 2.0).abs() < 1e-12 && (extrapolated - 1.0).abs() < 1e-12);
    }

    #[test]
    fn results_that_do_not_converge_have_no_order() {
        assert_eq!(richardson(&[(1.0, 1.0), (2.0, 2.0)]), Convergence::TooFew);
        assert_eq!(richardson(&[(1.0, 1.0), (2.0, 2.0), (4.0, 1.5)]), Convergence::NotMonotone);
        assert_eq!(richardson(&[(1.0, 1.0), (2.0, 1.0), (4.0, 1.5)]), Convergence::NotMonotone);
        // Equal differences on a doubling ladder: order 0.
        assert_eq!(richardson(&[(1.0, 1.0), (2.0, 2.0), (4.0, 3.0)]), Convergence::NotShrinking);
        // A difference 4096 times the other: order 12.
        assert_eq!(richardson(&[(1.0, 0.0), (2.0, 1.0), (4.0, 4097.0)]), Convergence::NotShrinking);
    }
}
