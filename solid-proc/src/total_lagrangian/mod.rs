//! Total-Lagrangian solid: neighbours, kernels and their correction belong to the reference configuration and are made
//! once. A hyperelastic law turns the deformation gradient into stress (Bonet and Lok 1999; Vignjevic, Reveles and
//! Campbell 2006).

mod account;
pub(crate) mod bounds;
mod clamp;
pub(crate) mod contact;
mod decide;
mod evaluate;
mod fracture;
mod hourglass;
mod loads;
pub(crate) mod material;
mod model;
mod pass;
mod relaxation;
mod state;
pub(crate) mod step_limit;
mod stress;
#[cfg(test)]
mod tests;

pub(crate) use decide::EFFECTS;
pub use model::TotalLagrangian;
