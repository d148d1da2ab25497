//! Files that are either whole or not there.

use super::OutputError;
use std::ffi::OsString;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// The name under which `path` is written before it is renamed: `.NAME.tmp` in the same folder.
pub fn temporary(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".tmp");
    path.with_file_name(name)
}

/// Replaces `path` by what `write` puts into the file it is given. When this returns, the new content
/// survives a crash of the machine; until it returns, a reader finds the old file or the new one, whole.
pub fn replace(path: &Path, write: impl FnOnce(&Path) -> Result<(), OutputError>) -> Result<(), OutputError> {
    let written = temporary(path);
    let result = write(&written).and_then(|()| {
        let file = File::open(&written).map_err(OutputError::io("open", &written))?;
        file.sync_all().map_err(OutputError::io("synchronise", &written))?;
        fs::rename(&written, path).map_err(OutputError::io("write", path))
    });
    if result.is_err() {
        // The error to report is the first one; what is left of the file only takes up room.
        let _ = fs::remove_file(&written);
        return result;
    }
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    File::open(folder)
        .and_then(|folder| folder.sync_all())
        .map_err(OutputError::io("synchronise the folder", folder))
}

/// [`replace`] with these bytes.
pub fn replace_bytes(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    replace(path, |temporary| fs::write(temporary, bytes).map_err(OutputError::io("write", path)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_temporary() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("run.json");
        replace_bytes(&path, b"old").unwrap();
        let result = replace(&path, |temporary| {
            fs::write(temporary, b"half").unwrap();
            Err(OutputError::malformed(temporary, "stop here"))
        });
        assert!(result.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }
}
