//! Shared memory: how much a run takes, and taking it before the first message.
//!
//! Objects in `/dev/shm` are sparse until they are written to, and a write for which there is no room left kills the
//! process with SIGBUS. So the room is checked before anything is created and then reserved page by page.

use super::{LinkConfig, LinkError, Participant, Transport};
use halfstep_wire::Name;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, ProbeHeader, StateHeader, StateRecord};
use std::ffi::CString;
use std::os::fd::AsRawFd;
use std::path::Path;

/// Where POSIX shared memory lies.
pub(super) const SHM: &str = "/dev/shm";
/// Messages of a channel that can exist at once: two that the slowest reader holds, two in its queue, one that is being
/// filled, one spare. Lock-step needs fewer, so the transport's worst case for independent readers is not reserved.
pub(super) const SAMPLES: usize = 6;
/// Generous size of the transport's own header of a message, and of its bookkeeping for a channel.
const MESSAGE_OVERHEAD: usize = 256;
const CHANNEL_OVERHEAD: u64 = 64 * 1024;

/// Bytes that the messages take which a process publishes.
pub(super) fn published_bytes(config: &LinkConfig, process: Name) -> u64 {
    let channel = |count: u32, header: usize, record: usize| {
        let message = header + MESSAGE_OVERHEAD + count as usize * record;
        SAMPLES as u64 * message as u64 + CHANNEL_OVERHEAD
    };
    let forces = |p: &Participant| channel(p.capacity, size_of::<ForceHeader>(), size_of::<ForceRecord>());
    let states = |p: &Participant| {
        let probes =
            if p.probes == 0 { 0 } else { channel(p.probes, size_of::<ProbeHeader>(), size_of::<f64>()) };
        probes + channel(p.capacity, size_of::<StateHeader>(), size_of::<StateRecord>())
    };
    match process {
        Name::COUPLER => config.participants.iter().map(forces).sum(),
        _ => config.members(process).into_iter().map(|k| states(&config.participants[k])).sum(),
    }
}

/// Fails if what a process publishes does not fit into what is free.
pub(super) fn check_room<S: Transport>(config: &LinkConfig, process: Name) -> Result<(), LinkError> {
    if !S::SHARED_MEMORY {
        return Ok(());
    }
    let needed = published_bytes(config, process);
    let available = free_bytes()?;
    if needed > available { Err(LinkError::SharedMemoryFull { needed, available }) } else { Ok(()) }
}

/// Reserves every page of the run's objects that exist by now.
pub(super) fn reserve<S: Transport>(config: &LinkConfig) -> Result<(), LinkError> {
    if !S::SHARED_MEMORY {
        return Ok(());
    }
    let shm = Path::new(SHM);
    for entry in std::fs::read_dir(shm).map_err(|e| LinkError::io(shm, &e))?.flatten() {
        if !entry.file_name().to_string_lossy().starts_with(&config.prefix) {
            continue;
        }
        // An object of another role may go at any time; its own role has reserved it.
        let Ok(file) = std::fs::OpenOptions::new().read(true).write(true).open(entry.path()) else {
            continue;
        };
        let Ok(length) = file.metadata().map(|m| m.len()) else { continue };
        if length == 0 {
            continue;
        }
        // SAFETY: the descriptor is open for writing during the call; no memory is passed.
        let error = unsafe { libc::posix_fallocate(file.as_raw_fd(), 0, length as libc::off_t) };
        if error == libc::ENOSPC {
            return Err(LinkError::SharedMemoryFull { needed: length, available: free_bytes()? });
        }
    }
    Ok(())
}

fn free_bytes() -> Result<u64, LinkError> {
    let path = CString::new(SHM).expect("no NUL");
    let mut info = std::mem::MaybeUninit::<libc::statvfs>::uninit();
    // SAFETY: `path` is NUL-terminated, `info` is large enough and read only if the call filled it.
    unsafe {
        if libc::statvfs(path.as_ptr(), info.as_mut_ptr()) != 0 {
            return Err(LinkError::io(Path::new(SHM), &std::io::Error::last_os_error()));
        }
        let info = info.assume_init();
        Ok(info.f_bavail * info.f_frsize)
    }
}
