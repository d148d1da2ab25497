//! The midpoint step, Kayaki's eqs. (30) and (31): to n + 1/2 with the rates at n, then from n to n + 1 with the rates
//! at n + 1/2. One walk over the particles also applies the state equation and finds what the next step depends on.

use crate::columns::{Columns, Source};
use crate::rates::RateSum;
use halfstep_scene::bounds::Bounds;
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::state_equation::StateEquation;
use halfstep_wire::half_step::{HalfStep, Stage};

/// Slots that one task walks over; a whole number of clusters. Halves of a few thousand are to be of one length.
const TASK: usize = 256;

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
    /// Time from n, s.
    span: f64,
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
        Self { state, gravity, span: half_step.span(), density, fastest, mass: 0.0, first }
    }
}

/// Advances all particles by the sums of their rates.
pub fn advance<const D: usize>(
    columns: &mut Columns<D>,
    sums: &[RateSum<D>],
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
    walk(part, &conditions)
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

fn walk<const D: usize>(part: Part<'_, D>, conditions: &Conditions<'_, D>) -> Extremes {
    let slots = part.id.len();
    if slots <= TASK {
        return update(part, conditions);
    }
    let (a, b) = part.split_at((slots / 2).next_multiple_of(TASK));
    let (a, b) = rayon::join(|| walk(a, conditions), || walk(b, conditions));
    a.join(b)
}

fn update<const D: usize>(part: Part<'_, D>, conditions: &Conditions<'_, D>) -> Extremes {
    let Conditions { state, gravity, span, density: (low, high), fastest, mass, first } = *conditions;
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
        let (mut x, mut v) = ([0.0; D], [0.0; D]);
        let (mut moved, mut speed, mut pushed) = (0.0, 0.0, 0.0);
        for d in 0..D {
            let a = gravity[d] + sum.acceleration[d].0[k];
            x[d] = part.position_n[d][slot] + span * present.velocity[d];
            v[d] = part.velocity_n[d][slot] + span * a;
            part.position[d][slot] = x[d];
            let dx = x[d] - part.reference[d][slot];
            moved += dx * dx;
            speed += v[d] * v[d];
            pushed += a * a;
        }
        let rho = part.density_n[slot] + span * sum.density_rate.0[k];
        *present = Source::new(x, v, rho, state.pressure(rho), mass);
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
