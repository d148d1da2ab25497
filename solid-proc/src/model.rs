//! The seam: what a solid model is to the rest of the program.

use halfstep_role::role::Costs;
use halfstep_scene::EnergyPart;
use halfstep_sph::quantity::Quantity;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::state::State;

/// Forces on a model's particles from outside during one stage: one entry for each, by particle number.
#[derive(Clone, Debug)]
pub struct Load<const D: usize> {
    /// Force, N (2D: N/m).
    pub force: Vec<[f64; D]>,
}

impl<const D: usize> Load<D> {
    /// No load on `n` particles.
    pub fn none(n: usize) -> Self {
        Self { force: vec![[0.0; D]; n] }
    }
}

/// What neighbours outside of the model add to the strain rate of one of its particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OuterRates<const D: usize> {
    /// Rate of density, kg/(m³ s).
    pub density: f64,
    /// dv_a/dx_b, 1/s.
    pub gradient: [[f64; D]; D],
}

impl<const D: usize> OuterRates<D> {
    /// Nothing.
    pub const ZERO: Self = Self { density: 0.0, gradient: [[0.0; D]; D] };
}

/// All particles of a model in their present state: one entry for each, by particle number.
#[derive(Clone, Copy, Debug)]
pub struct Particles<'a, const D: usize> {
    /// Position in the reference configuration, m.
    pub reference: &'a [[f64; D]],
    /// Position, m.
    pub position: &'a [[f64; D]],
    /// Velocity, m/s. (Half-way a record may show a mean over sub-steps instead.)
    pub velocity: &'a [[f64; D]],
    /// Density, kg/m³.
    pub density: &'a [f64],
    /// Mass, kg (2D: kg/m).
    pub mass: &'a [f64],
}

impl<const D: usize> Particles<'_, D> {
    /// How many.
    pub fn len(&self) -> usize {
        self.reference.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.reference.is_empty()
    }

    /// Sum over some particles of m v² / 2, J (2D: J/m).
    pub fn kinetic_energy_of(&self, particles: &[u32]) -> f64 {
        let of = |p: usize| 0.5 * self.mass[p] * self.velocity[p].iter().map(|v| v * v).sum::<f64>();
        particles.iter().map(|&p| of(p as usize)).sum()
    }

    /// Sum over all particles of m v² / 2, J (2D: J/m).
    pub fn kinetic_energy(&self) -> f64 {
        let of = |(m, v): (&f64, &[f64; D])| 0.5 * m * v.iter().map(|v| v * v).sum::<f64>();
        self.mass.iter().zip(self.velocity).map(of).sum()
    }
}

/// A rigid body of a model in its present state.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidState<const D: usize> {
    /// Name that scenes give it.
    pub name: String,
    /// Mass, kg (2D: kg/m).
    pub mass: f64,
    /// Centre of mass, m.
    pub center: [f64; D],
    /// Velocity of the centre of mass, m/s.
    pub velocity: [f64; D],
    /// What it has turned by, rad: in the plane the third component, which goes on beyond a whole turn; in space the
    /// rotation's axis times its angle.
    pub angle: [f64; 3],
    /// Angular velocity, rad/s.
    pub angular_velocity: [f64; 3],
    /// Kinetic energy, J (2D: J/m).
    pub kinetic_energy: f64,
    /// Force of contacts, mean over the last step, N (2D: N/m).
    pub contact_force: [f64; D],
    /// Moment of that about the centre of mass, N m (2D: N).
    pub contact_moment: [f64; 3],
}

impl<const D: usize> RigidState<D> {
    /// At rest at the origin.
    pub(crate) fn named(name: String) -> Self {
        Self {
            name,
            mass: 0.0,
            center: [0.0; D],
            velocity: [0.0; D],
            angle: [0.0; 3],
            angular_velocity: [0.0; 3],
            kinetic_energy: 0.0,
            contact_force: [0.0; D],
            contact_moment: [0.0; 3],
        }
    }
}

/// What fracture has done to a model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FractureSummary {
    /// Energy that it took, J (2D: J/m).
    pub energy: f64,
    /// Area of cracks, m² (2D: m): of the faces of cells between which pairs are cut.
    pub area: f64,
    /// Number of bodies.
    pub bodies: u32,
    /// Particles that are loose: left with too few neighbours for a deformation gradient.
    pub loose: u32,
    /// Particles of fragments of at most four rows where there were more, without those that are loose.
    pub thin: u32,
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

/// A solid made of particles.
///
/// Particle numbers run from 0 to n - 1 and never change. A step from n to n + 1 is `advance` with its
/// first stage (to n + 1/2, under the load of n) and then with its second (from n to n + 1, under the load of n + 1/2).
pub trait SolidModel<const D: usize>: Send {
    /// The particles.
    fn particles(&self) -> Particles<'_, D>;
    /// Numbers of the interface set S: particles within 2h of the surface in the reference configuration, ascending.
    fn interface_set(&self) -> &[u32];
    /// Appends the present state of these particles as the wire has it.
    fn records(&self, particles: &[u32], out: &mut Vec<StateRecord>);
    /// Largest stable time step of one sub-step, s.
    fn sub_step_limit(&self) -> f64;
    /// Goes from n over the half-step's span, to n + 1/2 or to n + 1. The load is the force of the stage's own state.
    ///
    /// # Errors
    /// The particle that is farthest out of bounds.
    fn advance(&mut self, half_step: &HalfStep, sub_steps: u32, load: &Load<D>) -> Result<(), OutOfBounds>;
    /// Takes over gravity, m/s², for all evaluations until the next call: before each advance that of the instant of
    /// the stage's own state.
    fn set_gravity(&mut self, gravity: [f64; D]);
    /// Takes over what neighbours outside of the model add to its strain rates, by particle number, for all
    /// evaluations until the next call; an empty slice stands for nothing. A model whose strain does not count such
    /// neighbours ignores it.
    fn take_outer_rates(&mut self, _rates: &[OuterRates<D>]) {}
    /// Energy stored in the material, J (2D: J/m).
    fn strain_energy(&self) -> f64;
    /// Keeps account from now on of what the model's effects give or take of its energy. A model that keeps none lets
    /// that appear as an error of integration.
    fn keep_account(&mut self) {}
    /// Calls `give` with what was given over the last step, J (2D: J/m), after its second stage; negative: taken.
    fn account(&mut self, _give: &mut dyn FnMut(EnergyPart, f64)) {}
    /// The rigid bodies that the model is made of, whose mass and energy are not those of [`Self::particles`]; none of
    /// a model that strains.
    fn rigid_bodies(&self) -> &[RigidState<D>] {
        &[]
    }
    /// Index of each particle's rigid body; empty where there are none.
    fn body_of(&self) -> &[u32] {
        &[]
    }
    /// Number of each particle's body, where fracture changes which are one.
    fn parted(&self) -> Option<&[u32]> {
        None
    }
    /// Deformation gradient of a particle; `None` of a model that keeps none.
    fn deformation(&self, _particle: u32) -> Option<[[f64; D]; D]> {
        None
    }
    /// Kinetic energy, J (2D: J/m).
    fn kinetic_energy(&self) -> f64 {
        match self.rigid_bodies() {
            [] => self.particles().kinetic_energy(),
            bodies => bodies.iter().map(|body| body.kinetic_energy).sum(),
        }
    }
    /// Kinetic and strain energy of some particles of a model that strains, J (2D: J/m), without what contacts between
    /// bodies hold.
    fn energy_of(&self, particles: &[u32]) -> f64 {
        self.particles().kinetic_energy_of(particles)
    }
    /// Calls `give` with particles and the force of contacts on them with walls and other bodies that the model
    /// evaluates, N (2D: N/m), as evaluated last; of a particle as often as kinds of contact act on it. A model of
    /// rigid bodies has it in [`Self::rigid_bodies`].
    fn contact_forces(&self, _give: &mut dyn FnMut(u32, [f64; D])) {}
    /// Joints whose ends are apart by more than a tenth of the spacing in the present state, each with how far, m.
    fn open_joints(&self) -> Vec<(String, f64)> {
        Vec::new()
    }
    /// Joints whose ends begin with different velocities, each with how fast they move, m/s, and turn, rad/s, against
    /// each other.
    fn jerked_joints(&self) -> Vec<(String, [f64; 2])> {
        Vec::new()
    }
    /// What fracture has done; of a model that does not break nothing.
    fn fracture(&self) -> FractureSummary {
        FractureSummary::default()
    }
    /// The model can break: its frames show damage.
    fn breaks(&self) -> bool {
        false
    }
    /// Damage of a particle, 0 to 1.
    fn damage(&self, _particle: u32) -> f64 {
        0.0
    }
    /// Pair evaluations so far.
    fn pair_evaluations(&self) -> u64;
    /// What the model keeps over an interruption; `None`: it cannot be saved, and no checkpoints are written.
    fn state(&mut self) -> Option<&mut dyn State> {
        None
    }
    /// What the model's effects take of its time, measured on the present state, which does not change. A model without
    /// effects that can be left out has none to name.
    fn costs(&mut self) -> Costs {
        Costs::default()
    }
}
