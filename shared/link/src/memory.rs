//! Shared memory: how much a run takes, and taking it before the first message.
//!
//! Objects in `/dev/shm` are sparse until they are written to, and a write for which there is no room left kills the
//! process with SIGBUS. So the room is checked before anything is created and then reserved page by page.

use super::{LinkConfig, LinkError, Participant, Transport};
use halfstep_wire::Name;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, ProbeHeader, StateHeader, StateRecord};
use std::ffi::CString;
use std::os::fd::AsRawFd;
use std::os::unix::ffi::OsStrExt;
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

/// Fails if what all processes of a run publish does not fit into what is free.
///
/// # Errors
/// It does not, or the system does not say.
pub fn check_all_room(config: &LinkConfig) -> Result<(), LinkError> {
    let (needed, available) = (config.shared_memory_bytes(), free_bytes()?);
    if needed > available { Err(LinkError::SharedMemoryFull { needed, available }) } else { Ok(()) }
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

/// Participants of other programs may leave the number of samples to the transport, which makes up to eleven.
const OTHERS: u64 = 4;
/// Bookkeeping that does not grow with the messages: of two processes it is 3 MB.
const BOOKKEEPING: u64 = 64 << 20;

/// Reserves every page of the run's objects that exist by now.
///
/// # Errors
/// There is no room, or they are far larger than the run's messages: whoever made them so shall not have the memory.
pub(super) fn reserve<S: Transport>(config: &LinkConfig) -> Result<(), LinkError> {
    if !S::SHARED_MEMORY {
        return Ok(());
    }
    let shm = Path::new(SHM);
    let mut objects = Vec::new();
    for entry in std::fs::read_dir(shm).map_err(|e| LinkError::io(shm, &e))?.flatten() {
        if !entry.file_name().to_string_lossy().starts_with(&config.prefix) {
            continue;
        }
        // An object of another role may go at any time; its own role has reserved it.
        let Ok(file) = std::fs::OpenOptions::new().read(true).write(true).open(entry.path()) else {
            continue;
        };
        let Ok(length) = file.metadata().map(|m| m.len()) else { continue };
        objects.push((file, length));
    }
    let bytes: u64 = objects.iter().map(|(_, length)| *length).sum();
    let expected = config.shared_memory_bytes();
    if bytes > OTHERS * expected + BOOKKEEPING {
        return Err(LinkError::Oversized { bytes, expected });
    }
    for (file, length) in objects.into_iter().filter(|(_, length)| *length > 0) {
        // SAFETY: the descriptor is open for writing during the call; no memory is passed.
        let error = unsafe { libc::posix_fallocate(file.as_raw_fd(), 0, length as libc::off_t) };
        if error == libc::ENOSPC {
            return Err(LinkError::SharedMemoryFull { needed: length, available: free_bytes()? });
        }
    }
    Ok(())
}

fn free_bytes() -> Result<u64, LinkError> {
    free_space(Path::new(SHM))
}

/// Bytes that are free where a path lies.
///
/// # Errors
/// The system does not say.
pub fn free_space(folder: &Path) -> Result<u64, LinkError> {
    let path = CString::new(folder.as_os_str().as_bytes());
    let path = path.map_err(|e| LinkError::io(folder, &std::io::Error::from(e)))?;
    let mut info = std::mem::MaybeUninit::<libc::statvfs>::uninit();
    // SAFETY: `path` is NUL-terminated, `info` is large enough and read only if the call filled it.
    unsafe {
        if libc::statvfs(path.as_ptr(), info.as_mut_ptr()) != 0 {
            return Err(LinkError::io(folder, &std::io::Error::last_os_error()));
        }
        let info = info.assume_init();
        Ok(info.f_bavail * info.f_frsize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Claim, Processes};
    use std::os::unix::fs::MetadataExt;

    /// A participant of another program decides how large its objects are; the others do not pay for it.
    #[test]
    fn objects_that_are_too_large_are_not_reserved() {
        let config = LinkConfig::of_two(100, 100);
        let _claim = Claim::new(&config).unwrap();
        let path = Path::new(SHM).join(format!("{}object", config.prefix));
        let object = std::fs::File::create(&path).unwrap();
        object.set_len(1 << 20).unwrap();
        reserve::<Processes>(&config).unwrap();
        assert_eq!(object.metadata().unwrap().blocks() * 512, 1 << 20);
        object.set_len(4 << 30).unwrap();
        match reserve::<Processes>(&config) {
            Err(LinkError::Oversized { bytes, expected }) => {
                assert!(bytes >= 4 << 30 && expected == config.shared_memory_bytes());
            }
            other => panic!("{other:?}"),
        }
        assert!(object.metadata().unwrap().blocks() * 512 < 2 << 20);
    }
}
