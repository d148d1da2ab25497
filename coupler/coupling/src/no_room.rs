//! What a process does that writes to shared memory for which no room is left: the system sends SIGBUS. It can only
//! happen while a run starts, since all of its memory is reserved before the first message.
//!
//! The transport writes to its objects as soon as it has made them, so that nothing can be reserved before. The signal
//! comes in the middle of that: nothing but a few calls to the system can be made, and what they need is prepared.

use std::ffi::CString;
use std::io;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::sync::OnceLock;

/// Exit status of a process that has no room.
pub const STATUS: i32 = 2;

/// What the process says then.
pub const REASON: &str = "shared memory (/dev/shm) was filled up while the run started";

#[derive(Debug)]
struct Prepared {
    message: Vec<u8>,
    /// A file, the name under which it is written, and what goes into it.
    report: Option<(CString, CString, Vec<u8>)>,
}

static PREPARED: OnceLock<Prepared> = OnceLock::new();

/// From now on SIGBUS ends this process in order, with a message on standard error and a file in place of an older one.
/// The first call counts.
///
/// # Errors
/// A path is none, or the system refuses.
pub fn prepare(message: String, report: Option<(&Path, Vec<u8>)>) -> io::Result<()> {
    let name = |path: &Path| CString::new(path.as_os_str().as_bytes());
    let report = match report {
        Some((path, text)) => {
            let temporary = halfstep_output::atomic::temporary(path);
            Some((name(path)?, name(&temporary)?, text))
        }
        None => None,
    };
    if PREPARED.set(Prepared { message: message.into_bytes(), report }).is_err() {
        return Ok(());
    }
    // SAFETY: the structure is plain data; the handler calls only what a handler may call.
    unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        action.sa_sigaction = on_signal as extern "C" fn(i32) as usize;
        if libc::sigaction(libc::SIGBUS, &raw const action, std::ptr::null_mut()) != 0 {
            return Err(io::Error::last_os_error());
        }
    }
    Ok(())
}

extern "C" fn on_signal(_: i32) {
    let write = |file: i32, bytes: &[u8]| {
        // SAFETY: so many bytes are there.
        unsafe { libc::write(file, bytes.as_ptr().cast(), bytes.len()) }
    };
    if let Some(Prepared { message, report }) = PREPARED.get() {
        write(libc::STDERR_FILENO, message);
        if let Some((path, temporary, text)) = report {
            // SAFETY: both paths end with NUL.
            unsafe {
                let flags = libc::O_WRONLY | libc::O_CREAT | libc::O_TRUNC;
                let file = libc::open(temporary.as_ptr(), flags, 0o644);
                if file >= 0 && write(file, text) == text.len() as isize {
                    libc::rename(temporary.as_ptr(), path.as_ptr());
                }
            }
        }
    }
    // SAFETY: the call does not return.
    unsafe { libc::_exit(STATUS) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    const FOLDER: &str = "HALFSTEP_TEST_NO_ROOM";

    #[test]
    fn a_process_without_room_says_so_and_leaves_its_report() {
        if let Some(folder) = std::env::var_os(FOLDER) {
            return touch_what_is_not_there(Path::new(&folder));
        }
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("run.json"), "before").unwrap();
        let output = Command::new(std::env::current_exe().unwrap())
            .args([
                "--exact",
                "no_room::tests::a_process_without_room_says_so_and_leaves_its_report",
                "--nocapture",
            ])
            .env(FOLDER, folder.path())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(STATUS));
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains("no room is left"), "{said}");
        assert_eq!(std::fs::read_to_string(folder.path().join("run.json")).unwrap(), "after");
    }

    /// A page of a file that has become shorter.
    fn touch_what_is_not_there(folder: &Path) {
        use std::os::fd::AsRawFd;
        prepare("no room is left\n".into(), Some((&folder.join("run.json"), b"after".to_vec()))).unwrap();
        let mut options = std::fs::File::options();
        options.read(true).write(true).create(true).truncate(true);
        let file = options.open(folder.join("object")).unwrap();
        file.set_len(4096).unwrap();
        // SAFETY: the mapping is as long as the file; that it is not any more when it is touched is what is tested.
        unsafe {
            let flags = libc::PROT_READ | libc::PROT_WRITE;
            let page = libc::mmap(std::ptr::null_mut(), 4096, flags, libc::MAP_SHARED, file.as_raw_fd(), 0);
            assert_ne!(page, libc::MAP_FAILED);
            file.set_len(0).unwrap();
            page.cast::<u8>().write_volatile(1);
        }
    }
}
