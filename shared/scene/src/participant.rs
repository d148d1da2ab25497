//! Who takes part in a run: the fluid and each solid.

use super::{Phase, Scene};

/// The fluid or one solid of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Participant {
    /// Index of the solid in [`Scene::participants`].
    pub id: usize,
    /// Fluid or solid.
    pub phase: Phase,
    /// `fluid`, or the solid's name.
    pub name: String,
    /// Name of the process that serves it.
    pub process: String,
}

impl Scene {
    /// The fluid, where there is one, then the solids in the scene's order.
    pub fn participants(&self) -> Vec<Participant> {
        let fluid = self.fluid.as_ref().map(|_| (Phase::Fluid, "fluid", "fluid"));
        let solids = self.solids.iter().map(|s| (Phase::Solid, s.name.as_str(), s.process.as_str()));
        let number = |(id, (phase, name, process)): (usize, (Phase, &str, &str))| Participant {
            id,
            phase,
            name: name.to_owned(),
            process: process.to_owned(),
        };
        fluid.into_iter().chain(solids).enumerate().map(number).collect()
    }
}
