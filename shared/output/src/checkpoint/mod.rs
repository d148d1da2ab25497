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

pub use halfstep_wire::checkpoint::{FOLDERS, file_name, folder};
pub use manifest::{FileEntry, Manifest};
pub use writer::StateWriter;

/// The coupler's file.
pub const COUPLER: &str = "coupler.hdf";
/// The file that makes a checkpoint whole.
pub const MANIFEST: &str = "manifest.json";
