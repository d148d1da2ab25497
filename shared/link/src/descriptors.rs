//! Open files: a run that has too few of them finds out in the middle of its start, from errors that look like others.

use super::{LinkConfig, LinkError};
use std::fs::File;

/// Descriptors of the coupler that each participant takes. Two take 83 of it at most, while they connect.
const EACH: usize = 40;
/// Descriptors of a process for its own files.
const OWN: usize = 24;

/// Raises this process's limit of open files as far as the system allows; processes that it starts have the same.
pub fn raise_descriptor_limit() {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: `limit` is large enough; it is read only where the call filled it.
    unsafe {
        if libc::getrlimit(libc::RLIMIT_NOFILE, &raw mut limit) == 0 {
            limit.rlim_cur = limit.rlim_max;
            libc::setrlimit(libc::RLIMIT_NOFILE, &raw const limit);
        }
    }
}

/// Whether a process of a run can open as many files as it needs to connect.
///
/// # Errors
/// It cannot.
pub fn check_descriptors(config: &LinkConfig) -> Result<(), LinkError> {
    let needed = OWN + EACH * config.participants.len();
    // Only to open them shows how many there are besides those in use.
    let mut spare = Vec::with_capacity(needed);
    while spare.len() < needed {
        match File::open("/dev/null") {
            Ok(file) => spare.push(file),
            Err(error) if is_of_the_limit(&error) => {
                return Err(LinkError::Descriptors { needed, available: spare.len() });
            }
            // Not for want of descriptors.
            Err(_) => break,
        }
    }
    Ok(())
}

fn is_of_the_limit(error: &std::io::Error) -> bool {
    matches!(error.raw_os_error(), Some(libc::EMFILE | libc::ENFILE))
}
