//! A solid in C on the library `c`: compiled here, and run by the real program beside the same solid in Python.

use halfstep_tests::python::python;
use halfstep_tests::run::{repository, scene};
use std::path::{Path, PathBuf};
use std::process::Command;

const STIFFNESS: f64 = 2e4;

/// The folder with the library, which this package depends on: beside the tests.
fn libraries() -> PathBuf {
    // The function of the library is named so that the library is built, and up to date.
    let named: extern "C" fn() -> i32 = halfstep_c::halfstep_close;
    assert_eq!(named(), 0);
    let test = std::env::current_exe().expect("a test has a path");
    let deps = test.parent().expect("a folder").to_owned();
    assert!(deps.join("libhalfstep_c.so").exists(), "{}", deps.display());
    deps
}

/// Compiles a C program, warnings are errors; returns the program.
fn compiled(source: &Path, folder: &Path) -> PathBuf {
    let program = folder.join(source.file_stem().expect("a name"));
    let libraries = libraries();
    let run_path = format!("-Wl,-rpath,{}", libraries.display());
    let mut cc = Command::new("cc");
    cc.args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O2", "-I"]);
    cc.arg(repository().join("c/include")).arg(source).arg("-o").arg(&program);
    let done = cc.arg("-L").arg(&libraries).args([&run_path, "-lhalfstep_c"]).output().expect("a C compiler");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    program
}

/// Both sum the forces of 448 particles, in another order: the last bits differ, and nothing else.
#[test]
fn a_block_in_c_moves_as_the_one_in_python() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = compiled(&repository().join("c/examples/spring_block.c"), folder.path());
    let block = |line: String| scene("spring-block").until(0.2).argument("--solid").argument(line).run();
    let in_c = block(format!("{} {STIFFNESS}", program.display()));
    let script = repository().join("tests/python/spring_block.py");
    let in_python = block(format!("{} {} {STIFFNESS}", python().display(), script.display()));
    let [c, python] = [&in_c, &in_python].map(|run| run.curve("block.x"));
    let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // The last bits of speeds are in the time steps, too.
    assert_eq!(c.times.len(), python.times.len());
    let late = apart(&c.times, &python.times);
    assert!(late < 1e-12, "{late:e} s");
    let away = apart(&c.values, &python.values);
    let largest = c.values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    println!("apart by {away:e} m of {largest:e} m in {} steps", in_c.report.steps);
    assert!(largest > 1e-3 && away < 1e-9 * largest, "{away:e} of {largest:e}");
    assert!(in_c.report.audit.action_reaction.expect("an audit") <= 1e-12);
    let said = std::fs::read_to_string(in_c.dir().join("log.txt")).expect("a log");
    assert!(said.contains("contact of the solid with walls: by itself, as it says"), "{said}");
}

/// Null pointers, wrong counts, numbers that nothing has, calls out of order: a code and a text, outside of a run.
#[test]
fn what_is_wrong_is_a_code_and_a_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = compiled(&repository().join("tests/c/wrong.c"), folder.path());
    let alone = Command::new(&program).output().expect("it starts");
    let said = String::from_utf8_lossy(&alone.stdout).into_owned();
    assert!(alone.status.success(), "{said}{}", String::from_utf8_lossy(&alone.stderr));
    assert!(said.contains("halfstep run SCENE --solid"), "{said}");
}

/// The same within a run, which then says who ended it and how.
#[test]
fn a_run_says_what_a_solid_in_c_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = compiled(&repository().join("tests/c/wrong.c"), folder.path());
    for (how, told) in [
        ("diverged", "the solid diverged at step 2, stage 0: speed of particle 3 is 7.0000e1 m/s"),
        ("close", "the solid failed at step 2"),
        ("leave", "the solid"),
    ] {
        let line = format!("{} {how}", program.display());
        let outcome = scene("spring-block").until(0.05).argument("--solid").argument(line).outcome();
        assert_eq!(outcome.code(), Some(2), "{how}: {}", outcome.stderr);
        let error = outcome.report().error.expect("an error");
        println!("{how}: {error}");
        assert!(error.contains(told), "{how}: {error}");
    }
}
