//! The Python package `python/halfstep`: its own tests, and whether it can be installed.

use halfstep_tests::python::python;
use halfstep_tests::run::repository;
use std::process::Command;

/// Runs a program that must succeed; what it says on standard output.
fn output(command: &mut Command) -> String {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Checks of answers, tables of the protocol page, mappings, and the integration that advances a solver once a step.
#[test]
fn the_packages_own_tests_pass() {
    let tests = repository().join("python/tests");
    output(Command::new(python()).args(["-m", "unittest", "discover", "-s"]).arg(tests));
}

/// `pip install ./python`: whoever installs it has all modules, and learns how to start a solid.
#[test]
fn the_package_can_be_installed() {
    let folder = tempfile::tempdir().unwrap();
    let (source, target) = (folder.path().join("python"), folder.path().join("installed"));
    output(Command::new("cp").arg("-r").arg(repository().join("python")).arg(&source));
    let pip = ["-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation", "--target"];
    output(
        Command::new(python()).args(pip).arg(&target).arg(&source).env("PIP_DISABLE_PIP_VERSION_CHECK", "1"),
    );
    let line = "import halfstep; print(halfstep.__file__); halfstep.Solid([[0.0, 0.0]], 1.0, 1.0)";
    let mut alone = Command::new(python());
    alone.args(["-c", line]).env("PYTHONPATH", &target).current_dir(folder.path());
    let ended = alone.output().unwrap();
    let (said, error) = (String::from_utf8_lossy(&ended.stdout), String::from_utf8_lossy(&ended.stderr));
    assert!(said.starts_with(&target.display().to_string()), "{said}");
    assert!(!ended.status.success() && error.contains("halfstep run SCENE --solid"), "{error}");
}

/// The wheel that would be published: pure Python, with its licences and what it needs.
#[test]
fn a_wheel_has_what_an_index_asks_for() {
    let folder = tempfile::tempdir().unwrap();
    let (source, wheels) = (folder.path().join("python"), folder.path().join("wheels"));
    output(Command::new("cp").arg("-r").arg(repository().join("python")).arg(&source));
    let pip = ["-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir"];
    output(
        Command::new(python()).args(pip).arg(&wheels).arg(&source).env("PIP_DISABLE_PIP_VERSION_CHECK", "1"),
    );
    let made: Vec<_> = std::fs::read_dir(&wheels).unwrap().flatten().map(|file| file.path()).collect();
    let [wheel] = made.as_slice() else { panic!("{made:?}") };
    assert!(wheel.to_string_lossy().ends_with("-py3-none-any.whl"), "{wheel:?}");
    let list = "import sys, zipfile; wheel = zipfile.ZipFile(sys.argv[1]); names = wheel.namelist(); \
        print(*names); print(wheel.read(next(n for n in names if n.endswith('METADATA'))).decode())";
    let told = output(Command::new(python()).args(["-c", list]).arg(wheel));
    for part in [
        "halfstep/solid.py",
        "licenses/LICENSE-MIT",
        "licenses/LICENSE-APACHE",
        "License-Expression: MIT OR Apache-2.0",
        "Requires-Dist: iceoryx2==",
        "Requires-Python: >=3.10",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

/// The page's table has each example with the lines that it has, and none has more than a hundred.
#[test]
fn complete_solids_have_a_hundred_lines_at_most() {
    let page = std::fs::read_to_string(repository().join("python/README.md")).unwrap();
    let rows: Vec<(&str, usize)> = page
        .lines()
        .filter_map(|line| {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let path = cells.get(1)?.strip_prefix('`')?.strip_suffix('`')?;
            Some((path, cells.get(3)?.parse().ok()?))
        })
        .collect();
    for (path, lines) in &rows {
        let text = std::fs::read_to_string(repository().join(path)).unwrap();
        assert_eq!(text.lines().count(), *lines, "{path}");
        assert!(*lines <= 100, "{path}");
    }
    for folder in std::fs::read_dir(repository().join("python/examples")).unwrap().flatten() {
        let name = folder.path().strip_prefix(repository()).unwrap().display().to_string();
        assert!(rows.iter().any(|(path, _)| path.starts_with(&name)), "{name} has no row");
    }
}
