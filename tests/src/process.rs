//! Other processes, as the system sees them.

use std::path::Path;

/// Sends a signal.
///
/// # Panics
/// There is no such process.
pub fn kill(pid: u32, signal: i32) {
    // SAFETY: no memory is passed.
    assert_eq!(unsafe { libc::kill(pid as i32, signal) }, 0, "process {pid}");
}

/// Whether a process runs: it exists and is not just waiting for its parent to ask how it ended.
pub fn is_alive(pid: u32) -> bool {
    stat(pid).is_some_and(|(state, _)| state != "Z" && state != "X")
}

/// Processor time that this thread has taken, s.
pub fn cpu_seconds() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the pointer is to a live timespec.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// State and parent of a process.
fn stat(pid: u32) -> Option<(String, u32)> {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The name before the last bracket may hold anything.
    let mut words = text.rsplit_once(')')?.1.split_whitespace();
    Some((words.next()?.to_owned(), words.next()?.parse().ok()?))
}

/// Process number of the role (`fluid`, `solid`) that this launcher has started, once there is one.
pub fn role_of(launcher: u32, role: &str) -> Option<u32> {
    let processes = std::fs::read_dir("/proc").ok()?.flatten();
    processes.filter_map(|entry| entry.file_name().to_str()?.parse().ok()).find(|&pid: &u32| {
        let arguments = std::fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        let words: Vec<&[u8]> = arguments.split(|&byte| byte == 0).collect();
        stat(pid).is_some_and(|(_, parent)| parent == launcher)
            && words.len() > 2
            && words[1] == b"role"
            && words[2] == role.as_bytes()
    })
}

/// All processes with this value of an environment variable, whoever started them.
pub fn with_variable(name: &str, value: &str) -> Vec<u32> {
    let wanted = format!("{name}={value}").into_bytes();
    let processes = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let pids = processes.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    pids.filter(|pid: &u32| {
        let variables = std::fs::read(format!("/proc/{pid}/environ")).unwrap_or_default();
        variables.split(|&byte| byte == 0).any(|variable| variable == wanted)
    })
    .collect()
}

/// What the runs of a launcher have in shared memory and in the folders for temporary files.
pub fn leftovers(launcher: u32) -> Vec<String> {
    let prefix = format!("hs{launcher}-");
    let temporary = std::env::temp_dir();
    let mut found: Vec<String> = [Path::new("/dev/shm"), Path::new("/tmp"), &temporary]
        .into_iter()
        .filter_map(|folder| std::fs::read_dir(folder).ok())
        .flatten()
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().starts_with(&prefix))
        .map(|entry| entry.path().display().to_string())
        .collect();
    found.dedup();
    found
}

/// Memory of a process that is resident, bytes: its own and what it has touched of shared memory; 0 where it is gone.
pub fn resident(pid: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    kib.unwrap_or(0) << 10
}

/// Number of open descriptors of a process; 0 where it is gone.
pub fn descriptors(pid: u32) -> u64 {
    std::fs::read_dir(format!("/proc/{pid}/fd")).map_or(0, |entries| entries.count() as u64)
}

/// What the runs of a launcher have in shared memory: bytes that are allocated, and number of objects.
pub fn shared_memory(launcher: u32) -> (u64, u64) {
    use std::os::unix::fs::MetadataExt;
    let prefix = format!("hs{launcher}-");
    let entries = std::fs::read_dir("/dev/shm").into_iter().flatten().flatten();
    let own = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(&prefix));
    own.filter_map(|entry| entry.metadata().ok())
        .fold((0, 0), |(bytes, count), file| (bytes + file.blocks() * 512, count + 1))
}
