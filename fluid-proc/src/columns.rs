//! Columns of the fluid particles and what the pair pass reads of any source set.

use halfstep_scene::geometry::FluidPoint;
use halfstep_sph::columns::copy;
pub use halfstep_sph::columns::{Vectors, fit, vectors};
use halfstep_sph::lane::{Halves, LANES, Lanes, Number, Precision, components};
use halfstep_sph::neighbours::{PADDING, Rows};
use halfstep_sph::state_equation::StateEquation;
use rayon::prelude::*;

/// A particle's state but for where it is as a target, and what the pair pass reads of a neighbour, side by side: one
/// cache line in two dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Source<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s (a wall's: the extrapolated one).
    pub velocity: [f64; D],
    /// Density rho, kg/m³.
    pub density: f64,
    /// Pressure p, Pa.
    pub pressure: f64,
    /// p / rho², m⁵/(kg s²).
    pub pressure_term: f64,
    /// Volume m / rho, m³ (2D: m²).
    pub volume: f64,
}

impl<const D: usize> Source<D> {
    /// At rest at the origin.
    pub const ZERO: Self = Self {
        position: [0.0; D],
        velocity: [0.0; D],
        density: 0.0,
        pressure: 0.0,
        pressure_term: 0.0,
        volume: 0.0,
    };

    /// From a particle's state.
    #[inline(always)]
    pub fn new(position: [f64; D], velocity: [f64; D], density: f64, pressure: f64, mass: f64) -> Self {
        let inverse = 1.0 / density;
        Self {
            position,
            velocity,
            density,
            pressure,
            pressure_term: pressure * inverse * inverse,
            volume: mass * inverse,
        }
    }
}

/// Slots that one task rounds.
const TASK: usize = 1024;

/// A source in single precision: one cache line in two and in three dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
struct SingleSource<const D: usize> {
    position: [Halves; D],
    velocity: [f32; D],
    density: f32,
    excess: f32,
    pressure: f32,
    pressure_term: f32,
    volume: f32,
}

impl<const D: usize> SingleSource<D> {
    const ZERO: Self = Self {
        position: [Halves { high: 0.0, low: 0.0 }; D],
        velocity: [0.0; D],
        density: 0.0,
        excess: 0.0,
        pressure: 0.0,
        pressure_term: 0.0,
        volume: 0.0,
    };

    #[inline(always)]
    fn new(source: &Source<D>, reference: f64) -> Self {
        Self {
            position: source.position.map(Halves::of),
            velocity: source.velocity.map(|v| v as f32),
            density: source.density as f32,
            excess: (source.density - reference) as f32,
            pressure: source.pressure as f32,
            pressure_term: source.pressure_term as f32,
            volume: source.volume as f32,
        }
    }
}

/// A source beside several targets: the same numbers for each of them.
#[derive(Clone, Copy, Debug)]
pub struct Beside<const D: usize, L> {
    /// Velocity, m/s.
    pub velocity: [L; D],
    /// Density rho, kg/m³.
    pub density: L,
    /// Density over the reference, kg/m³: differences of densities are those of this.
    pub excess: L,
    /// Pressure p, Pa.
    pub pressure: L,
    /// p / rho², m⁵/(kg s²).
    pub pressure_term: L,
    /// Volume, m³ (2D: m²).
    pub volume: L,
}

/// The particles of a pair pass: fluid and walls alike.
#[derive(Clone, Debug)]
pub struct PairParticles<const D: usize> {
    /// Position, m.
    pub position: Vectors<D>,
    /// The same with the rest of the state.
    pub sources: Vec<Source<D>>,
    /// The same in single precision; only for passes of mixed precision.
    single: Vec<SingleSource<D>>,
    /// Mass of each particle, kg (2D: kg/m).
    pub mass: f64,
    /// Reference density, kg/m³.
    density: f64,
}

impl<const D: usize> PairParticles<D> {
    /// `n` particles of one mass, kg (2D: kg/m), whose density is about `density`, kg/m³.
    pub fn new(n: usize, mass: f64, density: f64) -> Self {
        Self { position: vectors(n), sources: vec![Source::ZERO; n], single: Vec::new(), mass, density }
    }

    /// Brings all into a new order. What a source has of position and pressure is not what it was.
    pub fn permute(&mut self, rows: &mut Rows<D>) {
        for d in 0..D {
            rows.permute(&mut self.position[d]);
            rows.permute_field(&mut self.sources, Source::ZERO, |s| &mut s.velocity[d]);
        }
        rows.permute_field(&mut self.sources, Source::ZERO, |s| &mut s.density);
        self.sources.truncate(rows.slots());
    }

    /// Gives a slot a pressure, with its velocity and density as they are and its position from the columns.
    #[inline]
    pub fn show(&mut self, slot: usize, pressure: f64) {
        let Source { velocity, density, .. } = self.sources[slot];
        let position = std::array::from_fn(|d| self.position[d][slot]);
        self.sources[slot] = Source::new(position, velocity, density, pressure, self.mass);
    }

    /// Brings what passes of this precision read up to date.
    pub fn round_for(&mut self, precision: Precision) {
        if precision == Precision::Double {
            return;
        }
        let reference = self.density;
        fit(&mut self.single, self.sources.len(), SingleSource::ZERO);
        let parts = self.single.par_chunks_mut(TASK).zip(self.sources.par_chunks(TASK));
        parts.for_each(|(single, sources)| {
            for (single, source) in single.iter_mut().zip(sources) {
                *single = SingleSource::new(source, reference);
            }
        });
    }

    /// Bytes allocated for what passes of mixed precision read.
    pub fn bytes_of_single(&self) -> usize {
        self.single.capacity() * size_of::<SingleSource<D>>()
    }

    /// Where source `j` is.
    #[inline(always)]
    pub fn at<L: Lanes>(&self, j: usize) -> [L::Number; D] {
        if L::SINGLE {
            components(|d| L::of_halves(self.single[j].position[d]))
        } else {
            components(|d| L::Number::of(self.sources[j].position[d]))
        }
    }

    /// Source `j` beside several targets.
    #[inline(always)]
    pub fn beside<L: Lanes>(&self, j: usize) -> Beside<D, L> {
        if L::SINGLE {
            let s = &self.single[j];
            Beside {
                velocity: components(|d| L::splat_single(s.velocity[d])),
                density: L::splat_single(s.density),
                excess: L::splat_single(s.excess),
                pressure: L::splat_single(s.pressure),
                pressure_term: L::splat_single(s.pressure_term),
                volume: L::splat_single(s.volume),
            }
        } else {
            let s = &self.sources[j];
            Beside {
                velocity: components(|d| L::splat(s.velocity[d])),
                density: L::splat(s.density),
                excess: L::splat(s.density),
                pressure: L::splat(s.pressure),
                pressure_term: L::splat(s.pressure_term),
                volume: L::splat(s.volume),
            }
        }
    }

    #[inline(always)]
    fn each<L: Lanes>(&self, slot: usize, of: impl Fn(&Source<D>) -> f64) -> L {
        each(&self.sources, slot, of)
    }

    /// Velocities of consecutive slots.
    #[inline(always)]
    pub fn velocities<L: Lanes>(&self, slot: usize) -> [L; D] {
        components(|d| self.each(slot, |s| s.velocity[d]))
    }

    /// Densities of consecutive slots.
    #[inline(always)]
    pub fn densities<L: Lanes>(&self, slot: usize) -> L {
        self.each(slot, |s| s.density)
    }

    /// Densities over the reference of consecutive slots, as [`Beside::excess`] has them.
    #[inline(always)]
    pub fn excesses<L: Lanes>(&self, slot: usize) -> L {
        if L::SINGLE { self.each(slot, |s| s.density - self.density) } else { self.densities(slot) }
    }

    /// p / rho² of consecutive slots.
    #[inline(always)]
    pub fn pressure_terms<L: Lanes>(&self, slot: usize) -> L {
        self.each(slot, |s| s.pressure_term)
    }
}

/// One number of each of consecutive records.
#[inline(always)]
pub(crate) fn each<T, L: Lanes>(records: &[T], slot: usize, of: impl Fn(&T) -> f64) -> L {
    let records = &records[slot..slot + L::TARGETS];
    L::each(|k| of(&records[k]))
}

/// The fluid particles. State at the present stage, and the state at n while a step is under way.
#[derive(Clone, Debug)]
pub struct Columns<const D: usize> {
    /// Particle number, or [`PADDING`].
    pub id: Vec<u32>,
    /// Present state.
    pub now: PairParticles<D>,
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
        let mut now = PairParticles::new(n, state.density * volume, state.density);
        for (i, p) in points.iter().enumerate() {
            for d in 0..D {
                now.position[d][i] = p.position[d];
            }
            now.sources[i].velocity = p.velocity;
            now.sources[i].density = state.density_at(p.pressure + state.background);
        }
        Self {
            id: (0..n as u32).collect(),
            position_n: now.position.clone(),
            velocity_n: std::array::from_fn(|d| now.sources.iter().map(|s| s.velocity[d]).collect()),
            density_n: now.sources.iter().map(|s| s.density).collect(),
            reference: vectors(0),
            now,
            particles: n,
        }
    }

    /// Number of slots, padding included.
    pub fn slots(&self) -> usize {
        self.id.len()
    }

    /// Brings all columns into a new order.
    pub fn permute(&mut self, rows: &mut Rows<D>, state: &StateEquation) {
        self.now.permute(rows);
        for d in 0..D {
            rows.permute(&mut self.position_n[d]);
            rows.permute(&mut self.velocity_n[d]);
        }
        rows.permute(&mut self.density_n);
        rows.permute_ids(&mut self.id);
        let slots = self.id.len();
        debug_assert_eq!(slots % LANES, 0);
        self.particles = self.id.iter().filter(|&&i| i != PADDING).count();
        for d in 0..D {
            copy(&mut self.reference[d], &self.now.position[d]);
        }
        for slot in 0..slots {
            self.now.show(slot, state.pressure(self.now.sources[slot].density));
        }
    }
}
