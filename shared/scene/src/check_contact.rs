//! What must hold between the tables of contact.

use super::Phase;
use super::bounds::flow_speed;
use super::check::Check;
use super::contact::PairContact;

impl Check<'_> {
    /// One table speaks of a pair of solids.
    pub(super) fn contacts(&self) {
        if self.report.has_any(&["contact", "solid"]) {
            return;
        }
        let all = &self.scene.pair_contacts;
        for (k, contact) in all.iter().enumerate() {
            if all[..k].iter().any(|other| other.solids == contact.solids) {
                self.wrong(&format!("contact.{k}.solids"), "another [[contact]] is about these two solids");
            }
        }
        self.wall_contacts();
        self.contacts_of_bodies();
        let unknown = |contact: &PairContact| contact.stiffness.is_none();
        let Some(pair) = self.scene.contacts().into_iter().find(unknown) else { return };
        if flow_speed(self.scene) == 0.0 {
            let [a, b] = pair.solids.map(|solid| &self.scene.solids[solid].name);
            self.wrong(
                "solid",
                format!(
                    "`{a}` and `{b}` can touch, but nothing in the scene says how fast: give a [[contact]] with \
                     `stiffness` (Pa/m), or with `touch = false`"
                ),
            );
        }
    }

    /// What the coupler holds of one solid against each other has a speed that says how hard.
    fn contacts_of_bodies(&self) {
        if flow_speed(self.scene) > 0.0 {
            return;
        }
        let of = |solid: usize| self.scene.shapes.iter().filter(move |shape| shape.solid == Some(solid));
        for [solid, _] in self.scene.contacts_of_bodies().map(|contact| contact.solids) {
            let several = of(solid).any(|shape| of(solid).any(|other| other.body() != shape.body()));
            if several {
                let why = "how stiff contact of its bodies is follows from gravity and speeds, and nothing in the \
                           scene moves";
                self.wrong(&format!("{}.contact", self.solid_key(solid)), why);
            }
        }
    }

    /// What the coupler holds against walls has a speed that says how hard.
    fn wall_contacts(&self) {
        let of = |phase: Phase| self.scene.shapes.iter().filter(move |shape| shape.phase == phase);
        // Walls that say nothing may be touched where a body is free.
        let free = of(Phase::Solid).any(|shape| shape.clamp.is_empty());
        let walls = of(Phase::Wall).any(|shape| shape.contact || free);
        if !walls || flow_speed(self.scene) > 0.0 {
            return;
        }
        let held = |k: &usize| self.scene.leaves_walls_to_coupler(*k);
        for k in (0..self.scene.solids.len()).filter(held) {
            let why = "how stiff contact is follows from gravity and speeds, and nothing in the scene moves";
            self.wrong(&format!("{}.contact", self.solid_key(k)), format!("says nothing of walls: {why}"));
        }
    }
}
