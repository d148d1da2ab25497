//! What makes the files of a checkpoint one checkpoint.

use super::MANIFEST;
use crate::{OutputError, atomic};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use xxhash_rust::xxh3::Xxh3;

/// Version of the layout of checkpoints.
const FORMAT: u32 = 1;

/// `manifest.json` of a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Version of the layout of checkpoints.
    pub format: u32,
    /// Number of the checkpoint, from 1 on.
    pub number: u64,
    /// Step n.
    pub step: u64,
    /// Its time, s.
    pub time: f64,
    /// Version of the program.
    pub version: String,
    /// Instruction set level of the run, on which its bits depend.
    pub isa: String,
    /// Hash of the scene but for its end time, hexadecimal.
    pub scene: String,
    /// The files of the checkpoint.
    pub files: Vec<FileEntry>,
}

/// A file of a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileEntry {
    /// Name in the checkpoint's folder.
    pub name: String,
    /// Size.
    pub bytes: u64,
    /// XXH3 (64 bit) of the content, hexadecimal.
    pub xxh3: String,
}

impl Manifest {
    /// Lists these files of a folder, which are there, and writes the manifest beside them.
    ///
    /// # Errors
    /// A file cannot be read, or the manifest not be written.
    pub fn write(mut self, folder: &Path, files: &[String]) -> Result<(), OutputError> {
        self.format = FORMAT;
        self.files = files.iter().map(|name| FileEntry::of(folder, name)).collect::<Result<_, _>>()?;
        let path = folder.join(MANIFEST);
        let text = serde_json::to_vec_pretty(&self);
        let text = text.map_err(|e| OutputError::malformed(&path, e.to_string()))?;
        atomic::replace_bytes(&path, &text)
    }

    /// Reads the manifest of a folder and compares every file with it; `None` where there is none.
    ///
    /// # Errors
    /// The checkpoint is torn or changed, or of another layout.
    pub fn read(folder: &Path) -> Result<Option<Self>, OutputError> {
        let path = folder.join(MANIFEST);
        if std::fs::metadata(&path).is_ok_and(|metadata| !metadata.is_file()) {
            return Err(OutputError::malformed(&path, "it is no file"));
        }
        let text = match std::fs::read(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(OutputError::io("read", &path)(error)),
        };
        let manifest: Self =
            serde_json::from_slice(&text).map_err(|e| OutputError::malformed(&path, e.to_string()))?;
        let sound = (1..=u64::from(u32::MAX)).contains(&manifest.number)
            && manifest.time.is_finite()
            && manifest.time >= 0.0;
        if !sound {
            return Err(OutputError::malformed(&path, "number or time are those of no checkpoint"));
        }
        if manifest.format != FORMAT {
            let reason = format!("checkpoints of layout {} cannot be read, {FORMAT} can", manifest.format);
            return Err(OutputError::malformed(&path, reason));
        }
        for listed in &manifest.files {
            // A name shall not lead out of the folder.
            if Path::new(&listed.name).file_name().is_none_or(|name| name != listed.name.as_str()) {
                return Err(OutputError::malformed(&path, format!("`{}` is no file name", listed.name)));
            }
            if FileEntry::of(folder, &listed.name)? != *listed {
                let reason = "it is not what was written: size or checksum differ".to_owned();
                return Err(OutputError::malformed(&folder.join(&listed.name), reason));
            }
        }
        Ok(Some(manifest))
    }

    /// Removes the manifest of a folder: what is in it is no checkpoint any more.
    ///
    /// # Errors
    /// There is one that cannot be removed.
    pub fn remove(folder: &Path) -> Result<(), OutputError> {
        let path = folder.join(MANIFEST);
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                Err(OutputError::io("remove", &path)(error))
            }
            _ => Ok(()),
        }
    }
}

impl FileEntry {
    fn of(folder: &Path, name: &str) -> Result<Self, OutputError> {
        let path = folder.join(name);
        let io = |e| OutputError::io("read", &path)(e);
        // A pipe would never end.
        if !std::fs::metadata(&path).map_err(io)?.is_file() {
            return Err(OutputError::malformed(&path, "it is no file"));
        }
        let mut file = BufReader::with_capacity(1 << 16, File::open(&path).map_err(io)?);
        let (mut hash, mut bytes, mut buffer) = (Xxh3::new(), 0, vec![0; 1 << 16]);
        loop {
            let n = file.read(&mut buffer).map_err(io)?;
            if n == 0 {
                break;
            }
            hash.update(&buffer[..n]);
            bytes += n as u64;
        }
        Ok(Self { name: name.to_owned(), bytes, xxh3: format!("{:016x}", hash.digest()) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written() -> (tempfile::TempDir, Manifest) {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("fluid.hdf"), b"water").unwrap();
        std::fs::write(dir.path().join("coupler.hdf"), b"").unwrap();
        let manifest = Manifest { number: 3, step: 7, time: 0.1 + 0.2, ..Manifest::default() };
        manifest.write(dir.path(), &["fluid.hdf".into(), "coupler.hdf".into()]).unwrap();
        let read = Manifest::read(dir.path()).unwrap().unwrap();
        (dir, read)
    }

    #[test]
    fn a_whole_checkpoint_is_read_back() {
        let (dir, read) = written();
        assert_eq!((read.number, read.step, read.time), (3, 7, 0.1 + 0.2));
        assert_eq!(read.files[0].bytes, 5);
        Manifest::remove(dir.path()).unwrap();
        assert_eq!(Manifest::read(dir.path()).unwrap(), None);
    }

    #[test]
    fn a_changed_or_missing_file_is_found() {
        for change in [Some(b"wateR".as_slice()), Some(b"wate"), None] {
            let (dir, _) = written();
            let path = dir.path().join("fluid.hdf");
            match change {
                Some(bytes) => std::fs::write(&path, bytes).unwrap(),
                None => std::fs::remove_file(&path).unwrap(),
            }
            let message = Manifest::read(dir.path()).unwrap_err().to_string();
            assert!(message.contains("fluid.hdf"), "{message}");
        }
    }

    #[test]
    fn names_stay_in_the_folder() {
        let (dir, mut read) = written();
        read.files[0].name = "../fluid.hdf".into();
        std::fs::write(dir.path().join(MANIFEST), serde_json::to_vec(&read).unwrap()).unwrap();
        let message = Manifest::read(dir.path()).unwrap_err().to_string();
        assert!(message.contains("is no file name"), "{message}");
    }
}
