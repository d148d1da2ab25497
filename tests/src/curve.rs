//! A measured or published curve, and the figures that benchmarks state about one.

use crate::run::repository;
use halfstep_output::Table;

/// Values over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Times, s, ascending.
    pub times: Vec<f64>,
    /// Values in their own unit.
    pub values: Vec<f64>,
}

impl Curve {
    /// A column of a table, with or without its unit.
    ///
    /// # Panics
    /// The table has no such column.
    pub fn of(table: &Table, name: &str) -> Self {
        let values = table.column(name).unwrap_or_else(|| panic!("no {name} in {:?}", table.columns));
        Self { times: table.times(), values }
    }

    /// A column of `validation/CASE/reference/FILE`.
    ///
    /// # Panics
    /// There is no such file or column.
    pub fn reference(case: &str, file: &str, column: &str) -> Self {
        let path = repository().join("validation").join(case).join("reference").join(file);
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(&path).expect("reference");
        let headers = reader.headers().expect("headers").clone();
        let at = |name: &str| {
            headers.iter().position(|h| h == name).unwrap_or_else(|| panic!("{file} has no {name}"))
        };
        let (time, value) = (at("time [s]"), at(column));
        let rows: Vec<_> = reader.records().map(|r| r.expect("a row")).collect();
        let column = |k: usize| rows.iter().map(|r| r[k].trim().parse().expect("a number")).collect();
        Self { times: column(time), values: column(value) }
    }

    /// Value at a time, linear between rows.
    pub fn at(&self, time: f64) -> f64 {
        let next = self.times.partition_point(|&t| t < time).clamp(1, self.times.len() - 1);
        let (t0, t1) = (self.times[next - 1], self.times[next]);
        let (v0, v1) = (self.values[next - 1], self.values[next]);
        v0 + (v1 - v0) * (time - t0) / (t1 - t0)
    }

    /// Largest distance from another curve at the rows of this one.
    pub fn farthest_from(&self, other: &Self) -> f64 {
        self.times.iter().zip(&self.values).map(|(&t, v)| (v - other.at(t)).abs()).fold(0.0, f64::max)
    }

    /// Time and value of the largest value.
    pub fn peak(&self) -> (f64, f64) {
        let best = (0..self.values.len()).max_by(|&a, &b| self.values[a].total_cmp(&self.values[b]));
        let k = best.expect("a curve has rows");
        (self.times[k], self.values[k])
    }

    /// Time and value of the first maximum that the curve has left behind by `fall`.
    pub fn first_peak(&self, fall: f64) -> Option<(f64, f64)> {
        let mut best = (self.times[0], self.values[0]);
        for (&t, &v) in self.times.iter().zip(&self.values) {
            if v > best.1 {
                best = (t, v);
            } else if best.1 - v >= fall {
                return Some(best);
            }
        }
        None
    }

    /// First time at which the curve reaches a value.
    pub fn first_above(&self, value: f64) -> Option<f64> {
        self.values.iter().position(|&v| v >= value).map(|k| self.times[k])
    }

    /// The part from one time to another.
    #[must_use]
    pub fn between(&self, from: f64, to: f64) -> Self {
        let (times, values) =
            self.times.iter().zip(&self.values).filter(|(t, _)| (from..=to).contains(*t)).unzip();
        Self { times, values }
    }

    /// Mean of the values.
    pub fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len() as f64
    }

    /// Amplitude of the part with this period, s, about a value; the curve has whole periods.
    pub fn amplitude(&self, period: f64, about: f64) -> f64 {
        let part = |of: fn(f64) -> f64| {
            let rows = self.times.iter().zip(&self.values);
            let sum: f64 = rows.map(|(t, v)| (v - about) * of(std::f64::consts::TAU * t / period)).sum();
            2.0 * sum / self.values.len() as f64
        };
        part(f64::cos).hypot(part(f64::sin))
    }

    /// Slope of the line through the curve by least squares, per second.
    pub fn slope(&self) -> f64 {
        let n = self.times.len() as f64;
        let (time, value) = (self.times.iter().sum::<f64>() / n, self.mean());
        let rows = || self.times.iter().zip(&self.values);
        let moment: f64 = rows().map(|(t, v)| (t - time) * (v - value)).sum();
        moment / rows().map(|(t, _)| (t - time).powi(2)).sum::<f64>()
    }

    /// Root mean square of the difference to a reference, at the reference's times within this curve's.
    pub fn rms_to(&self, reference: &Self) -> f64 {
        let last = *self.times.last().expect("a curve has rows");
        let squares: Vec<f64> = reference
            .times
            .iter()
            .zip(&reference.values)
            .filter(|(t, _)| **t <= last)
            .map(|(&t, &v)| (self.at(t) - v).powi(2))
            .collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    }

    /// Times at which the curve passes through zero upward (`true`) or downward, linear between rows.
    pub fn crossings(&self) -> Vec<(f64, bool)> {
        let rows = self.times.windows(2).zip(self.values.windows(2));
        rows.filter(|(_, v)| (v[0] < 0.0) != (v[1] < 0.0))
            .map(|(t, v)| (t[0] + (t[1] - t[0]) * v[0] / (v[0] - v[1]), v[1] >= 0.0))
            .collect()
    }

    /// Mean period of an oscillation about zero: twice the mean distance of its crossings. `None` with fewer than two.
    pub fn period(&self) -> Option<f64> {
        let crossings = self.crossings();
        let (first, last) = (crossings.first()?, crossings.last()?);
        (crossings.len() > 1).then(|| 2.0 * (last.0 - first.0) / (crossings.len() - 1) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(f: impl Fn(f64) -> f64) -> Curve {
        let times: Vec<f64> = (0..=1000).map(|k| 1e-3 * f64::from(k)).collect();
        Curve { values: times.iter().map(|&t| f(t)).collect(), times }
    }

    #[test]
    fn the_part_of_a_period_by_hand() {
        // 0.3 sin - 0.4 cos has the amplitude 0.5; two other whole numbers of periods have no part in it.
        let turn = |t: f64| std::f64::consts::TAU * t;
        let wave =
            sampled(|t| 2.0 + 0.3 * turn(4.0 * t).sin() - 0.4 * turn(4.0 * t).cos() + turn(8.0 * t).sin());
        assert!((wave.amplitude(0.25, 2.0) - 0.5).abs() < 2e-3, "{}", wave.amplitude(0.25, 2.0));
    }

    #[test]
    fn an_oscillation_has_its_period_and_first_peak() {
        let period = 0.254;
        let wave = sampled(|t| -0.2 + (std::f64::consts::TAU * t / period).sin());
        let centred = Curve { values: wave.values.iter().map(|v| v + 0.2).collect(), ..wave.clone() };
        assert!((centred.period().unwrap() - period).abs() < 1e-5);
        let (time, value) = wave.first_peak(0.1).unwrap();
        assert!((time - period / 4.0).abs() < 1e-3 && (value - 0.8).abs() < 1e-3);
        assert_eq!(wave.first_peak(3.0), None);
        assert_eq!(sampled(|t| 1.0 + t).period(), None);
    }

    #[test]
    fn values_are_interpolated_and_compared() {
        let line = sampled(|t| 2.0 * t);
        assert!((line.at(0.12345) - 0.2469).abs() < 1e-12);
        assert!((line.at(0.0)).abs() < 1e-15 && (line.at(1.0) - 2.0).abs() < 1e-12);
        assert!((line.between(0.2, 0.4).mean() - 0.6).abs() < 1e-9);
        let reference = Curve { times: vec![0.5, 0.7, 3.0], values: vec![1.3, 1.4, 9.0] };
        assert!((line.rms_to(&reference) - 0.3 / 2.0_f64.sqrt()).abs() < 1e-9);
        assert_eq!(line.first_above(1.0), Some(0.5));
        assert!((line.slope() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_references_read() {
        let x = Curve::reference("elastic-gate", "experiment.csv", "x [mm]");
        assert_eq!(x.peak(), (0.16, 46.4));
        assert_eq!(Curve::reference("dam-break-plate", "published-peaks.csv", "x [mm]").times.len(), 7);
    }
}
