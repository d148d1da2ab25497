//! Kayaki's solid: Hooke's law in rate form with the Jaumann rate (Gray, Monaghan and Swift 2001), density by
//! continuity, artificial viscosity and artificial stress.

mod account;
mod artificial_stress;
mod bounds;
mod columns;
mod decide;
mod evaluate;
mod gradient;
mod model;
mod rates;
mod state;
mod stress_rate;
#[cfg(test)]
mod tests;
mod wall_states;

pub(crate) use decide::EFFECTS;
pub use model::Hypoelastic;
