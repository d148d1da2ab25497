//! Contact forces on each record of a solid, where a probe parts those on a body from the fluid's.

use crate::roles::probes_of;
use halfstep_scene::geometry::{self, SolidPoint};
use halfstep_scene::{BodyQuantity, ProbeKind, Scene};
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::state::{Fields, State, StateError};
use std::collections::HashSet;

/// A probe of a body's force: what its participant measured is the sum of all forces that it was sent.
struct OfBody {
    /// Place of its first value among the participant's.
    value: usize,
    /// What is added of the contact forces: taken out of the fluid's, or added to the model's own.
    sign: f64,
    particles: HashSet<u32>,
}

/// Contact forces on a solid's records, as evaluated last and before, N (2D: N/m).
pub(super) struct Touched {
    probes: Vec<OfBody>,
    now: Vec<[f64; 2]>,
    before: Vec<[f64; 2]>,
}

impl Touched {
    /// Of the solid of that index; `None` where no probe asks.
    pub(super) fn of<const D: usize>(scene: &Scene, solid: usize) -> Option<Self> {
        let asks = |kind: &ProbeKind| {
            matches!(kind, ProbeKind::Body { quantity, .. } if matches!(quantity, BodyQuantity::Force
                | BodyQuantity::Moment | BodyQuantity::ContactForce | BodyQuantity::ContactMoment))
        };
        let place = solid + usize::from(scene.fluid.is_some());
        if !probes_of(scene, place).any(|probe| asks(&probe.kind)) {
            return None;
        }
        let layout = geometry::solids::<D>(scene);
        let of_solid = |point: &&SolidPoint<D>| scene.shapes[point.body as usize].solid == Some(solid);
        let own: Vec<&SolidPoint<D>> = layout.solid.iter().filter(of_solid).collect();
        let (mut probes, mut value) = (Vec::new(), 0);
        for probe in probes_of(scene, place) {
            if let ProbeKind::Body { body, quantity } = &probe.kind {
                let sign = match quantity {
                    BodyQuantity::Force => Some(-1.0),
                    BodyQuantity::ContactForce => Some(1.0),
                    _ => None,
                };
                let is_of = |k: &u32| scene.shapes[own[*k as usize].body as usize].body() == body;
                let particles = || (0..own.len() as u32).filter(is_of).collect();
                probes.extend(sign.map(|sign| OfBody { value, sign, particles: particles() }));
            }
            value += probe.kind.components(scene.dimension).0.len();
        }
        Some(Self { probes, now: Vec::new(), before: Vec::new() })
    }

    /// Begins an evaluation for so many records.
    pub(super) fn begin(&mut self, records: usize) {
        std::mem::swap(&mut self.now, &mut self.before);
        self.now.clear();
        self.now.resize(records, [0.0; 2]);
    }

    pub(super) fn add(&mut self, record: usize, force: [f64; 2]) {
        (0..2).for_each(|d| self.now[record][d] += force[d]);
    }

    /// As evaluated last.
    pub(super) fn now(&self) -> &[[f64; 2]] {
        &self.now
    }

    /// Corrects what a solid measured on this state with the forces that brought it there.
    pub(super) fn correct(&self, records: &[StateRecord], values: &mut [f64]) {
        for probe in &self.probes {
            for (record, force) in records.iter().zip(&self.before) {
                if probe.particles.contains(&record.id) {
                    let sums = values[probe.value..].iter_mut().zip(force);
                    sums.for_each(|(sum, force)| *sum += probe.sign * force);
                }
            }
        }
    }
}

impl State for Touched {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let mut now = self.now.iter().map(|f| [f[0], f[1], 0.0]).collect();
        fields.points("contact_force", &mut now)?;
        self.now = now.into_iter().map(|f| [f[0], f[1]]).collect();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Two blocks of one solid and a slab of another one; the second block's first value is the third.
    #[test]
    fn a_bodys_contact_is_taken_out_of_its_force() {
        let text = "resolution = 0.1\nend_time = 1.0\ngravity = [0.0, -10.0]\n\
                    [[solid]]\nname = \"blocks\"\nmodel = \"rigid\"\ndensity = 500.0\n\
                    [[solid]]\nname = \"slab\"\nmodel = \"rigid\"\ndensity = 500.0\n\
                    [[shape]]\nname = \"a\"\nphase = \"solid\"\nsolid = \"blocks\"\n\
                    box = { min = [0.0, 0.0], max = [0.2, 0.1] }\n\
                    [[shape]]\nname = \"b\"\nphase = \"solid\"\nsolid = \"blocks\"\n\
                    box = { min = [0.5, 0.0], max = [0.6, 0.1] }\n\
                    [[shape]]\nname = \"s\"\nphase = \"solid\"\nsolid = \"slab\"\n\
                    box = { min = [0.0, -0.2], max = [1.0, -0.1] }\n\
                    [[probe]]\nname = \"a\"\nkind = \"body-contact-force\"\nbody = \"a\"\nsolid = \"blocks\"\n\
                    [[probe]]\nname = \"b\"\nkind = \"body-force\"\nbody = \"b\"\nsolid = \"blocks\"\n";
        let scene = halfstep_scene::parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        assert!(Touched::of::<2>(&scene, 1).is_none(), "nobody asks");
        let mut touched = Touched::of::<2>(&scene, 0).expect("two probes ask");
        let records: Vec<StateRecord> =
            (0..3).map(|id| StateRecord { id, ..StateRecord::default() }).collect();
        touched.begin(3);
        touched.add(0, [1.0, 2.0]);
        touched.add(1, [0.5, 0.0]);
        touched.add(2, [8.0, 4.0]);
        let mut values = [0.0, 0.0, 10.0, 10.0];
        touched.correct(&records, &mut values);
        assert_eq!(values, [0.0, 0.0, 10.0, 10.0], "before these forces nothing touched");
        touched.begin(3);
        touched.correct(&records, &mut values);
        assert_eq!(values, [1.5, 2.0, 2.0, 6.0]);
        assert_eq!(touched.now(), [[0.0; 2]; 3]);
    }
}
