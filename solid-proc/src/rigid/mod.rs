//! Rigid bodies: they do not strain. Joints and prescribed motion hold them, springs push them, walls and other bodies
//! stop them.
//!
//! A body goes by velocity Verlet; between the kicks it turns by a splitting into turns about its principal axes, which
//! keeps the angular momentum (Dullweber, Leimkuhler and McLachlan 1997). Joints are constraints on places and
//! velocities (RATTLE: Andersen 1983); contacts are impulses (Moreau 1988, Jean 1999). Vectors have three components
//! here; in two dimensions the third stays zero and bodies turn about z alone.

mod account;
mod body;
mod build;
mod contact;
mod decide;
mod impact;
mod joint;
mod limit;
mod model;
mod row;
mod solve;
mod start;
mod state;
mod step;
#[cfg(test)]
mod tests;

pub(crate) use decide::EFFECTS;
pub use model::Rigid;

/// A vector in space.
type Vec3 = nalgebra::Vector3<f64>;

/// A point or vector of the scene.
fn wide<const D: usize>(x: &[f64; D]) -> Vec3 {
    Vec3::from_fn(|d, _| if d < D { x[d] } else { 0.0 })
}
