//! Contact between two solids: what `[[contact]]` says of a pair, and what holds where it says nothing; and between the
//! bodies of one solid that strains, as its `contact` says.

use crate::bounds::flow_speed;
use crate::{EffectName, ModelKeys, Phase, Scene, Shape, Switch, geometry};
use serde::{Deserialize, Serialize};

/// Contact of two solids, as a scene says it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairContact {
    /// Indices of the two in [`Scene::solids`], ascending; of bodies of one solid twice its index.
    pub solids: [usize; 2],
    /// The two feel each other.
    pub touch: bool,
    /// Coulomb's coefficient of friction, sticking and sliding.
    pub friction: f64,
    /// Normal speed after an impact over that before it.
    pub restitution: f64,
    /// Pressure over penetration, Pa/m; `None`: from the scene.
    pub stiffness: Option<f64>,
}

impl PairContact {
    /// What holds for two solids of which the scene says nothing: they touch without friction and do not bounce.
    pub fn unsaid(solids: [usize; 2]) -> Self {
        Self { solids, touch: true, friction: 0.0, restitution: 0.0, stiffness: None }
    }
}

/// Speed of the stiffness from the scene over the flow's, U ([`flow_speed`]): a body as deep as the smallest side that
/// meets another, which stays, with U goes a twentieth of that side into it; a heavier one deeper, by the root of its
/// mass behind an area.
const STIFFNESS_SPEED: f64 = 20.0;

impl Scene {
    /// Walls that solids may touch, with their index in [`Scene::shapes`]; none where `wall-contact` is off.
    pub fn walls_to_touch(&self) -> impl Iterator<Item = (usize, &Shape)> {
        let on = self.switch(EffectName::WallContact) != Switch::Off;
        let all = self.shapes.iter().enumerate();
        all.filter(move |(_, shape)| on && shape.phase == Phase::Wall && shape.contact)
    }

    /// The solid of that index strains and says `contact`, so the coupler holds it against walls: its model knows no
    /// friction. In space the model pushes it.
    pub fn leaves_walls_to_coupler(&self, solid: usize) -> bool {
        let solid = &self.solids[solid];
        self.dimension == 2 && solid.rigid().is_none() && solid.contact().is_some()
    }

    /// The solid of that index has bodies that strain and says `contact`, so the coupler holds these against each
    /// other, too: its model knows no friction. The hypoelastic solid is one continuum.
    pub fn leaves_bodies_to_coupler(&self, solid: usize) -> bool {
        let continuum = matches!(self.solids[solid].model, ModelKeys::Hypoelastic(_));
        self.leaves_walls_to_coupler(solid) && !continuum
    }

    /// Contact between the bodies of each solid that leaves it to the coupler.
    pub fn contacts_of_bodies(&self) -> impl Iterator<Item = PairContact> {
        let left = (0..self.solids.len()).filter(|&solid| self.leaves_bodies_to_coupler(solid));
        left.map(|solid| self.own_contact(solid))
    }

    /// What the `contact` of the solid of that index says of what the coupler holds: walls and its own bodies.
    pub fn own_contact(&self, solid: usize) -> PairContact {
        let own = self.solids[solid].contact().unwrap_or_default();
        PairContact {
            friction: own.friction,
            restitution: own.restitution,
            ..PairContact::unsaid([solid; 2])
        }
    }

    /// Contact of each pair of solids that feel each other, in ascending order; in space there is none.
    pub fn contacts(&self) -> Vec<PairContact> {
        let count = if self.dimension == 2 { self.solids.len() } else { 0 };
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
        let of = |pair: [usize; 2]| {
            let said = self.pair_contacts.iter().find(|contact| contact.solids == pair);
            said.cloned().unwrap_or_else(|| PairContact::unsaid(pair))
        };
        pairs.map(of).filter(|contact| contact.touch).collect()
    }

    /// Stiffness of contact that follows from the scene, Pa/m: rho (20 U)² / l with the lower density of the two, the
    /// speed U that the flow is expected to reach, and the smallest side l of a box around a shape of the two. It does
    /// not know the spacing.
    pub fn contact_stiffness(&self, solids: [usize; 2]) -> f64 {
        let density = solids.iter().map(|&k| self.lightest_density(k)).fold(f64::INFINITY, f64::min);
        density * (STIFFNESS_SPEED * flow_speed(self)).powi(2) / self.smallest_side(solids)
    }

    /// Shapes of two solids, each with the smallest side of the box around it, m.
    pub fn shorter_sides(&self, solids: [usize; 2]) -> impl Iterator<Item = (&Shape, f64)> {
        let own = move |shape: &&Shape| {
            shape.phase == Phase::Solid && shape.solid.is_some_and(|solid| solids.contains(&solid))
        };
        self.shapes.iter().filter(own).map(|shape| {
            let around = geometry::bounding_box(shape, self);
            let sides = (0..self.dimension).map(|d| around.max[d] - around.min[d]);
            (shape, sides.fold(f64::INFINITY, f64::min))
        })
    }

    /// The smallest of them, m.
    pub fn smallest_side(&self, solids: [usize; 2]) -> f64 {
        self.shorter_sides(solids).map(|(_, side)| side).fold(f64::INFINITY, f64::min)
    }
}
