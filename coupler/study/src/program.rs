//! Which program made a run: this one, and those that compute its solids.

use super::error::StudyError;
use super::named::Named;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};
use xxhash_rust::xxh3::xxh3_64;

/// Which program made a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Version of the program.
    pub version: String,
    /// Hash of its file: versions under development have the same number.
    pub build: String,
    /// The instruction set that it computes with.
    #[serde(default)]
    pub isa: String,
    /// The programs that compute solids, each with a hash of the files that its command names; where these
    /// are not known a word that no other study has.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub solids: Vec<(String, String)>,
}

impl Program {
    /// The one that is running.
    ///
    /// # Errors
    /// The program's file cannot be read.
    pub fn own() -> Result<Self, StudyError> {
        let bytes = own_path().and_then(std::fs::read).map_err(StudyError::system("the own program"))?;
        let build = format!("{:016x}", xxh3_64(&bytes));
        let isa = halfstep::isa::of_environment().map_err(|e| StudyError::System(e.to_string()))?;
        Ok(Self {
            version: env!("CARGO_PKG_VERSION").into(),
            build,
            isa: format!("{isa:?}"),
            solids: Vec::new(),
        })
    }

    /// With solids that these commands compute, `[NAME=]COMMAND`. Where it is not known which files a command names, no
    /// other study has the same program: why comes with it.
    pub fn with_solids(mut self, commands: &[String]) -> (Self, Vec<String>) {
        let mut unknown = Vec::new();
        for command in commands {
            let named = Named::by(command);
            let missing = |word: &String| format!("`{word}` of `{command}` is no file that is known");
            let why = named.unknown.first().map(missing);
            let hash = match (why, named.hash()) {
                (None, Ok(hash)) => format!("{hash:016x}"),
                (why, hash) => {
                    unknown.extend(why.or(hash.err().map(|error| format!("`{command}`: {error}"))));
                    format!("unknown-{}-{:x}", std::process::id(), nanoseconds())
                }
            };
            self.solids.push((command.clone(), hash));
        }
        (self, unknown)
    }
}

fn nanoseconds() -> u128 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos())
}

/// The file of the program that is running.
pub(super) fn own_path() -> std::io::Result<PathBuf> {
    std::env::current_exe()
}
