//! Tractions and cracks that a scene prescribes.

use crate::columns::Vectors;
use halfstep_scene::geometry::{Cracks, SolidPoint, crosses};
use halfstep_scene::{Scene, Traction};
use halfstep_sph::pair::FixedPairs;

/// Particles that a scene loads.
pub(super) struct Loads<const D: usize> {
    /// Slot, acceleration by the whole traction, m/s², and which of the tractions.
    loaded: Vec<(usize, [f64; D], usize)>,
    tractions: Vec<Traction>,
}

impl<const D: usize> Loads<D> {
    /// On the free particles of a solid of this spacing, m, and mass of a particle, kg (2D: kg/m).
    pub(super) fn new(scene: &Scene, points: &[SolidPoint<D>], slot_of: &[u32], dx: f64, mass: f64) -> Self {
        let (mut loaded, mut tractions) = (Vec::new(), Vec::new());
        for (index, shape) in scene.shapes.iter().enumerate() {
            let Some(load) = &shape.load else { continue };
            let taken = |p: &SolidPoint<D>| p.body as usize == index && !p.clamped && p.is_in_load(scene);
            let area = dx.powi(D as i32 - 1);
            let acceleration = std::array::from_fn(|d| load.traction[d] * area / mass);
            let slots = points.iter().zip(slot_of).filter(|(p, _)| taken(p));
            loaded.extend(slots.map(|(_, &slot)| (slot as usize, acceleration, tractions.len())));
            tractions.push(*load);
        }
        Self { loaded, tractions }
    }

    /// Acceleration of each loaded slot at a time, s.
    fn at(&self, time: f64) -> impl Iterator<Item = (usize, [f64; D])> + '_ {
        let of = move |(slot, whole, traction): &(usize, [f64; D], usize)| {
            let share = self.tractions[*traction].share(time);
            (*slot, whole.map(|a| a * share))
        };
        self.loaded.iter().map(of)
    }

    /// Adds them at a time, s.
    pub(super) fn add(&self, time: f64, load: &mut Vectors<D>) {
        for (slot, a) in self.at(time) {
            for d in 0..D {
                load[d][slot] += a[d];
            }
        }
    }

    /// Work over a particle's mass from one state to another, J/kg.
    pub(super) fn work(&self, time: f64, from: &Vectors<D>, to: &Vectors<D>) -> f64 {
        self.at(time).map(|(slot, a)| (0..D).map(|d| a[d] * (to[d][slot] - from[d][slot])).sum::<f64>()).sum()
    }
}

/// Takes pairs apart whose line crosses a crack of the scene's solid of that index.
pub(super) fn crack<const D: usize>(scene: &Scene, solid: usize, pairs: &mut FixedPairs<D>) {
    for crack in Cracks::of(scene).of_solid(Some(solid)) {
        let x = pairs.position().clone();
        let place = |slot: usize| [x[0][slot], x[1][slot]];
        pairs.part(|i, j| crosses([place(i), place(j)], crack));
    }
}
