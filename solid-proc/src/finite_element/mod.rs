//! Finite elements: squares with one point of integration on the particles' cells, large rotation, explicit in time.

mod account;
mod decide;
mod element;
mod mesh;
mod model;
mod state;
#[cfg(test)]
mod tests;

pub(crate) use decide::EFFECTS;
pub use model::FiniteElement;
