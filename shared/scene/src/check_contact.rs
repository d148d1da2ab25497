//! What must hold between the tables of contact.

use super::check::Check;

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
    }
}
