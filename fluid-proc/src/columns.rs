//! Columns of the fluid particles and what the pair pass reads of any source set.

use halfstep_shared::geometry::FluidPoint;
use halfstep_shared::lane::LANES;
use halfstep_shared::neighbours::{PADDING, Rows};
use halfstep_shared::state_equation::StateEquation;
use rayon::prelude::*;

/// Slots that one task updates.
pub const CHUNK: usize = 2048;

/// D columns.
pub type Vectors<const D: usize> = [Vec<f64>; D];

/// `D` columns of `n` zeros.
pub fn vectors<const D: usize>(n: usize) -> Vectors<D> {
    std::array::from_fn(|_| vec![0.0; n])
}

/// What a neighbour shows in the pair pass: fluid and wall particles alike.
#[derive(Clone, Debug)]
pub struct Shown<const D: usize> {
    /// Position, m.
    pub position: Vectors<D>,
    /// Velocity, m/s (a wall's: the extrapolated one).
    pub velocity: Vectors<D>,
    /// Density rho, kg/m³.
    pub density: Vec<f64>,
    /// p / rho², m⁵/(kg s²).
    pub pressure_term: Vec<f64>,
    /// Volume m / rho, m³ (2D: m²).
    pub volume: Vec<f64>,
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
            pressure_term: vec![0.0; n],
            volume: vec![0.0; n],
            mass,
        }
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
    /// Acceleration, m/s².
    pub acceleration: Vectors<D>,
    /// Rate of density, kg/(m³ s).
    pub density_rate: Vec<f64>,
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
            acceleration: vectors(n),
            density_rate: vec![0.0; n],
            particles: n,
        }
    }

    /// Number of slots, padding included.
    pub fn slots(&self) -> usize {
        self.id.len()
    }

    /// Brings all columns into a new order.
    pub fn permute(&mut self, rows: &mut Rows<D>) {
        for d in 0..D {
            rows.permute(&mut self.now.position[d]);
            rows.permute(&mut self.now.velocity[d]);
            rows.permute(&mut self.position_n[d]);
            rows.permute(&mut self.velocity_n[d]);
            rows.permute(&mut self.acceleration[d]);
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
        for column in
            [&mut self.now.pressure_term, &mut self.now.volume, &mut self.pressure, &mut self.density_rate]
        {
            column.resize(slots, 0.0);
        }
    }

    /// Pressure and what follows from it, from the density.
    pub fn apply_state_equation(&mut self, state: &StateEquation) {
        let mass = self.now.mass;
        (&mut self.pressure, &mut self.now.pressure_term, &mut self.now.volume, &self.now.density)
            .into_par_iter()
            .with_min_len(CHUNK)
            .for_each(|(p, term, volume, &rho)| {
                *p = state.pressure(rho);
                let inverse = 1.0 / rho;
                *term = *p * inverse * inverse;
                *volume = mass * inverse;
            });
    }

    /// Remembers the present state as the state at n.
    pub fn save(&mut self) {
        for d in 0..D {
            self.position_n[d].clone_from(&self.now.position[d]);
            self.velocity_n[d].clone_from(&self.now.velocity[d]);
        }
        self.density_n.clone_from(&self.now.density);
    }

    /// state = state at n + dt * present rates.
    pub fn advance(&mut self, dt: f64) {
        for d in 0..D {
            let columns = (
                &mut self.now.position[d],
                &self.position_n[d],
                &mut self.now.velocity[d],
                &self.velocity_n[d],
                &self.acceleration[d],
            );
            columns.into_par_iter().with_min_len(CHUNK).for_each(|(x, &xn, v, &vn, &a)| {
                *x = xn + dt * *v;
                *v = vn + dt * a;
            });
        }
        (&mut self.now.density, &self.density_n, &self.density_rate)
            .into_par_iter()
            .with_min_len(CHUNK)
            .for_each(|(rho, &rho_n, &rate)| *rho = rho_n + dt * rate);
    }
}
