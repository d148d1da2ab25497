use crate::model::{Load, SolidModel};
use crate::total_lagrangian::TotalLagrangian;
use halfstep_scene::EnergyPart;
use halfstep_sph::lane::Isa;
use halfstep_wire::half_step::HalfStep;

/// Runs a solid alone.
pub(super) struct Run<const D: usize> {
    pub(super) model: TotalLagrangian<D>,
    pub(super) time: f64,
    step: u64,
    pub(super) given: Vec<(EnergyPart, f64)>,
    start: f64,
}

impl<const D: usize> Run<D> {
    pub(super) fn of(text: &str) -> Self {
        let scene = halfstep_scene::parse(text, "test.toml".as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let mut model = TotalLagrangian::<D>::new(&scene, 0, Isa::detect()).expect("a solid");
        model.keep_account();
        let start = model.strain_energy() + model.particles().kinetic_energy();
        Self { model, time: 0.0, step: 0, given: EnergyPart::ALL.iter().map(|p| (*p, 0.0)).collect(), start }
    }

    pub(super) fn step(&mut self) {
        let dt = self.model.sub_step_limit();
        let none = Load::none(self.model.particles().len());
        for stage in HalfStep::begin(self.step, self.time).lasting(dt).both() {
            self.model.advance(&stage, 1, &none).unwrap_or_else(|e| panic!("at {}: {e:?}", self.time));
        }
        self.model.account(&mut |part, joules| self.given[part as usize].1 += joules);
        self.time += dt;
        self.step += 1;
    }

    pub(super) fn given(&self, part: EnergyPart) -> f64 {
        self.given[part as usize].1
    }

    /// What nobody gave, J.
    pub(super) fn rest(&self) -> f64 {
        let held = self.model.strain_energy() + self.model.particles().kinetic_energy();
        held - self.start - self.given.iter().map(|given| given.1).sum::<f64>()
    }
}

/// A bar 100 mm x 20 mm pulled at its right end.
fn bar(dx: f64, nu: f64, speed: f64) -> String {
    format!(
        "resolution = {dx}\nend_time = 1.0\n[solid]\ndensity = 1000.0\nyoungs_modulus = 1e9\npoissons_ratio = {nu}\n\
         fracture = {{ strength = 1e6, energy = 100.0 }}\n\
         [[shape]]\nname = \"left\"\nbody = \"bar\"\nphase = \"solid\"\nbox = {{ min = [-0.05, 0.0], max = [0.05, 0.02] }}\n\
         clamp = {{ min = [-0.05, 0.0], max = [0.0, 0.02] }}\n\
         [[shape]]\nname = \"right\"\nbody = \"bar\"\nphase = \"solid\"\nbox = {{ min = [0.05, 0.0], max = [0.15, 0.02] }}\n\
         clamp = {{ min = [0.1, 0.0], max = [0.15, 0.02] }}\n\
         motion = {{ velocity = [{speed}, 0.0], start = 0.0, end = 1.0 }}\n"
    )
}

#[test]
fn bar_probe() {
    for (dx, nu) in [(0.01, 0.0), (0.005, 0.0), (0.0025, 0.0), (0.005, 0.3)] {
        let mut run = Run::<2>::of(&bar(dx, nu, 0.05));
        let mut most = 0.0_f64;
        let mut next = 0.0;
        while run.time < 0.016 {
            run.step();
            let s = run.model.summary();
            let mid = run.model.record((run.model.slot_of.len() / 2) as u32);
            most = most.max(halfstep_wire::frame::von_mises(&mid.deviatoric_stress));
            if run.time > next {
                next += 0.004;
                println!("  t {:.4} taken {:.4} area {:.4} bodies {} damaged {} clamps {:.4} rest {:.2e} strain {:.4} visc {:.4} kin {:.2e}", run.time, s.energy, s.area, s.bodies,
                    run.model.fracture.as_ref().unwrap().damaged.len(), run.given(EnergyPart::Clamps), run.rest(), run.model.strain_energy(), run.given(EnergyPart::ArtificialViscosity), run.model.particles().kinetic_energy());
            }
        }
        let s = run.model.summary();
        println!("dx {dx} nu {nu} steps {} taken/GfA {:.4} peak {:.4e} s {s:?} rest {:.3e}", run.step, s.energy / 2.0, most, run.rest());
        let f = run.model.fracture.as_ref().unwrap();
        let mut rows: Vec<(i64, f64)> = f.damaged.iter().map(|&s| ((run.model.pairs.position()[0][s]*1e5) as i64, f.damage[s])).collect();
        rows.sort_by(|a,b| a.0.cmp(&b.0));
        println!("{:?}", rows.chunk_by(|a,b| a.0==b.0).map(|c| (c[0].0, c.len(), c[0].1)).collect::<Vec<_>>());
    }
}
