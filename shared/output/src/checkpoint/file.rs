//! A saved state as an HDF5 file: groups and one-dimensional datasets under the names of the state.

use crate::vtkhdf::unlocked;
use crate::{OutputError, atomic};
use halfstep_wire::state::{Column, Group};
use hdf5::types::TypeDescriptor;
use std::path::Path;

/// Groups within groups that a file may have.
const DEPTH: usize = 16;

/// Writes a state; on return it is on disk under its final name.
///
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, state: &Group) -> Result<(), OutputError> {
    atomic::replace(path, |temporary| fill(temporary, state).map_err(OutputError::hdf5("write", path)))
}

fn fill(path: &Path, state: &Group) -> hdf5::Result<()> {
    let file = unlocked().create(path)?;
    put(&file, state)?;
    // Errors of the disk surface here; those of a close would be lost.
    file.flush()?;
    file.close()
}

fn put(into: &hdf5::Group, state: &Group) -> hdf5::Result<()> {
    for (name, column) in &state.columns {
        let dataset = into.new_dataset_builder();
        match column {
            Column::Reals(values) => dataset.with_data(values).create(name.as_str())?,
            Column::Numbers(values) => dataset.with_data(values).create(name.as_str())?,
            Column::Counts(values) => dataset.with_data(values).create(name.as_str())?,
            Column::Text(text) => dataset.with_data(text.as_bytes()).create(name.as_str())?,
        };
    }
    for (name, group) in &state.groups {
        put(&into.create_group(name)?, group)?;
    }
    Ok(())
}

/// Reads a state back.
///
/// # Errors
/// The file cannot be read or holds something else than a state.
pub fn read(path: &Path) -> Result<Group, OutputError> {
    let file = unlocked().open(path).map_err(OutputError::hdf5("read", path))?;
    take(&file, path, DEPTH)
}

fn take(from: &hdf5::Group, path: &Path, depth: usize) -> Result<Group, OutputError> {
    let hdf5 = |e| OutputError::hdf5("read", path)(e);
    if depth == 0 {
        return Err(OutputError::malformed(path, "its groups are nested too deeply"));
    }
    let mut state = Group::default();
    for dataset in from.datasets().map_err(hdf5)? {
        let name = last_name(&dataset.name());
        state.columns.insert(name, column(&dataset, path)?);
    }
    for group in from.groups().map_err(hdf5)? {
        state.groups.insert(last_name(&group.name()), take(&group, path, depth - 1)?);
    }
    Ok(state)
}

fn last_name(path: &str) -> String {
    path.rsplit('/').next().unwrap_or_default().to_owned()
}

fn column(dataset: &hdf5::Dataset, path: &Path) -> Result<Column, OutputError> {
    let hdf5 = |e| OutputError::hdf5("read", path)(e);
    let kind = dataset.dtype().and_then(|kind| kind.to_descriptor()).map_err(hdf5)?;
    let f64s = TypeDescriptor::Float(hdf5::types::FloatSize::U8);
    let unsigned = |size| TypeDescriptor::Unsigned(size);
    if kind == f64s {
        Ok(Column::Reals(dataset.read_raw().map_err(hdf5)?))
    } else if kind == unsigned(hdf5::types::IntSize::U4) {
        Ok(Column::Numbers(dataset.read_raw().map_err(hdf5)?))
    } else if kind == unsigned(hdf5::types::IntSize::U8) {
        Ok(Column::Counts(dataset.read_raw().map_err(hdf5)?))
    } else if kind == unsigned(hdf5::types::IntSize::U1) {
        let bytes: Vec<u8> = dataset.read_raw().map_err(hdf5)?;
        let text = String::from_utf8(bytes);
        Ok(Column::Text(text.map_err(|_| OutputError::malformed(path, "a text is not UTF-8"))?))
    } else {
        Err(OutputError::malformed(path, format!("{} is of a type that no state has", dataset.name())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_reads_back_bit_by_bit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("fluid.hdf");
        let mut inner = Group::default();
        inner.columns.insert("id".into(), Column::Numbers(vec![3, u32::MAX]));
        inner.columns.insert("epoch".into(), Column::Counts(vec![u64::MAX]));
        inner.columns.insert("none".into(), Column::Reals(Vec::new()));
        let mut state = Group::default();
        let bits = [f64::from_bits(0x7ff8_0000_0000_0abc), -0.0, 5e-324, 0.1 + 0.2, f64::NEG_INFINITY];
        state.columns.insert("position_x".into(), Column::Reals(bits.to_vec()));
        state.columns.insert("warned".into(), Column::Text("gate, größer".into()));
        state.columns.insert("empty".into(), Column::Text(String::new()));
        state.groups.insert("interface_0".into(), inner.clone());
        write(&path, &state).unwrap();
        let read = super::read(&path).unwrap();
        assert_eq!(read.groups["interface_0"], inner);
        let Column::Reals(values) = &read.columns["position_x"] else { panic!("{read:?}") };
        assert_eq!(values.iter().map(|v| v.to_bits()).collect::<Vec<_>>(), bits.map(f64::to_bits));
        assert_eq!(read.columns["warned"], state.columns["warned"]);
        assert_eq!(read.columns["empty"], Column::Text(String::new()));
    }

    #[test]
    fn a_file_that_is_no_state_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("fluid.hdf");
        assert!(super::read(&path).is_err());
        std::fs::write(&path, b"not HDF5").unwrap();
        assert!(super::read(&path).is_err());
        unlocked().create(&path).unwrap().new_dataset_builder().with_data(&[1.0_f32]).create("x").unwrap();
        let message = super::read(&path).unwrap_err().to_string();
        assert!(message.contains("of a type that no state has"), "{message}");
    }
}
