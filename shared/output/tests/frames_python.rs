//! Other programs open the frames: VTK's HDF reader (the one inside ParaView) and h5py, from Python.
//!
//! `tests/python/setup.sh` keeps the environment with the pinned packages.

use halfstep_output::{Frame, FramePoint, vtkhdf};
use halfstep_scene::Phase;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;

const PYTHON: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/python");

/// Runs a command and returns what it prints.
fn run(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {}\n{stderr}", output.status);
    String::from_utf8(output.stdout).unwrap()
}

/// The interpreter of the environment that the tests in Python share.
fn python() -> PathBuf {
    run(Command::new("sh").arg(Path::new(PYTHON).join("setup.sh"))).trim().into()
}

#[test]
fn vtk_and_h5py_see_what_was_written() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("fluid_000007.hdf");
    let mut frame = Frame { time: 1.0 / 3.0, ..Frame::default() };
    for k in 0..50_u32 {
        let at = |c: u32| f64::from(k) + f64::from(c) / 16.0;
        frame.push(FramePoint {
            position: [at(0), at(1), at(2)],
            velocity: [at(3), at(4), at(5)],
            density: at(6),
            pressure: -at(7),
            stress: [at(8), at(9), at(10), at(11), at(12), at(13)],
            phase: [Phase::Fluid, Phase::Solid, Phase::Wall][k as usize % 3],
            id: k * 7,
        });
    }
    vtkhdf::write(&path, &frame).unwrap();
    let printed = run(Command::new(python()).arg(Path::new(PYTHON).join("frames_check.py")).arg(&path));
    let seen: Value = serde_json::from_str(&printed).unwrap();

    let n = frame.len();
    let vtk = &seen["vtk"];
    assert_eq!(vtk["class"], "vtkUnstructuredGrid");
    assert_eq!((&vtk["points"], &vtk["cells"]), (&json!(n), &json!(n)));
    assert_eq!(vtk["cell_types"], json!(vec![1; n]), "vertex cells");
    assert_eq!(vtk["cell_points"], json!((0..n).collect::<Vec<_>>()));
    let h5py = &seen["h5py"];
    assert_eq!((&h5py["version"], &h5py["type"]), (&json!([1, 0]), &json!("UnstructuredGrid")));
    let types = json!({
        "velocity": "float32", "density": "float32", "pressure": "float32", "stress": "float32",
        "phase": "uint8", "id": "int32",
    });
    assert_eq!(h5py["types"], types);
    // The values are exact in single precision, so both languages print the same numbers.
    let data = json!({
        "velocity": frame.velocity, "density": frame.density, "pressure": frame.pressure, "stress": frame.stress,
        "phase": frame.phase, "id": frame.id,
    });
    for reader in [vtk, h5py] {
        assert_eq!(reader["time"], json!(frame.time));
        assert_eq!(reader["coordinates"], json!(frame.points));
        assert_eq!(reader["data"], data);
    }
}
