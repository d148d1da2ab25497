//! The energy ledger of a participant: what it holds at n, what it was given since the start and by whom, and the rest.
//!
//! ```text
//! held(n) - held(0) = sum of all that was given + integration
//! ```
//!
//! What is given over a step is its power at n + 1/2, with the rates that the step took, times dt. So the rest is the
//! error of time integration and nothing else.

use halfstep_scene::{EnergyEntry, EnergyPart, Phase};
use halfstep_wire::state::{Fields, State, StateError};

/// The ledger.
#[derive(Clone, Debug)]
pub struct Ledger {
    phase: Phase,
    /// By [`EnergyPart`], J (2D: J/m).
    values: Vec<f64>,
    /// Largest change of each, J (2D: J/m).
    largest: Vec<f64>,
    /// What is held at the start; potential energy counts from there. Empty before the first state.
    start: Vec<f64>,
}

impl Ledger {
    /// Of a participant of a phase.
    pub fn new(phase: Phase) -> Self {
        let none = vec![0.0; EnergyPart::ALL.len()];
        Self { phase, largest: none.clone(), values: none, start: Vec::new() }
    }

    /// Notes energy that was given, J (2D: J/m).
    pub fn give(&mut self, part: EnergyPart, joules: f64) {
        self.values[part as usize] += joules;
    }

    /// Notes what is held at n, in the order of [`EnergyPart::of`]: kinetic, stored and potential energy, J (2D: J/m).
    pub fn hold(&mut self, held: [f64; 3]) {
        let first = self.start.is_empty();
        if first {
            self.start = held.to_vec();
        }
        let (mut change, parts) = (0.0, EnergyPart::of(self.phase));
        for ((&part, &now), &start) in parts.iter().zip(&held).zip(&self.start) {
            change += now - start;
            self.values[part as usize] = if part == EnergyPart::Potential { now - start } else { now };
            let largest = &mut self.largest[part as usize];
            *largest = largest.max((now - start).abs());
        }
        let given = parts.iter().filter(|part| !part.is_held() && **part != EnergyPart::Integration);
        let sum: f64 = given.clone().map(|&part| self.values[part as usize]).sum();
        self.values[EnergyPart::Integration as usize] = change - sum;
        for &part in given.chain([&EnergyPart::Integration]) {
            let largest = &mut self.largest[part as usize];
            *largest = largest.max(self.values[part as usize].abs());
        }
    }

    /// A part at the last state, J (2D: J/m).
    pub fn value(&self, part: EnergyPart) -> f64 {
        self.values[part as usize]
    }

    /// All parts of the participant's phase.
    pub fn entries(&self) -> Vec<EnergyEntry> {
        let entry = |&part: &EnergyPart| EnergyEntry {
            part,
            joules: self.values[part as usize],
            largest: self.largest[part as usize],
        };
        EnergyPart::of(self.phase).iter().map(entry).collect()
    }

    /// Appends what a probe asks for: all parts or one of them.
    pub fn measure(&self, part: Option<EnergyPart>, out: &mut Vec<f64>) {
        let all = EnergyPart::of(self.phase).iter().copied();
        out.extend(all.filter(|&own| part.is_none_or(|part| part == own)).map(|part| self.value(part)));
    }
}

impl State for Ledger {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let parts = EnergyPart::ALL.len();
        fields.reals("values", &mut self.values)?;
        fields.reals("largest", &mut self.largest)?;
        fields.reals("start", &mut self.start)?;
        fields.length("values", parts, self.values.len())?;
        fields.length("largest", parts, self.largest.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nobody_gave_is_the_error_of_integration() {
        let mut ledger = Ledger::new(Phase::Solid);
        ledger.hold([3.0, 1.0, 100.0]);
        ledger.give(EnergyPart::SideFriction, -0.5);
        ledger.give(EnergyPart::InterfacePressure, 2.0);
        ledger.hold([4.0, 1.25, 100.5]);
        // 1 + 0.25 + 0.5 held more, 1.5 given.
        let value = |part| ledger.value(part);
        assert_eq!(value(EnergyPart::Integration), 0.25);
        assert_eq!([value(EnergyPart::Kinetic), value(EnergyPart::Potential)], [4.0, 0.5]);
        ledger.hold([3.0, 1.0, 100.0]);
        let entries = ledger.entries();
        assert_eq!(entries.len(), EnergyPart::of(Phase::Solid).len());
        assert_eq!((entries[0].joules, entries[0].largest), (3.0, 1.0));
        let mut one = Vec::new();
        ledger.measure(Some(EnergyPart::SideFriction), &mut one);
        assert_eq!(one, [-0.5]);
    }
}
