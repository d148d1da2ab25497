//! What the coupler does for a solid process that only exchanges states: its frames and probes, from its records.

use halfstep_shared::geometry::{holds, nearest};
use halfstep_shared::output::{Frame, FramePoint, FrameWriter, OutputError};
use halfstep_shared::protocol::{ForceRecord, StateRecord};
use halfstep_shared::scene::{Phase, ProbeKind, Scene};
use std::path::Path;

/// Stand-in for a foreign solid's writer and probes.
pub struct ForeignSolid {
    writer: FrameWriter,
    kinds: Vec<ProbeKind>,
    dimension: usize,
    first: Vec<[f64; 3]>,
    /// For each displacement probe the records that are nearest to its point at first.
    nearest: Vec<Vec<usize>>,
    values: Vec<f64>,
}

impl ForeignSolid {
    /// Frames go to the run's folder.
    ///
    /// # Errors
    /// The writer cannot start.
    pub fn new(scene: &Scene, folder: &Path) -> Result<Self, OutputError> {
        Ok(Self {
            writer: FrameWriter::start(folder, "solid")?,
            kinds: scene.probes.iter().map(|p| p.kind).filter(|k| k.phase() == Phase::Solid).collect(),
            dimension: scene.dimension,
            first: Vec::new(),
            nearest: Vec::new(),
            values: Vec::new(),
        })
    }

    /// Probe values from the state at n.
    ///
    /// `forces` answer the same state, record by record.
    pub fn measure(&mut self, records: &[StateRecord], forces: &[ForceRecord]) -> &[f64] {
        if self.first.is_empty() {
            self.first = records.iter().map(|r| r.position).collect();
            self.nearest = self.kinds.iter().map(|kind| self.nearest_to(kind)).collect();
        }
        self.values.clear();
        for (kind, nearest) in self.kinds.iter().zip(&self.nearest) {
            match kind {
                ProbeKind::Displacement { .. } => {
                    for d in 0..self.dimension {
                        let sum: f64 =
                            nearest.iter().map(|&i| records[i].position[d] - self.first[i][d]).sum();
                        self.values.push(sum / nearest.len() as f64);
                    }
                }
                ProbeKind::KineticEnergy { .. } => {
                    let energy =
                        |r: &StateRecord| 0.5 * r.mass * r.velocity.iter().map(|v| v * v).sum::<f64>();
                    self.values.push(records.iter().map(energy).sum());
                }
                ProbeKind::Force { within } => {
                    for d in 0..self.dimension {
                        let inside = |i: &usize| within.is_none_or(|b| holds(&b, &self.first[*i], 0.0));
                        let force = |i: usize| {
                            records[i].mass * forces[i].cross_viscosity[d] + forces[i].stress_force[d]
                        };
                        self.values.push((0..records.len()).filter(inside).map(force).sum());
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

    fn nearest_to(&self, kind: &ProbeKind) -> Vec<usize> {
        let ProbeKind::Displacement { at } = kind else { return Vec::new() };
        nearest(self.first.iter().copied(), *at)
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
            }
        })
    }

    /// Waits until all frames are on disk.
    ///
    /// # Errors
    /// A frame could not be written.
    pub fn finish(self) -> Result<(), OutputError> {
        self.writer.finish().map(|_| ())
    }
}
