//! Probes, integral quantities, output and hash of the fluid.

use crate::columns::Source;
use crate::effects::FluidEffect;
use crate::fluid::Fluid;
use halfstep_scene::{Phase, ProbeKind};
use halfstep_sph::neighbours::PADDING;
use halfstep_wire::frame::{Frame, FramePoint};
use halfstep_wire::protocol::Audit;
use halfstep_wire::wide;
use xxhash_rust::xxh3::Xxh3;

impl<const D: usize, X: FluidEffect<D>> Fluid<D, X> {
    pub(crate) fn real_slots(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.columns.slots()).filter(|&s| self.columns.id[s] != PADDING)
    }

    fn position(&self, slot: usize) -> [f64; D] {
        std::array::from_fn(|d| self.columns.now.position[d][slot])
    }

    fn speed_squared(&self, slot: usize) -> f64 {
        self.columns.now.sources[slot].velocity.iter().map(|v| v.powi(2)).sum()
    }

    fn kinetic_energy(&self) -> f64 {
        0.5 * self.columns.now.mass * self.real_slots().map(|s| self.speed_squared(s)).sum::<f64>()
    }

    /// Kernel average of the fluid's pressure at a point; 0 where there is no fluid within 2h.
    fn pressure_at(&self, at: [f64; D]) -> f64 {
        let h = self.smoothing_length;
        let (mut sum, mut weight) = (0.0, 0.0);
        self.rows.candidates(&self.columns.reference[0], at, at, 2.0 * h + self.skin, |first, end| {
            for s in first..end {
                let x = self.position(s);
                let r2: f64 = (0..D).map(|d| (x[d] - at[d]).powi(2)).sum();
                if r2 < 4.0 * h * h {
                    let w = halfstep_sph::kernel::value_at::<D>(self.kernel, h, r2.sqrt());
                    // Extrapolated along gravity, as toward a wall: exact at rest.
                    let head: f64 = (0..D).map(|d| self.gravity[d] * (at[d] - x[d])).sum();
                    let particle = &self.columns.now.sources[s];
                    sum += w * (particle.pressure + particle.density * head);
                    weight += w;
                }
            }
        });
        if weight > 0.0 { sum / weight } else { 0.0 }
    }

    /// Appends the values of the fluid's probes.
    pub(crate) fn measure(&self, out: &mut Vec<f64>) {
        let half = 0.5 * self.resolution;
        for probe in &self.probes {
            match *probe {
                ProbeKind::Pressure { at } => out.push(self.pressure_at(std::array::from_fn(|d| at[d]))),
                ProbeKind::WaterLevel { x } => out.push(
                    self.real_slots()
                        .filter(|&s| (self.columns.now.position[0][s] - x).abs() <= 2.0 * half)
                        .map(|s| self.columns.now.position[1][s] + half)
                        .reduce(f64::max)
                        .unwrap_or(0.0),
                ),
                ProbeKind::Front => out.push(
                    self.real_slots()
                        .map(|s| self.columns.now.position[0][s] + half)
                        .fold(f64::NEG_INFINITY, f64::max),
                ),
                ProbeKind::KineticEnergy { phase: Phase::Fluid } => out.push(self.kinetic_energy()),
                ProbeKind::Centroid { phase: Phase::Fluid } => {
                    let count = self.columns.particles.max(1) as f64;
                    for d in 0..D {
                        out.push(
                            self.real_slots().map(|s| self.columns.now.position[d][s]).sum::<f64>() / count,
                        );
                    }
                }
                ProbeKind::Energy { part, .. } => {
                    if let Some(ledger) = &self.ledger {
                        ledger.ledger.measure(part, out);
                    }
                }
                _ => {}
            }
        }
    }

    pub(crate) fn audit_values(&self) -> Audit {
        let mass = self.columns.now.mass;
        let (mut momentum, mut energy, mut stored, mut error) = ([0.0; D], 0.0, 0.0, 0.0_f64);
        // All in one walk: it is done every step.
        for (particle, _) in self.columns.now.sources.iter().zip(&self.columns.id).filter(|p| *p.1 != PADDING)
        {
            for d in 0..D {
                momentum[d] += particle.velocity[d];
            }
            energy += particle.velocity.iter().map(|v| v.powi(2)).sum::<f64>();
            stored += self.state.energy(particle.density);
            error = error.max((particle.density / self.state.density - 1.0).abs());
        }
        Audit {
            momentum: wide(momentum.map(|p| mass * p)),
            kinetic_energy: 0.5 * mass * energy,
            mass: mass * self.columns.particles as f64,
            density_error: error,
            gap: self.coupling.as_ref().map_or(f64::INFINITY, |c| c.gap()),
            stored_energy: mass * stored,
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
