//! Where the checkpoints of a run lie: the last two, in turn, each with a file for each participant.

use std::path::{Path, PathBuf};

/// Folders of the two generations.
pub const FOLDERS: [&str; 2] = ["checkpoint-a", "checkpoint-b"];

/// Where checkpoint `number` of the run in a folder lies; the first has number 1.
pub fn folder(run: &Path, number: u64) -> PathBuf {
    run.join(FOLDERS[usize::from(number.is_multiple_of(2))])
}

/// The file of a participant.
pub fn file_name(participant: &str) -> String {
    format!("{participant}.hdf")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The protocol page gives these names to programs of others.
    #[test]
    fn generations_take_turns() {
        let at = |number| folder(Path::new("run"), number).join(file_name("gate"));
        assert_eq!(at(1), Path::new("run/checkpoint-a/gate.hdf"));
        assert_eq!((at(2), at(3)), ("run/checkpoint-b/gate.hdf".into(), at(1)));
    }
}
