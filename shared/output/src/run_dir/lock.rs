//! Who has a run's folder: a file that its owner keeps locked, with the owner's process and start in it. The system
//! unlocks it when the owner ends, however that is; what is left of a killed run locks nothing.

use crate::OutputError;
use crate::series::is_at;
use std::fs::{File, TryLockError};
use std::io::{Read, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// How long processes of a run whose launcher was killed may take to end.
const ORPHANS: Duration = Duration::from_secs(2);

/// The file's name.
const NAME: &str = "run.lock";

/// A folder that is this process's own while the value lives.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    file: File,
}

impl Lock {
    /// Takes the folder.
    ///
    /// # Errors
    /// Another run has it, or the file cannot be made.
    pub(super) fn take(dir: &Path) -> Result<Self, OutputError> {
        let path = dir.join(NAME);
        let deadline = Instant::now() + ORPHANS;
        loop {
            let mut options = File::options();
            let file = options.read(true).write(true).create(true).truncate(false).open(&path);
            let mut file = file.map_err(OutputError::io("open", &path))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let (process, seconds) = owner(&mut file);
                    // Processes of a killed run end soon after it.
                    let alone =
                        process.is_some_and(|process| !Path::new(&format!("/proc/{process}")).exists());
                    if alone && Instant::now() < deadline {
                        std::thread::sleep(Duration::from_millis(20));
                        continue;
                    }
                    return Err(OutputError::InUse { dir: dir.into(), process, seconds });
                }
                Err(TryLockError::Error(error)) => return Err(OutputError::io("lock", &path)(error)),
            }
            // The owner before may have removed the file after it was opened here.
            if !is_at(&file, &path) {
                continue;
            }
            let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
            file.set_len(0)
                .and_then(|()| writeln!(file, "{} {now}", std::process::id()))
                .map_err(OutputError::io("write", &path))?;
            return Ok(Self { path, file });
        }
    }

    /// The locked file.
    pub(super) fn file(&self) -> BorrowedFd<'_> {
        self.file.as_fd()
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // The file stays locked until it is closed, after this.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Process that has the folder, and for how long, s.
fn owner(file: &mut File) -> (Option<u64>, Option<u64>) {
    let mut text = String::new();
    let _ = file.take(64).read_to_string(&mut text);
    let mut words = text.split_whitespace().map(str::parse::<u64>);
    let (process, started) = (words.next().and_then(Result::ok), words.next().and_then(Result::ok));
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    (process, started.map(|started| now.saturating_sub(started)))
}
