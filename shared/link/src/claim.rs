//! A run's files, and who removes them: whoever leaves last.
//!
//! Every role holds a shared lock on one file in the run's root folder. The system releases it when the role ends,
//! however that happens. A role that leaves tries to get the lock for itself: if it can, nobody else is left, and it
//! removes everything that carries the run's prefix. So nothing stays behind even when the launcher was killed; and
//! a later run recognises the files of runs that were killed as a whole by the same lock.

use super::memory::SHM;
use super::{LinkConfig, LinkError};
use std::fs::{DirBuilder, DirEntry, File, OpenOptions};
use std::io::ErrorKind;
use std::os::fd::AsRawFd;
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

const LOCK: &str = "lock";

/// Presence in a run. The last one to be dropped removes the run's files.
#[derive(Debug)]
pub struct Claim {
    lock: File,
    prefix: String,
    root: PathBuf,
}

impl Claim {
    /// Joins the run. A launcher does this before it starts the roles and keeps the claim until they have ended.
    pub fn new(config: &LinkConfig) -> Result<Self, LinkError> {
        config.transport()?;
        let path = config.root.join(LOCK);
        loop {
            match DirBuilder::new().mode(0o700).create(&config.root) {
                Err(e) if e.kind() != ErrorKind::AlreadyExists => {
                    return Err(LinkError::io(&config.root, &e));
                }
                _ => {}
            }
            let lock = match open_lock(&path, true) {
                // The last role of before has just removed the folder.
                Err(e) if e.kind() == ErrorKind::NotFound => continue,
                other => other.map_err(|e| LinkError::io(&path, &e))?,
            };
            flock(&lock, libc::LOCK_SH).map_err(|e| LinkError::io(&path, &e))?;
            if is_file_at(&lock, &path) {
                return Ok(Self { lock, prefix: config.prefix.clone(), root: config.root.clone() });
            }
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        if flock(&self.lock, libc::LOCK_EX | libc::LOCK_NB).is_ok()
            && is_file_at(&self.lock, &self.root.join(LOCK))
        {
            remove_files(&self.prefix, &self.root);
        }
    }
}

/// Removes everything that carries the run's prefix, and its root folder, unless a role of the run still lives.
/// Returns whether the run's files are gone.
pub fn cleanup(config: &LinkConfig) -> bool {
    match Claim::new(config) {
        Ok(claim) => drop(claim),
        Err(_) => return false,
    }
    !config.root.exists()
}

/// Removes what runs of this user left behind that nobody is part of any more. Returns how many there were.
pub fn cleanup_stale() -> usize {
    let mut places = vec![PathBuf::from("/tmp")];
    if std::env::temp_dir() != places[0] {
        places.push(std::env::temp_dir());
    }
    let entries = places.iter().filter_map(|place| std::fs::read_dir(place).ok()).flatten().flatten();
    entries.filter(|entry| remove_if_stale(&entry.path())).count()
}

fn remove_if_stale(root: &Path) -> bool {
    let Some(name) = root.file_name().and_then(|n| n.to_str()).filter(|n| is_run_name(n)) else {
        return false;
    };
    // SAFETY: the call has no preconditions.
    let user = unsafe { libc::geteuid() };
    if !std::fs::symlink_metadata(root).is_ok_and(|m| m.is_dir() && m.uid() == user) {
        return false;
    }
    let path = root.join(LOCK);
    match open_lock(&path, false) {
        Ok(lock) => {
            let free = flock(&lock, libc::LOCK_EX | libc::LOCK_NB).is_ok() && is_file_at(&lock, &path);
            if free {
                remove_files(&format!("{name}_"), root);
            }
            free
        }
        // Either about to be claimed, then it is made again, or half removed.
        Err(_) => std::fs::remove_dir(root).is_ok(),
    }
}

/// The pattern of [`LinkConfig::new`]: `hs`, a process number, `-`, eight hexadecimal digits.
fn is_run_name(name: &str) -> bool {
    let Some((pid, seed)) = name.strip_prefix("hs").and_then(|rest| rest.split_once('-')) else {
        return false;
    };
    !pid.is_empty()
        && pid.bytes().all(|b| b.is_ascii_digit())
        && seed.len() == 8
        && seed.bytes().all(|b| b.is_ascii_hexdigit())
}

fn open_lock(path: &Path, create: bool) -> std::io::Result<File> {
    OpenOptions::new().read(true).write(true).create(create).truncate(false).mode(0o600).open(path)
}

fn is_file_at(file: &File, path: &Path) -> bool {
    let identity = |m: std::fs::Metadata| (m.dev(), m.ino());
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(a), Ok(b)) => identity(a) == identity(b),
        _ => false,
    }
}

fn flock(file: &File, operation: i32) -> std::io::Result<()> {
    loop {
        // SAFETY: the descriptor is open; no memory is passed.
        if unsafe { libc::flock(file.as_raw_fd(), operation) } == 0 {
            return Ok(());
        }
        let error = std::io::Error::last_os_error();
        if error.kind() != ErrorKind::Interrupted {
            return Err(error);
        }
    }
}

/// The lock goes last: whoever is killed in the middle of this leaves a run that the next one recognises.
fn remove_files(prefix: &str, root: &Path) {
    let carries_prefix = |entry: &DirEntry| entry.file_name().to_string_lossy().starts_with(prefix);
    for entry in std::fs::read_dir(SHM).into_iter().flatten().flatten().filter(carries_prefix) {
        let _ = std::fs::remove_file(entry.path());
    }
    for entry in std::fs::read_dir(root).into_iter().flatten().flatten() {
        let path = entry.path();
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            let _ = std::fs::remove_dir_all(path);
        } else if entry.file_name() != LOCK {
            let _ = std::fs::remove_file(path);
        }
    }
    let _ = std::fs::remove_file(root.join(LOCK));
    let _ = std::fs::remove_dir(root);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_process_removes_the_files() {
        let config = LinkConfig::of_two(1, 1);
        let object = Path::new(SHM).join(format!("{}object", config.prefix));
        let (first, second) = (Claim::new(&config).unwrap(), Claim::new(&config).unwrap());
        std::fs::write(&object, "x").unwrap();
        drop(first);
        assert!(object.exists() && config.root.exists());
        assert!(!cleanup(&config), "a role still lives");
        drop(second);
        assert!(!object.exists() && !config.root.exists());
        assert!(cleanup(&config));
    }

    #[test]
    fn only_abandoned_runs_are_stale() {
        let (alive, abandoned) = (LinkConfig::of_two(1, 1), LinkConfig::of_two(1, 1));
        let _claim = Claim::new(&alive).unwrap();
        let claim = Claim::new(&abandoned).unwrap();
        let object = Path::new(SHM).join(format!("{}object", abandoned.prefix));
        std::fs::write(&object, "x").unwrap();
        // As if the process had been killed: the lock goes, nobody removes anything.
        flock(&claim.lock, libc::LOCK_UN).unwrap();
        // Another run on this machine may be faster: only the result counts.
        cleanup_stale();
        assert!(!object.exists() && !abandoned.root.exists());
        assert!(alive.root.join(LOCK).exists());
        drop(claim);
    }

    #[test]
    fn only_names_of_runs_are_touched() {
        assert!(is_run_name("hs12-0123abcd"));
        for other in ["hs-0123abcd", "hs12-0123abc", "hs12-0123abcg", "hsx-0123abcd", "xs12-0123abcd", "hs12"]
        {
            assert!(!is_run_name(other), "{other}");
        }
    }
}
