//! Integral quantities, output and hash of the fluid.

use crate::columns::Source;
use crate::effects::FluidEffect;
use crate::fluid::Fluid;
use halfstep_scene::Phase;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::state_equation::StateEquation;
use halfstep_wire::frame::{Frame, FramePoint};
use halfstep_wire::protocol::Audit;
use halfstep_wire::wide;
use xxhash_rust::xxh3::Xxh3;

impl<const D: usize, X: FluidEffect<D>> Fluid<D, X> {
    pub(crate) fn real_slots(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.columns.slots()).filter(|&s| self.columns.id[s] != PADDING)
    }

    pub(crate) fn position(&self, slot: usize) -> [f64; D] {
        std::array::from_fn(|d| self.columns.now.position[d][slot])
    }

    fn speed_squared(&self, slot: usize) -> f64 {
        self.columns.now.sources[slot].velocity.iter().map(|v| v.powi(2)).sum()
    }

    pub(crate) fn kinetic_energy(&self) -> f64 {
        0.5 * self.columns.now.mass * self.real_slots().map(|s| self.speed_squared(s)).sum::<f64>()
    }

    pub(crate) fn audit_values(&self) -> Audit {
        let mass = self.columns.now.mass;
        let totals = Totals::of(&self.columns.now.sources, &self.columns.id, &self.state);
        Audit {
            momentum: wide(totals.velocity.map(|v| mass * v)),
            kinetic_energy: 0.5 * mass * totals.square,
            mass: mass * self.columns.particles as f64,
            density_error: totals.density_error,
            gap: self.coupling.as_ref().map_or(f64::INFINITY, |c| c.gap()),
            stored_energy: mass * totals.stored,
        }
    }

    pub(crate) fn copy_to(&self, time: f64, frame: &mut Frame) {
        frame.clear();
        frame.time = time;
        for s in self.real_slots() {
            let particle = &self.columns.now.sources[s];
            frame.push(point(particle, particle.velocity, Phase::Fluid, self.columns.id[s]));
        }
        let Some(walls) = &self.walls else { return };
        for s in (0..walls.slots()).filter(|&s| walls.id[s] != PADDING) {
            let velocity = std::array::from_fn(|d| walls.own_velocity[d][s]);
            frame.push(point(&walls.shown.sources[s], velocity, Phase::Wall, walls.id[s]));
        }
    }

    pub(crate) fn hash(&self) -> u64 {
        let mut slots: Vec<usize> = self.real_slots().collect();
        slots.sort_unstable_by_key(|&s| self.columns.id[s]);
        let mut hash = Xxh3::new();
        for s in slots {
            let particle = &self.columns.now.sources[s];
            hash.update(&self.columns.id[s].to_le_bytes());
            for d in 0..D {
                hash.update(&particle.position[d].to_le_bytes());
                hash.update(&particle.velocity[d].to_le_bytes());
            }
            hash.update(&particle.density.to_le_bytes());
        }
        hash.digest()
    }
}

/// Sums over particles, in one walk: they are asked for every step.
#[derive(Clone, Copy)]
struct Totals<const D: usize> {
    /// Of velocities, m/s.
    velocity: [f64; D],
    /// Of squared velocities, m²/s².
    square: f64,
    /// Of energies of compression, J/kg.
    stored: f64,
    /// Largest |rho / rho0 - 1|.
    density_error: f64,
}

/// Particles that are added up in a row: another number rounds otherwise.
const TASK: usize = 1024;

impl<const D: usize> Totals<D> {
    /// Halves are added up where they end, whatever thread has walked them: the same bits for any number of threads.
    fn of(particles: &[Source<D>], id: &[u32], state: &StateEquation) -> Self {
        if particles.len() > TASK {
            let at = (particles.len() / 2).next_multiple_of(TASK);
            let (a, b) = rayon::join(
                || Self::of(&particles[..at], &id[..at], state),
                || Self::of(&particles[at..], &id[at..], state),
            );
            return Self {
                velocity: std::array::from_fn(|d| a.velocity[d] + b.velocity[d]),
                square: a.square + b.square,
                stored: a.stored + b.stored,
                density_error: a.density_error.max(b.density_error),
            };
        }
        let mut totals = Self { velocity: [0.0; D], square: 0.0, stored: 0.0, density_error: 0.0 };
        for (particle, _) in particles.iter().zip(id).filter(|p| *p.1 != PADDING) {
            for d in 0..D {
                totals.velocity[d] += particle.velocity[d];
            }
            totals.square += particle.velocity.iter().map(|v| v.powi(2)).sum::<f64>();
            totals.stored += state.energy(particle.density);
            totals.density_error = totals.density_error.max((particle.density / state.density - 1.0).abs());
        }
        totals
    }
}

fn point<const D: usize>(particle: &Source<D>, velocity: [f64; D], phase: Phase, id: u32) -> FramePoint {
    FramePoint {
        position: wide(particle.position),
        velocity: wide(velocity),
        density: particle.density,
        pressure: particle.pressure,
        stress: [0.0; 6],
        phase,
        id,
    }
}
