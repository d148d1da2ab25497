//! What the fluid does to walls: the reaction to what it gets from them. Measured where a probe asks for it and a row
//! is due; the time integration does not need it.

use crate::composition::Shares;
use crate::effects::{Effects, FluidEffect};
use crate::equations::{Momentum, Needed};
use crate::fluid::Fluid;
use crate::rates::{RateLaw, RateSum};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{LANES, Lane, Lanes, Unfused};
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::pair::PairLaw;

impl<const D: usize, X: FluidEffect<D>> Fluid<D, X> {
    /// Force of the fluid on each slot of the walls, N (2D: N/m), after the sums of the same state: for each pair minus
    /// the fluid particle's mass times the acceleration that the pair gives it, all effects at walls included.
    pub(crate) fn loads<K: Kernel<D>>(&self, kernel: K) -> Vec<[f64; D]> {
        let Some(walls) = &self.walls else { return Vec::new() };
        let mut loads = vec![[0.0; D]; walls.slots()];
        let (targets, sources) = (&self.columns.now, &walls.shown);
        let (effects, equations) = (self.effects.at_walls(), Momentum);
        self.add_loads(&RateLaw { kernel, equations, effects, targets, sources }, &mut loads);
        if self.effects.at_walls_predicted().any() {
            let velocities = self.predicted_from_now();
            if let Some(law) = self.predicted_law(kernel, &velocities) {
                self.add_loads(&law, &mut loads);
            }
        }
        loads
    }

    /// Velocities, m/s, to which the accelerations of this state lead in a step as long as the last one. What solids do
    /// is not among them.
    fn predicted_from_now(&self) -> Vec<[f64; D]> {
        let mut sums = vec![RateSum::default(); self.sums.len()];
        self.all_rates(Needed::Momentum, None, &mut sums);
        let mut velocities = Vec::new();
        self.predict(2.0 * self.density_lag, &sums, &mut velocities);
        velocities
    }

    /// Adds the reaction of a law between fluid and walls.
    fn add_loads<W>(&self, law: &W, loads: &mut [[f64; D]])
    where
        W: PairLaw<D, Sum<Lane> = RateSum<D>>,
    {
        let (fluid, mass) = (&self.columns.now, self.columns.now.mass);
        for slot in (0..self.columns.slots()).step_by(LANES) {
            let target = law.target(slot);
            let real: [bool; LANES] = std::array::from_fn(|k| self.columns.id[slot + k] != PADDING);
            for j in self.wall_list.of(slot) {
                let wall = law.source_position(j);
                let dx: [Lane; D] = std::array::from_fn(|d| {
                    Lane(std::array::from_fn(|k| fluid.position[d][slot + k] - wall[d]))
                });
                let r2 = dx.iter().fold(Lane::ZERO, |sum, &dx| sum + dx * dx);
                let mut rates = RateSum::default();
                law.add::<Unfused, Lane>(&target, j, dx, r2, &mut rates);
                for k in (0..LANES).filter(|&k| real[k]) {
                    (0..D).for_each(|d| loads[j][d] -= mass * rates.acceleration[d].0[k]);
                }
            }
        }
    }
}
