//! The folder of a run: what may be in it, and what of it may be removed.

use super::{OutputError, checkpoint, series};
use halfstep_wire::Name;
use std::os::fd::BorrowedFd;
use std::path::{Path, PathBuf};
use std::sync::Arc;

mod aside;
mod lock;
pub use aside::SetAside;
use lock::Lock;

/// Files that a run leaves in its folder, beside the frames.
pub const FILES: [&str; 10] = [
    "run.json",
    "probes.csv",
    "plot.png",
    "contact.png",
    "trace.json",
    "trace.png",
    "log.txt",
    "scene.json",
    "solid.env",
    TRIAL,
];

/// What was tried in a folder of `halfstep fake-fluid`.
pub const TRIAL: &str = "trial.json";

/// Whether a file in the run's folder is one that a run leaves.
fn is_run_file(name: &str) -> bool {
    let between = |start: &str, end: &str| name.strip_prefix(start).is_some_and(|rest| rest.ends_with(end));
    FILES.contains(&name)
        || between("report-", ".json")
        || between("solid-", ".env")
        || between("particles-", ".csv")
        || between("timeline-", ".json")
}

/// Whether a file or folder in the run's folder is one that a run leaves.
pub fn is_of_run(name: &str) -> bool {
    is_run_file(name)
        || checkpoint::FOLDERS.contains(&name)
        || series::frames_folder(Path::new("")) == Path::new(name)
}

/// Whether a file in the folder of a checkpoint is part of one.
fn is_checkpoint_file(name: &str) -> bool {
    let participant = name.strip_suffix(".hdf").is_some_and(|stem| stem.parse::<Name>().is_ok());
    name == checkpoint::MANIFEST || name == checkpoint::COUPLER || participant
}

/// A folder that is ready for a run: nothing of an earlier one is in it, and no other run goes on in it.
#[derive(Clone, Debug)]
pub struct RunDirectory {
    path: PathBuf,
    /// Held for as long as somebody has the folder.
    lock: Arc<Lock>,
}

impl RunDirectory {
    /// Creates the folder, or takes one that exists. Refuses one in which a run goes on, and one with files of an
    /// earlier run unless `force` is set, which removes them. Files that no run leaves are never touched. What an
    /// interrupted write left under a temporary name is removed.
    pub fn create(dir: &Path, force: bool) -> Result<Self, OutputError> {
        let frames = series::frames_folder(dir);
        std::fs::create_dir_all(&frames).map_err(OutputError::io("create", &frames))?;
        let this = Self { path: dir.into(), lock: Arc::new(Lock::take(dir)?) };
        let stems = stems(&frames)?;
        let is_frame = |name: &str| is_frame_file(name, &stems);
        let mut found = files(dir, is_run_file)?;
        found.extend(files(&frames, is_frame)?);
        let checkpoints = checkpoint::FOLDERS.map(|name| dir.join(name));
        for folder in checkpoints.iter().filter(|folder| folder.is_dir()) {
            found.extend(files(folder, is_checkpoint_file)?);
        }
        if let (Some(first), false) = (found.first(), force) {
            let found = first.strip_prefix(dir).unwrap_or(first).display().to_string();
            return Err(OutputError::Occupied { dir: dir.into(), found });
        }
        found.extend(this.temporaries(&stems)?);
        for folder in checkpoints.iter().filter(|folder| folder.is_dir()) {
            found.extend(files(folder, |name| is_temporary(name, is_checkpoint_file))?);
        }
        remove(found)?;
        for folder in checkpoints {
            // One that holds files of others stays.
            let _ = std::fs::remove_dir(folder);
        }
        Ok(this)
    }

    /// The folder of an interrupted run. Nothing in it changes.
    ///
    /// # Errors
    /// A run goes on in it, or there is no such folder.
    pub fn reopen(dir: &Path) -> Result<Self, OutputError> {
        Ok(Self { path: dir.into(), lock: Arc::new(Lock::take(dir)?) })
    }

    /// Whether the frames of a participant below this number are listed and there.
    ///
    /// # Errors
    /// One is missing, or the index cannot be read.
    pub fn check_frames(&self, stem: &str, count: u64) -> Result<(), OutputError> {
        let listed = series::Series::of_run(&self.path, stem)?;
        for number in 0..count {
            let path = self.frames().join(series::frame_name(stem, number as u32));
            let is_listed = listed.get(number as usize).is_some_and(|(listed, _)| *listed == path);
            if !is_listed || !path.is_file() {
                return Err(OutputError::malformed(
                    &path,
                    "this frame was written before the checkpoint and is missing",
                ));
            }
        }
        Ok(())
    }

    /// What interrupted writes left of the run's files and of the frames of these participants.
    fn temporaries(&self, stems: &[String]) -> Result<Vec<PathBuf>, OutputError> {
        let mut found = files(&self.path, |name| is_temporary(name, is_run_file))?;
        let is_frame = |name: &str| is_frame_file(name, stems);
        found.extend(files(&self.frames(), |name| is_temporary(name, is_frame))?);
        Ok(found)
    }

    /// The locked file, for processes of the run that outlive this one: while one of them has it open, the folder is in
    /// use.
    pub fn lock(&self) -> BorrowedFd<'_> {
        self.lock.file()
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder of the frames.
    pub fn frames(&self) -> PathBuf {
        series::frames_folder(&self.path)
    }

    /// Where a file of the run lies: `run.json`, ...
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }
}

fn remove(files: Vec<PathBuf>) -> Result<(), OutputError> {
    let mut files = files.into_iter();
    files.try_for_each(|file| std::fs::remove_file(&file).map_err(OutputError::io("remove", &file)))
}

/// The files in a folder whose name `wanted` accepts, sorted; links count, whatever they lead to.
fn files(folder: &Path, wanted: impl Fn(&str) -> bool) -> Result<Vec<PathBuf>, OutputError> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(OutputError::io("read", folder))? {
        let entry = entry.map_err(OutputError::io("read", folder))?;
        let kind = entry.file_type().map_err(OutputError::io("read", &entry.path()))?;
        if !kind.is_dir() && entry.file_name().to_str().is_some_and(&wanted) {
            found.push(entry.path());
        }
    }
    found.sort();
    Ok(found)
}

/// Participants whose frames are in a folder: those with an index, and those that every run may have.
fn stems(frames: &Path) -> Result<Vec<String>, OutputError> {
    let is_index =
        |name: &str| name.strip_suffix(series::INDEX_SUFFIX).is_some_and(|stem| stem.parse::<Name>().is_ok());
    let indexed = files(frames, is_index)?;
    let stem =
        |path: &PathBuf| path.file_name()?.to_str()?.strip_suffix(series::INDEX_SUFFIX).map(str::to_owned);
    let mut stems = vec![Name::FLUID.to_string(), Name::SOLID.to_string()];
    stems.extend(indexed.iter().filter_map(stem));
    Ok(stems)
}

/// Whether a file in the folder of the frames is a frame or an index of one of these participants.
fn is_frame_file(name: &str, stems: &[String]) -> bool {
    stems.iter().any(|stem| {
        name == series::index_name(stem)
            || name
                .strip_prefix(stem.as_str())
                .and_then(|rest| rest.strip_prefix('_')?.strip_suffix(".hdf"))
                .is_some_and(|digits| digits.len() >= 6 && digits.bytes().all(|b| b.is_ascii_digit()))
    })
}

/// Whether `name` is the temporary name of a file that `own` accepts.
fn is_temporary(name: &str, own: impl Fn(&str) -> bool) -> bool {
    name.strip_prefix('.').and_then(|rest| rest.strip_suffix(".tmp")).is_some_and(own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn touch(dir: &Path, names: &[&str]) {
        fs::create_dir_all(dir.join("frames")).unwrap();
        for name in names {
            fs::write(dir.join(name), name).unwrap();
        }
    }

    fn listing(dir: &Path) -> Vec<String> {
        let mut names: Vec<String> = files(dir, |_| true)
            .unwrap()
            .into_iter()
            .chain(files(&dir.join("frames"), |_| true).unwrap())
            .map(|path| path.strip_prefix(dir).unwrap().display().to_string())
            .collect();
        names.sort();
        names
    }

    const EXTERNAL: [&str; 7] = [
        "notes.txt",
        ".notes.tmp",
        "old-run.json",
        "frames/fluid_12.hdf",
        "frames/fluid_00000a.hdf",
        "frames/gas_000001.hdf",
        "frames/.swap.tmp",
    ];

    #[test]
    fn any_file_of_an_earlier_run_is_refused_and_kept() {
        for name in FILES.iter().chain(&["frames/fluid_000000.hdf", "frames/solid.hdf.series"]) {
            let dir = tempfile::tempdir().unwrap();
            touch(dir.path(), &[name]);
            let error = RunDirectory::create(dir.path(), false).unwrap_err();
            assert!(matches!(&error, OutputError::Occupied { found, .. } if found == name), "{error}");
            assert_eq!(listing(dir.path()), [*name]);
        }
    }

    #[test]
    fn force_removes_what_a_run_leaves_and_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        touch(dir.path(), &FILES);
        touch(
            dir.path(),
            &["frames/fluid_000000.hdf", "frames/solid_1234567.hdf", "frames/fluid.hdf.series"],
        );
        // Frames of a participant of any name are known by their index, which other programs' files lack.
        touch(dir.path(), &["frames/gate-2_000000.hdf", "frames/gate-2.hdf.series", "report-gate-2.json"]);
        touch(dir.path(), &[".run.json.tmp", "frames/.fluid_000001.hdf.tmp", "frames/.solid.hdf.series.tmp"]);
        touch(dir.path(), &EXTERNAL);
        fs::create_dir(dir.path().join("frames/solid_000009.hdf")).unwrap();
        RunDirectory::create(dir.path(), true).unwrap();
        let mut kept = EXTERNAL.map(String::from);
        kept.sort();
        assert_eq!(listing(dir.path()), kept);
        assert!(dir.path().join("frames/solid_000009.hdf").is_dir());
    }

    #[test]
    fn a_folder_in_use_is_refused_also_with_force() {
        let dir = tempfile::tempdir().unwrap();
        let first = RunDirectory::create(dir.path(), false).unwrap();
        touch(dir.path(), &["run.json"]);
        for again in [RunDirectory::create(dir.path(), true), RunDirectory::reopen(dir.path())] {
            let message = again.unwrap_err().to_string();
            assert!(message.contains(&format!("process {}", std::process::id())), "{message}");
        }
        assert_eq!(listing(dir.path()), ["run.json", "run.lock"], "nothing was removed");
        drop(first);
        assert_eq!(listing(dir.path()), ["run.json"]);
        RunDirectory::create(dir.path(), true).unwrap();
    }

    #[test]
    fn checkpoints_of_an_earlier_run_are_refused_and_removed_with_force() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("checkpoint-b");
        fs::create_dir_all(&folder).unwrap();
        for name in ["gate.hdf", "coupler.hdf", "manifest.json", ".gate.hdf.tmp"] {
            fs::write(folder.join(name), name).unwrap();
        }
        assert!(matches!(RunDirectory::create(dir.path(), false), Err(OutputError::Occupied { .. })));
        RunDirectory::create(dir.path(), true).unwrap();
        assert!(!folder.exists());
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("notes.txt"), "mine").unwrap();
        RunDirectory::create(dir.path(), true).unwrap();
        assert!(folder.join("notes.txt").exists());
    }

    #[test]
    fn temporary_files_alone_are_no_earlier_run_and_go() {
        let dir = tempfile::tempdir().unwrap();
        touch(dir.path(), &[".run.json.tmp", "frames/.fluid_000001.hdf.tmp", "notes.txt"]);
        let run = RunDirectory::create(dir.path(), false).unwrap();
        assert_eq!(listing(dir.path()), ["notes.txt", "run.lock"]);
        assert_eq!(run.file("run.json"), dir.path().join("run.json"));
    }

    #[test]
    fn a_new_folder_is_created_with_its_parents() {
        let dir = tempfile::tempdir().unwrap();
        let run = RunDirectory::create(&dir.path().join("out/gate"), false).unwrap();
        assert!(run.frames().is_dir());
        fs::write(dir.path().join("file"), "").unwrap();
        let error = RunDirectory::create(&dir.path().join("file"), true).unwrap_err();
        assert!(error.to_string().contains("file"), "{error}");
    }
}
