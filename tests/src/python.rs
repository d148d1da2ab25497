//! The Python environments of tests and examples.

use crate::run::repository;
use std::path::PathBuf;
use std::process::Command;

/// A solid that stays where it is, and fails at step 3.
pub const FAILING_SOLID: &str = "import halfstep\npoints = halfstep.particles()\n\
    solid = halfstep.Solid(points.position, points.mass, points.density)\n\
    for step in solid:\n    if step.number == 3: raise ValueError('no convergence')\n\
    \x20   step.publish(points.position, 0.0)\n";

/// A solid that stays where it is, and hangs at step 3: then there is a file `hangs` in the run's folder.
pub const HANGING_SOLID: &str = "import halfstep, os, time\npoints = halfstep.particles()\n\
    solid = halfstep.Solid(points.position, points.mass, points.density)\n\
    for step in solid:\n    if step.number == 3:\n        open(os.environ['HALFSTEP_OUT'] + '/hangs', 'w').close()\n\
    \x20       time.sleep(600)\n    step.publish(points.position, 0.0)\n";

/// The interpreter that has the package `halfstep` and what tests and the small examples need.
pub fn python() -> PathBuf {
    interpreter(&[])
}

/// The interpreter of an example that needs more: a folder of `python/examples`.
pub fn python_of(example: &str) -> PathBuf {
    interpreter(&[example])
}

fn interpreter(arguments: &[&str]) -> PathBuf {
    let output = Command::new("sh").arg(repository().join("tests/python/setup.sh")).args(arguments).output();
    let output = output.expect("sh starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("a path").trim().into()
}
