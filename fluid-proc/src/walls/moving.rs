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
    /// The same at the last sort.
    at_sort: Vec<Placement>,
    /// When the last sort was, s.
    pub(crate) sorted_at: f64,
    /// Now, s.
    pub(crate) time: f64,
    /// Distance of each shape's farthest particle from the pivot about which it turns, m.
    radius: Vec<f64>,
    /// Shape of each slot: a whole number, as a column that is sorted with the others.
    pub(crate) shape: Vec<f64>,
    /// Place in the scene, m.
    pub(crate) initial: Vectors<D>,
    /// The scene's constant velocity of the surface, m/s.
    pub(crate) surface: Vectors<D>,
    /// The normal in the scene.
    pub(crate) normal: Vectors<D>,
    /// Largest displacement since the last sort, m.
    pub displacement: f64,
}

/// What of the walls changes as they move: columns by slot.
pub(crate) struct Seen<'a, const D: usize> {
    pub(crate) position: &'a mut Vectors<D>,
    pub(crate) velocity: &'a mut Vectors<D>,
    pub(crate) normal: &'a mut Vectors<D>,
}

/// The motion of each shape of a scene; empty where no wall moves.
pub fn motions(scene: &Scene) -> Vec<Option<Motion>> {
    let walls = |s: &halfstep_scene::Shape| s.motion.clone().filter(|_| s.phase == Phase::Wall);
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
            at_sort: vec![Placement::default(); motions.len()],
            sorted_at: 0.0,
            time: 0.0,
            radius: vec![0.0; motions.len()],
            shape: points.iter().map(|p| f64::from(p.shape)).collect(),
            initial: vectors(points.len()),
            surface: vectors(points.len()),
            normal: vectors(points.len()),
            displacement: 0.0,
        };
        for (i, p) in points.iter().enumerate() {
            for d in 0..D {
                moving.initial[d][i] = p.position[d];
                moving.surface[d][i] = p.velocity[d];
                moving.normal[d][i] = p.normal[d];
            }
            let shape = p.shape as usize;
            if let Some(pivot) = motions[shape].as_ref().and_then(Motion::pivot) {
                let away = ((p.position[0] - pivot[0]).powi(2) + (p.position[1] - pivot[1]).powi(2)).sqrt();
                moving.radius[shape] = moving.radius[shape].max(away);
            }
        }
        Some(moving)
    }

    pub(crate) fn permute(&mut self, rows: &mut Rows<D>) {
        rows.permute(&mut self.shape);
        for d in 0..D {
            rows.permute(&mut self.initial[d]);
            rows.permute(&mut self.surface[d]);
            rows.permute(&mut self.normal[d]);
        }
        self.at_sort.clone_from(&self.placements);
        self.sorted_at = self.time;
        self.displacement = 0.0;
    }

    fn go_to(&mut self, time: f64) {
        self.time = time;
        for (motion, now) in self.motions.iter().zip(&mut self.placements) {
            if let Some(motion) = motion {
                *now = motion.at(time);
            }
        }
    }

    pub(crate) fn place(&mut self, time: f64, seen: Seen<'_, D>) {
        self.go_to(time);
        let moved = self.placements.iter().zip(&self.at_sort).zip(&self.radius);
        self.displacement =
            moved.map(|((now, at_sort), &radius)| now.moved_since(at_sort, radius)).fold(0.0, f64::max);
        for slot in 0..self.shape.len() {
            let now = &self.placements[self.shape[slot] as usize];
            let place = self.initial(slot);
            let (x, v) = (now.position_of(place), now.velocity_of(place));
            let surface: [f64; D] = now.direction_of(std::array::from_fn(|d| self.surface[d][slot]));
            for d in 0..D {
                seen.position[d][slot] = x[d];
                seen.velocity[d][slot] = surface[d] + v[d];
            }
            if now.turn.is_some() {
                let normal: [f64; D] = now.direction_of(std::array::from_fn(|d| self.normal[d][slot]));
                (0..D).for_each(|d| seen.normal[d][slot] = normal[d]);
            }
        }
    }

    fn initial(&self, slot: usize) -> [f64; D] {
        std::array::from_fn(|d| self.initial[d][slot])
    }

    /// Brings the walls to where they were at the last sort.
    pub(crate) fn return_to_sort(&mut self, position: &mut Vectors<D>) {
        self.go_to(self.sorted_at);
        for slot in 0..self.shape.len() {
            let x = self.placements[self.shape[slot] as usize].position_of(self.initial(slot));
            (0..D).for_each(|d| position[d][slot] = x[d]);
        }
    }

    /// Where a point of the scene is that goes along with the wall of a shape.
    pub(crate) fn carry(&self, shape: usize, point: [f64; D]) -> [f64; D] {
        self.placements[shape].position_of(point)
    }

    /// Velocity of the surface above a slot, which is so deep, m; m/s.
    pub(crate) fn velocity_above(&self, slot: usize, depth: f64) -> [f64; D] {
        let now = &self.placements[self.shape[slot] as usize];
        let above = std::array::from_fn(|d| self.initial[d][slot] + depth * self.normal[d][slot]);
        let (v, belt): ([f64; D], [f64; D]) =
            (now.velocity_of(above), now.direction_of(std::array::from_fn(|d| self.surface[d][slot])));
        std::array::from_fn(|d| v[d] + belt[d])
    }

    /// Acceleration of a slot, m/s².
    pub(crate) fn acceleration(&self, slot: usize) -> [f64; D] {
        self.placements[self.shape[slot] as usize].acceleration_of(self.initial(slot))
    }
}
