//! What must hold between solids and the rest of the scene.

use super::check::{Check, PHASE_BLIND_BY};
use super::document::Value;
use super::*;

impl Check<'_> {
    pub(super) fn solids(&self) {
        let names: Vec<&str> = self.scene.solids.iter().map(|s| s.name.as_str()).collect();
        self.unique("solid", &names);
        if names.len() > 1 && !self.report.has_any(&["shape", "solid"]) {
            for (k, name) in names.iter().enumerate() {
                if self.scene.shapes.iter().all(|s| s.solid != Some(k)) {
                    self.place(&self.solid_key(k), format!("no solid shape says `solid = \"{name}\"`"));
                }
            }
        }
        self.solid_time_step();
    }

    /// The key of the solid of that index: by index where its name is taken twice.
    pub(super) fn solid_key(&self, index: usize) -> String {
        let listed = self.root.child("solid").is_some_and(|node| matches!(node.value, Value::Array(_)));
        let name = self.scene.solids.get(index).map_or("", |s| s.name.as_str());
        let first = self.scene.solids.iter().position(|s| s.name == name);
        match (listed, first == Some(index) && !name.is_empty()) {
            (false, _) => "solid".to_owned(),
            (true, true) => format!("solid.{name}"),
            (true, false) => format!("solid.{index}"),
        }
    }

    pub(super) fn model(&self, solid: usize) -> Option<SolidModelName> {
        self.scene.solids.get(solid).map(|s| s.model.name())
    }

    /// A model may be stable to less than `numerics.solid_cfl` allows in general.
    fn solid_time_step(&self) {
        let key = "numerics.solid_cfl";
        for (k, solid) in self.scene.solids.iter().enumerate() {
            let name = solid.model.name();
            if let Some((most, why)) = name.rules().largest_cfl
                && self.scene.numerics.solid_cfl > most
                && !self.report.has(key)
            {
                let model = format!("{}.model", self.solid_key(k));
                let reason = format!("must be at most {most} with {model} = \"{}\": {why}", name.name());
                self.report.among(self.root, key, &[&model], reason);
            }
        }
    }

    /// What the phase-blind treatment asks of solids.
    pub(super) fn phase_blind_solids(&self) {
        let key = "interface.treatment";
        if self.scene.solids.len() > 1 {
            let why =
                "its sums do not ask what a neighbour is, so each would need the particles of the others";
            let reason = format!("cannot be phase-blind with several solids: {why}");
            self.report.among(self.root, key, &["preset"], reason);
            return;
        }
        let Some(solid) = self.scene.solids.first() else { return };
        let of_solid = self.solid_key(0);
        let name = solid.model.name();
        if let Some(why) = name.rules().not_phase_blind {
            let model = format!("{of_solid}.model");
            let reason = format!("cannot be phase-blind with {model} = \"{}\": {why}", name.name());
            self.report.among(self.root, key, &[&model, "preset"], reason);
        }
        if matches!(solid.sub_steps, SubSteps::Fixed(n) if n != 1) {
            let why = "a particle close to the interface hangs on a spring as stiff as the solid";
            let reason = format!("must be \"auto\" or 1 with phase-blind: {why}");
            self.report.among(self.root, &format!("{of_solid}.sub_steps"), &PHASE_BLIND_BY, reason);
        }
    }
}
