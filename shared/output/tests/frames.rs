//! Frame files and their writer: what is written reads back, and a kill loses nothing that was announced.

use halfstep_output::series::{Series, frame_name, frames_folder, index_name};
use halfstep_output::{Frame, FramePoint, FrameWriter, OutputError, atomic, vtkhdf};
use halfstep_scene::Phase;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Values that are exact in single precision and tell particle, column, component and frame apart.
fn fill(frame: &mut Frame, number: u32, particles: u32) {
    frame.time = f64::from(number) / 3.0;
    for k in 0..particles {
        let at = |c: u32| f64::from(number * 1024 + k) + f64::from(c) / 16.0;
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
}

fn filled(number: u32, particles: u32) -> Frame {
    let mut frame = Frame::default();
    fill(&mut frame, number, particles);
    frame
}

#[test]
fn a_frame_reads_back_bit_for_bit() {
    let dir = tempfile::tempdir().unwrap();
    for particles in [0, 1, 1000] {
        let path = dir.path().join("fluid_000000.hdf");
        let frame = filled(11, particles);
        vtkhdf::write(&path, &frame).unwrap();
        assert_eq!(vtkhdf::read(&path).unwrap(), frame);
        assert!(!atomic::temporary(&path).exists());
    }
    // What only solids have.
    let path = dir.path().join("solid_000000.hdf");
    let mut solid = filled(11, 3);
    solid.displacement = vec![[0.5, -0.25, 0.0]; 3];
    solid.von_mises = vec![1.0, 2.0, 4.0];
    solid.body = vec![0, 1, 0];
    vtkhdf::write(&path, &solid).unwrap();
    assert_eq!(vtkhdf::read(&path).unwrap(), solid);
    solid.body.pop();
    assert!(vtkhdf::write(&path, &solid).is_err(), "a body for each particle");
    let mut crooked = filled(0, 3);
    crooked.id.pop();
    let error = vtkhdf::write(&dir.path().join("crooked.hdf"), &crooked).unwrap_err();
    assert!(matches!(error, OutputError::Malformed { .. }), "{error}");
}

#[test]
fn a_lock_that_somebody_holds_stops_neither_writing_nor_reading() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("fluid_000000.hdf");
    let file = std::fs::File::create(atomic::temporary(&path)).unwrap();
    file.try_lock().unwrap();
    vtkhdf::write(&path, &filled(3, 10)).unwrap();
    // The lock moved along with the file.
    assert!(std::fs::File::open(&path).unwrap().try_lock_shared().is_err());
    assert_eq!(vtkhdf::read(&path).unwrap(), filled(3, 10));
}

#[test]
fn a_file_without_a_frame_is_an_error_that_names_the_file() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("fluid_000000.hdf");
    std::fs::write(&path, "not HDF5").unwrap();
    let error = vtkhdf::read(&path).unwrap_err();
    assert!(matches!(error, OutputError::Hdf5 { .. }));
    assert!(error.to_string().contains("fluid_000000.hdf"), "{error}");

    vtkhdf::write(&path, &filled(0, 4)).unwrap();
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    assert!(vtkhdf::read(&path).is_err());
}

#[test]
fn the_writer_announces_every_frame_in_order() {
    let dir = tempfile::tempdir().unwrap();
    let mut writer = FrameWriter::start(dir.path(), "solid").unwrap();
    for number in 0..10 {
        // Fewer and fewer particles: nothing of an earlier use of the memory may remain.
        writer.submit(number, |frame| fill(frame, number, 100 - 10 * number)).unwrap();
        // Two frames circulate: when one more is accepted, the one before the last two is on disk.
        assert!(writer.safe() + 2 > number);
    }
    assert_eq!(writer.finish().unwrap(), 10);
    let listed = Series::of_run(dir.path(), "solid").unwrap();
    assert_eq!(listed.len(), 10);
    for (number, (path, time)) in (0..).zip(&listed) {
        let frame = filled(number, 100 - 10 * number);
        assert_eq!(
            (path.file_name().unwrap().to_str().unwrap(), *time),
            (&*frame_name("solid", number), frame.time)
        );
        assert_eq!(vtkhdf::read(path).unwrap(), frame);
    }
    assert!(Series::of_run(dir.path(), "fluid").unwrap().is_empty());
}

#[test]
fn a_writer_that_starts_again_replaces_the_list_from_its_first_frame_on() {
    let dir = tempfile::tempdir().unwrap();
    for first in [0, 3] {
        let mut writer = FrameWriter::start(dir.path(), "fluid").unwrap();
        for number in first..first + 6 {
            writer.submit(number, |frame| fill(frame, number, 2)).unwrap();
        }
        assert_eq!(writer.finish().unwrap(), first + 6);
    }
    let listed = Series::of_run(dir.path(), "fluid").unwrap();
    let numbers: Vec<_> = listed.iter().map(|(_, time)| (time * 3.0).round() as u32).collect();
    assert_eq!(numbers, (0..9).collect::<Vec<_>>());
}

#[test]
fn the_index_is_what_paraview_expects() {
    let dir = tempfile::tempdir().unwrap();
    let mut writer = FrameWriter::start(dir.path(), "fluid").unwrap();
    for number in 0..2 {
        writer.submit(number, |frame| fill(frame, number, 1)).unwrap();
    }
    writer.finish().unwrap();
    let text = std::fs::read(frames_folder(dir.path()).join(index_name("fluid"))).unwrap();
    let value: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let expected = serde_json::json!({
        "file-series-version": "1.0",
        "files": [
            { "name": "fluid_000000.hdf", "time": 0.0 },
            { "name": "fluid_000001.hdf", "time": 1.0 / 3.0 },
        ],
    });
    assert_eq!(value, expected);
}

#[test]
fn an_error_of_the_thread_surfaces_with_its_path_and_the_library_stays_silent() {
    const CHILD: &str = "HALFSTEP_TEST_BROKEN_FOLDER";
    if let Ok(dir) = std::env::var(CHILD) {
        let mut writer = FrameWriter::start(Path::new(&dir), "fluid").unwrap();
        writer.submit(0, |frame| fill(frame, 0, 10)).unwrap();
        while writer.safe() == 0 {
            std::thread::yield_now();
        }
        std::fs::remove_dir_all(frames_folder(Path::new(&dir))).unwrap();
        let error = (1..).find_map(|n| writer.submit(n, |frame| fill(frame, n, 10)).err()).unwrap();
        println!("first: {error}");
        println!("then: {}", writer.submit(9, |_| ()).unwrap_err());
        println!("last: {}", writer.finish().unwrap_err());
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let output = again(
        "an_error_of_the_thread_surfaces_with_its_path_and_the_library_stays_silent",
        CHILD,
        dir.path(),
    )
    .output()
    .unwrap();
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{stdout}");
    assert!(stdout.contains("first: cannot write"), "{stdout}");
    assert!(stdout.contains("fluid_000001.hdf: "), "{stdout}");
    assert_eq!(stdout.matches("has stopped").count(), 2, "{stdout}");
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn a_kill_at_any_moment_loses_no_announced_frame() {
    const CHILD: &str = "HALFSTEP_TEST_KILLED_WRITER";
    const PARTICLES: u32 = 300;
    if let Ok(dir) = std::env::var(CHILD) {
        let mut writer = FrameWriter::start(Path::new(&dir), "fluid").unwrap();
        for number in 0..100_000 {
            writer.submit(number, |frame| fill(frame, number, PARTICLES)).unwrap();
            println!("safe {}.", writer.safe());
        }
        unreachable!("the parent kills this process long before");
    }
    for repeat in 0..20_u64 {
        let dir = tempfile::tempdir().unwrap();
        let stdout = dir.path().join("stdout");
        let mut child = again("a_kill_at_any_moment_loses_no_announced_frame", CHILD, dir.path())
            .stdout(Stdio::from(std::fs::File::create(&stdout).unwrap()))
            .spawn()
            .unwrap();
        let said = || {
            let said = std::fs::read_to_string(&stdout).unwrap();
            said.rsplit("safe ").find_map(|tail| tail.split_once('.')?.0.parse::<usize>().ok()).unwrap_or(0)
        };
        while said() == 0 {
            assert!(child.try_wait().unwrap().is_none(), "the writer ended by itself");
            std::thread::sleep(Duration::from_millis(1));
        }
        // Moments that do not repeat, in the middle of whatever the writer is doing then.
        std::thread::sleep(Duration::from_micros(3_571 * repeat));
        child.kill().unwrap();
        child.wait().unwrap();

        let listed = Series::of_run(dir.path(), "fluid").unwrap();
        assert!(listed.len() >= said(), "{} frames said to be safe, {} listed", said(), listed.len());
        for (number, (path, time)) in (0..).zip(&listed) {
            let frame = vtkhdf::read(path).unwrap();
            assert!(frame == filled(number, PARTICLES), "{} has other content", path.display());
            assert_eq!(frame.time, *time);
        }
    }
}

/// This test binary once more, running one test, told by a variable that it is the child.
fn again(test: &str, variable: &str, dir: &Path) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", test, "--nocapture", "--test-threads=1"]).env(variable, dir);
    command
}
