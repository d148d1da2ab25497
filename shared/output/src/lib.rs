//! What a run leaves behind: frames for viewers, probe curves, the report and two pictures.
//!
//! | file | who writes it |
//! |---|---|
//! | `frames/{fluid,solid}_NNNNNN.hdf`, `frames/{fluid,solid}.hdf.series` | [`FrameWriter`], one per process |
//! | `probes.csv` | [`ProbeLog`] |
//! | `run.json` | [`RunReport`] |
//! | `checkpoint-a/`, `checkpoint-b/` | [`checkpoint`] |
//! | `plot.png`, `contact.png` | [`draw_plot`], [`draw_contact`] |
//! | `trace.json`, `trace.png` | [`timeline`], [`draw_timeline`] |
//!
//! A file that a reader can see is whole: except for `probes.csv`, which grows line by line, every file is written
//! under a temporary name (`.NAME.tmp`), synchronised with the disk and renamed. Killing the program at any moment
//! leaves nothing half-written under a final name.
//!
//! ```
//! use halfstep_output::{ProbeLog, read_probes};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("probes.csv");
//! let mut log = ProbeLog::create(&path, &["tip.x [m]".to_string()])?;
//! log.row(0.1 + 0.2, &[1e-3])?;
//! let table = read_probes(&path)?;
//! assert_eq!(table.column("tip.x"), Some(vec![1e-3]));
//! assert_eq!(table.times(), [0.1 + 0.2], "bit for bit");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod atomic;
mod background;
pub mod checkpoint;
mod first_message;
#[cfg(feature = "pictures")]
pub mod pictures;
pub mod probes;
pub mod run_dir;
pub mod run_json;
pub mod series;
pub mod timeline;
pub mod vtkhdf;
pub mod writer;

pub use first_message::{FirstMessage, IN_FLUID};
pub use halfstep_wire::frame::{Frame, FramePoint};
#[cfg(feature = "pictures")]
pub use pictures::{draw_contact, draw_plot, draw_start, draw_timeline};
pub use probes::{ProbeLog, Table, read_probes};
pub use run_dir::{RunDirectory, SetAside};
pub use run_json::RunReport;
pub use writer::FrameWriter;

use std::path::{Path, PathBuf};

/// Why something could not be written or read. Every message is one line and says which file.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The operating system refused.
    #[error("cannot {action} {}: {error}", path.display())]
    Io {
        /// What was tried: a verb.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        error: std::io::Error,
    },
    /// The HDF5 library refused.
    #[error("cannot {action} {}: {reason}", path.display())]
    Hdf5 {
        /// What was tried: a verb.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The library's reason.
        reason: String,
    },
    /// A file exists but does not hold what its name promises.
    #[error("{}: {reason}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A row has another number of values than the file has columns.
    #[error("{}: a row of {got} values for {expected} columns", path.display())]
    Columns {
        /// The file.
        path: PathBuf,
        /// Columns beside the time.
        expected: usize,
        /// Values given.
        got: usize,
    },
    /// The folder holds an earlier run.
    #[error("{} holds an earlier run ({found}); give another folder, or --force to replace that run", dir.display())]
    Occupied {
        /// The folder.
        dir: PathBuf,
        /// A file of the earlier run.
        found: String,
    },
    /// The folder of a trial holds an earlier run.
    #[error("{} holds a run ({found}); give another folder, or --replace to replace that run", dir.display())]
    HoldsRun {
        /// The folder.
        dir: PathBuf,
        /// A file of the run.
        found: String,
    },
    /// A run goes on in the folder.
    #[error(
        "a run goes on in {}: process {}, for {} s so far; give another folder, or end that run first",
        dir.display(),
        process.map_or_else(|| "unknown".to_owned(), |process| process.to_string()),
        seconds.map_or_else(|| "some".to_owned(), |seconds| seconds.to_string())
    )]
    InUse {
        /// The folder.
        dir: PathBuf,
        /// Number of the process.
        process: Option<u64>,
        /// How long it has had the folder, s.
        seconds: Option<u64>,
    },
    /// A picture could not be drawn.
    #[error("cannot draw {}: {reason}", path.display())]
    Picture {
        /// The picture.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The thread that writes the frames is gone: it panicked, or its error was reported before.
    #[error("the writer of the {stem} frames in {} has stopped", dir.display())]
    WriterStopped {
        /// The folder of the frames.
        dir: PathBuf,
        /// `fluid` or `solid`.
        stem: String,
    },
}

impl OutputError {
    pub(crate) fn io(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |error| Self::Io { action, path: path.into(), error }
    }
    pub(crate) fn hdf5(action: &'static str, path: &Path) -> impl FnOnce(hdf5::Error) -> Self {
        move |error| {
            let text = error.to_string();
            // What the system said, where it did; the names of the library's functions say nothing to a reader.
            let said = text.split_once("error message = '").and_then(|(_, rest)| rest.split_once('\''));
            let reason = match (said, action) {
                (Some((said, _)), _) => said.to_owned(),
                (None, "read") => "it is damaged, or of another kind".to_owned(),
                (None, _) => text,
            };
            Self::Hdf5 { action, path: path.into(), reason }
        }
    }
    pub(crate) fn malformed(path: &Path, reason: impl Into<String>) -> Self {
        Self::Malformed { path: path.into(), reason: reason.into() }
    }
}
