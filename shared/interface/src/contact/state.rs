//! What contacts keep over an interruption.

use super::corners::Corners;
use super::law::Touch;
use super::{Booked, Contact, Pair};
use halfstep_wire::state::{Fields, State, StateError};

impl State for Booked {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.real("normal", &mut self.normal)?;
        fields.real("friction", &mut self.friction)?;
        fields.real("largest_force", &mut self.largest_force)?;
        fields.real("largest_penetration", &mut self.largest_penetration)
    }
}

/// Contacts as they go on.
fn touch_fields(fields: &mut Fields<'_>, touches: &mut Vec<Touch>) -> Result<(), StateError> {
    let numbers_of = |t: &Touch| [t.key[0], t.key[1], t.key[2], t.part];
    let mut numbers: Vec<u32> = touches.iter().flat_map(numbers_of).collect();
    let mut reals: Vec<f64> =
        touches.iter().flat_map(|t| [t.share, t.approach, t.share_of_push, t.rest]).collect();
    fields.numbers("touches", &mut numbers)?;
    fields.reals("sticking", &mut reals)?;
    fields.length("sticking", numbers.len(), reals.len())?;
    if fields.loading() {
        let of = |(n, r): (&[u32], &[f64])| Touch {
            key: [n[0], n[1], n[2]],
            part: n[3],
            share: r[0],
            approach: r[1],
            share_of_push: r[2],
            rest: r[3],
        };
        *touches = numbers.chunks_exact(4).zip(reals.chunks_exact(4)).map(of).collect();
    }
    Ok(())
}

impl State for Corners {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        touch_fields(fields, &mut self.touches)
    }
}

impl State for Pair {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        self.booked.fields(fields)?;
        for (side, name) in self.sides.iter_mut().zip(["first", "second"]) {
            let [normal, along] = &mut side.forces;
            fields.points(&format!("{name}_normal"), normal)?;
            fields.points(&format!("{name}_along"), along)?;
            fields.length("along", normal.len(), along.len())?;
        }
        touch_fields(fields, &mut self.touches)?;
        Ok(())
    }
}

impl State for Contact {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        if fields.loading() {
            self.first = vec![(Vec::new(), Vec::new()); self.placed.len()];
        }
        for (k, (at, mass)) in self.first.iter_mut().enumerate() {
            fields.points(&format!("first_{k}"), at)?;
            fields.reals(&format!("mass_{k}"), mass)?;
            fields.length("mass", at.len(), mass.len())?;
        }
        self.pairs.iter_mut().enumerate().try_for_each(|(k, pair)| fields.part(&format!("pair_{k}"), pair))
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.build();
        for pair in &self.pairs {
            let sizes =
                pair.sides.each_ref().map(|side| (side.forces[0].len(), self.first[side.solid].0.len()));
            if sizes.iter().any(|(forces, records)| *forces != 0 && forces != records) {
                return Err(StateError::contradiction("contact forces on other records than the first ones"));
            }
            let [a, b] = pair.sides.each_ref().map(|side| &self.outlines[side.solid]);
            let known = |touch: &Touch| {
                let (own, other) = if touch.key[0] == 0 { (a, b) } else { (b, a) };
                (touch.key[1] as usize) < own.points.len() && (touch.part as usize) < other.parts.len()
            };
            if !pair.touches.iter().all(known) {
                return Err(StateError::contradiction("a contact of a point that the scene does not have"));
            }
        }
        Ok(())
    }
}
