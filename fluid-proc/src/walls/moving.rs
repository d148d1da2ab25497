//! Walls that move by prescription.

use crate::columns::{Vectors, vectors};
use halfstep_scene::geometry::WallPoint;
use halfstep_scene::{Motion, Phase, Placement, Scene};
use halfstep_sph::neighbours::Rows;

/// Where walls move, and where they are now.
#[derive(Clone, Debug)]
pub struct Moving<const D: usize> {
    motions: Vec<Option<Motion>>,
    /// By shape.
    placements: Vec<Placement>,
    /// Displacement of each shape at the last sort.
    pub(crate) at_sort: Vec<[f64; 3]>,
    /// Shape of each slot: a whole number, as a column that is sorted with the others.
    pub(crate) shape: Vec<f64>,
    /// Place in the scene, m.
    pub(crate) initial: Vectors<D>,
    /// The scene's constant velocity of the surface, m/s.
    pub(crate) surface: Vectors<D>,
    /// Largest displacement since the last sort, m.
    pub displacement: f64,
}

/// The motion of each shape of a scene; empty where no wall moves.
pub fn motions(scene: &Scene) -> Vec<Option<Motion>> {
    let walls = |s: &halfstep_scene::Shape| s.motion.filter(|_| s.phase == Phase::Wall);
    let motions: Vec<_> = scene.shapes.iter().map(walls).collect();
    if motions.iter().all(Option::is_none) { Vec::new() } else { motions }
}

impl<const D: usize> Moving<D> {
    /// `None` where there are no motions.
    pub(crate) fn new(points: &[WallPoint<D>], motions: &[Option<Motion>]) -> Option<Self> {
        if motions.is_empty() {
            return None;
        }
        let mut moving = Self {
            motions: motions.to_vec(),
            placements: vec![Placement::default(); motions.len()],
            at_sort: vec![[0.0; 3]; motions.len()],
            shape: points.iter().map(|p| f64::from(p.shape)).collect(),
            initial: vectors(points.len()),
            surface: vectors(points.len()),
            displacement: 0.0,
        };
        for (i, p) in points.iter().enumerate() {
            for d in 0..D {
                moving.initial[d][i] = p.position[d];
                moving.surface[d][i] = p.velocity[d];
            }
        }
        Some(moving)
    }

    pub(crate) fn permute(&mut self, rows: &mut Rows<D>) {
        rows.permute(&mut self.shape);
        for d in 0..D {
            rows.permute(&mut self.initial[d]);
            rows.permute(&mut self.surface[d]);
        }
        for (at_sort, now) in self.at_sort.iter_mut().zip(&self.placements) {
            *at_sort = now.displacement;
        }
        self.displacement = 0.0;
    }

    pub(crate) fn place(&mut self, time: f64, position: &mut Vectors<D>, velocity: &mut Vectors<D>) {
        self.displacement = 0.0;
        for (k, motion) in self.motions.iter().enumerate() {
            let Some(motion) = motion else { continue };
            let now = motion.at(time);
            let moved: f64 = (0..3).map(|d| (now.displacement[d] - self.at_sort[k][d]).powi(2)).sum();
            self.displacement = self.displacement.max(moved.sqrt());
            self.placements[k] = now;
        }
        for slot in 0..self.shape.len() {
            let now = &self.placements[self.shape[slot] as usize];
            for d in 0..D {
                position[d][slot] = self.initial[d][slot] + now.displacement[d];
                velocity[d][slot] = self.surface[d][slot] + now.velocity[d];
            }
        }
    }

    /// Brings the walls to where they were at the last sort.
    pub(crate) fn return_to_sort(&mut self, position: &mut Vectors<D>) {
        for (now, at_sort) in self.placements.iter_mut().zip(&self.at_sort) {
            now.displacement = *at_sort;
        }
        for slot in 0..self.shape.len() {
            let displacement = self.at_sort[self.shape[slot] as usize];
            for d in 0..D {
                position[d][slot] = self.initial[d][slot] + displacement[d];
            }
        }
    }

    /// Where a point of the scene is that goes along with the wall of a shape.
    pub(crate) fn carry(&self, shape: usize, point: [f64; D]) -> [f64; D] {
        let now = &self.placements[shape];
        std::array::from_fn(|d| point[d] + now.displacement[d])
    }

    /// Acceleration of a slot, m/s².
    pub(crate) fn acceleration(&self, slot: usize) -> [f64; 3] {
        self.placements[self.shape[slot] as usize].acceleration
    }
}
