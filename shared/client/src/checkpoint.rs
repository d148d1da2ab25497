//! Checkpoints of a solid: named lists of numbers in the folder that the run tells, as JSON, which keeps every bit of
//! them. The file's name is the participant's, as the protocol has it.

use crate::Error;
use halfstep_wire::checkpoint::{file_name, folder};
use halfstep_wire::protocol::StateRecord;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{File, rename};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Folder of the checkpoint that the run goes on from; not set where it begins.
const FROM: &str = "HALFSTEP_CHECKPOINT";
/// Folder of the run.
const RUN: &str = "HALFSTEP_OUT";

/// What the solver keeps, by name.
pub(crate) type Kept = BTreeMap<String, Vec<f64>>;

/// The state at n: the solver's own, and what the solid had said of it beside positions and velocities.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Saved {
    pub(crate) step: u64,
    pub(crate) time: f64,
    pub(crate) dt_limit: f64,
    pub(crate) sub_steps: u32,
    pub(crate) stored_energy: f64,
    /// Of each particle the deviatoric stress, Pa, the pressure, Pa, and the density, kg/m³.
    pub(crate) stress: Vec<[f64; 6]>,
    pub(crate) pressure: Vec<f64>,
    pub(crate) density: Vec<f64>,
    pub(crate) kept: Kept,
}

fn failed(path: &Path, why: impl std::fmt::Display) -> Error {
    Error::Run(format!("{}: {why}", path.display()))
}

impl Saved {
    /// What the run goes on from; `None` where it begins.
    pub(crate) fn of_environment(participant: &str) -> Result<Option<Self>, Error> {
        let Some(folder) = std::env::var_os(FROM) else { return Ok(None) };
        let path = PathBuf::from(folder).join(file_name(participant));
        let file = std::fs::read(&path).map_err(|e| failed(&path, e))?;
        let found = serde_json::from_slice(&file);
        found.map(Some).map_err(|e| failed(&path, format!("no checkpoint of this library: {e}")))
    }

    /// Writes checkpoint `number`: under its name only when it is whole and on disk.
    pub(crate) fn write(&self, participant: &str, number: u64) -> Result<(), Error> {
        let run = std::env::var_os(RUN).ok_or_else(|| Error::Run(format!("{RUN} is not set")))?;
        self.write_in(&folder(Path::new(&run), number), &file_name(participant))
    }

    fn write_in(&self, folder: &Path, name: &str) -> Result<(), Error> {
        let (path, unfinished) = (folder.join(name), folder.join(format!(".{name}.tmp")));
        let text = serde_json::to_vec(self).map_err(|e| failed(&path, e))?;
        let written = File::create(&unfinished).and_then(|mut file| {
            file.write_all(&text)?;
            file.sync_all()?;
            rename(&unfinished, &path)?;
            File::open(folder)?.sync_all()
        });
        written.map_err(|e| failed(&path, e))
    }

    /// Gives the records back what was said of them.
    pub(crate) fn restore(&self, records: &mut [StateRecord]) -> Result<(), Error> {
        let count = records.len();
        let lengths = [self.stress.len(), self.pressure.len(), self.density.len()];
        if let Some(other) = lengths.into_iter().find(|length| *length != count) {
            return Err(Error::Count(format!("{count} particles, but the checkpoint has {other}")));
        }
        let of = self.stress.iter().zip(&self.pressure).zip(&self.density);
        for (record, ((stress, pressure), density)) in records.iter_mut().zip(of) {
            (record.deviatoric_stress, record.pressure, record.density) = (*stress, *pressure, *density);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let odd = vec![0.1 + 0.2, -0.0, f64::MIN_POSITIVE, 1.0 / 3.0, f64::MAX, 5e-324];
        let saved = Saved {
            step: 7,
            time: 0.1,
            dt_limit: 1e30,
            sub_steps: 3,
            stored_energy: 2.5e-3,
            stress: vec![[1.0 / 7.0; 6]],
            pressure: vec![-1e5],
            density: vec![2000.0],
            kept: Kept::from([("x".into(), odd.clone())]),
        };
        saved.write_in(folder.path(), "gate.hdf").unwrap();
        let names: Vec<_> =
            std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(names, ["gate.hdf"]);
        let read: Saved =
            serde_json::from_slice(&std::fs::read(folder.path().join("gate.hdf")).unwrap()).unwrap();
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!((bits(&read.kept["x"]), &read), (bits(&odd), &saved));
        let mut records = [StateRecord::default()];
        read.restore(&mut records).unwrap();
        assert_eq!((records[0].pressure, records[0].density), (-1e5, 2000.0));
        assert!(matches!(read.restore(&mut []), Err(Error::Count(_))));
    }
}
