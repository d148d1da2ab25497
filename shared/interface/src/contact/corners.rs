//! Corners of walls against the outline of a solid that goes over them: of a ridge between two of its points none of
//! these knows. The law is that of a point of another solid whose mass is infinite ([`Law::pass`]).

use super::Side;
use super::law::{Law, Touch, dot, less};
use super::outline::{Outline, Piece, Point};
use super::placed::Placed;
use halfstep_scene::geometry::{WallCorner, wall_corners};
use halfstep_scene::{Placement, Scene};

/// Depth in the solid, in spacings, from which on a corner that begins there is left out.
const BEGUN: f64 = 0.01;

/// Distance from the line of a face within which a corner is its own, in spacings.
const FLUSH: f64 = 1e-6;

/// A corner of a wall.
#[derive(Clone, Copy, Debug)]
struct Corner {
    /// Which wall.
    wall: usize,
    /// Where on it, m.
    place: [f64; 2],
    /// Of its faces before and after it.
    normals: [[f64; 2]; 2],
}

/// Corners of all walls that a solid may touch, as an outline of points without parts.
#[derive(Clone, Debug, Default)]
pub(super) struct Corners {
    all: Vec<Corner>,
    outline: Outline,
    placed: Placed,
    /// Contacts at n, ascending.
    pub(super) touches: Vec<Touch>,
    /// Contacts at n + 1/2.
    halfway: Vec<Touch>,
}

impl Corners {
    /// Of a scene's walls, beside the solid's outline at its first place: what begins in the solid, as the corner of a
    /// wall that it is let into, is left out. So are belts: what sticks to a corner does not go along with one.
    pub(super) fn new(scene: &Scene, solid: (&Outline, &Placed)) -> Self {
        let touched: Vec<_> = scene.walls_to_touch().collect();
        let spacing = solid.0.spacing;
        let wall = |corner: &WallCorner| {
            let k = touched
                .iter()
                .position(|(index, wall)| *index == corner.shape && wall.velocity == [0.0; 3])?;
            let begun = solid.1.depth_of(solid.0, corner.place);
            // Twice its share of the walls' outline: in a pass between two solids half of K is the other's.
            let WallCorner { place, normals, .. } = *corner;
            let own = Corner { wall: k, place, normals };
            (begun <= BEGUN * spacing).then_some((own, corner.length.min(spacing)))
        };
        let all: Vec<_> = wall_corners(scene).iter().filter_map(wall).collect();
        let point = |&(_, length): &(Corner, f64)| Point {
            weights: Vec::new(),
            offset: [0.0; 2],
            length,
            radius: 0.0,
            beside: None,
        };
        let points: Vec<Point> = all.iter().map(point).collect();
        let piece = Piece::of_points((0..points.len() as u32).collect());
        Self {
            outline: Outline { points, pieces: vec![piece], spacing, ..Outline::default() },
            all: all.into_iter().map(|(corner, _)| corner).collect(),
            ..Self::default()
        }
    }

    /// Adds the forces of corners on a solid's records, in a time step `dt`, s, with the walls where they are; returns
    /// the largest depth, m. `whole`: of a state at n.
    pub(super) fn act(
        &mut self,
        law: &Law,
        placements: &[Placement],
        solid: (&Outline, &Placed),
        (on, records): (&mut Side, usize),
        (dt, whole): (f64, bool),
    ) -> f64 {
        let at = |corner: &Corner| placements[corner.wall].position_of(corner.place);
        let velocity = |corner: &Corner| placements[corner.wall].velocity_of(corner.place);
        self.halfway.clear();
        let touching = |at: [f64; 2]| solid.1.targets.iter().any(|target| target.holds(at, 0.0));
        if !self.all.iter().map(at).any(touching) {
            if whole {
                self.touches.clear();
            }
            return 0.0;
        }
        self.placed.put(self.all.iter().map(at).collect(), self.all.iter().map(velocity).collect());
        on.forces.iter_mut().for_each(|forces| forces.resize(records, [0.0; 2]));
        let mut walls = Side { solid: usize::MAX, ..Side::default() };
        let own = (&self.outline, &self.placed);
        let deepest = law.pass(0, [own, solid], [&mut walls, on], (&self.touches, dt), &mut self.halfway);
        if whole {
            std::mem::swap(&mut self.touches, &mut self.halfway);
        }
        deepest
    }

    /// Normals of the faces that a wall's face, known by a place on it, m, and its normal, meets at corners inside of
    /// the solid.
    pub(super) fn beyond<'a>(
        &'a self,
        solid: (&'a Outline, &'a Placed),
        (wall, placement): (usize, &'a Placement),
        [on, normal]: [[f64; 2]; 2],
    ) -> impl Iterator<Item = [f64; 2]> {
        let own = self.all.iter().filter(move |corner| corner.wall == wall);
        let of_face = own.filter(move |corner| {
            let at = placement.position_of(corner.place);
            dot(less(at, on), normal).abs() < FLUSH * solid.0.spacing && solid.1.depth_of(solid.0, at) > 0.0
        });
        // Of its own face and the other one: the first is known.
        of_face.flat_map(move |corner| corner.normals.map(|normal| placement.direction_of(normal)))
    }

    /// Whether contacts are those of corners and parts that there are.
    pub(super) fn know(&self, solid: &Outline) -> bool {
        let known = |touch: &Touch| {
            (touch.key[1] as usize) < self.all.len() && (touch.part as usize) < solid.parts.len()
        };
        self.touches.iter().all(known)
    }
}
