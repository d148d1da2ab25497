//! Viscous stress between fluid and solid without slip, where the solid is the fluid's moving wall (pair force of
//! [`halfstep_sph::viscosity`]; shown velocity of Adami, Hu and Adams 2012, eqs. 22 and 23).
//!
//! Velocities relative to the solid, with the rotation Omega_s beside its particle s ([`super::spin`]), are
//!   w_fs = v_f - u_s - Omega_s (x_f - x_s),  w~_s = sum_f w_fs W_sf / sum_f W_sf,
//! and s shows the fluid the velocity v_s = u_s - w~_s, its own where there is no fluid around. With grad W = F x_ij,
//!   m_f a_f += sum_s V_f V_s (2 D mu / <r²>) F ((v_f - v_s) . x_fs) x_fs,  V_f = m_f / rho_f,  V_s = m_s / rho_s as
//! shown. The solid receives the opposite of each pair force. Omega_s turns nothing along x_fs, so the force has no
//! part of it. The screen of a thin plate shows a velocity at each of its faces.

mod laws;

use super::faces::{AtFaces, FaceSum};
use super::moving_wall::OneFace;
use super::phase_blind::Vector;
use super::spin::{MomentLaw, Spin};
use super::{Interface, InterfaceParticles, Parameters, SolidForce};
use halfstep_scene::{Decision, Derived, EffectName, Scene, Treatment};
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::ClusterList;
use halfstep_sph::viscosity::strength;
use halfstep_sph::{pair, with_kernel};
use halfstep_wire::protocol::StateRecord;
use laws::{OnFluid, OnSolid, Seen};

/// Whether fluid sticks to solids.
pub fn interface_viscosity(scene: &Scene) -> Decision {
    Decision::new(scene, EffectName::InterfaceViscosity, derive(scene))
}

fn derive(scene: &Scene) -> Derived {
    if scene.fluid.is_none() || scene.solids.is_empty() {
        return Derived::Impossible("one phase only".into());
    }
    if scene.interface.treatment == Treatment::PhaseBlind {
        return Derived::Impossible("phase-blind: the fluid shows the solid its pressure only".into());
    }
    let viscosity = halfstep_scene::viscosity(scene);
    if !viscosity.on {
        return Derived::Impossible(format!("viscosity is off: {}", viscosity.why));
    }
    Derived::On("viscosity is on, and fluid sticks to solids".into())
}

/// What the effect keeps between passes; nothing that a run that goes on needs.
#[derive(Clone, Debug)]
pub(super) struct ViscousStress<const D: usize> {
    /// 2 D mu / <r²>, Pa s / m².
    strength: f64,
    spin: Spin<D>,
    /// v_s at each face by slot of the solid, m/s.
    shown: [[Vec<f64>; D]; 2],
    faces: Vec<[FaceSum<D>; 2]>,
    on_fluid: Vec<Vector<D>>,
    on_solid: Vec<SolidForce<D>>,
}

impl<const D: usize> ViscousStress<D> {
    /// With a list that is as wide as the passes; `None` where no viscous stress crosses the interface.
    pub(super) fn new(parameters: &Parameters<D>, list: &ClusterList) -> Option<Self> {
        let strength = strength::<D>(parameters.viscosity?, parameters.kernel, parameters.smoothing_length);
        let shown = std::array::from_fn(|_| std::array::from_fn(|_| Vec::new()));
        let (faces, on_fluid, on_solid) = Default::default();
        Some(Self { strength, spin: Spin::new(list.clone()), shown, faces, on_fluid, on_solid })
    }

    /// Lists the solid's neighbours among itself.
    pub(super) fn list(&mut self, solid: &InterfaceParticles<D>, reach: f64) {
        self.spin.list.build(&solid.position, &solid.position, solid.rows(), reach);
    }

    /// Pairs that its own passes evaluate.
    pub(super) fn pairs(&self) -> usize {
        self.spin.list.pairs()
    }

    fn seen<'a, F>(&'a self, interface: &'a Interface<D>, faces: F) -> Seen<'a, F, D> {
        let Interface { fluid, solid, .. } = interface;
        Seen { fluid, solid, shown: &self.shown, faces, strength: self.strength }
    }
}

/// Runs a pass with the faces that the solid has.
macro_rules! with_faces {
    ($interface:ident, $stress:ident, |$kernel:ident, $seen:ident| $pass:expr) => {{
        let p = &$interface.parameters;
        with_kernel!(p.kernel, p.smoothing_length, D, |$kernel| match &$interface.screen {
            None => {
                let $seen = $stress.seen($interface, OneFace(&$interface.solid));
                $pass
            }
            Some(screen) => {
                let $seen = $stress.seen($interface, screen.wall($interface));
                $pass
            }
        });
    }};
}

impl<const D: usize> Interface<D> {
    /// Velocities that the solid with these records shows the fluid, once its densities are known.
    pub(super) fn show_velocity(&mut self, records: &[StateRecord]) {
        let Some(mut stress) = self.viscous_stress.take() else { return };
        stress.spin.load(&self.solid, records);
        let (this, isa) = (&*self, self.parameters.isa);
        let mut moments = std::mem::take(&mut stress.spin.sums);
        moments.resize(stress.spin.list.fours(), Default::default());
        with_kernel!(this.parameters.kernel, this.parameters.smoothing_length, D, |kernel| {
            pair::pass(
                isa,
                &MomentLaw { kernel, solid: &this.solid, body: &stress.spin.body },
                &stress.spin.list,
                &mut moments,
            );
        });
        stress.spin.sums = moments;
        let slots = this.solid.density.len();
        stress.spin.solve(slots);
        let mut faces = std::mem::take(&mut stress.faces);
        faces.resize(this.solid_list.fours(), Default::default());
        with_faces!(this, stress, |kernel, seen| {
            let Seen { fluid, solid, faces: of, .. } = seen;
            let law = AtFaces { kernel, fluid, solid, faces: of };
            pair::pass(isa, &law, &this.solid_list, &mut faces);
        });
        let ViscousStress { shown, spin, .. } = &mut stress;
        shown.iter_mut().flatten().for_each(|column| column.resize(slots, 0.0));
        for slot in 0..slots {
            let own: [f64; D] = std::array::from_fn(|d| this.solid.velocity[d][slot]);
            for (shown, sum) in shown.iter_mut().zip(&faces[slot / LANES]) {
                let relative = sum.relative(slot % LANES, &own, |a, b| spin.columns[a][b][slot]);
                (0..D).for_each(|d| shown[d][slot] = own[d] - relative[d]);
            }
        }
        stress.faces = faces;
        self.viscous_stress = Some(stress);
    }

    /// Acceleration of the fluid by viscous stress: `visit(record, acceleration)`, m/s²; nothing without the effect.
    pub fn drag_on_fluid(&mut self, mut visit: impl FnMut(usize, [f64; D])) {
        let Some(mut stress) = self.viscous_stress.take() else { return };
        let (this, isa) = (&*self, self.parameters.isa);
        let mut sums = std::mem::take(&mut stress.on_fluid);
        sums.resize(this.fluid_list.fours(), Vector::default());
        with_faces!(this, stress, |kernel, seen| {
            pair::pass(isa, &OnFluid(kernel, seen), &this.fluid_list, &mut sums);
        });
        for (slot, record) in this.fluid.slots() {
            visit(record, sums[slot / LANES].0.map(|a| a.0[slot % LANES]));
        }
        stress.on_fluid = sums;
        self.viscous_stress = Some(stress);
    }

    /// The same of the solid, an acceleration of its own mass.
    pub fn drag_on_solid(&mut self, mut visit: impl FnMut(usize, [f64; D])) {
        let Some(mut stress) = self.viscous_stress.take() else { return };
        let (this, isa) = (&*self, self.parameters.isa);
        let mut sums = std::mem::take(&mut stress.on_solid);
        sums.resize(this.solid_list.fours(), SolidForce::default());
        with_faces!(this, stress, |kernel, seen| {
            pair::pass(isa, &OnSolid(kernel, seen), &this.solid_list, &mut sums);
        });
        for (slot, record) in this.solid.slots() {
            let mass = this.solid.own_mass[slot];
            visit(record, sums[slot / LANES].0.map(|force| force.0[slot % LANES] / mass));
        }
        stress.on_solid = sums;
        self.viscous_stress = Some(stress);
    }
}
