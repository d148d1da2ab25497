//! Contacts of the solids with each other and with walls: their forces, their time step, and what they did.

use super::Solids;
use halfstep_interface::contact::{Booked, Contact, PairLaw, WallContact};
use halfstep_link::StateMessage;
use halfstep_output::run_json::ForceKind;
use halfstep_role::timeline;
use halfstep_wire::half_step::Stage;
use halfstep_wire::wide;

/// What contact did to a pair of solids, or to a solid and the walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactSummary {
    /// Indices of the two in the scene; `None`: the walls.
    pub solids: [Option<usize>; 2],
    /// Pressure over penetration, Pa/m.
    pub stiffness: f64,
    /// Energies and largest values.
    pub booked: Booked,
}

impl<const D: usize> Solids<D> {
    /// Largest time step that contacts are stable with, s; `None` where nothing can touch.
    pub(crate) fn contact_limit(&self) -> Option<f64> {
        let walls = self.solids.iter().filter_map(|side| side.walls.as_ref()).map(WallContact::limit);
        let least = self.contact.iter().map(Contact::limit).chain(walls).fold(f64::INFINITY, f64::min);
        least.is_finite().then_some(least)
    }

    /// What contacts did to each pair of solids and to the bodies of one, and walls to each solid that the coupler
    /// holds against them.
    pub(crate) fn contacts(&self) -> Vec<ContactSummary> {
        let of = |(solids, law, booked): ([usize; 2], &PairLaw, Booked)| ContactSummary {
            solids: solids.map(Some),
            stiffness: law.stiffness,
            booked,
        };
        let walls = self.solids.iter().enumerate().filter_map(|(solid, side)| {
            let walls = side.walls.as_ref()?;
            let (stiffness, booked) = (walls.law().stiffness, walls.booked());
            Some(ContactSummary { solids: [Some(solid), None], stiffness, booked })
        });
        self.contact.iter().flat_map(Contact::booked).map(of).chain(walls).collect()
    }

    /// Adds the forces of contacts at the states' instant, s, in a time step `dt`, s, to those of the fluid.
    pub(super) fn touch(&mut self, states: &[impl StateMessage], [time, dt]: [f64; 2]) {
        let _phase = timeline::phase("contact");
        let whole = states[self.first].header().stage == Stage::First.number();
        for (side, state) in self.solids.iter_mut().zip(&states[self.first..]) {
            let Some(walls) = &mut side.walls else { continue };
            walls.evaluate(state.records(), [time, dt], whole);
            for (record, force) in side.forces.iter_mut().enumerate() {
                let on = walls.on(record);
                (0..2).for_each(|d| force.stress_force[d] += on[d]);
                side.by_kind.add(ForceKind::Walls, wide(on));
                side.touched.iter_mut().for_each(|touched| touched.add(record, on));
            }
        }
        let Some(contact) = &mut self.contact else { return };
        contact.evaluate(|solid| states[solid + self.first].records(), whole, dt);
        contact.forces(|solid, record, force| {
            let side = &mut self.solids[solid];
            let sum = &mut side.forces[record].stress_force;
            (0..2).for_each(|d| sum[d] += force[d]);
            side.by_kind.add(ForceKind::Contact, wide(force));
            side.touched.iter_mut().for_each(|touched| touched.add(record, force));
        });
    }
}
