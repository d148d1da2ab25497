//! The phases of matter in a scene.

/// The phase that a particle belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Phase {
    /// Liquid.
    Fluid,
    /// Deformable solid.
    Solid,
    /// Rigid wall.
    Wall,
}
