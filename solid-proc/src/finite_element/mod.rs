//! Finite elements: squares with one point of integration on the particles' cells, large rotation, explicit
//! or implicit in time.

mod account;
mod decide;
mod element;
mod equations;
mod implicit;
mod mesh;
mod model;
mod state;
mod stress;
#[cfg(test)]
mod tests;

pub(crate) use decide::EFFECTS;
pub use model::FiniteElement;
