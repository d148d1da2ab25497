//! The seam: what a solid model is to the rest of the program.

use halfstep_role::role::Costs;
use halfstep_sph::quantity::Quantity;
use halfstep_wire::frame::{Frame, FramePoint};
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::StateRecord;

/// What the fluid does to the solid during one stage. One entry for each of the model's particles, by particle number;
/// particles outside the interface set have zeros.
#[derive(Clone, Debug)]
pub struct Load<const D: usize> {
    /// Force, N (2D: N/m).
    pub force: Vec<[f64; D]>,
    /// Rate of density by fluid neighbours, kg/(m³ s); empty but for phase-blind coupling.
    pub density_rate: Vec<f64>,
    /// dv_a/dx_b by fluid neighbours, 1/s; empty but for phase-blind coupling.
    pub gradient: Vec<[[f64; D]; D]>,
}

impl<const D: usize> Load<D> {
    /// No load on `n` particles.
    pub fn none(n: usize) -> Self {
        Self { force: vec![[0.0; D]; n], density_rate: Vec::new(), gradient: Vec::new() }
    }
}

/// A particle of the model left its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfBounds {
    /// Particle number.
    pub particle: u32,
    /// Which quantity.
    pub quantity: Quantity,
    /// Its value.
    pub value: f64,
    /// Where, m.
    pub position: [f64; 3],
}

/// A deformable solid made of particles.
///
/// Particle numbers run from 0 to `particles()` - 1 and never change. A step from n to n + 1 is `advance` with its
/// first stage (to n + 1/2, under the load of n) and then with its second (from n to n + 1, under the load of n + 1/2).
pub trait SolidModel<const D: usize>: Send {
    /// Number of particles.
    fn particles(&self) -> usize;
    /// Numbers of the interface set S: particles within 2h of the surface in the reference configuration, ascending.
    fn interface_set(&self) -> &[u32];
    /// Present state of a particle for the wire.
    fn record(&self, particle: u32) -> StateRecord;
    /// Position of a particle, m.
    fn position(&self, particle: u32) -> [f64; D] {
        let record = self.record(particle);
        std::array::from_fn(|d| record.position[d])
    }
    /// Density of a particle, kg/m³.
    fn density(&self, particle: u32) -> f64 {
        self.record(particle).density
    }
    /// Velocity of a particle, m/s. (The record may show the mean over sub-steps instead.)
    fn velocity(&self, particle: u32) -> [f64; D];
    /// Largest stable time step of one sub-step, s.
    fn sub_step_limit(&self) -> f64;
    /// Goes from n over the half-step's span, to n + 1/2 or to n + 1. The load is the force of the stage's own state.
    ///
    /// # Errors
    /// The particle that is farthest out of bounds.
    fn advance(&mut self, half_step: &HalfStep, sub_steps: u32, load: &Load<D>) -> Result<(), OutOfBounds>;
    /// Position in the reference configuration, m.
    fn reference(&self, particle: u32) -> [f64; D];
    /// Mass of a particle, kg (2D: kg/m).
    fn mass(&self, particle: u32) -> f64;
    /// Energy stored in the material, J (2D: J/m).
    fn strain_energy(&self) -> f64;
    /// Copies the particles for output.
    fn fill_frame(&self, frame: &mut Frame) {
        for p in 0..self.particles() as u32 {
            frame.push(FramePoint::solid(&self.record(p)));
        }
    }
    /// Pair evaluations so far.
    fn pair_evaluations(&self) -> u64;
    /// What the model's effects take of its time, measured on the present state, which does not change. A model without
    /// effects that can be left out has none to name.
    fn costs(&mut self) -> Costs {
        Costs::default()
    }
}
