//! Fluid particles in the engine's order, outside any run: what instruction counts and benchmarks work on.

use halfstep_fluid::columns::PairParticles;
use halfstep_fluid::composition::Pass;
use halfstep_fluid::equations::Both;
use halfstep_fluid::rates::{PairEffect, RateLaw, RateSum};
use halfstep_sph::kernel::{CubicSpline, Kernel};
use halfstep_sph::lane::{Isa, Precision};
use halfstep_sph::neighbours::{ClusterList, Rows};
use halfstep_sph::pair;

/// Smoothing length of [`RatePass`], m, for particles about 1 m apart.
pub const SMOOTHING_LENGTH: f64 = 1.33;

/// One particle, before the sort.
#[derive(Clone, Copy, Debug)]
pub struct Particle {
    /// Position, m.
    pub position: [f64; 2],
    /// Velocity, m/s.
    pub velocity: [f64; 2],
    /// Density, kg/m³.
    pub density: f64,
    /// Pressure, Pa.
    pub pressure: f64,
}

/// Particles of mass 1, sorted into rows of height 2, with their neighbours.
#[derive(Clone, Debug)]
pub struct Patch {
    /// The particles.
    pub shown: PairParticles<2>,
    /// Neighbours of the particles.
    pub list: ClusterList,
    /// Instruction set of the list and of the passes over it.
    pub isa: Isa,
    /// Number of the particle in each slot, or padding.
    pub id: Vec<u32>,
}

impl Patch {
    /// Sorts particles and lists all pairs within `reach`.
    pub fn new(particles: &[Particle], reach: f64, isa: Isa) -> Self {
        Self::with_precision(particles, reach, isa, Precision::Double)
    }

    /// The same for passes of this precision.
    pub fn with_precision(particles: &[Particle], reach: f64, isa: Isa, precision: Precision) -> Self {
        let mut shown = PairParticles::<2>::new(particles.len(), 1.0, 1.0);
        let mut pressure: Vec<f64> = particles.iter().map(|p| p.pressure).collect();
        for (k, p) in particles.iter().enumerate() {
            for d in 0..2 {
                shown.position[d][k] = p.position[d];
            }
            (shown.sources[k].velocity, shown.sources[k].density) = (p.velocity, p.density);
        }
        let mut id: Vec<u32> = (0..particles.len() as u32).collect();
        let mut rows = Rows::<2>::new(precision);
        rows.sort(&shown.position, &id, 2.0, [-1e3; 2], [1e3; 2]);
        shown.permute(&mut rows);
        rows.permute(&mut pressure);
        rows.permute_ids(&mut id);
        (0..id.len()).for_each(|slot| shown.show(slot, pressure[slot]));
        shown.round_for(precision);
        let mut list = ClusterList::with_precision(isa, precision);
        list.build(&shown.position, &shown.position, &rows, reach);
        Self { shown, list, id, isa }
    }
}

/// The fluid's rate pass over a patch, with the cubic spline.
#[derive(Debug)]
pub struct RatePass<'a>(pub &'a Patch, pub &'a mut [RateSum<2>]);

impl Pass<2> for RatePass<'_> {
    type Equations = Both;
    fn run<E: PairEffect<2>>(self, effects: E) {
        let shown = &self.0.shown;
        let kernel = CubicSpline::<2>::new(SMOOTHING_LENGTH);
        let law = RateLaw { equations: Both, kernel, effects, targets: shown, sources: shown };
        pair::pass(self.0.isa, &law, &self.0.list, self.1);
    }
}
