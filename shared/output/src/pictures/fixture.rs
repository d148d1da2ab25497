//! A scene and a run to draw: water that leaves a tank under a bending gate, made up.

use crate::{Frame, FramePoint, FrameWriter, ProbeLog, series};
use halfstep_scene::*;
use std::path::Path;

pub(crate) const SPACING: f64 = 0.002;

/// A scene as the elastic gate's; only what pictures use has a meaning.
pub(crate) fn scene() -> Scene {
    // Who takes part is the shipped gate's.
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/elastic-gate.toml");
    let gate = halfstep_scene::load(&path, &[]).expect("the shipped gate");
    Scene {
        name: "elastic-gate".into(),
        path: "scenes/elastic-gate.toml".into(),
        preset: None,
        dimension: 2,
        resolution: SPACING,
        smoothing_ratio: 1.33,
        whole: None,
        end_time: 0.4,
        time_step: TimeStep::Auto,
        gravity: [0.0, -9.81, 0.0],
        frame: None,
        fluid: gate.fluid,
        solids: gate.solids,
        interface: Interface {
            treatment: Treatment::MovingWall,
            cross_viscosity: 0.0,
            cross_viscosity_far: 0.0,
            cross_viscosity_reach: 1.25,
        },
        output: Output { frame_interval: 0.02, probe_interval: 0.001, checkpoint_interval: 0.0 },
        pair_contacts: Vec::new(),
        shapes: Vec::new(),
        voids: Vec::new(),
        probes: vec![
            Probe {
                name: "tip".into(),
                kind: ProbeKind::Displacement { at: [0.1, 0.0, 0.0] },
                solid: Some(0),
            },
            Probe {
                name: "bottom".into(),
                kind: ProbeKind::Pressure { at: [0.05, 0.0, 0.0], to: None, shape: None },
                solid: None,
            },
        ],
        references: vec![
            Reference {
                probe: "tip.x".into(),
                label: "Antoci et al. 2007, experiment".into(),
                points: (0..=10).map(|k| [0.04 * f64::from(k), 1.1 * tip(0.04 * f64::from(k))[0]]).collect(),
                column: None,
            },
            Reference {
                probe: "tip.y".into(),
                label: "Antoci et al. 2007, experiment".into(),
                points: (0..=10).map(|k| [0.04 * f64::from(k), 1.1 * tip(0.04 * f64::from(k))[1]]).collect(),
                column: None,
            },
            Reference {
                probe: "tip.x".into(),
                label: "another code".into(),
                points: (0..=200)
                    .map(|k| [0.002 * f64::from(k), 0.9 * tip(0.002 * f64::from(k))[0]])
                    .collect(),
                column: None,
            },
        ],
        metrics: Vec::new(),
        effects: Default::default(),
        own_effects: Default::default(),
        numerics: Numerics {
            kernel: KernelName::WendlandC2,
            precision: Precision::Double,
            cfl: 0.25,
            solid_cfl: 0.5,
            max_sub_steps: 100,
            interface_capacity: None,
            threads: Threads { fluid: 1, solid: 1 },
            lattice: Lattice::Centred,
            domain: None,
        },
        doubtful: Default::default(),
    }
}

/// Displacement of the gate's tip, m.
pub(crate) fn tip(time: f64) -> [f64; 2] {
    let x = 0.045 * (1.0 - (-time / 0.06).exp()) * (1.0 - 1.2 * time);
    [x, 0.35 * x]
}

/// Writes `probes.csv`.
pub(crate) fn probes(scene: &Scene, dir: &Path) {
    let columns: Vec<String> = scene.probes.iter().flat_map(|probe| probe.columns(scene.dimension)).collect();
    let mut log = ProbeLog::create(&dir.join("probes.csv"), &columns).unwrap();
    for k in 0..=400 {
        let time = f64::from(k) * 0.001;
        let [x, y] = tip(time);
        let pressure = 1400.0 * (1.0 - 1.5 * time) + 40.0 * (300.0 * time).sin();
        log.row(time, &[x, y, pressure]).unwrap();
    }
}

/// Writes `count` frames of both sides.
pub(crate) fn frames(dir: &Path, count: u32) {
    std::fs::create_dir_all(series::frames_folder(dir)).unwrap();
    let [mut fluid, mut solid] = ["fluid", "solid"].map(|stem| FrameWriter::start(dir, stem).unwrap());
    for number in 0..count {
        let time = 0.4 * f64::from(number) / f64::from((count - 1).max(1));
        fluid.submit(number, |frame| water(frame, time)).unwrap();
        solid.submit(number, |frame| gate(frame, time)).unwrap();
    }
    assert_eq!([fluid, solid].map(|writer| writer.finish().unwrap()), [count; 2]);
}

/// Writes one frame of the gate alone, intact or with this many cracked particles.
pub(crate) fn cracked_gate(dir: &Path, cracked: usize) {
    std::fs::create_dir_all(series::frames_folder(dir)).unwrap();
    let mut writer = FrameWriter::start(dir, "solid").unwrap();
    writer
        .submit(0, |frame| {
            gate(frame, 0.0);
            frame.damage = (0..frame.points.len()).map(|k| if k < cracked { 1.0 } else { 0.5 }).collect();
        })
        .unwrap();
    assert_eq!(writer.finish().unwrap(), 1);
}

fn point(phase: Phase, id: usize, x: f64, y: f64, pressure: f64, bending: f64) -> FramePoint {
    FramePoint {
        position: [x, y, 0.0],
        velocity: [0.0; 3],
        density: 1000.0,
        pressure,
        stress: [0.0, bending, 0.0, 0.0, 0.0, 0.0],
        phase,
        id: id as u32,
    }
}

fn grid(columns: usize, rows: usize) -> impl Iterator<Item = (f64, f64)> {
    (0..columns * rows).map(move |k| ((k % columns) as f64 * SPACING, (k / columns) as f64 * SPACING))
}

fn water(frame: &mut Frame, time: f64) {
    frame.time = time;
    let level = 0.14 * (1.0 - 1.2 * time);
    for (id, (x, y)) in grid(50, 70).enumerate() {
        let [mut x, mut y] = [x, y * level / 0.14];
        let pressure = 9810.0 * (level - y);
        // What has left: a jet along the floor, and one drop far away.
        if id % 50 > 20 && (id / 50) as f64 * SPACING > level {
            (x, y) = (0.11 + time * 0.5 * ((id % 7) as f64 / 7.0), 0.3 * y * time);
        }
        if id == 3 && time > 0.0 {
            (x, y) = (30.0, 2.0);
        }
        frame.push(point(Phase::Fluid, id, x, y, pressure, 0.0));
    }
    for (id, (x, y)) in grid(150, 3).enumerate() {
        frame.push(point(Phase::Wall, id, x - 3.0 * SPACING, y - 3.0 * SPACING, 0.0, 0.0));
    }
    for (id, (x, y)) in grid(3, 70).enumerate() {
        frame.push(point(Phase::Wall, 450 + id, x - 3.0 * SPACING, y, 0.0, 0.0));
    }
    for (id, (x, y)) in grid(3, 30).enumerate() {
        frame.push(point(Phase::Wall, 660 + id, x + 0.1, y + 0.08, 0.0, 0.0));
    }
}

fn gate(frame: &mut Frame, time: f64) {
    frame.time = time;
    let [dx, dy] = tip(time);
    for (id, (x, y)) in grid(3, 40).enumerate() {
        let along = 1.0 - y / 0.08;
        let bending = 2e6 * (x / SPACING - 1.0) * (1.0 - along) * dx / 0.03;
        frame.push(point(
            Phase::Solid,
            id,
            0.1 + x + dx * along * along,
            y + dy * along * along,
            0.0,
            bending,
        ));
    }
}
