//! A solid that rests and that no fluid has reached is not computed until something comes near.
//!
//! An elastic body that is let go from rest goes farthest within half of its slowest period. If no particle was farther
//! than [`TOLERANCE`] dx from its place in the reference configuration during all of that time, none will be later: the
//! body sleeps in the state that it has. The first force that is not zero wakes it, in the same half-step. The slowest
//! period is that of a cantilever as long as the longest and as thick as the shortest side of the solid's box: T =
//! 1.787 L² / H sqrt(12 rho (1 - nu²) / E) (first bending mode, beta L = 1.875). Where that box says too little (rings,
//! several plates), gravity sets a least time: a mode that sags by more than the tolerance has fallen by it after
//! sqrt(8 tolerance / |g|), whatever its period. Only solids that are clamped and begin at rest may sleep.

use crate::model::{Load, OuterRates, Particles};
use halfstep_scene::{Scene, Solid};
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::state::{Fields, State, StateError};

/// Largest displacement of a solid at rest, over the spacing.
pub(crate) const TOLERANCE: f64 = 0.01;

/// Whether a solid sleeps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sleep {
    /// Half the slowest period, or longer, s.
    window: f64,
    /// m.
    tolerance: f64,
    /// How long nothing has happened, s.
    quiet: f64,
    asleep: bool,
}

impl Sleep {
    pub(crate) fn new<const D: usize>(
        scene: &Scene,
        solid: &Solid,
        spacing: f64,
        particles: Particles<'_, D>,
    ) -> Self {
        let mut sides = [(f64::INFINITY, f64::NEG_INFINITY); D];
        for reference in particles.reference {
            for (side, &x) in sides.iter_mut().zip(reference) {
                *side = (side.0.min(x), side.1.max(x));
            }
        }
        let lengths = sides.map(|(low, high)| high - low + spacing);
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let tolerance = TOLERANCE * spacing;
        let gravity = scene.gravity_magnitude();
        let fall = if gravity > 0.0 { (8.0 * tolerance / gravity).sqrt() } else { 0.0 };
        Self {
            window: fall.max(0.5 * slowest_period(solid, longest, shortest)),
            tolerance,
            quiet: 0.0,
            asleep: false,
        }
    }

    /// What this stage asks of the solid.
    pub(crate) fn decide<const D: usize>(
        &mut self,
        half_step: &HalfStep,
        load: &Load<D>,
        outer: &[OuterRates<D>],
        particles: Particles<'_, D>,
    ) -> Rest {
        if !is_zero(load, outer) {
            self.quiet = 0.0;
            let slept = std::mem::take(&mut self.asleep);
            return if slept && half_step.stage == Stage::Second { Rest::Woken } else { Rest::Awake };
        }
        if self.asleep {
            return Rest::Asleep;
        }
        if half_step.stage == Stage::First {
            self.quiet = if is_still(particles, self.tolerance) { self.quiet + half_step.dt } else { 0.0 };
            self.asleep = self.quiet > self.window;
        }
        if self.asleep { Rest::Asleep } else { Rest::Awake }
    }
}

impl State for Sleep {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.real("quiet", &mut self.quiet)?;
        fields.flag("asleep", &mut self.asleep)
    }
}

/// What a half-step asks of the solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rest {
    /// To be computed.
    Awake,
    /// Nothing.
    Asleep,
    /// To be computed from the step's first stage on, which was slept through.
    Woken,
}

fn slowest_period(solid: &Solid, length: f64, thickness: f64) -> f64 {
    let nu = solid.poissons_ratio;
    let stiffness = solid.youngs_modulus / (12.0 * solid.density * (1.0 - nu * nu));
    1.787 * length * length / thickness / stiffness.sqrt()
}

fn is_zero<const D: usize>(load: &Load<D>, outer: &[OuterRates<D>]) -> bool {
    load.force.as_flattened().iter().all(|&f| f == 0.0) && outer.iter().all(|r| *r == OuterRates::ZERO)
}

fn is_still<const D: usize>(particles: Particles<'_, D>, tolerance: f64) -> bool {
    particles
        .position
        .iter()
        .zip(particles.reference)
        .all(|(x, x0)| (0..D).map(|d| (x[d] - x0[d]).powi(2)).sum::<f64>() <= tolerance * tolerance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hypoelastic::Hypoelastic;
    use crate::model::SolidModel;
    use halfstep_sph::lane::Isa;
    use std::path::Path;

    /// A plate 10 mm x 80 mm that stands clamped, without gravity.
    fn scene() -> Scene {
        let text = "resolution = 0.002\nend_time = 1.0\ngravity = [0.0, 0.0]\n[solid]\nmodel = \"hypoelastic\"\ndensity = 2500.0\n\
                    youngs_modulus = 12e6\npoissons_ratio = 0.4\n[[shape]]\nname = \"plate\"\nphase = \"solid\"\n\
                    box = { min = [0.0, 0.0], max = [0.01, 0.08] }\nclamp = { min = [0.0, 0.0], max = [0.01, 0.006] }\n";
        halfstep_scene::parse(text, Path::new("plate.toml"), &[]).unwrap()
    }

    #[test]
    fn the_slowest_period_by_hand() {
        // Thin cantilever, L = 1 m, H = 0.1 m, rho = 1200, E = 1.2e6, nu = 0: omega = 1.8751² sqrt(E H² / (12 rho)) =
        // 3.516 * 0.9129 = 3.2097, T = 1.9576 s.
        let mut solid = scene().solids.remove(0);
        (solid.density, solid.youngs_modulus, solid.poissons_ratio) = (1200.0, 1.2e6, 0.0);
        assert!((slowest_period(&solid, 1.0, 0.1) - 1.9576).abs() < 1e-3);
    }

    #[test]
    fn it_falls_asleep_after_half_a_period_and_wakes_at_a_force() {
        let scene = scene();
        let solid = scene.solids[0].clone();
        let model = Hypoelastic::<2>::new(&scene, 0, Isa::detect()).unwrap();
        let mut sleep = Sleep::new(&scene, &solid, scene.resolution, model.particles());
        let window = 0.5 * slowest_period(&solid, 0.08, 0.01);
        let [first, second] = HalfStep::begin(0, 0.0).lasting(0.6 * window).both();
        let mut load = Load::<2>::none(model.particles().len());
        assert_eq!(sleep.decide(&first, &load, &[], model.particles()), Rest::Awake);
        assert_eq!(sleep.decide(&second, &load, &[], model.particles()), Rest::Awake);
        assert_eq!(sleep.decide(&first, &load, &[], model.particles()), Rest::Asleep);
        load.force[7] = [1e-9, 0.0];
        assert_eq!(sleep.decide(&second, &load, &[], model.particles()), Rest::Woken);
        assert_eq!(sleep.decide(&first, &load, &[], model.particles()), Rest::Awake);
        load.force[7] = [0.0, 0.0];
        assert_eq!(
            sleep.decide(&first, &load, &[], model.particles()),
            Rest::Awake,
            "the window begins anew"
        );
    }
}
