//! Columns of the fluid particles and what the pair pass reads of any source set.

pub use halfstep_shared::columns::{Vectors, vectors};
use halfstep_shared::geometry::FluidPoint;
use halfstep_shared::lane::{LANES, Lane};
use halfstep_shared::neighbours::{PADDING, Rows};
use halfstep_shared::state_equation::StateEquation;

/// Makes a column that long, with room for the little more that other padding may need: not twice as much.
pub(crate) fn fit<T: Clone>(column: &mut Vec<T>, len: usize, value: T) {
    if column.capacity() < len {
        column.reserve_exact(len + len / 32 + 64 - column.len());
    }
    column.resize(len, value);
}

/// What the pair pass reads of one neighbour, side by side: one cache line in two dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Source<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s (a wall's: the extrapolated one).
    pub velocity: [f64; D],
    /// Density rho, kg/m³.
    pub density: f64,
    /// p / rho², m⁵/(kg s²).
    pub pressure_term: f64,
    /// Volume m / rho, m³ (2D: m²).
    pub volume: f64,
}

impl<const D: usize> Source<D> {
    /// At rest at the origin.
    pub const ZERO: Self =
        Self { position: [0.0; D], velocity: [0.0; D], density: 0.0, pressure_term: 0.0, volume: 0.0 };
}

/// The particles of a pair pass: fluid and walls alike.
#[derive(Clone, Debug)]
pub struct Shown<const D: usize> {
    /// Position, m.
    pub position: Vectors<D>,
    /// Velocity, m/s (a wall's: the extrapolated one).
    pub velocity: Vectors<D>,
    /// Density rho, kg/m³.
    pub density: Vec<f64>,
    /// The same and what follows from it, as neighbours read it.
    pub sources: Vec<Source<D>>,
    /// Mass of each particle, kg (2D: kg/m).
    pub mass: f64,
}

impl<const D: usize> Shown<D> {
    /// `n` particles of one mass.
    pub fn new(n: usize, mass: f64) -> Self {
        Self {
            position: vectors(n),
            velocity: vectors(n),
            density: vec![0.0; n],
            sources: vec![Source::ZERO; n],
            mass,
        }
    }

    /// Makes a slot's source from its columns and its pressure.
    #[inline]
    pub fn show(&mut self, slot: usize, pressure: f64) {
        let density = self.density[slot];
        self.sources[slot] = source(
            std::array::from_fn(|d| self.position[d][slot]),
            std::array::from_fn(|d| self.velocity[d][slot]),
            density,
            pressure,
            self.mass,
        );
    }

    /// p / rho² of four slots.
    #[inline(always)]
    pub fn pressure_terms(&self, slot: usize) -> Lane {
        Lane(std::array::from_fn(|k| self.sources[slot + k].pressure_term))
    }
}

/// A source from a particle's state.
#[inline(always)]
pub(crate) fn source<const D: usize>(
    position: [f64; D],
    velocity: [f64; D],
    density: f64,
    pressure: f64,
    mass: f64,
) -> Source<D> {
    let inverse = 1.0 / density;
    Source {
        position,
        velocity,
        density,
        pressure_term: pressure * inverse * inverse,
        volume: mass * inverse,
    }
}

/// The fluid particles. State at the present stage, and the state at n while a step is under way.
#[derive(Clone, Debug)]
pub struct Columns<const D: usize> {
    /// Particle number, or [`PADDING`].
    pub id: Vec<u32>,
    /// Present state.
    pub now: Shown<D>,
    /// Pressure, Pa.
    pub pressure: Vec<f64>,
    /// Position at n, m.
    pub position_n: Vectors<D>,
    /// Velocity at n, m/s.
    pub velocity_n: Vectors<D>,
    /// Density at n, kg/m³.
    pub density_n: Vec<f64>,
    /// Position at the last sort, m.
    pub reference: Vectors<D>,
    /// Number of particles.
    pub particles: usize,
}

impl<const D: usize> Columns<D> {
    /// From the scene's points, unsorted.
    pub fn new(points: &[FluidPoint<D>], state: &StateEquation, volume: f64) -> Self {
        let n = points.len();
        let mut now = Shown::new(n, state.density * volume);
        for (i, p) in points.iter().enumerate() {
            for d in 0..D {
                now.position[d][i] = p.position[d];
                now.velocity[d][i] = p.velocity[d];
            }
            now.density[i] = state.density_at(p.pressure + state.background);
        }
        Self {
            id: (0..n as u32).collect(),
            position_n: now.position.clone(),
            velocity_n: now.velocity.clone(),
            density_n: now.density.clone(),
            reference: now.position.clone(),
            now,
            pressure: vec![0.0; n],
            particles: n,
        }
    }

    /// Number of slots, padding included.
    pub fn slots(&self) -> usize {
        self.id.len()
    }

    /// Brings all columns into a new order.
    pub fn permute(&mut self, rows: &mut Rows<D>, state: &StateEquation) {
        for d in 0..D {
            rows.permute(&mut self.now.position[d]);
            rows.permute(&mut self.now.velocity[d]);
            rows.permute(&mut self.position_n[d]);
            rows.permute(&mut self.velocity_n[d]);
        }
        rows.permute(&mut self.now.density);
        rows.permute(&mut self.density_n);
        rows.permute_ids(&mut self.id);
        let slots = self.id.len();
        debug_assert_eq!(slots % LANES, 0);
        self.particles = self.id.iter().filter(|&&i| i != PADDING).count();
        for d in 0..D {
            self.reference[d].clone_from(&self.now.position[d]);
        }
        fit(&mut self.pressure, slots, 0.0);
        fit(&mut self.now.sources, slots, Source::ZERO);
        for slot in 0..slots {
            let pressure = state.pressure(self.now.density[slot]);
            self.pressure[slot] = pressure;
            self.now.show(slot, pressure);
        }
    }
}
