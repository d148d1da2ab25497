//! Checkpoints: the states of all participants and of the coupler at one instant, from which a run goes on.
//!
//! ```text
//! checkpoint-a/, checkpoint-b/      the last two, in turn
//!   NAME.hdf                        one for each participant: see [`file`]
//!   coupler.hdf
//!   manifest.json                   last, when all others are on disk: see [`Manifest`]
//! ```
//!
//! The manifest of a checkpoint is removed before its files are replaced, so a folder without one is a torn checkpoint.

pub mod file;
mod manifest;
mod writer;

pub use manifest::{FileEntry, Manifest};
pub use writer::StateWriter;

use std::path::{Path, PathBuf};

/// Folders of the two generations.
pub const FOLDERS: [&str; 2] = ["checkpoint-a", "checkpoint-b"];
/// The coupler's file.
pub const COUPLER: &str = "coupler.hdf";
/// The file that makes a checkpoint whole.
pub const MANIFEST: &str = "manifest.json";

/// Where checkpoint `number` of the run in a folder lies; the first has number 1.
pub fn folder(run: &Path, number: u64) -> PathBuf {
    run.join(FOLDERS[usize::from(number.is_multiple_of(2))])
}

/// The file of a participant.
pub fn file_name(participant: &str) -> String {
    format!("{participant}.hdf")
}
