//! The Python environment of tests and examples.

use crate::run::repository;
use std::path::PathBuf;
use std::process::Command;

/// The interpreter that has the package `halfstep` and what tests and examples need.
pub fn python() -> PathBuf {
    let output = Command::new("sh").arg(repository().join("tests/python/setup.sh")).output();
    let output = output.expect("sh starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("a path").trim().into()
}
