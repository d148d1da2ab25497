//! Percentiles of a duration over millions of half-steps in constant memory.

use std::time::Duration;

/// Buckets per factor of ten.
const RESOLUTION: f64 = 40.0;
const BUCKETS: usize = 320;

/// Histogram of durations from 0.1 µs to 10 s in steps of 6 %.
#[derive(Clone, Debug)]
pub(crate) struct Latency {
    counts: [u64; BUCKETS],
    total: u64,
}

impl Default for Latency {
    fn default() -> Self {
        Self { counts: [0; BUCKETS], total: 0 }
    }
}

impl Latency {
    /// Counts one duration.
    pub(crate) fn add(&mut self, duration: Duration) {
        let decades = (duration.as_secs_f64() * 1e7).max(1.0).log10();
        self.counts[((decades * RESOLUTION) as usize).min(BUCKETS - 1)] += 1;
        self.total += 1;
    }

    /// The duration that the given share does not exceed, µs; 0 where nothing was counted.
    pub(crate) fn percentile(&self, share: f64) -> f64 {
        let wanted = (self.total as f64 * share).ceil() as u64;
        let mut seen = 0;
        for (bucket, &count) in self.counts.iter().enumerate() {
            seen += count;
            if count > 0 && seen >= wanted {
                return 10f64.powf((bucket as f64 + 0.5) / RESOLUTION) * 0.1;
            }
        }
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_within_a_bucket() {
        let mut latency = Latency::default();
        for k in 1..=100 {
            latency.add(Duration::from_micros(k * 10));
        }
        assert!((latency.percentile(0.5) / 500.0 - 1.0).abs() < 0.06);
        assert!((latency.percentile(0.99) / 990.0 - 1.0).abs() < 0.06);
        assert_eq!(Latency::default().percentile(0.5), 0.0);
    }
}
