//! A solid in Python on the package `halfstep`, whose fluid and coupler are the test: a block on a spring.

use halfstep_coupling::supervise::Children;
use halfstep_link::{
    Claim, CouplerLink, CouplerPort, Expect, FLUID, LinkConfig, Port, ProcessLink, Processes, StateMessage,
};
use halfstep_scene::{Block, Geometry};
use halfstep_tests::conformance::link::Run;
use halfstep_tests::python::python;
use halfstep_wire::Name;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{
    ForceHeader, ForceRecord, LAST_STAGE, StateHeader, StateRecord, order, status,
};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Place of the block among the participants.
const SOLID: usize = 1;
const RESOLUTION: f64 = 0.01;
const SOLID_DENSITY: f64 = 1200.0;
const STIFFNESS: f64 = 4.0e4;
const WIDTH: f64 = 0.05;
const HEIGHT: f64 = 0.10;
/// Depth of the water at the block's left side times its weight, Pa.
const BOTTOM_PRESSURE: f64 = 1000.0 * 9.81 * HEIGHT;

fn scene() -> serde_json::Value {
    let block = Block { min: [0.2, 0.0, 0.0], max: [0.2 + WIDTH, HEIGHT, 0.0] };
    serde_json::json!({
        "dimension": 2,
        "resolution": RESOLUTION,
        "solid": { "density": SOLID_DENSITY },
        "shapes": [
            { "phase": "fluid", "geometry": Geometry::Box(Block { min: [0.0; 3], max: [0.2, HEIGHT, 0.0] }) },
            { "phase": "solid", "geometry": Geometry::Box(block) },
        ],
    })
}

/// The pressure of water at rest on the left side, half of it as f_i and half as a force, so that both are needed.
fn hydrostatic(record: &StateRecord) -> ForceRecord {
    let on_left_side = (record.id as usize) < (HEIGHT / RESOLUTION).round() as usize;
    let depth = HEIGHT - record.position[1];
    let force = if on_left_side { BOTTOM_PRESSURE * depth / HEIGHT * RESOLUTION } else { 0.0 };
    ForceRecord {
        id: record.id,
        flags: 0,
        cross_viscosity: [0.5 * force / record.mass, 7.0, 0.0],
        stress_force: [0.5 * force, -3.0, 0.0],
    }
}

/// A fluid that says nothing of interest, on time.
fn fluid(config: &LinkConfig) {
    let mut link = ProcessLink::<Processes>::open(config, Name::FLUID, None).unwrap();
    let (mut states, mut forces) = (Vec::new(), Vec::new());
    let mut half_step = HalfStep::begin(0, 0.0);
    loop {
        let (expect, header) = (Expect::of(&half_step), half_step.state_header());
        link.receive_peer(0, 0, &expect.dt(header.dt), &mut states).unwrap();
        let header = StateHeader { dt_limit: 1.0, ..header };
        link.send_state(0, &header, &[]).unwrap();
        let answer = link.receive_forces(0, &expect, &mut forces).unwrap();
        if answer.order & order::STOP != 0 {
            let last = StateHeader { stage: LAST_STAGE, status: status::FINISHED, ..header };
            link.send_state(0, &last, &[]).unwrap();
            return;
        }
        half_step = half_step.with_step(answer.dt, answer.next_time).next();
    }
}

/// The block's displacement at the start of each step and at the end of the last.
fn coupler(config: &LinkConfig, steps: u64, dt: f64) -> Vec<(f64, f64)> {
    let mut link = CouplerLink::<Processes>::open(config, None).unwrap();
    let mut curve = Vec::new();
    let mut time = 0.0;
    for step in 0.. {
        let stops = step == steps;
        for half_step in HalfStep::begin(step, time).lasting(dt).both() {
            let expect = Expect::of(&half_step).dt(half_step.state_header().dt);
            let order = if stops { order::STOP } else { order::GO };
            let header = ForceHeader { order, ..half_step.force_header() };
            drop(link.receive_state(FLUID, &expect).unwrap());
            link.send_forces(FLUID, &header, &[]).unwrap();
            let solid = link.receive_state(SOLID, &expect).unwrap();
            let records = solid.records();
            assert_eq!(records.len(), 50);
            if half_step.stage == Stage::First {
                curve.push((time, records[0].position[0] - 0.205));
            }
            let answer = |record: &StateRecord| hydrostatic(record);
            let forces: Vec<ForceRecord> =
                if stops { Vec::new() } else { records.iter().map(answer).collect() };
            link.send_forces(SOLID, &header, &forces).unwrap();
            if stops {
                for place in [FLUID, SOLID] {
                    let last = link.receive_state(place, &Expect::last(step)).unwrap();
                    assert_eq!(last.header().status, status::FINISHED);
                }
                return curve;
            }
        }
        time += dt;
    }
    unreachable!("it stops")
}

/// Shows what the script printed if the test fails.
struct PrintOnPanic(PathBuf);

impl Drop for PrintOnPanic {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("{}", std::fs::read_to_string(&self.0).unwrap_or_default());
        }
    }
}

#[test]
fn a_python_block_swings_about_its_equilibrium() {
    let python = python();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("python/spring_block.py");
    assert!(std::fs::read_to_string(&script).unwrap().lines().count() <= 40, "it is meant to be short");
    let dir = tempfile::tempdir().unwrap();
    let scene_path = dir.path().join("scene.json");
    std::fs::write(&scene_path, scene().to_string()).unwrap();
    let log = dir.path().join("log.txt");
    let _shown = PrintOnPanic(log.clone());

    let run = Run::new(0, 50);
    let config: &LinkConfig = &run;
    let claim = Claim::new(config).unwrap();
    let mut children = Children::new(&log);
    let line = format!("'{}' '{}' {STIFFNESS}", python.display(), script.display());
    let told = [("HALFSTEP_SCENE", scene_path.as_path())];
    children.spawn_shell(&config.participants[SOLID], &line, config, &told).unwrap();

    let mass = SOLID_DENSITY * WIDTH * HEIGHT;
    let load = 0.5 * BOTTOM_PRESSURE * HEIGHT;
    let equilibrium = load / STIFFNESS;
    let frequency = (STIFFNESS / mass).sqrt();
    let period = 2.0 * std::f64::consts::PI / frequency;
    let curve = std::thread::scope(|threads| {
        threads.spawn(|| fluid(config));
        coupler(config, 1000, period / 400.0)
    });
    assert!(children.wait(Duration::from_secs(10)));
    assert!(children.first_exit().is_some_and(|(_, status)| status.success()));
    drop(claim);

    assert_eq!(curve.len(), 1001);
    for (time, displacement) in &curve {
        let exact = equilibrium * (1.0 - (frequency * time).cos());
        assert!((displacement - exact).abs() < 1e-3 * equilibrium, "{time}: {displacement}, exactly {exact}");
    }
    let mean = curve[..800].iter().map(|(_, x)| x).sum::<f64>() / 800.0;
    assert!((mean / equilibrium - 1.0).abs() < 1e-3, "equilibrium {mean}, expected {equilibrium}");
    // Upward crossings of the equilibrium are a period apart.
    let crossings: Vec<f64> = curve
        .windows(2)
        .filter(|pair| pair[0].1 < equilibrium && pair[1].1 >= equilibrium)
        .map(|pair| {
            let [(t0, x0), (t1, x1)] = [pair[0], pair[1]];
            t0 + (t1 - t0) * (equilibrium - x0) / (x1 - x0)
        })
        .collect();
    assert_eq!(crossings.len(), 3);
    let measured = (crossings[2] - crossings[0]) / 2.0;
    assert!((measured / period - 1.0).abs() < 1e-3, "period {measured}, expected {period}");
}
