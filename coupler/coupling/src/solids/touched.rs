//! Contact forces on each record of a solid, where a probe parts them from the fluid's.

use crate::roles::probes_of;
use halfstep_scene::geometry::{self, SolidPoint, holds};
use halfstep_scene::{BodyQuantity, ProbeKind, Scene};
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::state::{Fields, State, StateError};
use std::collections::HashSet;

/// What a probe measures of the forces on its particles.
enum Part {
    Force,
    /// Moment about a point, m.
    Moment([f64; 2]),
    /// Moment about the centre of mass, which has this place among the participant's values.
    AboutCentre(usize),
}

/// A probe of forces: what its participant measured is the sum of all forces that it was sent.
struct OfForces {
    /// Place of its first value among the participant's.
    value: usize,
    part: Part,
    /// What is added of the contact forces: taken out of the fluid's, or added to the model's own.
    sign: f64,
    particles: HashSet<u32>,
}

/// Contact forces on a solid's records, as evaluated last and before, N (2D: N/m).
pub(super) struct Touched {
    probes: Vec<OfForces>,
    now: Vec<[f64; 2]>,
    before: Vec<[f64; 2]>,
}

impl Touched {
    /// Of the solid of that index; `None` where no probe asks.
    pub(super) fn of<const D: usize>(scene: &Scene, solid: usize) -> Option<Self> {
        let place = solid + usize::from(scene.fluid.is_some());
        if !probes_of(scene, place).any(|probe| part_of(&probe.kind, 0).is_some()) {
            return None;
        }
        let layout = geometry::solids::<D>(scene);
        let of_solid = |point: &&SolidPoint<D>| scene.shapes[point.body as usize].solid == Some(solid);
        let own: Vec<&SolidPoint<D>> = layout.solid.iter().filter(of_solid).collect();
        let takes = |kind: &ProbeKind, point: &SolidPoint<D>| match kind {
            ProbeKind::Force { within, shape } | ProbeKind::Moment { within, shape, .. } => {
                within.is_none_or(|block| holds(&block, &point.position, 0.0))
                    && shape.is_none_or(|shape| shape == point.body as usize)
            }
            ProbeKind::Body { body, .. } => scene.shapes[point.body as usize].body() == body,
            _ => false,
        };
        let count = |kind: &ProbeKind| kind.count(scene.dimension);
        let mut centre = probes_of(scene, place).map(|probe| count(&probe.kind)).sum();
        let (mut probes, mut value) = (Vec::new(), 0);
        for kind in probes_of(scene, place).map(|probe| &probe.kind) {
            if let Some((part, sign)) = part_of(kind, centre) {
                let particles = (0..own.len() as u32).filter(|&k| takes(kind, own[k as usize])).collect();
                probes.push(OfForces { value, part, sign, particles });
            }
            value += count(kind);
            centre += kind.companions(scene.dimension);
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
            let of =
                records.iter().zip(&self.before).filter(|(record, _)| probe.particles.contains(&record.id));
            let about = match probe.part {
                Part::Force => {
                    for (_, force) in of {
                        let sums = values[probe.value..].iter_mut().zip(force);
                        sums.for_each(|(sum, force)| *sum += probe.sign * force);
                    }
                    continue;
                }
                Part::Moment(about) => about,
                Part::AboutCentre(place) => [values[place], values[place + 1]],
            };
            let moment = |(record, force): (&StateRecord, &[f64; 2])| {
                let x = record.position;
                (x[0] - about[0]) * force[1] - (x[1] - about[1]) * force[0]
            };
            values[probe.value] += probe.sign * of.map(moment).sum::<f64>();
        }
    }
}

/// What a probe measures of forces, with the place of the centre of mass if it is about that, and what is added of the
/// contact forces; `None`: it holds none of them.
fn part_of(kind: &ProbeKind, centre: usize) -> Option<(Part, f64)> {
    let quantity = match kind {
        ProbeKind::Force { .. } => return Some((Part::Force, -1.0)),
        ProbeKind::Moment { about, .. } => return Some((Part::Moment([about[0], about[1]]), -1.0)),
        ProbeKind::Body { quantity, .. } => quantity,
        _ => return None,
    };
    match quantity {
        BodyQuantity::Force => Some((Part::Force, -1.0)),
        BodyQuantity::Moment => Some((Part::AboutCentre(centre), -1.0)),
        BodyQuantity::ContactForce => Some((Part::Force, 1.0)),
        BodyQuantity::ContactMoment => Some((Part::AboutCentre(centre), 1.0)),
        _ => None,
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

    /// Two blocks of one solid, of three particles, and a slab of another one.
    #[test]
    fn contact_is_taken_out_of_the_fluids_forces() {
        let body = |name: &str, kind: &str, body: &str| {
            format!(
                "[[probe]]\nname = \"{name}\"\nkind = \"{kind}\"\nbody = \"{body}\"\nsolid = \"blocks\"\n"
            )
        };
        let all = |name: &str, kind: &str, more: &str| {
            format!("[[probe]]\nname = \"{name}\"\nkind = \"{kind}\"\nsolid = \"blocks\"\n{more}\n")
        };
        let text = "resolution = 0.1\nend_time = 1.0\ngravity = [0.0, -10.0]\n\
                    effects.thin-plate-screen = \"off\"\n[fluid]\ndensity = 1000.0\n\
                    [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [2.0, 0.0], max = [3.0, 1.0] }\n\
                    [[solid]]\nname = \"blocks\"\nmodel = \"rigid\"\ndensity = 500.0\n\
                    [[solid]]\nname = \"slab\"\nmodel = \"rigid\"\ndensity = 500.0\n\
                    [[shape]]\nname = \"a\"\nphase = \"solid\"\nsolid = \"blocks\"\n\
                    box = { min = [0.0, 0.0], max = [0.2, 0.1] }\n\
                    [[shape]]\nname = \"b\"\nphase = \"solid\"\nsolid = \"blocks\"\n\
                    box = { min = [0.5, 0.0], max = [0.6, 0.1] }\n\
                    [[shape]]\nname = \"s\"\nphase = \"solid\"\nsolid = \"slab\"\n\
                    box = { min = [0.0, -0.2], max = [1.0, -0.1] }\n"
            .to_owned()
            + &body("by-others", "body-contact-force", "a")
            + &body("by-water", "body-force", "b")
            + &body("turned-by-water", "body-moment", "a")
            + &body("turned-by-others", "body-contact-moment", "b")
            + &all("right", "force", "within = { min = [0.1, 0.0], max = [0.6, 0.1] }")
            + &all("turned", "moment", "about = [1.0, 2.0]")
            + "[[probe]]\nname = \"one\"\nkind = \"force\"\nshape = \"b\"\n";
        let scene =
            halfstep_scene::parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        assert!(Touched::of::<2>(&scene, 1).is_none(), "nobody asks");
        let mut touched = Touched::of::<2>(&scene, 0).expect("seven probes ask");
        let record =
            |(id, x): (u32, f64)| StateRecord { id, position: [x, 3.0, 0.0], ..StateRecord::default() };
        let records: Vec<StateRecord> = [(0, 1.0), (1, 3.0), (2, 5.0)].map(record).into();
        touched.begin(3);
        touched.add(0, [1.0, 2.0]);
        touched.add(1, [0.5, 0.0]);
        touched.add(2, [8.0, 4.0]);
        // Seven probes, then the centres of a and of b.
        let measured = [0.0, 0.0, 10.0, 10.0, 20.0, 0.0, 10.0, 10.0, 100.0, 9.0, 9.0, 2.0, 2.5, 4.0, 2.0];
        let mut values = measured;
        touched.correct(&records, &mut values);
        assert_eq!(values, measured, "before these forces nothing touched");
        touched.begin(3);
        touched.correct(&records, &mut values);
        assert_eq!(values[..4], [1.5, 2.0, 2.0, 6.0]);
        // About (2, 2.5): (-1, 0.5) x (1, 2) = -2.5 and (1, 0.5) x (0.5, 0) = -0.25.
        assert_eq!(values[4], 22.75);
        // About (4, 2): (1, 1) x (8, 4) = -4.
        assert_eq!(values[5], -4.0);
        assert_eq!(values[6..8], [1.5, 6.0]);
        // About (1, 2): (0, 1) x (1, 2) = -1, (2, 1) x (0.5, 0) = -0.5, (4, 1) x (8, 4) = 8.
        assert_eq!(values[8], 93.5);
        assert_eq!(values[9..11], [1.0, 5.0]);
        assert_eq!(values[11..], measured[11..], "centres are as they were");
        assert_eq!(touched.now(), [[0.0; 2]; 3]);
    }
}
