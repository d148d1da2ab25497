//! Which instruction set a process computes with: the one that the processor is fastest with, unless the environment
//! names one.

use halfstep_role::serve;
use halfstep_scene::parse;
use halfstep_sph::lane::Isa;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Environment variable with the instruction set level: `baseline`, `avx2` or `avx512vl`. Without it the fastest is
/// taken. Roles that run as processes inherit it.
pub const ISA_VARIABLE: &str = "HALFSTEP_ISA";

/// The levels by name, lowest first.
const LEVELS: [(&str, Isa); 3] =
    [("baseline", Isa::Baseline), ("avx2", Isa::Avx2), ("avx512vl", Isa::Avx512vl)];

/// Why a level cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum IsaError {
    /// No level has this name.
    #[error("{ISA_VARIABLE} is `{0}`, but a level is baseline, avx2 or avx512vl")]
    Unknown(String),
    /// The processor lacks the level's instructions.
    #[error("{ISA_VARIABLE} is `{}`, but this processor's best level is {}", name(*.asked), name(*.best))]
    Absent {
        /// The level asked for.
        asked: Isa,
        /// The processor's best.
        best: Isa,
    },
}

/// A level's name.
pub fn name(isa: Isa) -> &'static str {
    match isa {
        Isa::Baseline => "baseline",
        Isa::Avx2 => "avx2",
        Isa::Avx512vl => "avx512vl",
    }
}

/// The level that [`ISA_VARIABLE`] names in this process's environment, or else the fastest.
///
/// # Errors
/// There is no such level, or the processor does not have it.
pub fn of_environment() -> Result<Isa, IsaError> {
    match std::env::var_os(ISA_VARIABLE) {
        Some(value) => choose(&value.to_string_lossy(), Isa::detect()),
        None => Ok(fastest()),
    }
}

/// Water whose passes are timed: 1000 particles.
const TRIAL: &str = "resolution = 0.02\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
                     phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.8, 0.5] }\n";
/// Of which the fastest counts, since others may have the processor in between.
const PASSES: usize = 5;

/// The level with the fastest passes on this processor. AVX-512 computes eight targets at once, whose neighbours are
/// 1.25 times as many for each: where a processor has one unit for such vectors it loses. Both levels give the same
/// bits.
pub fn fastest() -> Isa {
    static FASTEST: OnceLock<Isa> = OnceLock::new();
    *FASTEST.get_or_init(|| match Isa::detect() {
        Isa::Avx512vl => quicker(Isa::Avx512vl, Isa::Avx2),
        best => best,
    })
}

/// The one of two levels that computes the trial's passes in less time.
fn quicker(one: Isa, other: Isa) -> Isa {
    let trial = parse(TRIAL, "trial.toml".as_ref(), &[]).ok();
    let fluids = trial.map(|scene| [one, other].map(|isa| halfstep_fluid::role(&scene, isa)));
    let Some([Some(mut first), Some(mut second)]) = fluids else { return one };
    let timed = serve::on_threads(1, || {
        let mut least = [Duration::MAX; 2];
        for _ in 0..PASSES {
            for (role, least) in [&mut first, &mut second].into_iter().zip(&mut least) {
                let start = Instant::now();
                role.own_sums();
                *least = start.elapsed().min(*least);
            }
        }
        least
    });
    timed.map_or(one, |[first, second]| if first <= second { one } else { other })
}

fn choose(value: &str, best: Isa) -> Result<Isa, IsaError> {
    let level = LEVELS.iter().find(|(name, _)| *name == value);
    let (_, asked) = *level.ok_or_else(|| IsaError::Unknown(value.into()))?;
    if asked <= best { Ok(asked) } else { Err(IsaError::Absent { asked, best }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_environment_may_lower_the_level_and_not_raise_it() {
        assert_eq!(choose("baseline", Isa::Avx2), Ok(Isa::Baseline));
        assert_eq!(choose("avx2", Isa::Avx2), Ok(Isa::Avx2));
        let absent = choose("avx512vl", Isa::Avx2).unwrap_err();
        assert_eq!(absent.to_string(), "HALFSTEP_ISA is `avx512vl`, but this processor's best level is avx2");
        let unknown = choose("AVX2", Isa::Avx2).unwrap_err();
        assert_eq!(unknown.to_string(), "HALFSTEP_ISA is `AVX2`, but a level is baseline, avx2 or avx512vl");
        assert!(fastest() <= Isa::detect());
        assert_eq!(
            fastest() == Isa::Baseline,
            Isa::detect() == Isa::Baseline,
            "as fast levels have the same bits"
        );
        assert!(LEVELS.iter().all(|(text, level)| name(*level) == *text));
    }
}
