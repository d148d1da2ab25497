//! The fluid's energy ledger: powers at n + 1/2, by the effects one after the other.
//!
//! An effect that gives the accelerations a and the density rates r has the power sum m v . a + sum m p / rho² r: the
//! second sum is what it adds to the energy of compression, whose slope by the density is m p / rho². At walls v is
//! relative to the wall; the force on the fluid times the wall's own velocity is the work of walls that move.
//!
//! Position Verlet evaluates forces at n + 1/2 with the velocity at n, but goes from n to n + 1 with the mean of both:
//! there v is v_n + dt / 2 D v / Dt, f_i left out but in its own power, in the powers and in what continuity gives, and
//! walls show continuity what they show beside such fluid. Its density is that of n + 1/2 when the rest is at n + 1:
//! what compression holds at n + 1 has half a step of the power at n + 1/2 beside what that density has.
//!
//! Only scenes whose probes ask for energies pay for these passes, one for each share of a pair.

use crate::columns::{PairParticles, Source, Vectors, each};
use crate::effects::{Effects, FluidEffect};
use crate::fluid::Fluid;
use crate::momentum::pressure_and_continuity;
use crate::rates::{FluidPair, PairEffect, PairRates, Target};
use crate::walls::WallLaw;
use halfstep_role::ledger::Ledger;
use halfstep_role::role::Peer;
use halfstep_role::timeline;
use halfstep_scene::{EnergyPart, FluidIntegration, Phase};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Isa, LANES, Lane, Lanes, components};
use halfstep_sph::neighbours::{ClusterList, PADDING};
use halfstep_sph::pair::{self, PairLaw, distance, dot, pair_sum};
use halfstep_wire::half_step::Stage;
use halfstep_wire::protocol::{ForceRecord, StateRecord};

/// The ledger with the powers of the step that is under way.
#[derive(Clone, Debug)]
pub(crate) struct FluidLedger<const D: usize> {
    pub(crate) ledger: Ledger,
    /// At n + 1/2, by [`EnergyPart`], W (2D: W/m).
    powers: Vec<f64>,
    /// What the density rates of all of them add to the energy of compression at n + 1/2, W (2D: W/m).
    compressing: f64,
    sums: Vec<Power>,
    /// Position Verlet: mean velocity over the step of each slot, m/s; else empty.
    middle: Vec<[f64; D]>,
    /// What each slot of the walls shows beside these, m/s.
    shown: Vec<[f64; D]>,
}

/// Power of an effect on several particles, per mass, W/kg.
#[derive(Clone, Copy, Debug)]
struct Power<L = Lane> {
    /// By the accelerations, relative to walls, and by the density rates.
    given: L,
    /// Of it by the density rates.
    compressing: L,
    /// By the walls' motion.
    walls: L,
}

pair_sum!(Power {} { given, compressing, walls });

/// Pressure and continuity as a share of a pair.
#[derive(Clone, Copy, Debug)]
struct Pressure;

impl<const D: usize> PairEffect<D> for Pressure {
    type Own<L: Lanes> = ();
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        let own = pressure_and_continuity(pair);
        rates.bracket += own.bracket;
        rates.density += own.density;
    }
}

/// The power of one share of a pair.
struct PowerLaw<'a, K, E, const D: usize> {
    kernel: K,
    effect: E,
    targets: &'a PairParticles<D>,
    sources: &'a PairParticles<D>,
    /// Mean velocities of the targets and of the sources over the step, m/s, where forces are not evaluated with them.
    middle: Option<[&'a [[f64; D]]; 2]>,
    /// Predicted velocity of the targets, m/s, where forces are evaluated with it.
    predicted: Option<&'a [[f64; D]]>,
    /// Own velocity of walls, m/s; none between fluid particles.
    walls: Option<&'a Vectors<D>>,
}

impl<K: Kernel<D>, E: PairEffect<D>, const D: usize> PairLaw<D> for PowerLaw<'_, K, E, D> {
    const SINGLE: bool = true;
    /// With the velocity that the power is of, m/s.
    type Target<L: Lanes> = (Target<E::Own<L>, L, D>, [L; D]);
    type Sum<L: Lanes> = Power<L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.targets.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        let target = Target::load(self.targets, slot, self.effect.own(slot));
        let velocity = match self.middle {
            None => target.velocity,
            Some([middle, _]) => components(|d| each(middle, slot, |v| v[d])),
        };
        let target = match self.predicted {
            None => target,
            Some(predicted) => target.moving(predicted, slot),
        };
        (target, velocity)
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.sources.sources[j].position
    }
    #[inline(always)]
    fn source_numbers<L: Lanes>(&self, j: usize) -> [L::Number; D] {
        self.sources.at::<L>(j)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        (i, velocity): &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut Power<L>,
    ) {
        let s = self.sources.beside::<L>(j);
        let f = self.kernel.gradient_over_r::<A, L>(distance(r2, self.kernel.smoothing_length()));
        let pair = i.with::<A>(&s, dx, r2);
        let mut rates = PairRates::ZERO;
        self.effect.add::<A, L>(&i.own, j, &pair, &mut rates);
        if let Some([_, sources]) = self.middle {
            let dv = components(|d| velocity[d] - L::splat(sources[j][d]));
            let pair = FluidPair { dv, approach: dot::<D, A, L>(dv, dx), ..pair };
            let mut of_middle = PairRates::ZERO;
            self.effect.add::<A, L>(&i.own, j, &pair, &mut of_middle);
            rates.density = of_middle.density;
        }
        let mf = L::splat(self.sources.mass) * f;
        let a: [L; D] = components(|d| mf * (rates.bracket * dx[d] + rates.vector[d]));
        let wall = |d: usize| L::splat(self.walls.map_or(0.0, |walls| walls[d][j]));
        for d in 0..D {
            sum.given += a[d] * (velocity[d] - wall(d));
            sum.walls += a[d] * wall(d);
        }
        let compressing = i.pressure_term * s.volume * f * rates.density;
        sum.given += compressing;
        sum.compressing += compressing;
    }
}

/// Measures one share after the other.
pub struct Measuring<'a, K, const D: usize> {
    kernel: K,
    isa: Isa,
    id: &'a [u32],
    fluid: &'a PairParticles<D>,
    sources: &'a PairParticles<D>,
    middle: Option<[&'a [[f64; D]]; 2]>,
    predicted: &'a [[f64; D]],
    walls: Option<&'a Vectors<D>>,
    list: &'a ClusterList,
    sums: &'a mut Vec<Power>,
    powers: &'a mut [f64],
    compressing: &'a mut f64,
}

impl<K: Kernel<D>, const D: usize> Measuring<'_, K, D> {
    /// Adds the power of a share to its part.
    pub(crate) fn add<E: PairEffect<D>>(&mut self, part: EnergyPart, effect: E) {
        self.add_at(part, effect, None);
    }

    /// The same of a share at predicted velocities.
    pub(crate) fn add_predicted<E: PairEffect<D>>(&mut self, part: EnergyPart, effect: E) {
        self.add_at(part, effect, Some(self.predicted));
    }

    fn add_at<E: PairEffect<D>>(&mut self, part: EnergyPart, effect: E, predicted: Option<&[[f64; D]]>) {
        // No pass is compiled for a share that adds nothing.
        if const { !E::MOMENTUM && !E::CONTINUITY } {
            return;
        }
        let Self { kernel, fluid, sources, middle, walls, .. } = *self;
        let law = PowerLaw { kernel, effect, targets: fluid, sources, middle, predicted, walls };
        self.sums.resize(self.list.fours(), Power::default());
        pair::pass(self.isa, &law, self.list, self.sums);
        let (mut given, mut compressing, mut moving) = (0.0, 0.0, 0.0);
        for slot in (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING) {
            let (sum, k) = (&self.sums[slot / LANES], slot % LANES);
            given += sum.given.0[k];
            compressing += sum.compressing.0[k];
            moving += sum.walls.0[k];
        }
        self.powers[part as usize] += self.fluid.mass * given;
        *self.compressing += self.fluid.mass * compressing;
        self.powers[EnergyPart::MovingWalls as usize] += self.fluid.mass * moving;
    }
}

impl<const D: usize> FluidLedger<D> {
    pub(crate) fn new() -> Self {
        let powers = vec![0.0; EnergyPart::ALL.len()];
        Self {
            ledger: Ledger::new(Phase::Fluid),
            powers,
            compressing: 0.0,
            sums: Vec::new(),
            middle: Vec::new(),
            shown: Vec::new(),
        }
    }

    /// Mean velocity over the step of a slot, m/s.
    pub(crate) fn mean_velocity(&self, slot: usize) -> [f64; D] {
        self.middle[slot]
    }

    /// Adds what a solid's pressure does to a particle that published this record.
    pub(crate) fn push(&mut self, own: &StateRecord, acceleration: [f64; D], density_rate: f64) {
        let work: f64 = (0..D).map(|d| own.velocity[d] * acceleration[d]).sum();
        let compressing = own.pressure / own.density.powi(2) * density_rate;
        self.powers[EnergyPart::InterfacePressure as usize] += own.mass * (work + compressing);
        self.compressing += own.mass * compressing;
    }
}

impl<const D: usize, X: FluidEffect<D>> Fluid<D, X> {
    /// Position Verlet: notes the powers at n + 1/2 by the mean velocity over the step, once all sums are there but
    /// those that answer the interface.
    pub(crate) fn measure_powers_by_means<K: Kernel<D>>(
        &mut self,
        kernel: K,
        records: &[StateRecord],
        peers: &[Peer],
    ) {
        if self.ledger.is_none() {
            return;
        }
        let half = 0.5 * self.dt;
        let mean = |(slot, particle): (usize, &Source<D>)| {
            let sum = &self.sums[slot / LANES];
            let a = |d: usize| self.gravity[d] + sum.acceleration[d].0[slot % LANES];
            std::array::from_fn(|d| particle.velocity[d] + half * a(d))
        };
        let middle: Vec<_> = self.columns.now.sources.iter().enumerate().map(mean).collect();
        let shown = self.shown_by_walls(kernel, &middle);
        if let Some(own) = &mut self.ledger {
            (own.middle, own.shown) = (middle, shown);
        }
        self.measure_powers(kernel);
        if let (Some(own), Some(coupling)) = (&mut self.ledger, &mut self.coupling) {
            coupling.measure_push(records, peers, own);
        }
    }

    /// Velocities, m/s, that walls show beside fluid with these.
    fn shown_by_walls<K: Kernel<D>>(&self, kernel: K, velocities: &[[f64; D]]) -> Vec<[f64; D]> {
        let Some(walls) = &self.walls else { return Vec::new() };
        let mut fluid = self.columns.now.clone();
        fluid.sources.iter_mut().zip(velocities).for_each(|(source, v)| source.velocity = *v);
        fluid.round_for(self.fluid_list.precision());
        let law = WallLaw::new(kernel, self.gravity, walls, &fluid);
        let mut shown = vec![[[0.0; D]; LANES]; self.list_of_walls.fours()];
        let show = |slot, sum: &_| walls.shows(slot, sum, &self.state).map(|source| source.velocity);
        pair::pass_into(self.isa, &law, &self.list_of_walls, show, &mut shown);
        shown.as_flattened().to_vec()
    }

    /// Notes the powers of all shares at n + 1/2.
    pub(crate) fn measure_powers<K: Kernel<D>>(&mut self, kernel: K) {
        let Some(FluidLedger { powers, compressing, sums, middle, shown, .. }) = &mut self.ledger else {
            return;
        };
        let _phase = timeline::phase("energy ledger");
        powers.fill(0.0);
        *compressing = 0.0;
        let fluid = &self.columns.now;
        let middle = (!middle.is_empty()).then_some([middle.as_slice(); 2]);
        let (id, isa) = (self.columns.id.as_slice(), self.isa);
        let (list, walls, predicted) = (&self.fluid_list, None, self.predicted.as_slice());
        let mut among = Measuring {
            kernel,
            isa,
            id,
            fluid,
            sources: fluid,
            middle,
            predicted,
            walls,
            list,
            sums,
            powers: powers.as_mut(),
            compressing,
        };
        among.add(EnergyPart::Continuity, Pressure);
        self.effects.measure_pairs(&mut among);
        self.effects.on_particles(&mut |name, of| {
            let real = fluid.sources.iter().enumerate().filter(|(slot, _)| id[*slot] != PADDING);
            let power = |(slot, p): (usize, &Source<D>)| -> f64 {
                let velocity = middle.map_or(&p.velocity, |[middle, _]| &middle[slot]);
                of(&p.position, &p.velocity).iter().zip(velocity).map(|(a, v)| a * v).sum()
            };
            powers[EnergyPart::of_effect(name) as usize] += fluid.mass * real.map(power).sum::<f64>();
        });
        if let Some(drift) = self.effects.drift() {
            let real = drift.iter().zip(id).filter(|(_, id)| **id != PADDING);
            let fall = |velocity: &[f64; D]| (0..D).map(|d| self.gravity[d] * velocity[d]).sum::<f64>();
            powers[EnergyPart::ParticleShifting as usize] -=
                fluid.mass * real.map(|(velocity, _)| fall(velocity)).sum::<f64>();
        }
        let Some(walls) = &self.walls else { return };
        let (sources, list) = (&walls.shown, &self.wall_list);
        let middle = middle.map(|[middle, _]| [middle, shown.as_slice()]);
        let walls = Some(&walls.own_velocity);
        let mut at_walls = Measuring {
            kernel,
            isa,
            id,
            fluid,
            sources,
            middle,
            predicted,
            walls,
            list,
            sums,
            powers,
            compressing,
        };
        at_walls.add(EnergyPart::WallPressure, Pressure);
        self.effects.measure_walls(&mut at_walls);
    }

    /// Notes the power of f_i and of viscous stress across the interface at n + 1/2.
    pub(crate) fn measure_cross_viscosity(&mut self, forces: &[ForceRecord]) {
        let (Some(own), Some(coupling)) = (&mut self.ledger, &self.coupling) else { return };
        let pushed = coupling.slots().iter().zip(forces).map(|(&slot, force)| {
            let slot = slot as usize;
            let velocity = self.columns.now.sources[slot].velocity;
            let f = &force.cross_viscosity;
            // Means over the step have the others' acceleration A, dt / 2 A: f_i is booked with dt A + dt / 2 f_i, so
            // that all powers together are those of the mean velocity.
            let booked = |d: usize| match own.middle.get(slot) {
                Some(middle) => 2.0 * middle[d] - velocity[d] + 0.5 * self.dt * f[d],
                None => velocity[d],
            };
            (0..D).map(|d| booked(d) * f[d]).sum::<f64>()
        });
        own.powers[EnergyPart::CrossViscosity as usize] = self.columns.now.mass * pushed.sum::<f64>();
    }

    /// Kinetic energy, that of compression, and potential energy of the particles at these slots, J (2D: J/m).
    fn held(&self, slots: impl Iterator<Item = usize>) -> [f64; 3] {
        let c = &self.columns;
        // Between the stages of a step the particles hold what they held at n.
        let within = self.stage == Stage::Second;
        let mut held = [0.0; 3];
        for s in slots {
            let now = &c.now.sources[s];
            let at_n = |columns: &Vectors<D>| std::array::from_fn(|d| columns[d][s]);
            let (x, v, rho): ([f64; D], [f64; D], f64) = if within {
                (at_n(&c.position_n), at_n(&c.velocity_n), c.density_n[s])
            } else {
                (at_n(&c.now.position), now.velocity, now.density)
            };
            held[0] += 0.5 * v.map(|v| v * v).iter().sum::<f64>();
            held[1] += self.state.energy(rho);
            held[2] -= (0..D).map(|d| self.gravity[d] * x[d]).sum::<f64>();
        }
        held.map(|energy| c.now.mass * energy)
    }

    /// Notes what is held at n, after a step of this length, s, or at the start.
    pub(crate) fn close_ledger(&mut self, dt: f64) {
        if self.ledger.is_none() {
            return;
        }
        let mut held = self.held(self.real_slots());
        let Some(FluidLedger { ledger, powers, compressing, .. }) = &mut self.ledger else { return };
        if self.integration == FluidIntegration::Verlet {
            held[1] += 0.5 * dt * *compressing;
        }
        for (&part, power) in EnergyPart::ALL.iter().zip(powers) {
            ledger.give(part, dt * *power);
        }
        ledger.hold(held);
    }

    /// Notes that the particles at these slots leave.
    pub(crate) fn give_away(&mut self, slots: &[usize]) {
        if self.ledger.is_none() || slots.is_empty() {
            return;
        }
        let taken: f64 = self.held(slots.iter().copied()).iter().sum();
        if let Some(own) = &mut self.ledger {
            own.ledger.give(EnergyPart::Outflow, -taken);
        }
    }
}
