//! Which instruction set and precision the pair loop is computed with.

use super::{LANES, WIDEST, WIDEST_SINGLE};

/// What the sums over fluid and wall particles are computed in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// All in double precision.
    #[default]
    Double,
    /// What a pair gives and its sums within a pass in single precision, from differences of positions and densities in
    /// double precision; states are kept, and rates added to them, in double precision.
    Mixed,
}

impl Precision {
    /// What rows of particles are padded to a multiple of, whatever the processor.
    pub fn padding(self) -> usize {
        match self {
            Self::Double => WIDEST,
            Self::Mixed => WIDEST_SINGLE,
        }
    }
}

/// The instruction set that the pair loop was dispatched to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Isa {
    /// x86-64-v1 or any other processor.
    Baseline,
    /// AVX2 and FMA.
    Avx2,
    /// AVX-512 with VL and DQ: eight numbers at once.
    Avx512vl,
}

impl Isa {
    /// The best that this processor has.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("fma")
            {
                return Self::Avx512vl;
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                return Self::Avx2;
            }
        }
        Self::Baseline
    }

    /// What a run computes with unless it is told: the best, but AVX2 on Intel's processors with AVX-512, for the same
    /// bits. Roots and divisions, which bound the passes, take them as long for each of eight numbers as for each of
    /// four, and a cluster of eight has more neighbours for each target.
    pub fn preferred() -> Self {
        match Self::detect() {
            Self::Avx512vl if intel() => Self::Avx2,
            best => best,
        }
    }

    /// Targets that the wide passes compute at once.
    pub fn targets(self, precision: Precision) -> usize {
        match (self, precision) {
            (Self::Baseline, _) | (Self::Avx2, Precision::Double) => LANES,
            (Self::Avx2, Precision::Mixed) | (Self::Avx512vl, Precision::Double) => WIDEST,
            (Self::Avx512vl, Precision::Mixed) => WIDEST_SINGLE,
        }
    }

    /// Name of the level in `run.json`. The two levels with FMA give the same bits, so they share one name there.
    pub fn bits_name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 | Self::Avx512vl => "fma",
        }
    }
}

/// Whether Intel made this processor.
fn intel() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        let id = std::arch::x86_64::__cpuid(0);
        [id.ebx, id.edx, id.ecx].map(u32::to_le_bytes).as_flattened() == b"GenuineIntel"
    }
    #[cfg(not(target_arch = "x86_64"))]
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_compute_with_a_level_that_the_processor_has_for_the_bits_of_the_best() {
        assert!(Isa::preferred() <= Isa::detect());
        assert_eq!(Isa::preferred().bits_name(), Isa::detect().bits_name());
        assert!(!intel() || Isa::preferred() <= Isa::Avx2);
    }
}
