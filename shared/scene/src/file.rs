//! Reading a file that somebody names: whatever the name leads to, an answer comes soon.

use std::fs::File;
use std::io::Read;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

/// Largest size, bytes. A scene with an outline of a million corners has 40 MB.
const MAX: u64 = 64 << 20;

/// The text of a regular file of a size that a scene or a table of a curve may have; else what is wrong with it.
pub(super) fn read(path: &Path) -> Result<String, String> {
    let cannot = |error: std::io::Error| format!("cannot be read: {error}");
    // To open a pipe would wait until somebody writes to it.
    let file = File::options().read(true).custom_flags(libc::O_NONBLOCK).open(path).map_err(cannot)?;
    if !file.metadata().map_err(cannot)?.is_file() {
        return Err("cannot be read: it is a folder, a pipe or a device, and no file".into());
    }
    let mut text = String::new();
    let length = file.take(MAX + 1).read_to_string(&mut text).map_err(cannot)?;
    if length as u64 > MAX {
        return Err(format!("cannot be read: it has more than {} MiB", MAX >> 20));
    }
    Ok(text)
}
