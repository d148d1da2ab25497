//! Fracture (`solid.fracture`): crack-band damage in particles, cuts of pairs, and the bodies that are left.
//!
//! **Damage.** The principal tension sigma of the undamaged law (Rankine), carried to the surface where a particle lies
//! under one, starts damage where it reaches f_t. From then on the nominal tension follows the largest stretch s,
//!   (1 - d) sigma J / s <= f_t exp(-(e - e0) / e_f),   e = e0 + s - s0,   e0 = f_t / E',
//!   e_f = G_f / (f_t b) - e0 / 2   (Bazant and Oh 1983),
//! so a band of width b takes G_f from a crack across it, whatever Poisson's ratio is (next to clamps: `beside_clamp`).
//! Damage scales the tensile part of the stored energy (see `split`) and, to the sixteenth power of 1 - d, the
//! hourglass resistance, which would stiffen the band.
//!
//! **Cuts.** A stretched pair of two particles that have 0.5 % of their strength left is cut: its weight is zero in
//! the moment matrix, the deformation gradient, the force and the hourglass term, and both get a new moment matrix. So
//! is a pair with one such particle once it has opened half as far again.
//! So force stays the derivative of an energy. What damage and cuts take of the energy of the present state is booked
//! when they happen.
//!
//! A damaged particle that is squeezed to a fifth of its volume, or torn to five times of it, is crushed: it loses all
//! its pairs, and goes on as a single particle before it ends the run.
//!
//! Where cuts leave one row of particles, its edges decide in its place (see `ligament`).
//!
//! Both change only at the ends of sub-steps of a step's second stage, which is not taken back, one particle after the
//! other: the first stage computes with what is damaged and cut at n.

mod beside_clamp;
mod cuts;
mod friction;
mod growth;
mod ligament;
mod principal;
mod softening;
mod split;
mod state;
mod surface;
#[cfg(test)]
mod tests;
mod thin;

use super::contact::Contact;
use super::material::Matrix;
use super::model::TotalLagrangian;
use crate::effects::takes_part;
use crate::model::FractureSummary;
pub(super) use friction::Drift;
use friction::Rubbing;
use halfstep_scene::{EffectName, Fracture as Keys, Scene};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::{tensor, with_kernel};
use ligament::Ligament;
use nalgebra::SVector;
use softening::Softening;

/// Part of its strength with which a particle is broken: its stretched pairs with other broken ones are cut. Above, a
/// cut would take noticeably less than G_f: with d = 0.99 and a long softening a quarter of the strength is left.
const BROKEN: f64 = 0.005;

/// What is damaged and cut, by slot.
pub(super) struct Fracture<const D: usize> {
    keys: Keys,
    /// E', Pa.
    modulus: f64,
    /// dx, m.
    spacing: f64,
    /// What happens now is not taken back.
    accepted: bool,
    /// det M inside of the lattice.
    inside: f64,
    /// det M of a corner of the lattice.
    corner: f64,
    /// Of an irregular arrangement: det M inside of its lattice.
    irregular: Option<f64>,
    /// Area for which a cut pair stands, of a lattice a straight one alone, m² (2D: m).
    face: f64,
    /// From a particle under the intact surface to the surface, m; zero inside.
    outward: Vec<[f64; D]>,
    /// Whether a particle has neighbours in a rigid clamp, cuts aside.
    beside_clamp: Vec<bool>,
    /// Largest strain since damage began; 0: intact.
    strain: Vec<f64>,
    /// Strain at which damage began.
    onset: Vec<f64>,
    /// Largest principal stretch at which it did; beside a clamp with the opening on the free side added.
    begun: Vec<f64>,
    /// d.
    damage: Vec<f64>,
    /// F at the end of the last accepted sub-step.
    last: Vec<Matrix<D>>,
    /// Slots with damage, ascending.
    damaged: Vec<usize>,
    /// Slots that are crushed in the present state, ascending: they lose all their pairs at the end of the sub-step.
    crushed: Vec<usize>,
    /// Pairs that are cut, by their slots, in the order of the cuts.
    cuts: Vec<[usize; 2]>,
    /// Particles in the last row beside a cut, ascending by their slots; they follow from the cuts.
    ligaments: Vec<Ligament<D>>,
    /// Coulomb's coefficient of what is left; 0: it does not rub.
    friction: f64,
    /// What rubs in the present state, in the order in which it is slowed.
    rubbing: Vec<Rubbing<D>>,
    /// The same at n.
    rubbing_at_n: Vec<Rubbing<D>>,
    /// What rubbed in the last kick: slots, and the acceleration of the first, m/s².
    rubbed: Vec<([usize; 2], [f64; D])>,
    /// Energy taken, J (2D: J/m).
    taken: f64,
    /// Body of each particle.
    body: Vec<u32>,
    bodies: u32,
    loose: u32,
    /// Particles of bodies that have become thin.
    thin: u32,
    /// Neighbours with which a particle lacks none; more than it can have at the surface.
    whole: Vec<usize>,
    /// Rows of a thick body.
    thick_rows: usize,
    /// Whether each particle began in a thick body.
    was_thick: Vec<bool>,
    /// What sees contacts once there is a cut.
    dormant: Option<Contact<D>>,
    /// Softens along a straight line.
    #[cfg(test)]
    linear: bool,
}

/// det M of a particle of a lattice of spacing `dx` with the neighbours in the direction of all axes (`side` = 0, a
/// corner), or of all directions (-1).
fn determinant<K: Kernel<D>, const D: usize>(kernel: K, dx: f64, side: i32) -> f64 {
    let rows = (2.0 * kernel.smoothing_length() / dx).ceil() as i32 + 1;
    let (first, count) = (side * (rows - 1), rows - side * (rows - 1));
    let mut moment = Matrix::<D>::zeros();
    for k in 0..count.pow(D as u32) {
        let place = |axis: usize| first + k / count.pow(axis as u32) % count;
        let x = SVector::<f64, D>::from_fn(|axis, _| f64::from(place(axis)) * dx);
        if x.norm() > 0.0 {
            moment += x * x.transpose() * (-dx.powi(D as i32) * kernel.slope_at(x.norm()));
        }
    }
    tensor::determinant(&moment)
}

impl<const D: usize> Fracture<D> {
    /// Of the scene's solid of that index; `None` where it does not break.
    pub(super) fn new(
        scene: &Scene,
        solid: usize,
        body: &[u32],
        dormant: Option<Contact<D>>,
    ) -> Option<Self> {
        let material = scene.solids.get(solid)?;
        let keys = material.fracture().filter(|_| takes_part(scene, solid, EffectName::Fracture))?;
        let dx = scene.solid_spacing(solid);
        let h = material.smoothing_ratio * dx;
        Some(Self {
            keys,
            modulus: material.strip_modulus(D),
            spacing: dx,
            accepted: false,
            inside: 1.0,
            corner: with_kernel!(scene.numerics.kernel, h, D, |k| determinant(k, dx, 0)),
            irregular: material
                .irregular()
                .map(|_| with_kernel!(scene.numerics.kernel, h, D, |k| determinant(k, dx, -1))),
            face: dx.powi(D as i32 - 1),
            outward: Vec::new(),
            beside_clamp: Vec::new(),
            strain: Vec::new(),
            onset: Vec::new(),
            begun: Vec::new(),
            damage: Vec::new(),
            last: Vec::new(),
            damaged: Vec::new(),
            crushed: Vec::new(),
            cuts: Vec::new(),
            ligaments: Vec::new(),
            friction: match takes_part(scene, solid, EffectName::FragmentFriction) {
                true => keys.friction,
                false => 0.0,
            },
            rubbing: Vec::new(),
            rubbing_at_n: Vec::new(),
            rubbed: Vec::new(),
            taken: 0.0,
            bodies: body.iter().max().map_or(0, |last| last + 1),
            body: body.to_vec(),
            loose: 0,
            thin: 0,
            whole: Vec::new(),
            thick_rows: thin::rows_of_a_thick_body(scene, dx),
            was_thick: Vec::new(),
            dormant,
            #[cfg(test)]
            linear: false,
        })
    }

    /// What happens now is not taken back, or may be.
    pub(super) fn accept(&mut self, accepted: bool) {
        self.accepted = accepted;
        self.crushed.clear();
    }

    /// Body of each particle.
    pub(super) fn bodies(&self) -> &[u32] {
        &self.body
    }

    /// What happens now is not taken back.
    pub(super) fn is_accepted(&self) -> bool {
        self.accepted
    }

    /// The particle is broken.
    fn is_broken(&self, slot: usize) -> bool {
        self.strain[slot] > 0.0 && self.strain[slot] >= self.broken_strain(slot)
    }

    /// Strain with which a particle is broken; of an intact one what it is inside.
    fn broken_strain(&self, slot: usize) -> f64 {
        let onset = match self.strain[slot] > 0.0 {
            true => self.onset[slot],
            false => self.keys.strength / self.modulus,
        };
        self.law(slot, onset).strain_of(BROKEN)
    }

    /// Opening of a crack with which a particle is broken, m.
    fn broken_opening(&self, slot: usize) -> f64 {
        self.band(slot) * self.broken_strain(slot)
    }

    /// Width of the band of a crack through a particle, m. The rigid side of a clamp stores nothing: the row beside it
    /// takes all of the energy.
    fn band(&self, slot: usize) -> f64 {
        if self.beside_clamp[slot] { self.spacing } else { Keys::BAND * self.spacing }
    }

    /// Softening of a slot from this strain on.
    fn law(&self, slot: usize, onset: f64) -> Softening {
        let law = Softening::new(onset, self.modulus, self.keys.energy / self.band(slot));
        #[cfg(test)]
        let law = law.straight(self.linear);
        law
    }
}

impl<const D: usize> TotalLagrangian<D> {
    /// Lays out the columns of fracture; the moment matrices are made.
    pub(super) fn prepare_fracture(&mut self) {
        let Some(mut fracture) = self.fracture.take() else { return };
        let slots = self.id.len();
        let determinant = |slot: usize| tensor::determinant(&self.moment(slot));
        let free = (0..slots).filter(|&slot| self.is_free(slot));
        fracture.inside = fracture.irregular.unwrap_or_else(|| free.map(determinant).fold(0.0, f64::max));
        if fracture.irregular.is_some() {
            fracture.face = self.face_of_a_pair();
        }
        let none = vec![0.0; slots];
        (fracture.strain, fracture.onset) = (none.clone(), none.clone());
        (fracture.begun, fracture.damage) = (none.clone(), none);
        fracture.last = vec![Matrix::identity(); slots];
        fracture.outward = (0..slots).map(|slot| self.outward(slot, fracture.inside)).collect();
        let beside = |slot| self.pairs.neighbours(slot).any(|(j, _)| self.is_rigid(j));
        fracture.beside_clamp = (0..slots).map(beside).collect();
        self.note_thickness(&mut fracture);
        self.fracture = Some(fracture);
    }

    /// What fracture has done.
    pub(super) fn summary(&self) -> FractureSummary {
        let Some(fracture) = &self.fracture else { return FractureSummary::default() };
        let Fracture { taken, bodies, loose, thin, .. } = *fracture;
        FractureSummary { energy: taken, area: self.cut_area(), bodies, loose, thin }
    }

    /// d of a slot.
    pub(super) fn damage_at(&self, slot: usize) -> f64 {
        self.fracture.as_ref().map_or(0.0, |fracture| fracture.damage[slot])
    }

    /// The slot has a particle that its model moves.
    pub(super) fn is_free(&self, slot: usize) -> bool {
        self.id[slot] != PADDING && self.fixed.clamped[slot] == 0.0
    }
}
