//! Walls that hold values toward the solid (Kayaki section 4.1): velocity zero, the pressure extrapolated from the
//! particles around (eq. 28), the density of that pressure (eq. 5) and no deviatoric stress. They take part in the
//! solid's sums like its own particles and, unlike walls toward the fluid, may pull.
//!
//! Two sets can be such walls. `effects.wall-particles`: the scene's wall particles, which then are particles of the
//! model after the solid's own, never published and never moved. `effects.wall-clamp`: the solid's clamped rows, since
//! Kayaki's text leaves open whether its plate's clamp is made of the solid's particles or of the wall's.

use super::model::Hypoelastic;
use crate::columns::{Vectors, vectors};
use halfstep_scene::geometry::{SolidPoint, WallPoint};
use halfstep_scene::{Phase, Scene};
use halfstep_sph::extrapolation::{Extrapolation, ExtrapolationSum};
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::pair::{self, Narrow};
use halfstep_sph::with_kernel;

/// Out of every kernel's reach, m.
const FAR: f64 = 1e30;

/// Which particles are walls, and columns for the extrapolation.
pub(super) struct WallStates<const D: usize> {
    /// The clamped rows are, too.
    pub(super) clamps: bool,
    /// Positions, those of walls out of reach.
    free: Vectors<D>,
    sums: Vec<ExtrapolationSum>,
}

impl<const D: usize> WallStates<D> {
    pub(super) fn new(clamps: bool) -> Self {
        Self { clamps, free: vectors(0), sums: Vec::new() }
    }
}

/// The scene's wall particles as particles of the model.
pub(super) fn wall_particles<const D: usize>(
    walls: &[WallPoint<D>],
) -> impl Iterator<Item = SolidPoint<D>> + '_ {
    walls.iter().map(|wall| SolidPoint {
        position: wall.position,
        site: wall.position,
        velocity: [0.0; D],
        clamped: true,
        body: wall.shape,
        copy: 0,
    })
}

/// Why the scene's walls cannot hold values toward its solid of that index; `None`: they can.
pub(super) fn why_not(scene: &Scene, solid: usize) -> Option<&'static str> {
    let walls = || scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall);
    if walls().next().is_none() {
        return Some("the scene has no walls");
    }
    if walls().any(|wall| wall.motion.is_some()) {
        return Some("a wall moves");
    }
    if scene.leaves_walls_to_coupler(solid) {
        return Some("the solid says `contact`, so that the coupler holds it against walls");
    }
    (scene.solid_spacing(solid) != scene.resolution).then_some("the solid's spacing is not that of the walls")
}

impl<const D: usize> Hypoelastic<D> {
    /// The particle of a slot is a wall's, or a clamped one that acts as such.
    fn is_wall(&self, slot: usize, clamps: bool) -> bool {
        let id = self.id[slot];
        id != PADDING && (id as usize >= self.own || clamps && self.points[id as usize].clamped)
    }

    /// Gives walls the state that they hold toward the solid.
    pub(super) fn show_walls(&mut self) {
        let Some(mut states) = self.wall_states.take() else { return };
        let slots = self.id.len();
        for d in 0..D {
            states.free[d].clone_from(&self.now.position[d]);
        }
        for slot in (0..slots).filter(|&s| self.is_wall(s, states.clamps)) {
            states.free[0][slot] = FAR;
        }
        states.sums.resize(self.neighbours.fours(), ExtrapolationSum::default());
        with_kernel!(self.kernel, self.smoothing_length, D, |kernel| {
            let law = Narrow(Extrapolation {
                kernel,
                gravity: self.gravity,
                targets: &self.now.position,
                sources: &states.free,
                density: &self.now.density,
                pressure: &self.pressure,
            });
            pair::pass(self.isa, &law, &self.neighbours, &mut states.sums);
        });
        self.pair_evaluations += self.neighbours.pairs() as u64;
        let (k, rho0) = (self.material.bulk_modulus(), self.material.density);
        for slot in 0..slots {
            if !self.is_wall(slot, states.clamps) {
                continue;
            }
            let p = states.sums[slot / LANES].pressure(slot % LANES).unwrap_or(0.0);
            self.now.density[slot] = rho0 * (1.0 + p / k);
            for a in 0..D {
                for b in a..D {
                    self.now.stress[a][b][slot] = 0.0;
                }
            }
            self.show(slot, p);
        }
        self.wall_states = Some(states);
    }
}
