//! Bodies: connected pieces of solid.

use crate::geometry::{self, Layout};
use crate::{Phase, RigidBody, Scene, Shape, Solid, dispatch};

/// A connected piece of a solid.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Body {
    /// The shapes that it has particles of: indices in [`Scene::shapes`], ascending.
    pub shapes: Vec<usize>,
    /// Number of its particles.
    pub particles: usize,
    /// Number of those that a clamp holds.
    pub clamped: usize,
    /// A clamp, a joint or a prescribed motion holds it.
    pub held: bool,
}

impl Scene {
    /// Whether a shape is one of a rigid solid.
    pub fn is_rigid(&self, shape: &Shape) -> bool {
        shape.solid.is_some_and(|solid| self.solids[solid].rigid().is_some())
    }

    /// The bodies, in the order of their first particles.
    pub fn bodies(&self) -> Vec<Body> {
        let all = dispatch!(self.dimension, D => self.bodies_of::<D>(&geometry::solids(self)));
        all.unwrap_or_default()
    }

    /// The bodies of particles that are placed, in the order of their first particles.
    pub fn bodies_of<const D: usize>(&self, layout: &Layout<D>) -> Vec<Body> {
        let mut bodies: Vec<Body> = Vec::new();
        for (point, piece) in layout.solid.iter().zip(geometry::pieces(self, layout)) {
            if bodies.len() <= piece as usize {
                bodies.push(Body::default());
            }
            let body = &mut bodies[piece as usize];
            body.particles += 1;
            body.clamped += usize::from(point.clamped);
            body.held |= point.clamped;
            let shape = point.body as usize;
            if let Err(place) = body.shapes.binary_search(&shape) {
                body.shapes.insert(place, shape);
                body.held |= is_held(&self.solids, &self.shapes, &self.shapes[shape]);
            }
        }
        bodies
    }

    /// The lowest mean density of a body of the solid of that index, and of all that it is made of, kg/m³: a rigid body
    /// may have been given a mass of its own.
    pub fn lightest_density(&self, solid: usize) -> f64 {
        let Some(material) = self.solids.get(solid) else { return f64::INFINITY };
        let own = || self.shapes.iter().filter(|shape| shape.solid == Some(solid));
        let lightest = own().filter_map(|shape| shape.density).fold(material.density, f64::min);
        let given = material.rigid().map_or(&[][..], |keys| &keys.bodies);
        if given.iter().all(|body| body.mass.is_none()) {
            return lightest;
        }
        let bodies = self.bodies();
        let cell = self.solid_spacing(solid).powi(self.dimension as i32);
        let of = |said: &RigidBody| {
            let named = |body: &&Body| {
                body.shapes
                    .iter()
                    .any(|&k| self.shapes[k].solid == Some(solid) && self.shapes[k].body() == said.name)
            };
            let particles: usize = bodies.iter().filter(named).map(|body| body.particles).sum();
            said.mass.map(|mass| mass / (particles.max(1) as f64 * cell))
        };
        given.iter().filter_map(of).fold(lightest, f64::min)
    }

    /// A shape without `body` whose name another one of its solid gives as its `body` is of that body, too.
    pub(crate) fn name_joined_bodies(&mut self) {
        let joined: Vec<usize> = (0..self.shapes.len())
            .filter(|&k| {
                let own = &self.shapes[k];
                let names = |other: &Shape| other.solid == own.solid && other.body == own.name;
                own.solid.is_some() && own.body.is_empty() && self.shapes.iter().any(names)
            })
            .collect();
        for k in joined {
            self.shapes[k].body = self.shapes[k].name.clone();
        }
    }

    /// What nothing holds would fall through walls: those that say nothing of `contact` can be touched where a body is
    /// not held.
    pub(crate) fn touch_free_bodies(&mut self, said: &[bool]) {
        let unsaid = |(shape, said): (&Shape, &bool)| shape.phase == Phase::Wall && !said;
        if self.solids.is_empty() || !self.shapes.iter().zip(said).any(unsaid) {
            return;
        }
        if self.bodies().iter().all(|body| body.held) {
            return;
        }
        for (shape, _) in self.shapes.iter_mut().zip(said).filter(|(_, said)| !**said) {
            shape.contact = shape.phase == Phase::Wall;
        }
    }
}

/// A motion of its own holds a shape's rigid body, or a joint to space, to a wall or to another body that is held.
pub(super) fn is_held(solids: &[Solid], shapes: &[Shape], shape: &Shape) -> bool {
    let Some(keys) = shape.solid.and_then(|k| solids.get(k)).and_then(Solid::rigid) else { return false };
    let any_of = |name: &str, fits: fn(&Shape) -> bool| {
        shapes.iter().any(|s| s.solid == shape.solid && s.body() == name && fits(s))
    };
    let mut reached = vec![shape.body()];
    let mut next = 0;
    while let Some(&body) = reached.get(next) {
        next += 1;
        if any_of(body, |shape| shape.motion.is_some()) {
            return true;
        }
        for joint in keys.joints.iter().filter(|joint| joint.holds()) {
            let other = match (joint.body == body, joint.with == body) {
                (true, _) => joint.with.as_str(),
                (_, true) => joint.body.as_str(),
                _ => continue,
            };
            if !any_of(other, |_| true) {
                return true;
            }
            if !reached.contains(&other) {
                reached.push(other);
            }
        }
    }
    false
}

#[cfg(test)]
mod tests;
