//! The index of the frames of one process: `frames/STEM.hdf.series`, which ParaView opens as a time series.
//!
//! A frame is *announced* once the index names it; an announced frame is whole and on disk. The index is JSON with a
//! line for each frame. It grows at its end, so that the last of many frames costs no more than the first.

use super::{OutputError, atomic};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::fs::File;
use std::os::unix::fs::{FileExt, MetadataExt};
use std::path::{Path, PathBuf};

/// What stands behind the last frame.
const END: &str = "\n]}\n";

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
    /// Reads an index. One that a crash of the machine has cut lists the frames whose lines are whole.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let text = std::fs::read_to_string(path).map_err(OutputError::io("read", path))?;
        serde_json::from_str(&text).or_else(|error| {
            let whole = text.rfind('}').map(|end| format!("{}{END}", &text[..=end]));
            let mended = whole.and_then(|whole| serde_json::from_str(&whole).ok());
            mended.ok_or_else(|| OutputError::malformed(path, error.to_string()))
        })
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

    /// Replaces the index on disk, one line a frame.
    pub(crate) fn write(&self, path: &Path) -> Result<(), OutputError> {
        let mut text = String::with_capacity(64 + 64 * self.files.len());
        text.push_str("{\"file-series-version\":\"1.0\",\"files\":[");
        for (k, entry) in self.files.iter().enumerate() {
            let _ = write!(text, "{}\n{}", if k == 0 { "" } else { "," }, line(entry, path)?);
        }
        text.push_str(END);
        atomic::replace_bytes(path, text.as_bytes())
    }
}

fn line(entry: &SeriesEntry, path: &Path) -> Result<String, OutputError> {
    serde_json::to_string(entry).map_err(|e| OutputError::malformed(path, e.to_string()))
}

/// The index of a run that goes on.
#[derive(Debug)]
pub(crate) struct Index {
    path: PathBuf,
    /// What is listed on disk.
    listed: Series,
    /// The file, and where the next line goes; `None` before the first frame.
    file: Option<(File, u64)>,
}

impl Index {
    /// Goes on with what an index on disk lists, if there is one.
    pub(crate) fn open(path: PathBuf) -> Result<Self, OutputError> {
        let listed = match path.try_exists().map_err(OutputError::io("read", &path))? {
            true => Series::read(&path)?,
            false => Series::default(),
        };
        Ok(Self { path, listed, file: None })
    }

    /// Number after the last frame that is listed.
    pub(crate) fn safe(&self) -> u32 {
        let number = |name: &str| name.strip_suffix(".hdf")?.rsplit_once('_')?.1.parse::<u32>().ok();
        self.listed
            .files
            .last()
            .and_then(|entry| number(&entry.name))
            .map_or(0, |last| last.saturating_add(1))
    }

    /// Announces a frame, in place of those at its number and later ones. On return it is listed on disk.
    pub(crate) fn announce(&mut self, name: String, time: f64) -> Result<(), OutputError> {
        let before = self.listed.files.len();
        // Numbers have a fixed width, so names sort like numbers.
        self.listed.keep_below(&name);
        let entry = SeriesEntry { name, time };
        match self.file.take_if(|_| self.listed.files.len() == before && before > 0) {
            Some((file, at)) => self.append(file, at, &entry)?,
            None => self.file = None,
        }
        self.listed.files.push(entry);
        if self.file.is_none() {
            self.replace()?;
        }
        Ok(())
    }

    /// The whole index anew.
    fn replace(&mut self) -> Result<(), OutputError> {
        self.listed.write(&self.path)?;
        let file =
            File::options().write(true).open(&self.path).map_err(OutputError::io("open", &self.path))?;
        let length = file.metadata().map_err(OutputError::io("read", &self.path))?.len();
        self.file = Some((file, length - END.len() as u64));
        Ok(())
    }

    /// One more line, and the end behind it, in one write.
    fn append(&mut self, file: File, at: u64, entry: &SeriesEntry) -> Result<(), OutputError> {
        if !is_at(&file, &self.path) {
            return Err(OutputError::malformed(
                &self.path,
                "it was removed or replaced while the run went on",
            ));
        }
        let more = format!(",\n{}", line(entry, &self.path)?);
        file.write_all_at(format!("{more}{END}").as_bytes(), at)
            .and_then(|()| file.sync_data())
            .map_err(OutputError::io("write", &self.path))?;
        self.file = Some((file, at + more.len() as u64));
        Ok(())
    }
}

/// Whether a path still leads to an open file.
pub(crate) fn is_at(file: &File, path: &Path) -> bool {
    let identity = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(own), Ok(there)) => identity(own) == identity(there),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(path: &Path) -> Vec<String> {
        Series::read(path).unwrap().files.into_iter().map(|entry| entry.name).collect()
    }

    #[test]
    fn a_frame_is_added_without_writing_the_others_anew() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(index_name("fluid"));
        let mut index = Index::open(path.clone()).unwrap();
        index.announce(frame_name("fluid", 0), 0.0).unwrap();
        let file = std::fs::metadata(&path).unwrap().ino();
        for number in 1..40 {
            index.announce(frame_name("fluid", number), f64::from(number) / 3.0).unwrap();
            assert_eq!(names(&path).len() as u32, number + 1, "valid after each frame");
        }
        assert_eq!(std::fs::metadata(&path).unwrap().ino(), file, "the same file");
        // As if it had been written at once.
        let whole = std::fs::read(&path).unwrap();
        Series::read(&path).unwrap().write(&path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), whole);
        let mut index = Index::open(path.clone()).unwrap();
        assert_eq!(index.safe(), 40);
        index.announce(frame_name("fluid", 3), 0.5).unwrap();
        index.announce(frame_name("fluid", 4), 0.6).unwrap();
        assert_eq!(names(&path).len(), 5, "a run that goes on replaces what came later");
        std::fs::remove_file(&path).unwrap();
        let message = index.announce(frame_name("fluid", 5), 0.7).unwrap_err().to_string();
        assert!(message.contains("fluid.hdf.series: it was removed"), "{message}");
    }

    #[test]
    fn an_index_that_a_crash_has_cut_lists_its_whole_lines() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(index_name("fluid"));
        let mut index = Index::open(path.clone()).unwrap();
        for number in 0..3 {
            index.announce(frame_name("fluid", number), f64::from(number)).unwrap();
        }
        let whole = std::fs::read(&path).unwrap();
        let ends: Vec<usize> = (0..whole.len()).filter(|&k| whole[k] == b'}').collect();
        for cut in ends[0] + 1..whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let count = ends[..3].iter().filter(|&&end| end < cut).count();
            assert_eq!(names(&path).len(), count, "{cut} bytes");
        }
    }
}
