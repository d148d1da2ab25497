//! What the coupler does for a solid process that only exchanges states: its frames and probes, from its records.

mod body;
mod continuity;

use crate::roles::probes_of;
use crate::solids::expected::Expected;
pub use continuity::Continuity;
pub use halfstep_interface::contact::WallContact;
use halfstep_output::{FirstMessage, Frame, FramePoint, FrameWriter, OutputError};
use halfstep_scene::geometry::{self, holds, nearest};
use halfstep_scene::{BodyQuantity, ProbeKind, Scene, Shape, Spot, dispatch};
use halfstep_wire::Name;
use halfstep_wire::frame::{body_of, mean_stress, von_mises};
use halfstep_wire::protocol::{ForceRecord, StateRecord};
use halfstep_wire::state::{Fields, State, StateError};
use std::path::Path;

/// Stand-in for an external solid's writer and probes.
pub struct ExternalSolid {
    writer: FrameWriter,
    kinds: Vec<ProbeKind>,
    dimension: usize,
    /// The scene's shapes.
    shapes: Vec<Shape>,
    /// Place of the solid in the scene's list, and how far outside of its shape a particle may lie, m.
    solid: usize,
    margin: f64,
    /// Of each particle, the place of the shape that it began nearest to.
    shape_of: Vec<Option<usize>>,
    /// The scene has it as a model that strains.
    strains: bool,
    /// By probe, the angle at the last row, rad.
    turned: Vec<f64>,
    first: Vec<[f64; 3]>,
    /// The records that each probe is about, where it is not about all of them.
    chosen: Vec<Vec<usize>>,
    values: Vec<f64>,
    /// It says that it evaluates contact with walls itself.
    pub(crate) own_walls: bool,
}

impl ExternalSolid {
    /// For the participant at this place of the scene. Frames go to the run's folder.
    ///
    /// # Errors
    /// The writer cannot start.
    pub fn new(scene: &Scene, place: usize, name: Name, folder: &Path) -> Result<Self, OutputError> {
        let solid = place - usize::from(scene.fluid.is_some());
        Ok(Self {
            writer: FrameWriter::start(folder, name.as_str())?,
            kinds: probes_of(scene, place).map(|probe| probe.kind.clone()).collect(),
            dimension: scene.dimension,
            shapes: scene.shapes.clone(),
            solid,
            margin: 0.5 * scene.solid_spacing(solid),
            shape_of: Vec::new(),
            strains: scene.solids[solid].rigid().is_none(),
            turned: vec![0.0; probes_of(scene, place).count()],
            first: Vec::new(),
            chosen: Vec::new(),
            values: Vec::new(),
            own_walls: false,
        })
    }

    /// Takes the first records that the solid published: its reference configuration.
    pub fn begin(&mut self, records: &[StateRecord]) {
        self.first = records.iter().map(|r| r.position).collect();
        self.choose_records();
    }

    /// Its first message, in which these were its records, beside what the scene has for it.
    pub fn first_message(&self, scene: &Scene, records: &[StateRecord]) -> Option<FirstMessage> {
        dispatch!(scene.dimension, D => {
            Expected::<D>::of(scene, &geometry::layout::<D>(scene), self.solid).compare(self.first(), records)
        })
    }

    /// Positions in its reference configuration, m.
    pub(crate) fn first(&self) -> &[[f64; 3]] {
        &self.first
    }

    fn choose_records(&mut self) {
        self.shape_of = self.first.iter().map(|x| self.nearest_shape(x)).collect();
        self.chosen = self.kinds.iter().map(|kind| self.choose(kind)).collect();
    }

    /// Probe values from the state at n.
    ///
    /// `forces` answer the same state, record by record; `contact` are those among them of other solids and of walls,
    /// none where it is empty.
    pub fn measure(
        &mut self,
        records: &[StateRecord],
        forces: &[ForceRecord],
        contact: &[[f64; 2]],
    ) -> &[f64] {
        self.values.clear();
        let of_fluid = |i: usize| {
            let (mut force, of_contact) = (forces[i].force(records[i].mass), contact.get(i));
            of_contact.iter().for_each(|of| (0..2).for_each(|d| force[d] -= of[d]));
            force
        };
        let of_probes = self.kinds.iter().zip(&self.chosen).zip(&mut self.turned);
        for ((kind, chosen), turned) in of_probes {
            let parts = kind.count(self.dimension);
            match kind {
                ProbeKind::Displacement { .. } => {
                    for d in 0..self.dimension {
                        let sum: f64 =
                            chosen.iter().map(|&i| records[i].position[d] - self.first[i][d]).sum();
                        self.values.push(sum / chosen.len() as f64);
                    }
                }
                ProbeKind::Position { .. } => {
                    for d in 0..self.dimension {
                        let sum: f64 = chosen.iter().map(|&i| records[i].position[d]).sum();
                        self.values.push(sum / chosen.len() as f64);
                    }
                }
                ProbeKind::Stress { .. } => {
                    let sum: f64 = chosen.iter().map(|&i| von_mises(&records[i].deviatoric_stress)).sum();
                    self.values.push(sum / chosen.len() as f64);
                }
                ProbeKind::SolidVelocity { .. } => {
                    for d in 0..self.dimension {
                        let sum: f64 = chosen.iter().map(|&i| records[i].velocity[d]).sum();
                        self.values.push(sum / chosen.len() as f64);
                    }
                }
                ProbeKind::CauchyStress { of: Spot::At(_) } => {
                    let stress = mean_stress(chosen.iter().map(|&i| &records[i]));
                    self.values.extend(&stress[..if self.dimension == 2 { 4 } else { 6 }]);
                }
                // Its records say nothing of its strain, nor of its inside and what that stores.
                ProbeKind::Strain { .. }
                | ProbeKind::CauchyStress { .. }
                | ProbeKind::StrainEnergy
                | ProbeKind::CrackEnergy
                | ProbeKind::CrackArea
                | ProbeKind::Bodies
                | ProbeKind::Energy { .. } => self.values.extend(std::iter::repeat_n(f64::NAN, parts)),
                ProbeKind::Moment { about, .. } => {
                    let of = |&i: &usize| {
                        let (x, f) = (records[i].position, of_fluid(i));
                        (x[0] - about[0]) * f[1] - (x[1] - about[1]) * f[0]
                    };
                    self.values.push(chosen.iter().map(of).sum());
                }
                ProbeKind::KineticEnergy { .. } => {
                    self.values.push(records.iter().map(body::kinetic_energy).sum());
                }
                ProbeKind::Body { quantity, .. } => {
                    let first = &self.first;
                    let body = body::Particles { chosen, records, forces, contact, first, turned: *turned };
                    let value = body.quantity(*quantity, self.dimension, self.strains);
                    let value = value.map_or([f64::NAN; 3], |value| [value.x, value.y, value.z]);
                    if *quantity == BodyQuantity::Angle {
                        *turned = value[2];
                    }
                    self.values.extend(if parts == 1 { &value[2..] } else { &value[..parts] });
                }
                ProbeKind::Force { .. } => {
                    for d in 0..self.dimension {
                        self.values.push(chosen.iter().map(|&i| of_fluid(i)[d]).sum());
                    }
                }
                _ => {
                    let mass: f64 = records.iter().map(|r| r.mass).sum();
                    for d in 0..self.dimension {
                        self.values.push(records.iter().map(|r| r.mass * r.position[d]).sum::<f64>() / mass);
                    }
                }
            }
        }
        &self.values
    }

    /// Place of the solid's shape that a point is in or nearest to; of several that it is in, the last.
    fn nearest_shape(&self, x: &[f64; 3]) -> Option<usize> {
        let own = |(_, shape): &(usize, &Shape)| shape.solid == Some(self.solid);
        let away = |(k, shape): (usize, &Shape)| (k, geometry::distance(&shape.geometry, x));
        let near = self.shapes.iter().enumerate().filter(own).map(away).filter(|(_, d)| *d < self.margin);
        near.rev().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
    }

    fn choose(&self, kind: &ProbeKind) -> Vec<usize> {
        match *kind {
            ProbeKind::Force { within, shape } | ProbeKind::Moment { within, shape, .. } => {
                let inside = |i: &usize| {
                    let of_shape = shape.is_none() || self.shape_of[*i] == shape;
                    within.is_none_or(|b| holds(&b, &self.first[*i], 0.0)) && of_shape
                };
                (0..self.first.len()).filter(inside).collect()
            }
            ProbeKind::Body { ref body, .. } => {
                let inside = |i: &usize| self.shape_of[*i].is_some_and(|k| self.shapes[k].body() == body);
                (0..self.first.len()).filter(inside).collect()
            }
            _ => {
                let point = kind.point_of_solid();
                point.map_or(Vec::new(), |at| nearest(self.first.iter().copied(), at))
            }
        }
    }

    /// Writes the records as a frame.
    ///
    /// # Errors
    /// An earlier frame could not be written.
    pub fn write(&mut self, number: u64, time: f64, records: &[StateRecord]) -> Result<(), OutputError> {
        self.writer.submit(number as u32, |frame: &mut Frame| {
            frame.clear();
            frame.time = time;
            for r in records {
                frame.push(FramePoint::solid(r));
                frame.von_mises.push(von_mises(&r.deviatoric_stress) as f32);
            }
            let gone = |(r, first): (&StateRecord, &[f64; 3])| {
                std::array::from_fn(|d| (r.position[d] - first[d]) as f32)
            };
            frame.displacement.extend(records.iter().zip(&self.first).map(gone));
            // Bodies are told by a solid that has several.
            if let Some(bodies) = records.iter().map(body_of).collect::<Option<Vec<u32>>>() {
                frame.body.extend(bodies.iter().map(|&body| body as i32));
            }
        })
    }

    /// Waits until all frames are on disk.
    ///
    /// # Errors
    /// A frame could not be written.
    pub fn finish(&mut self) -> Result<(), OutputError> {
        self.writer.wait()
    }

    /// Number of frames that are on disk.
    pub fn frames_safe(&self) -> u32 {
        self.writer.safe()
    }
}

impl State for ExternalSolid {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.points("first_position", &mut self.first)?;
        fields.reals("turned", &mut self.turned)?;
        fields.length("turned", self.kinds.len(), self.turned.len())?;
        fields.flag("own_walls", &mut self.own_walls)
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.choose_records();
        Ok(())
    }
}
