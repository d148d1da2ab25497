//! A power law with factors, fitted in logarithms: y = exp(b_0) dx^p f_1 f_2 ..., one factor for each value of a key
//! other than the scene's own.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::BTreeSet;

/// Singular values below this part of the largest are zero.
const RANK: f64 = 1e-10;

/// A run that was measured, or one to predict.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Particle spacing, m.
    pub resolution: f64,
    /// Values of keys other than the scene's own, `key=value`.
    pub choices: Vec<String>,
}

/// The fitted law.
#[derive(Clone, Debug)]
pub struct Fit {
    choices: Vec<String>,
    scale: f64,
    range: (f64, f64),
    has_slope: bool,
    coefficients: DVector<f64>,
    /// Pseudo-inverse of X'X.
    covariance: DMatrix<f64>,
    /// X X+ : what the runs determine.
    projector: DMatrix<f64>,
    /// Runs beyond those that the coefficients use up.
    pub spare: usize,
    /// Standard deviation of the residuals, in logarithms.
    pub deviation: f64,
}

/// A predicted value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Best guess.
    pub value: f64,
    /// Ends of the two-sided interval that holds 80 % of such runs; `None` where no run is spare.
    pub interval: Option<(f64, f64)>,
    /// The resolution is outside those of the runs.
    pub extrapolated: bool,
}

impl Prediction {
    /// The interval's upper end, or the value where there is none.
    pub fn high(&self) -> f64 {
        self.interval.map_or(self.value, |(_, high)| high)
    }
}

impl Fit {
    /// Fits positive values; `None` with fewer than two of them.
    pub fn new(runs: &[(Point, f64)]) -> Option<Self> {
        let runs: Vec<_> = runs.iter().filter(|(_, y)| *y > 0.0 && y.is_finite()).collect();
        if runs.len() < 2 {
            return None;
        }
        let choices: BTreeSet<&String> = runs.iter().flat_map(|(p, _)| &p.choices).collect();
        let choices: Vec<String> = choices.into_iter().cloned().collect();
        let spacings = || runs.iter().map(|(p, _)| p.resolution);
        let range = (spacings().fold(f64::INFINITY, f64::min), spacings().fold(0.0, f64::max));
        let mut fit = Self {
            scale: range.0,
            range,
            has_slope: range.1 > range.0 * (1.0 + 1e-9),
            coefficients: DVector::zeros(0),
            covariance: DMatrix::zeros(0, 0),
            projector: DMatrix::zeros(0, 0),
            spare: 0,
            deviation: 0.0,
            choices,
        };
        let rows: Vec<DVector<f64>> = runs.iter().map(|(p, _)| fit.row(p)).collect();
        let x = DMatrix::from_fn(runs.len(), rows[0].len(), |i, j| rows[i][j]);
        let y = DVector::from_iterator(runs.len(), runs.iter().map(|(_, y)| y.ln()));
        let svd = x.clone().svd(true, true);
        let cut = RANK * svd.singular_values.max();
        let rank = svd.rank(cut);
        let inverse = svd.pseudo_inverse(cut).ok()?;
        fit.coefficients = &inverse * &y;
        fit.covariance = &inverse * inverse.transpose();
        fit.projector = &inverse * &x;
        fit.spare = runs.len() - rank;
        let residual = (&y - &x * &fit.coefficients).norm_squared();
        fit.deviation = if fit.spare > 0 { (residual / fit.spare as f64).sqrt() } else { 0.0 };
        Some(fit)
    }

    /// The power p of the spacing, where the runs have more than one.
    pub fn slope(&self) -> Option<f64> {
        self.has_slope.then(|| self.coefficients[1])
    }

    fn row(&self, point: &Point) -> DVector<f64> {
        let mut row = vec![1.0];
        if self.has_slope {
            row.push((point.resolution / self.scale).ln());
        }
        row.extend(self.choices.iter().map(|c| if point.choices.contains(c) { 1.0 } else { 0.0 }));
        DVector::from_vec(row)
    }

    /// What the law says of a run; `None` where the runs say nothing about one of its choices.
    pub fn predict(&self, point: &Point) -> Option<Prediction> {
        if point.choices.iter().any(|choice| !self.choices.contains(choice)) {
            return None;
        }
        let row = self.row(point);
        if (&row - &self.projector * &row).norm() > 1e-6 * row.norm() {
            return None;
        }
        let log = row.dot(&self.coefficients);
        let spread = self.deviation * (1.0 + row.dot(&(&self.covariance * &row))).sqrt();
        let quantile = (self.spare > 0).then(|| StudentsT::new(0.0, 1.0, self.spare as f64).ok()).flatten();
        let interval = quantile.map(|t| {
            let half = t.inverse_cdf(0.9) * spread;
            ((log - half).exp(), (log + half).exp())
        });
        let outside = |dx: f64| dx < self.range.0 * (1.0 - 1e-9) || dx > self.range.1 * (1.0 + 1e-9);
        Some(Prediction { value: log.exp(), interval, extrapolated: outside(point.resolution) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(resolution: f64, choices: &[&str]) -> Point {
        Point { resolution, choices: choices.iter().map(|c| c.to_string()).collect() }
    }

    #[test]
    fn a_power_law_with_a_factor_is_found() {
        // 3 dx², and half of it with the other kernel.
        let runs =
            [(at(1.0, &[]), 3.0), (at(2.0, &[]), 12.0), (at(4.0, &[]), 48.0), (at(1.0, &["kernel=w"]), 1.5)];
        let fit = Fit::new(&runs).unwrap();
        assert!((fit.slope().unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(fit.spare, 1);
        assert!(fit.deviation < 1e-12);
        let inside = fit.predict(&at(2.0, &["kernel=w"])).unwrap();
        assert!((inside.value - 6.0).abs() < 1e-9 && !inside.extrapolated);
        let outside = fit.predict(&at(0.5, &[])).unwrap();
        assert!((outside.value - 0.75).abs() < 1e-9 && outside.extrapolated);
        assert_eq!(fit.predict(&at(2.0, &["kernel=x"])), None);
    }

    #[test]
    fn the_interval_follows_students_distribution() {
        // Logarithms 0, 1 at one spacing: mean 1/2, deviation sqrt(1/2), one spare run. t(0.9, 1) = 3.0777;
        // the half width is 3.0777 sqrt(1/2) sqrt(3/2).
        let runs = [(at(1.0, &[]), 1.0), (at(1.0, &[]), 1.0_f64.exp())];
        let fit = Fit::new(&runs).unwrap();
        assert_eq!((fit.slope(), fit.spare), (None, 1));
        let prediction = fit.predict(&at(1.0, &[])).unwrap();
        let half = 3.077_684 * 0.75_f64.sqrt();
        let (low, high) = prediction.interval.unwrap();
        assert!((low.ln() - 0.5 + half).abs() < 1e-5 && (high.ln() - 0.5 - half).abs() < 1e-5);
        assert!((prediction.value.ln() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn without_a_spare_run_there_is_no_interval() {
        let fit = Fit::new(&[(at(1.0, &[]), 1.0), (at(2.0, &[]), 2.0)]).unwrap();
        assert_eq!((fit.spare, fit.predict(&at(1.5, &[])).unwrap().interval), (0, None));
        assert!(Fit::new(&[(at(1.0, &[]), 1.0), (at(2.0, &[]), 0.0)]).is_none());
    }

    #[test]
    fn keys_that_only_changed_together_are_not_predicted_apart() {
        let both = &["a=1", "b=1"][..];
        let fit = Fit::new(&[(at(1.0, &[]), 1.0), (at(1.0, both), 4.0), (at(1.0, both), 4.0)]).unwrap();
        assert!((fit.predict(&at(1.0, both)).unwrap().value - 4.0).abs() < 1e-9);
        assert_eq!(fit.predict(&at(1.0, &["a=1"])), None);
    }
}
