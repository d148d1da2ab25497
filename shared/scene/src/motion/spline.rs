//! Curves through points with continuous second derivatives.

use serde::{Deserialize, Serialize};

/// The natural cubic spline through points: its second derivative is continuous, and zero at both ends. Before and
/// after them it stands still.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spline {
    /// Ascending, s.
    times: Vec<f64>,
    values: Vec<f64>,
    /// Second derivatives at the points.
    bends: Vec<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    column: Option<Column>,
}

/// A column of a file that points come from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Path of the file, as the scene has it.
    pub file: String,
    /// Title of the column.
    pub title: String,
    /// Title of the column of times.
    #[serde(default)]
    pub time: String,
    /// What its numbers were multiplied by.
    pub scale: f64,
}

impl Spline {
    /// Through points at ascending times; at least two.
    pub fn new(times: Vec<f64>, values: Vec<f64>) -> Self {
        let n = times.len();
        let mut bends = vec![0.0; n];
        // The tridiagonal system h_k M_k + 2 (h_k + h_k+1) M_k+1 + h_k+1 M_k+2 = 6 (s_k+1 - s_k), M the second
        // derivatives, h the intervals and s the slopes between points, by elimination.
        let mut upper = vec![0.0; n];
        for k in 1..n.saturating_sub(1) {
            let (before, after) = (times[k] - times[k - 1], times[k + 1] - times[k]);
            let slope = |k: usize| (values[k + 1] - values[k]) / (times[k + 1] - times[k]);
            let pivot = 2.0 * (before + after) - before * upper[k - 1];
            upper[k] = after / pivot;
            bends[k] = (6.0 * (slope(k) - slope(k - 1)) - before * bends[k - 1]) / pivot;
        }
        for k in (1..n.saturating_sub(1)).rev() {
            bends[k] -= upper[k] * bends[k + 1];
        }
        Self { times, values, bends, column: None }
    }

    /// The same with the column that its points come from.
    #[must_use]
    pub fn from_column(self, column: Column) -> Self {
        Self { column: Some(column), ..self }
    }

    /// The column that its points come from.
    pub fn column(&self) -> Option<&Column> {
        self.column.as_ref()
    }

    /// Rate at which it comes to its last point.
    pub fn last_rate(&self) -> f64 {
        let n = self.times.len();
        self.within(n - 2, self.times[n - 1] - self.times[n - 2])[1]
    }

    /// Value, rate and second rate at a time.
    pub fn at(&self, time: f64) -> [f64; 3] {
        let next = self.times.partition_point(|t| *t <= time);
        match (next.checked_sub(1), self.times.get(next)) {
            (Some(k), Some(_)) => self.within(k, time - self.times[k]),
            (Some(last), None) => [self.values[last], 0.0, 0.0],
            (None, _) => [self.values[0], 0.0, 0.0],
        }
    }

    /// The same at `t` after the point `k`.
    fn within(&self, k: usize, t: f64) -> [f64; 3] {
        let [start, rate, bend, twist] = self.cubic(k);
        let value = start + t * (rate + t * (0.5 * bend + t * twist / 6.0));
        [value, rate + t * (bend + 0.5 * t * twist), bend + t * twist]
    }

    /// Value and derivatives at the point `k`, toward the next.
    fn cubic(&self, k: usize) -> [f64; 4] {
        let h = self.times[k + 1] - self.times[k];
        let (bend, next) = (self.bends[k], self.bends[k + 1]);
        let rate = (self.values[k + 1] - self.values[k]) / h - h * (2.0 * bend + next) / 6.0;
        [self.values[k], rate, bend, (next - bend) / h]
    }

    /// Times of the first and the last point, s.
    pub fn ends(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    /// Least and largest value.
    pub fn extent(&self) -> (f64, f64) {
        let mut extent = (f64::INFINITY, f64::NEG_INFINITY);
        let mut take = |value: f64| extent = (extent.0.min(value), extent.1.max(value));
        self.values.iter().for_each(|&value| take(value));
        for k in 0..self.times.len() - 1 {
            let h = self.times[k + 1] - self.times[k];
            let [_, rate, bend, twist] = self.cubic(k);
            // Where the rate is zero: rate + bend t + twist t² / 2.
            let root = (bend * bend - 2.0 * rate * twist).sqrt();
            let sum = -(bend + root.copysign(bend));
            for t in [sum / twist, 2.0 * rate / sum] {
                if t > 0.0 && t < h {
                    take(self.within(k, t)[0]);
                }
            }
        }
        extent
    }

    /// Largest value in size of what turns back by more than a quarter of its extent; 0 of what goes one way.
    pub fn swings_by(&self) -> f64 {
        let (mut highest, mut lowest) = (f64::NEG_INFINITY, f64::INFINITY);
        let (mut fall, mut rise) = (0.0_f64, 0.0_f64);
        for &value in &self.values {
            (highest, lowest) = (highest.max(value), lowest.min(value));
            (fall, rise) = (fall.max(highest - value), rise.max(value - lowest));
        }
        let (low, high) = self.extent();
        if fall.min(rise) > 0.25 * (high - low) { high.max(-low) } else { 0.0 }
    }

    /// Shortest time between two points, s.
    pub fn shortest(&self) -> f64 {
        self.times.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min)
    }

    /// Largest rate in size.
    pub fn fastest(&self) -> f64 {
        let mut fastest = 0.0_f64;
        for k in 0..self.times.len() - 1 {
            let h = self.times[k + 1] - self.times[k];
            let [_, _, bend, twist] = self.cubic(k);
            // The rate is largest at an end, or where the second rate is zero.
            for t in [0.0, h, -bend / twist] {
                if (0.0..=h).contains(&t) {
                    fastest = fastest.max(self.within(k, t)[1].abs());
                }
            }
        }
        fastest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_points_by_hand() {
        assert_eq!(Spline::new(vec![0.0, 1.0, 1.5], vec![0.0, 1.0, 0.0]).shortest(), 0.5);
        // 0, 1, 0 at 0, 1, 2: M = 6 (-1 - 1) / (2 (1 + 1)) = -3; value at 1/2: (0 + 1) / 2 - (0 - 3) / 16 = 11/16.
        let spline = Spline::new(vec![0.0, 1.0, 2.0], vec![0.0, 1.0, 0.0]);
        assert_eq!(spline.at(0.5), [11.0 / 16.0, 1.5 - 0.375, -1.5]);
        assert_eq!(spline.at(1.0), [1.0, 0.0, -3.0]);
        assert_eq!(spline.at(-1.0), [0.0; 3]);
        assert_eq!(spline.at(3.0), [0.0; 3]);
        assert_eq!(spline.last_rate(), -1.5);
        assert_eq!((spline.extent(), spline.fastest()), ((0.0, 1.0), 1.5));
    }

    #[test]
    fn it_passes_its_points_with_continuous_acceleration() {
        let times: Vec<f64> = [0.0, 0.3, 0.35, 1.0, 1.9, 2.0].into();
        let values: Vec<f64> = [0.0, 0.2, -0.1, 0.5, 0.5, 0.0].into();
        let spline = Spline::new(times.clone(), values.clone());
        let (low, high) = spline.extent();
        for (k, (&t, &value)) in times.iter().zip(&values).enumerate() {
            let (before, after) = (spline.at(t - 1e-9), spline.at(t + 1e-9));
            assert!((spline.at(t)[0] - value).abs() < 1e-14, "{t}");
            // Natural ends: no acceleration, so that it is continuous with the rest before and after them.
            assert!((before[2] - after[2]).abs() < 1e-4, "{t}: {before:?} {after:?}");
            if k > 0 && k + 1 < times.len() {
                assert!((before[1] - after[1]).abs() < 1e-6, "{t}: {before:?} {after:?}");
            }
        }
        let mut most = (0.0_f64, 0.0_f64, 0.0_f64);
        for k in 0..20_001 {
            let t = 1e-4 * f64::from(k);
            let [value, rate, _] = spline.at(t);
            let e = 1e-6;
            if t > e && t + e < 2.0 {
                let slope = (spline.at(t + e)[0] - spline.at(t - e)[0]) / (2.0 * e);
                assert!((slope - rate).abs() < 1e-5, "{t}: {slope} {rate}");
            }
            most = (most.0.min(value), most.1.max(value), most.2.max(rate.abs()));
        }
        assert!((most.0 - low).abs() < 1e-5 && (most.1 - high).abs() < 1e-5, "{most:?} {low} {high}");
        assert!((most.2 / spline.fastest() - 1.0).abs() < 1e-3, "{most:?} {}", spline.fastest());
    }

    #[test]
    fn two_points_are_a_straight_line() {
        let spline = Spline::new(vec![1.0, 3.0], vec![0.0, 1.0]);
        assert_eq!(spline.at(2.0), [0.5, 0.5, 0.0]);
        assert_eq!((spline.extent(), spline.fastest()), ((0.0, 1.0), 0.5));
    }

    #[test]
    fn what_turns_back_swings() {
        let of = |values: [f64; 4]| Spline::new(vec![0.0, 1.0, 2.0, 3.0], values.into()).swings_by();
        assert!(of([0.0, 1.0, -2.0, 0.0]) >= 2.0, "about a middle");
        assert!(of([0.0, 3.0, 3.0, 0.0]) >= 3.0, "there and back");
        assert_eq!(of([0.0, 1.0, 2.0, 3.0]), 0.0, "one way");
        assert_eq!(of([0.0, 2.0, 1.9, 3.0]), 0.0, "one way with noise");
    }
}
