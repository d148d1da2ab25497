//! One frame, one file: VTKHDF 1.0, an unstructured grid of one vertex cell per particle.
//!
//! This version and this kind of grid are what ParaView 5.11 and later, VTK's `vtkHDFReader` and any HDF5 reader open
//! as they are. The instant is `/VTKHDF/FieldData/TimeValue`, s.
//!
//! ```text
//! /VTKHDF                  @Version = [1, 0], @Type = "UnstructuredGrid"
//!   NumberOfPoints, NumberOfCells, NumberOfConnectivityIds    i64[1] = n
//!   Points f32[n,3]   Connectivity i64[n] = 0..n-1   Offsets i64[n+1] = 0..n   Types u8[n] = 1 (vertex)
//!   PointData/velocity f32[n,3], density f32[n], pressure f32[n], stress f32[n,6], phase u8[n], id i32[n];
//!   displacement f32[n,3], von_mises f32[n], body i32[n] of a solid; damage f32[n] of one that can break
//!   FieldData/TimeValue f64[1]
//! ```

use super::{Frame, OutputError, atomic};
use hdf5::types::FixedAscii;
use hdf5::{FileBuilder, Group, H5Type};
use ndarray::ArrayView;
use std::path::Path;

/// VTK's number of the cell type that is a single point.
const VTK_VERTEX: u8 = 1;

/// Writes a frame; on return it is on disk under its final name.
pub fn write(path: &Path, frame: &Frame) -> Result<(), OutputError> {
    if !frame.is_consistent() {
        return Err(OutputError::malformed(path, "the columns of the frame are not equally long"));
    }
    atomic::replace(path, |temporary| fill(temporary, frame).map_err(OutputError::hdf5("write", path)))
}

/// Files without the library's locks. A file under its final name never changes, so nobody needs them; and a lock
/// outlives its file for as long as a process that is just being started has inherited it.
pub(crate) fn unlocked() -> FileBuilder {
    let mut builder = FileBuilder::new();
    builder.with_fapl(|access| access.file_locking(false));
    builder
}

fn fill(path: &Path, frame: &Frame) -> hdf5::Result<()> {
    let file = unlocked().create(path)?;
    let root = file.create_group("VTKHDF")?;
    let version = root.new_attr::<i64>().shape(2).create("Version")?;
    version.write_raw(&[1_i64, 0])?;
    // Readers compare a fixed-length string of exactly this length.
    let kind =
        FixedAscii::<16>::from_ascii("UnstructuredGrid").map_err(|e| hdf5::Error::from(e.to_string()))?;
    root.new_attr::<FixedAscii<16>>().create("Type")?.write_scalar(&kind)?;

    let n = frame.len();
    // Indices of all cells share one width: VTK silently shows no cells when Offsets are narrower than Connectivity.
    let indices: Vec<i64> = (0..=n as i64).collect();
    for count in ["NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"] {
        put(&root, count, &[n as i64])?;
    }
    put_rows(&root, "Points", &frame.points)?;
    put(&root, "Connectivity", &indices[..n])?;
    put(&root, "Offsets", &indices)?;
    put(&root, "Types", &vec![VTK_VERTEX; n])?;

    let data = root.create_group("PointData")?;
    put_rows(&data, "velocity", &frame.velocity)?;
    put(&data, "density", &frame.density)?;
    put(&data, "pressure", &frame.pressure)?;
    put_rows(&data, "stress", &frame.stress)?;
    if !frame.damage.is_empty() {
        put(&data, "damage", &frame.damage)?;
    }
    if !frame.displacement.is_empty() {
        put_rows(&data, "displacement", &frame.displacement)?;
    }
    if !frame.von_mises.is_empty() {
        put(&data, "von_mises", &frame.von_mises)?;
    }
    if !frame.body.is_empty() {
        put(&data, "body", &frame.body)?;
    }
    put(&data, "phase", &frame.phase)?;
    put(&data, "id", &frame.id)?;
    put(&root.create_group("FieldData")?, "TimeValue", &[frame.time])?;
    // Errors of the disk surface here; those of a close would be lost.
    file.flush()?;
    file.close()
}

fn put<T: H5Type>(group: &Group, name: &str, values: &[T]) -> hdf5::Result<()> {
    group.new_dataset_builder().with_data(values).create(name).map(drop)
}

fn put_rows<const W: usize>(group: &Group, name: &str, rows: &[[f32; W]]) -> hdf5::Result<()> {
    let view = ArrayView::from_shape((rows.len(), W), rows.as_flattened())?;
    group.new_dataset_builder().with_data(view).create(name).map(drop)
}

/// Reads a frame back.
pub fn read(path: &Path) -> Result<Frame, OutputError> {
    let hdf5 = OutputError::hdf5;
    let file = unlocked().open(path).map_err(hdf5("read", path))?;
    let root = file.group("VTKHDF").map_err(hdf5("read", path))?;
    let data = root.group("PointData").map_err(hdf5("read", path))?;
    let fields = root.group("FieldData").map_err(hdf5("read", path))?;
    let time: Vec<f64> = column(&fields, "TimeValue", path)?;
    let frame = Frame {
        time: *time.first().ok_or_else(|| OutputError::malformed(path, "TimeValue is empty"))?,
        points: rows(&root, "Points", path)?,
        velocity: rows(&data, "velocity", path)?,
        density: column(&data, "density", path)?,
        pressure: column(&data, "pressure", path)?,
        stress: rows(&data, "stress", path)?,
        damage: if data.link_exists("damage") { column(&data, "damage", path)? } else { Vec::new() },
        displacement: if data.link_exists("displacement") {
            rows(&data, "displacement", path)?
        } else {
            Vec::new()
        },
        von_mises: if data.link_exists("von_mises") { column(&data, "von_mises", path)? } else { Vec::new() },
        body: if data.link_exists("body") { column(&data, "body", path)? } else { Vec::new() },
        phase: column(&data, "phase", path)?,
        id: column(&data, "id", path)?,
    };
    match frame.is_consistent() {
        true => Ok(frame),
        false => Err(OutputError::malformed(path, "its columns are not equally long")),
    }
}

fn column<T: H5Type>(group: &Group, name: &str, path: &Path) -> Result<Vec<T>, OutputError> {
    group.dataset(name).and_then(|dataset| dataset.read_raw()).map_err(OutputError::hdf5("read", path))
}

fn rows<const W: usize>(group: &Group, name: &str, path: &Path) -> Result<Vec<[f32; W]>, OutputError> {
    let dataset = group.dataset(name).map_err(OutputError::hdf5("read", path))?;
    let shape = dataset.shape();
    if shape.len() != 2 || shape[1] != W {
        return Err(OutputError::malformed(path, format!("{name} has shape {shape:?}, not [n, {W}]")));
    }
    let flat: Vec<f32> = dataset.read_raw().map_err(OutputError::hdf5("read", path))?;
    Ok(flat.as_chunks::<W>().0.to_vec())
}
