//! The index of the frames of one process: `frames/STEM.hdf.series`, which ParaView opens as a time series.
//!
//! A frame is *announced* once the index names it; an announced frame is whole and on disk.

use super::{OutputError, atomic};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The frames announced so far, in the order of time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Version of the index format.
    #[serde(rename = "file-series-version")]
    version: String,
    /// Name and time of each frame.
    pub files: Vec<SeriesEntry>,
}

/// One announced frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeriesEntry {
    /// File name, in the folder of the index.
    pub name: String,
    /// Simulated time, s.
    pub time: f64,
}

impl Default for Series {
    fn default() -> Self {
        Self { version: "1.0".into(), files: Vec::new() }
    }
}

/// The folder of a run's frames.
pub fn frames_folder(run: &Path) -> PathBuf {
    run.join("frames")
}

/// File name of frame `number` of `stem` (`fluid` or `solid`).
pub fn frame_name(stem: &str, number: u32) -> String {
    format!("{stem}_{number:06}.hdf")
}

/// Ending of the name of an index.
pub(crate) const INDEX_SUFFIX: &str = ".hdf.series";

/// File name of the index of `stem`.
pub fn index_name(stem: &str) -> String {
    format!("{stem}{INDEX_SUFFIX}")
}

/// Removes the frames of `stem` from this number on, from its index first.
pub(crate) fn forget_from(
    folder: &Path,
    stem: &str,
    number: u32,
    own: impl Fn(&str) -> bool,
) -> Result<(), OutputError> {
    let index = folder.join(index_name(stem));
    if !index.try_exists().map_err(OutputError::io("read", &index))? {
        return Ok(());
    }
    let mut series = Series::read(&index)?;
    if let Some(entry) = series.files.iter().find(|entry| !own(&entry.name)) {
        return Err(OutputError::malformed(&index, format!("`{}` is no frame of the {stem}", entry.name)));
    }
    let later: Vec<String> = series
        .files
        .iter()
        .map(|entry| entry.name.clone())
        .filter(|name| *name >= frame_name(stem, number))
        .collect();
    series.keep_below(&frame_name(stem, number));
    series.write(&index)?;
    for name in later {
        let path = folder.join(name);
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(OutputError::io("remove", &path)(error));
            }
            _ => {}
        }
    }
    Ok(())
}

impl Series {
    /// Reads an index.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let text = std::fs::read_to_string(path).map_err(OutputError::io("read", path))?;
        serde_json::from_str(&text).map_err(|e| OutputError::malformed(path, e.to_string()))
    }

    /// The frames announced by the run in folder `run`; none where it has no index for `stem`.
    pub fn of_run(run: &Path, stem: &str) -> Result<Vec<(PathBuf, f64)>, OutputError> {
        let folder = frames_folder(run);
        let index = folder.join(index_name(stem));
        if !index.try_exists().map_err(OutputError::io("read", &index))? {
            return Ok(Vec::new());
        }
        Ok(Self::read(&index)?.files.into_iter().map(|entry| (folder.join(entry.name), entry.time)).collect())
    }

    /// Keeps the first entries: those below a frame's name.
    fn keep_below(&mut self, name: &str) {
        self.files.retain(|entry| entry.name.as_str() < name);
    }

    /// Announces a frame, in place of those at its number and later ones.
    pub(crate) fn announce(&mut self, name: String, time: f64) {
        // Numbers have a fixed width, so names sort like numbers.
        self.keep_below(&name);
        self.files.push(SeriesEntry { name, time });
    }

    /// Replaces the index on disk: valid JSON at every instant, one line a frame.
    pub(crate) fn write(&self, path: &Path) -> Result<(), OutputError> {
        let mut text = String::with_capacity(64 + 64 * self.files.len());
        text.push_str("{\"file-series-version\":\"1.0\",\"files\":[");
        for (k, entry) in self.files.iter().enumerate() {
            let line =
                serde_json::to_string(entry).map_err(|e| OutputError::malformed(path, e.to_string()))?;
            let _ = write!(text, "{}\n{line}", if k == 0 { "" } else { "," });
        }
        text.push_str("\n]}\n");
        atomic::replace_bytes(path, text.as_bytes())
    }
}
