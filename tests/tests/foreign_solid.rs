//! A solid in another language, end to end: fluid process, coupler and a Python script that knows only the protocol.

use halfstep_shared::output::series::Series;
use halfstep_tests::curve::Curve;
use halfstep_tests::run::{repository, scene};
use std::process::Command;

const STIFFNESS: f64 = 2e4;

/// The interpreter of the environment with what the script needs.
fn python() -> String {
    let output = Command::new("sh").arg(repository().join("tests/python/setup.sh")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().trim().into()
}

/// Displacement x at which the spring carries the thrust of the water, whose volume is kept: k x = rho g H(x)² / 2.
fn equilibrium() -> f64 {
    let mut x = 0.0;
    for _ in 0..50 {
        let depth = 0.2 * 0.1 / (0.2 + x);
        x = 0.5 * 1000.0 * 9.81 * depth * depth / STIFFNESS;
    }
    x
}

#[test]
fn a_block_on_a_spring_in_python_swings_as_the_formula_says() {
    let script = repository().join("tests/python/spring_block.py");
    let command = format!("{} {} {STIFFNESS}", python(), script.display());
    let run = scene("spring-block").argument("--solid").argument(command).run();
    let curve = run.curve("block.x");

    // Westergaard 1933, as von Karman's estimate for a rigid wall: added mass 0.543 rho H² per metre of width.
    let mass = 8000.0 * 0.04 * 0.14 + 0.543 * 1000.0 * 0.1 * 0.1;
    let period = 2.0 * std::f64::consts::PI * (mass / STIFFNESS).sqrt();
    let expected = equilibrium();
    let mean = curve.between(0.0, 3.0 * period).mean();
    println!("equilibrium {mean:e} m, formula {expected:e} m");
    assert!((mean / expected - 1.0).abs() < 0.05, "{mean} {expected}");

    let swing = Curve { values: curve.values.iter().map(|x| x - mean).collect(), ..curve };
    let measured = swing.period().expect("it swings");
    println!("period {measured} s, formula {period} s");
    assert!((measured / period - 1.0).abs() < 0.05, "{measured} {period}");

    // Its frames and probes are the coupler's work.
    assert_eq!(
        Series::of_run(run.dir(), "solid").unwrap().len(),
        Series::of_run(run.dir(), "fluid").unwrap().len()
    );
    assert!(run.report.audit.action_reaction.unwrap() <= 1e-12);
}
