//! A run's files, and who removes them: whoever leaves last.
//!
//! Every role holds a shared lock on one file beside the run's objects in shared memory. The system releases the lock
//! when the role ends, however that happens. A role that leaves tries to get the lock for itself: if it can, nobody
//! else is left, and it removes everything that carries the run's prefix. So nothing stays behind even when the
//! launcher was killed; and a later run recognises the files of runs that were killed as a whole by the same lock.

use super::memory::SHM;
use super::{LinkConfig, LinkError};
use std::collections::BTreeSet;
use std::fs::{DirBuilder, DirEntry, File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::os::fd::AsRawFd;
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How long the end of a killed launcher may take, from what its roles hear first to the last of its files.
const DYING: Duration = Duration::from_millis(500);
/// How long such a launcher may still look alive.
const HEARING: Duration = Duration::from_millis(10);

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
        let path = lock_path(&config.prefix);
        loop {
            let mut lock = open_lock(&path, true).map_err(|e| LinkError::io(&path, &e))?;
            flock(&lock, libc::LOCK_SH).map_err(|e| LinkError::io(&path, &e))?;
            // The last role of before may just have removed the file.
            if !is_file_at(&lock, &path) {
                continue;
            }
            // Whoever cleans up after all of them shall find the folder. All write the same.
            lock.write_all(config.root.as_os_str().as_bytes()).map_err(|e| LinkError::io(&path, &e))?;
            match DirBuilder::new().mode(0o700).create(&config.root) {
                Err(e) if e.kind() != ErrorKind::AlreadyExists => {
                    return Err(LinkError::io(&config.root, &e));
                }
                _ => {}
            }
            return Ok(Self { lock, prefix: config.prefix.clone(), root: config.root.clone() });
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        let path = lock_path(&self.prefix);
        let launcher = self.prefix.trim_end_matches('_');
        let started = Instant::now();
        while started.elapsed() < DYING && is_file_at(&self.lock, &path) {
            if flock(&self.lock, libc::LOCK_EX | libc::LOCK_NB).is_ok() {
                if is_file_at(&self.lock, &path) {
                    remove_files(&self.prefix, &self.root);
                }
                return;
            }
            // The roles of a killed launcher hear of its end before the system has closed its files. One that lives
            // leaves after its roles.
            if started.elapsed() > HEARING && launcher_lives(launcher) {
                return;
            }
            std::thread::sleep(Duration::from_millis(2));
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
    !lock_path(&config.prefix).exists()
}

/// Removes what runs of this user left behind that nobody is part of any more. Returns how many there were.
///
/// A run that was killed as a whole leaves a lock that nobody holds. What a participant of another program made after
/// the last role had gone has no lock; it is removed when the launcher that its name tells of has ended.
pub fn cleanup_stale() -> usize {
    let mut places = vec![PathBuf::from("/tmp")];
    if std::env::temp_dir() != places[0] {
        places.push(std::env::temp_dir());
    }
    let shm = entries(Path::new(SHM))
        .filter_map(|entry| Some(run_of_object(&entry.file_name().to_string_lossy())?.to_owned()));
    let folders = places.iter().flat_map(|place| entries(place));
    let folders =
        folders.filter_map(|entry| entry.file_name().into_string().ok()).filter(|name| is_run_name(name));
    let runs: BTreeSet<String> = shm.chain(folders).collect();
    runs.iter().filter(|name| remove_if_stale(name, &places)).count()
}

fn entries(folder: &Path) -> impl Iterator<Item = DirEntry> + use<> {
    // SAFETY: the call has no preconditions.
    let user = unsafe { libc::geteuid() };
    let own = move |entry: &DirEntry| entry.metadata().is_ok_and(|metadata| metadata.uid() == user);
    std::fs::read_dir(folder).into_iter().flatten().flatten().filter(own)
}

fn remove_if_stale(name: &str, places: &[PathBuf]) -> bool {
    let prefix = format!("{name}_");
    let path = lock_path(&prefix);
    let mut roots: Vec<PathBuf> = places.iter().map(|place| place.join(name)).collect();
    let lock = match open_lock(&path, false) {
        Ok(mut lock) => {
            let free = flock(&lock, libc::LOCK_EX | libc::LOCK_NB).is_ok() && is_file_at(&lock, &path);
            if !free {
                return false;
            }
            let mut root = Vec::new();
            let _ = lock.read_to_end(&mut root);
            roots.push(PathBuf::from(std::ffi::OsString::from_vec(root)));
            Some(lock)
        }
        Err(_) if launcher_lives(name) => return false,
        Err(_) => None,
    };
    // SAFETY: the call has no preconditions.
    let user = unsafe { libc::geteuid() };
    let is_own = |root: &PathBuf| {
        root.file_name().is_some_and(|own| own == name)
            && std::fs::symlink_metadata(root).is_ok_and(|m| m.is_dir() && m.uid() == user)
    };
    for root in roots.iter().filter(|root| is_own(root)) {
        remove_folder(root);
    }
    remove_objects(&prefix);
    drop(lock);
    true
}

/// Whether the process in a run's name is there.
fn launcher_lives(name: &str) -> bool {
    let pid =
        name.strip_prefix("hs").and_then(|rest| rest.split_once('-')).and_then(|(pid, _)| pid.parse().ok());
    pid.is_some_and(process_lives)
}

/// Whether a process runs: it exists, and does not just wait for its parent to ask how it ended.
pub(super) fn process_lives(pid: u32) -> bool {
    let Ok(text) = std::fs::read_to_string(format!("/proc/{pid}/stat")) else { return false };
    // The name before the last bracket may hold anything.
    let state = text.rsplit_once(')').and_then(|(_, rest)| rest.trim_start().chars().next());
    !matches!(state, None | Some('Z' | 'X'))
}

/// The name of the run that an object in shared memory belongs to.
fn run_of_object(name: &str) -> Option<&str> {
    name.split_once('_').map(|(run, _)| run).filter(|run| is_run_name(run))
}

/// The file that roles lock: it lies where the run's objects do, because cleaners of temporary folders do not come
/// there.
fn lock_path(prefix: &str) -> PathBuf {
    Path::new(SHM).join(format!("{prefix}lock"))
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
    let flags = libc::O_NOFOLLOW;
    OpenOptions::new()
        .read(true)
        .write(true)
        .create(create)
        .truncate(false)
        .mode(0o600)
        .custom_flags(flags)
        .open(path)
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

fn remove_files(prefix: &str, root: &Path) {
    remove_folder(root);
    remove_objects(prefix);
}

/// The lock goes last: whoever is killed in the middle of this leaves a run that the next one recognises.
fn remove_objects(prefix: &str) {
    let carries_prefix = |entry: &DirEntry| entry.file_name().to_string_lossy().starts_with(prefix);
    let lock = lock_path(prefix);
    for entry in entries(Path::new(SHM)).filter(carries_prefix).filter(|entry| entry.path() != lock) {
        let _ = std::fs::remove_file(entry.path());
    }
    let _ = std::fs::remove_file(lock);
}

fn remove_folder(root: &Path) {
    for entry in std::fs::read_dir(root).into_iter().flatten().flatten() {
        let path = entry.path();
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            let _ = std::fs::remove_dir_all(path);
        } else {
            let _ = std::fs::remove_file(path);
        }
    }
    let _ = std::fs::remove_dir(root);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether all of these go. Another run's cleaning may be the one that removes them, and be in the middle of it.
    fn are_gone(paths: &[&Path]) -> bool {
        let deadline = Instant::now() + Duration::from_secs(20);
        while paths.iter().any(|path| path.exists()) {
            if Instant::now() > deadline {
                return false;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        true
    }

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
        assert!(are_gone(&[&object, &config.root, &lock_path(&config.prefix)]));
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
        cleanup_stale();
        assert!(are_gone(&[&object, &abandoned.root]));
        assert!(lock_path(&alive.prefix).exists() && alive.root.exists());
        drop(claim);
    }

    /// A participant of another program connects while the launcher is killed: its objects come after the last role.
    #[test]
    fn objects_without_a_lock_go_with_their_launcher() {
        let mut ended = std::process::Command::new("true").spawn().unwrap();
        ended.wait().unwrap();
        let object = |pid: u32| Path::new(SHM).join(format!("hs{pid}-0123abcd_object"));
        let (orphan, own) = (object(ended.id()), object(std::process::id()));
        let folder = std::env::temp_dir().join(format!("hs{}-0123abcd", ended.id()));
        std::fs::create_dir_all(folder.join("nodes")).unwrap();
        for path in [&orphan, &own] {
            std::fs::write(path, "x").unwrap();
        }
        cleanup_stale();
        assert!(are_gone(&[&orphan, &folder]));
        assert!(own.exists(), "its launcher lives");
        std::fs::remove_file(own).unwrap();
    }

    /// Cleaners of temporary folders do not know that a run goes on.
    #[test]
    fn a_run_whose_folder_was_removed_still_removes_its_objects() {
        let config = LinkConfig::of_two(1, 1);
        let object = Path::new(SHM).join(format!("{}object", config.prefix));
        let claim = Claim::new(&config).unwrap();
        std::fs::write(&object, "x").unwrap();
        std::fs::remove_dir_all(&config.root).unwrap();
        cleanup_stale();
        assert!(object.exists(), "it goes on");
        drop(claim);
        assert!(are_gone(&[&object, &lock_path(&config.prefix)]));
    }

    #[test]
    fn a_process_that_waits_to_be_asked_how_it_ended_does_not_live() {
        let mut child = std::process::Command::new("true").spawn().unwrap();
        let deadline = std::time::Instant::now() + std::time::Duration::from_secs(10);
        while process_lives(child.id()) {
            assert!(std::time::Instant::now() < deadline);
        }
        child.wait().unwrap();
        assert!(process_lives(std::process::id()));
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
