//! Checkpoints that somebody has changed.

use halfstep_output::checkpoint::{MANIFEST, Manifest, file};

/// Length of the manifest in the first four bytes (little-endian), the manifest, then the file `fluid.hdf`.
///
/// # Panics
/// A manifest is believed that its folder contradicts, or there is no folder for temporary files.
pub fn checkpoint(bytes: &[u8]) {
    let Some((length, rest)) = bytes.split_first_chunk() else { return };
    let (manifest, data) = rest.split_at(rest.len().min(u32::from_le_bytes(*length) as usize));
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let path = folder.path().join("fluid.hdf");
    std::fs::write(folder.path().join(MANIFEST), manifest).expect("the folder takes a file");
    std::fs::write(&path, data).expect("the folder takes a file");
    // HDF5 takes as much memory as a damaged file says (found here), so no file is opened whose checksum differs.
    let Ok(found) = Manifest::read(folder.path()) else { return };
    let found = found.expect("it is there");
    assert!(found.time.is_finite() && found.number >= 1);
    for listed in &found.files {
        let size = std::fs::metadata(folder.path().join(&listed.name)).map_or(u64::MAX, |file| file.len());
        assert_eq!(size, listed.bytes, "{}", listed.name);
    }
    if found.files.iter().any(|listed| listed.name == "fluid.hdf") {
        let _ = file::read(&path);
    }
}
