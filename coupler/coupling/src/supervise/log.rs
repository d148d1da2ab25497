//! The log of a run's children.

use crate::say;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Length beyond which a log is cut, and what is left of it, bytes.
const LONGEST: u64 = 64 << 20;
const LEFT: u64 = 1 << 20;

/// A file to which all children append.
#[derive(Debug)]
pub(super) struct Log {
    path: PathBuf,
    /// It has been cut, and that was said.
    cut: bool,
}

impl Log {
    pub(super) fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), cut: false }
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn open(&self) -> io::Result<File> {
        OpenOptions::new().create(true).append(true).open(&self.path)
    }

    /// Cuts a log that grows without end; says so the first time.
    pub(super) fn keep_short(&mut self) {
        let is_long = std::fs::metadata(&self.path).is_ok_and(|log| log.len() > LONGEST);
        if is_long && self.cut_now().is_ok() && !std::mem::replace(&mut self.cut, true) {
            say::warn(format_args!("warning: log.txt has been cut: a program writes very much"));
        }
    }

    fn cut_now(&self) -> io::Result<()> {
        let mut log = self.open()?;
        log.set_len(LEFT)?;
        writeln!(log, "\n[cut here: {} MiB had been written]", LONGEST >> 20)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The head of the log stays, and what comes afterwards.
    #[test]
    fn a_log_without_end_is_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.txt");
        let mut log = Log::new(&path);
        std::fs::write(&path, "the scene\n").unwrap();
        let grows = || OpenOptions::new().write(true).open(&path).unwrap().set_len(LONGEST + 1).unwrap();
        log.keep_short();
        assert!(!log.cut);
        grows();
        log.keep_short();
        assert!(log.cut);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("the scene\n") && text.ends_with("\n[cut here: 64 MiB had been written]\n"));
        assert!((text.len() as u64) < LEFT + 100);
        grows();
        log.keep_short();
        assert!(std::fs::metadata(&path).unwrap().len() < LEFT + 100);
    }
}
