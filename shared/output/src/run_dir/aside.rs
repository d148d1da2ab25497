//! What a run wrote after the checkpoint that it is to go on from: set aside until it goes on, else put back.

use super::{RunDirectory, files, is_frame_file, remove, stems};
use crate::{OutputError, atomic, series};
use std::fs;
use std::path::PathBuf;

/// Frames, indexes and report of a run from a checkpoint on. Dropped, they are put back.
#[derive(Debug)]
#[must_use]
pub struct SetAside {
    /// What is written anew, under the temporary names that the others have: file and content, if it was there.
    told: Vec<(PathBuf, Option<Vec<u8>>)>,
    /// The names of the files, each with the temporary one that it has meanwhile.
    files: Vec<[PathBuf; 2]>,
}

impl SetAside {
    /// The run goes on: what it wrote after the checkpoint is forgotten.
    ///
    /// # Errors
    /// The folder cannot be changed.
    pub fn forget(mut self) -> Result<(), OutputError> {
        self.told.clear();
        remove(std::mem::take(&mut self.files).into_iter().map(|[_, aside]| aside).collect())
    }
}

impl Drop for SetAside {
    fn drop(&mut self) {
        for [path, aside] in &self.files {
            if let Err(error) = fs::rename(aside, path) {
                tracing::error!("{} stays {}: {error}", path.display(), aside.display());
            }
        }
        for (path, content) in &self.told {
            let put_back = match content {
                Some(content) => atomic::replace_bytes(path, content),
                None => remove(vec![path.clone()]),
            };
            if let Err(error) = put_back {
                tracing::error!("{error}");
            }
        }
    }
}

impl RunDirectory {
    /// Sets aside what the run wrote after a checkpoint with so many frames, and removes what an interrupted write
    /// left.
    ///
    /// # Errors
    /// The folder cannot be read or changed.
    pub fn set_aside(&self, frames: u64) -> Result<SetAside, OutputError> {
        let folder = self.frames();
        fs::create_dir_all(&folder).map_err(OutputError::io("create", &folder))?;
        let stems = stems(&folder)?;
        remove(self.temporaries(&stems)?)?;
        let mut aside = SetAside { told: Vec::new(), files: Vec::new() };
        let indexes: Vec<PathBuf> = stems.iter().map(|stem| folder.join(series::index_name(stem))).collect();
        let told = ["run.json", "scene.json"].map(|name| self.file(name));
        for path in told.into_iter().chain(indexes.into_iter().filter(|index| index.is_file())) {
            let read = |path: &PathBuf| fs::read(path).map_err(OutputError::io("read", path));
            let content = if path.is_file() { Some(read(&path)?) } else { None };
            aside.told.push((path, content));
        }
        for stem in &stems {
            let own = std::slice::from_ref(stem);
            let first = series::frame_name(stem, frames as u32);
            let is_later = |name: &str| {
                name != series::index_name(stem) && is_frame_file(name, own) && name >= first.as_str()
            };
            for path in files(&folder, is_later)? {
                let kept = atomic::temporary(&path);
                fs::rename(&path, &kept).map_err(OutputError::io("set aside", &path))?;
                aside.files.push([path, kept]);
            }
            series::forget_from(&folder, stem, frames as u32, |name| is_frame_file(name, own))?;
        }
        Ok(aside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::writer::FrameWriter;
    use halfstep_wire::frame::{Frame, FrameSink};
    use std::path::Path;

    /// Name and content of each file of a folder and of its frames.
    fn content(dir: &Path) -> Vec<(PathBuf, Vec<u8>)> {
        let all = [dir.to_owned(), series::frames_folder(dir)];
        let paths = all.iter().flat_map(|folder| files(folder, |_| true).unwrap());
        paths.map(|path| (path.clone(), fs::read(path).unwrap())).collect()
    }

    #[test]
    fn what_came_later_is_put_back_unless_the_run_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path();
        let run = RunDirectory::create(dir, false).unwrap();
        let mut writer: Box<dyn FrameSink> = Box::new(FrameWriter::start(dir, "fluid").unwrap());
        for number in 0..4 {
            writer.submit(number, &mut |frame: &mut Frame| frame.time = f64::from(number)).unwrap();
        }
        writer.finish().unwrap();
        for (name, text) in [("run.json", "failed"), ("scene.json", "until 4"), ("notes.txt", "mine")] {
            fs::write(dir.join(name), text).unwrap();
        }
        let whole = content(dir);
        let set = || run.set_aside(2).unwrap();
        let begin = || {
            fs::write(dir.join("run.json"), "begun").unwrap();
            fs::write(dir.join("scene.json"), "until 9").unwrap();
        };
        let aside = set();
        let listed = series::Series::of_run(dir, "fluid").unwrap();
        assert_eq!((listed.len(), dir.join("frames/fluid_000002.hdf").exists()), (2, false));
        begin();
        drop(aside);
        assert!(content(dir) == whole);
        // A folder without a report stays one.
        fs::remove_file(dir.join("run.json")).unwrap();
        let aside = set();
        begin();
        drop(aside);
        assert!(!dir.join("run.json").exists());
        let aside = set();
        begin();
        aside.forget().unwrap();
        let names: Vec<_> = content(dir).into_iter().map(|(path, _)| path).collect();
        let told = ["notes.txt", "run.json", "run.lock", "scene.json"].map(|name| dir.join(name));
        let frames = ["fluid.hdf.series", "fluid_000000.hdf", "fluid_000001.hdf"];
        let frames = frames.map(|name| dir.join("frames").join(name));
        assert_eq!(names, [&told[..], &frames].concat());
    }
}
