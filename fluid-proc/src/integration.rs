//! The walk over all particles that ends a half-step: a rule of time integration, the state equation, and what the next
//! step depends on, in one.

use crate::columns::{Columns, Source};
use crate::effects::FluidEffect;
use crate::equations::Needed;
use crate::fluid::Fluid;
use crate::midpoint::Midpoint;
use crate::rates::RateSum;
use crate::verlet::{Drift, Kick};
use halfstep_scene::FluidIntegration;
use halfstep_scene::bounds::Bounds;
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::state_equation::StateEquation;
use halfstep_wire::half_step::{HalfStep, Stage};

/// Slots that one task walks over; a whole number of clusters. Halves of a few thousand are to be of one length.
const TASK: usize = 256;

/// What a rule advances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s.
    pub velocity: [f64; D],
    /// Density, kg/m³.
    pub density: f64,
}

/// What a stage makes of a particle.
pub trait Rule: Copy + Send + Sync {
    /// The stage changes the density.
    const DENSITY: bool;

    /// The state after the stage, from that at n, the present one, the acceleration, m/s², and the density's rate,
    /// kg/(m³ s).
    fn advance<const D: usize>(
        &self,
        at_n: &Moment<D>,
        now: &Source<D>,
        acceleration: [f64; D],
        density_rate: f64,
    ) -> Moment<D>;
}

/// The extremes over all particles after a stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extremes {
    /// Square of the largest displacement since the last sort, m².
    pub displacement: f64,
    /// Square of the largest speed, m²/s².
    pub speed: f64,
    /// Square of the largest acceleration, m²/s⁴.
    pub acceleration: f64,
    /// Some particle is out of bounds.
    pub out_of_bounds: bool,
}

impl Extremes {
    fn join(self, other: Self) -> Self {
        Self {
            displacement: self.displacement.max(other.displacement),
            speed: self.speed.max(other.speed),
            acceleration: self.acceleration.max(other.acceleration),
            out_of_bounds: self.out_of_bounds || other.out_of_bounds,
        }
    }
}

/// What holds for all particles during a stage.
#[derive(Clone, Copy)]
pub struct Conditions<'a, const D: usize> {
    state: &'a StateEquation,
    gravity: [f64; D],
    density: (f64, f64),
    fastest: f64,
    mass: f64,
    first: bool,
}

impl<'a, const D: usize> Conditions<'a, D> {
    /// For one half-step.
    pub fn new(half_step: &HalfStep, gravity: [f64; D], state: &'a StateEquation, bounds: &Bounds) -> Self {
        let change = bounds.density_change;
        let density = (bounds.density * (1.0 - change), bounds.density * (1.0 + change));
        let fastest = bounds.speed * bounds.speed;
        let first = half_step.stage == Stage::First;
        Self { state, gravity, density, fastest, mass: 0.0, first }
    }
}

impl<const D: usize, X: FluidEffect<D>> Fluid<D, X> {
    /// What the next step depends on.
    pub(crate) fn remember(&mut self, stage: Stage, extremes: &Extremes) {
        self.displacement = extremes.displacement.sqrt();
        self.largest_speed = extremes.speed.sqrt();
        if Needed::at(stage, self.integration).momentum() {
            self.largest_acceleration = extremes.acceleration.sqrt();
        }
    }

    /// Advances the particles by the rule of the scene.
    pub(crate) fn integrate(&mut self, half_step: &HalfStep) -> Extremes {
        let conditions = Conditions::new(half_step, self.gravity, &self.state, &self.bounds);
        let (columns, sums) = (&mut self.columns, self.sums.as_slice());
        match (self.integration, half_step.stage) {
            (FluidIntegration::Midpoint, _) => advance(columns, sums, Midpoint::new(half_step), conditions),
            (FluidIntegration::Verlet, Stage::First) => {
                let span = half_step.span();
                let drift = Drift { span, density_span: self.density_lag + span };
                advance(columns, sums, drift, conditions)
            }
            (FluidIntegration::Verlet, Stage::Second) => {
                self.density_lag = 0.5 * half_step.dt;
                advance(columns, sums, Kick { dt: half_step.dt }, conditions)
            }
        }
    }
}

/// Advances all particles by the sums of their rates.
pub fn advance<const D: usize>(
    columns: &mut Columns<D>,
    sums: &[RateSum<D>],
    rule: impl Rule,
    mut conditions: Conditions<'_, D>,
) -> Extremes {
    conditions.mass = columns.now.mass;
    if conditions.first {
        // The present state becomes that at n; what it takes the place of is overwritten.
        std::mem::swap(&mut columns.position_n, &mut columns.now.position);
    }
    let part = Part {
        id: &columns.id,
        sums,
        position_n: columns.position_n.each_ref().map(Vec::as_slice),
        velocity_n: columns.velocity_n.each_mut().map(Vec::as_mut_slice),
        density_n: &mut columns.density_n,
        reference: columns.reference.each_ref().map(Vec::as_slice),
        position: columns.now.position.each_mut().map(Vec::as_mut_slice),
        sources: &mut columns.now.sources,
    };
    walk(part, rule, &conditions)
}

/// Moves the state at n by a drift, m/s, over a step of length `dt`, s: what is advanced from there is moved along.
pub fn shift<const D: usize>(columns: &mut Columns<D>, drift: &[[f64; D]], dt: f64) {
    for d in 0..D {
        for (x, velocity) in columns.position_n[d].iter_mut().zip(drift) {
            *x += dt * velocity[d];
        }
    }
}

/// The columns of consecutive slots.
struct Part<'a, const D: usize> {
    id: &'a [u32],
    sums: &'a [RateSum<D>],
    position_n: [&'a [f64]; D],
    velocity_n: [&'a mut [f64]; D],
    density_n: &'a mut [f64],
    reference: [&'a [f64]; D],
    position: [&'a mut [f64]; D],
    sources: &'a mut [Source<D>],
}

fn split<const D: usize>(columns: [&[f64]; D], at: usize) -> ([&[f64]; D], [&[f64]; D]) {
    (columns.map(|c| &c[..at]), columns.map(|c| &c[at..]))
}

fn split_mut<const D: usize>(columns: [&mut [f64]; D], at: usize) -> ([&mut [f64]; D], [&mut [f64]; D]) {
    let mut right: [&mut [f64]; D] = std::array::from_fn(|_| Default::default());
    let mut d = 0;
    let left = columns.map(|c| {
        let (a, b) = c.split_at_mut(at);
        right[d] = b;
        d += 1;
        a
    });
    (left, right)
}

impl<const D: usize> Part<'_, D> {
    fn split_at(self, at: usize) -> (Self, Self) {
        let (position, position_) = split_mut(self.position, at);
        let (sources, sources_) = self.sources.split_at_mut(at);
        let (position_n, position_n_) = split(self.position_n, at);
        let (velocity_n, velocity_n_) = split_mut(self.velocity_n, at);
        let (reference, reference_) = split(self.reference, at);
        let (density_n, density_n_) = self.density_n.split_at_mut(at);
        let (id, id_) = self.id.split_at(at);
        let (sums, sums_) = self.sums.split_at(at / LANES);
        (
            Self { id, sums, position_n, velocity_n, density_n, reference, position, sources },
            Self {
                id: id_,
                sums: sums_,
                position_n: position_n_,
                velocity_n: velocity_n_,
                density_n: density_n_,
                reference: reference_,
                position: position_,
                sources: sources_,
            },
        )
    }
}

fn walk<const D: usize, R: Rule>(part: Part<'_, D>, rule: R, conditions: &Conditions<'_, D>) -> Extremes {
    let slots = part.id.len();
    if slots <= TASK {
        return update(part, rule, conditions);
    }
    let (a, b) = part.split_at((slots / 2).next_multiple_of(TASK));
    let (a, b) = rayon::join(|| walk(a, rule, conditions), || walk(b, rule, conditions));
    a.join(b)
}

fn update<const D: usize, R: Rule>(part: Part<'_, D>, rule: R, conditions: &Conditions<'_, D>) -> Extremes {
    let Conditions { state, gravity, density: (low, high), fastest, mass, first } = *conditions;
    let mut extremes = Extremes::default();
    for slot in 0..part.id.len() {
        let sum = &part.sums[slot / LANES];
        let k = slot % LANES;
        let present = &mut part.sources[slot];
        if first {
            for d in 0..D {
                part.velocity_n[d][slot] = present.velocity[d];
            }
            part.density_n[slot] = present.density;
        }
        let at_n = Moment {
            position: std::array::from_fn(|d| part.position_n[d][slot]),
            velocity: std::array::from_fn(|d| part.velocity_n[d][slot]),
            density: part.density_n[slot],
        };
        let acceleration = std::array::from_fn(|d| gravity[d] + sum.acceleration[d].0[k]);
        let after = rule.advance(&at_n, present, acceleration, sum.density_rate.0[k]);
        let (mut moved, mut speed, mut pushed) = (0.0, 0.0, 0.0);
        for d in 0..D {
            part.position[d][slot] = after.position[d];
            let dx = after.position[d] - part.reference[d][slot];
            moved += dx * dx;
            speed += after.velocity[d] * after.velocity[d];
            pushed += acceleration[d] * acceleration[d];
        }
        let rho = after.density;
        *present = if R::DENSITY {
            Source::new(after.position, after.velocity, rho, state.pressure(rho), mass)
        } else {
            Source { position: after.position, velocity: after.velocity, ..*present }
        };
        // Padding repeats particles without the solid's forces; what becomes of it must not steer the run.
        if part.id[slot] != PADDING {
            extremes = extremes.join(Extremes {
                displacement: moved,
                speed,
                acceleration: pushed,
                out_of_bounds: !(rho > low && rho < high && speed <= fastest),
            });
        }
    }
    extremes
}
