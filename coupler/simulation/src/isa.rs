//! Which instruction set a process computes with: the one that passes are fastest with on this processor, unless the
//! environment names another one that it has.

use halfstep_sph::lane::Isa;

/// Environment variable with the instruction set level: `baseline`, `avx2` or `avx512vl`. Without it
/// [`Isa::preferred`] is taken. Roles that run as processes inherit it.
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

/// The level that [`ISA_VARIABLE`] names in this process's environment, or else [`Isa::preferred`].
///
/// # Errors
/// There is no such level, or the processor does not have it.
pub fn of_environment() -> Result<Isa, IsaError> {
    let value = std::env::var_os(ISA_VARIABLE);
    let value = value.map(|v| v.to_string_lossy().into_owned());
    value.map_or_else(|| Ok(Isa::preferred()), |value| choose(&value, Isa::detect()))
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
    fn the_environment_names_a_level_that_the_processor_has() {
        assert_eq!(choose("avx512vl", Isa::Avx512vl), Ok(Isa::Avx512vl));
        assert_eq!(choose("baseline", Isa::Avx2), Ok(Isa::Baseline));
        assert_eq!(choose("avx2", Isa::Avx2), Ok(Isa::Avx2));
        let absent = choose("avx512vl", Isa::Avx2).unwrap_err();
        assert_eq!(absent.to_string(), "HALFSTEP_ISA is `avx512vl`, but this processor's best level is avx2");
        let unknown = choose("AVX2", Isa::Avx2).unwrap_err();
        assert_eq!(unknown.to_string(), "HALFSTEP_ISA is `AVX2`, but a level is baseline, avx2 or avx512vl");
        assert!(LEVELS.iter().all(|(text, level)| name(*level) == *text));
    }
}
