//! A program with a solid of its own: a rigid block on a spring holds back water.
//!
//! The block knows nothing of SPH but its particles: where they are, what they weigh, how fast they are. The water's
//! thrust, rho g H² / 2 = 49 N/m, pushes the block; it swings about 49 N/m over the spring's stiffness.

use halfstep::{Error, Scene, Simulation, SolidModel, scene};
use halfstep_scene::geometry;
use halfstep_solid::model::OutOfBounds;
use halfstep_solid::{Load, Particles};
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::state::{Fields, State, StateError};
use halfstep_wire::wide;
use std::path::Path;

const BASIN: &str = r#"
    resolution = 0.01
    end_time = 0.6
    gravity = [0.0, -9.81]
    [fluid]
    density = 1000.0
    [solid]
    density = 8000.0
    youngs_modulus = 1e7
    poissons_ratio = 0.3
    [[shape]]
    name = "water"
    phase = "fluid"
    box = { min = [0.0, 0.0], max = [0.2, 0.1] }
    pressure = "hydrostatic"
    [[shape]]
    name = "block"
    phase = "solid"
    box = { min = [0.2, 0.0], max = [0.24, 0.14] }
    [[shape]]
    name = "basin"
    phase = "wall"
    tank = { min = [0.0, 0.0], max = [0.4, 0.14], open = ["right", "top"] }
    [[probe]]
    name = "block"
    kind = "displacement"
    at = [0.22, 0.07]
"#;

/// A rigid body that a spring holds along x; it cannot turn nor rise.
struct SpringBlock {
    /// N/m for a metre of the body.
    stiffness: f64,
    /// Gravity along x, m/s².
    gravity: f64,
    /// Displacement and velocity at n, m and m/s.
    at_n: [f64; 2],
    /// The same now.
    now: [f64; 2],
    reference: Vec<[f64; 2]>,
    position: Vec<[f64; 2]>,
    velocity: Vec<[f64; 2]>,
    density: Vec<f64>,
    mass: Vec<f64>,
    all: Vec<u32>,
}

impl SpringBlock {
    /// The particles of a scene's first solid.
    fn new(scene: &Scene, stiffness: f64) -> Self {
        let layout = geometry::layout::<2>(scene).with_solid(scene, 0);
        let reference: Vec<[f64; 2]> = layout.solid.iter().map(|point| point.position).collect();
        let n = reference.len();
        let density = scene.solids[0].density;
        let velocity = layout.solid.first().map_or([0.0; 2], |point| point.velocity);
        let start = [0.0, velocity[0]];
        Self {
            stiffness,
            gravity: 0.0,
            at_n: start,
            now: start,
            position: reference.clone(),
            reference,
            velocity: vec![[start[1], 0.0]; n],
            density: vec![density; n],
            mass: vec![density * scene.resolution.powi(2); n],
            all: (0..n as u32).collect(),
        }
    }

    fn place(&mut self) {
        let [x, v] = self.now;
        for (position, reference) in self.position.iter_mut().zip(&self.reference) {
            *position = [reference[0] + x, reference[1]];
        }
        self.velocity.fill([v, 0.0]);
    }
}

impl SolidModel<2> for SpringBlock {
    fn particles(&self) -> Particles<'_, 2> {
        Particles {
            reference: &self.reference,
            position: &self.position,
            velocity: &self.velocity,
            density: &self.density,
            mass: &self.mass,
        }
    }

    fn interface_set(&self) -> &[u32] {
        &self.all
    }

    fn set_gravity(&mut self, gravity: [f64; 2]) {
        self.gravity = gravity[0];
    }

    fn records(&self, particles: &[u32], out: &mut Vec<StateRecord>) {
        out.extend(particles.iter().map(|&p| StateRecord {
            id: p,
            position: wide(self.position[p as usize]),
            velocity: wide(self.velocity[p as usize]),
            density: self.density[p as usize],
            mass: self.mass[p as usize],
            ..StateRecord::default()
        }));
    }

    fn sub_step_limit(&self) -> f64 {
        let mass: f64 = self.mass.iter().sum();
        0.1 * (mass / self.stiffness).sqrt()
    }

    /// The midpoint step: with the rates of n to n + 1/2, with those of n + 1/2 from n to n + 1.
    fn advance(&mut self, half_step: &HalfStep, _: u32, load: &Load<2>) -> Result<(), OutOfBounds> {
        if half_step.stage == Stage::First {
            self.at_n = self.now;
        }
        let mass: f64 = self.mass.iter().sum();
        let thrust: f64 = load.force.iter().map(|force| force[0]).sum();
        let [x, v] = self.now;
        let rates = [v, (thrust - self.stiffness * x) / mass + self.gravity];
        self.now = std::array::from_fn(|k| self.at_n[k] + half_step.span() * rates[k]);
        self.place();
        Ok(())
    }

    fn strain_energy(&self) -> f64 {
        0.5 * self.stiffness * self.now[0].powi(2)
    }

    fn pair_evaluations(&self) -> u64 {
        0
    }

    fn state(&mut self) -> Option<&mut dyn State> {
        Some(self)
    }
}

/// With it, a run with this block can be interrupted and goes on.
impl State for SpringBlock {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.vector("now", &mut self.now)
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.place();
        Ok(())
    }
}

fn parse(text: &str) -> Result<Scene, Error> {
    Ok(scene::parse(text, Path::new("basin.toml"), &[])?)
}

fn main() -> Result<(), Error> {
    let scene = parse(BASIN)?;
    let block = Box::new(SpringBlock::new(&scene, 2e4));
    let mut run = Simulation::new(scene).solid("solid", block)?.begin()?;
    let mut next = 0.0;
    while run.step()? {
        if run.time() >= next {
            println!("t = {:.2} s: {:.3} mm", run.time(), 1e3 * run.probe("block.x").unwrap_or(f64::NAN));
            next += 0.05;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without water: m = 8000 * 0.04 * 0.14 = 44.8 kg/m on 4.48e5 N/m, so omega = 100 1/s; v(0) = 0.1 m/s gives 1 mm
    /// at t = pi / 200 s.
    #[test]
    fn a_dry_block_swings_as_by_hand() {
        let begin = BASIN.find("[solid]").unwrap();
        let fluid = BASIN.find("[fluid]").unwrap();
        let dry = BASIN[..fluid].to_owned() + &BASIN[begin..];
        let water = (
            dry.find("    [[shape]]\n    name = \"water\"").unwrap(),
            dry.find("    [[shape]]\n    name = \"block\"").unwrap(),
        );
        let dry = dry.replace(&dry[water.0..water.1].to_owned(), "");
        let dry = dry.replace("end_time = 0.6", &format!("end_time = {}", std::f64::consts::PI / 200.0));
        let dry = dry.replace("max = [0.24, 0.14] }", "max = [0.24, 0.14] }\n    velocity = [0.1, 0.0]");
        let scene = parse(&dry).unwrap();
        let block = Box::new(SpringBlock::new(&scene, 4.48e5));
        let mut run = Simulation::new(scene).solid("solid", block).unwrap().begin().unwrap();
        while run.step().unwrap() {}
        let x = run.probe("block.x").unwrap();
        assert!((x / 1e-3 - 1.0).abs() < 2e-3, "{x} m");
    }

    /// The block is pushed to 2 * 49.05 / 2e4 = 4.9 mm at most, as a load that is suddenly there does, and less for the
    /// water that runs after it.
    #[test]
    fn the_water_pushes_the_block() {
        let mut scene = parse(BASIN).unwrap();
        scene.end_time = 0.25;
        let block = Box::new(SpringBlock::new(&scene, 2e4));
        let mut run = Simulation::new(scene).solid("solid", block).unwrap().begin().unwrap();
        let mut largest = 0.0_f64;
        while run.step().unwrap() {
            largest = largest.max(run.probe("block.x").unwrap());
        }
        assert!((2.5e-3..4.9e-3).contains(&largest), "{largest} m");
        let report = run.finish().unwrap();
        assert_eq!(report.participants[1].model.as_deref(), Some("own"));
    }

    #[test]
    fn an_interrupted_run_with_the_block_goes_on_to_the_same_bits() {
        let scene = || {
            let mut scene = parse(BASIN).unwrap();
            scene.end_time = 0.02;
            scene
        };
        let with_block = || {
            let scene = scene();
            let block = Box::new(SpringBlock::new(&scene, 2e4));
            Simulation::new(scene).solid("solid", block).unwrap()
        };
        let whole = with_block().run().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let mut first = with_block().folder(folder.path().join("run")).begin().unwrap();
        while first.steps() < whole.steps / 3 {
            first.step().unwrap();
        }
        first.finish().unwrap();
        let mut second = with_block().folder(folder.path().join("run")).resume().unwrap();
        assert!(second.steps() > 0, "it does not begin anew");
        while second.step().unwrap() {}
        let report = second.finish().unwrap();
        assert_eq!((report.steps, report.audit.state_hash), (whole.steps, whole.audit.state_hash));
    }
}
