//! Corners of walls against the outline of a solid that goes over them: of a ridge between two of its points none of
//! these knows. The law is that of a point of another solid whose mass is infinite ([`Law::pass`]).

use super::Side;
use super::law::{Law, Touch};
use super::outline::{Outline, Piece, Point};
use super::placed::Placed;
use halfstep_scene::geometry::{WallCorner, wall_corners};
use halfstep_scene::{Placement, Scene};

/// Depth in the solid, in spacings, from which on a corner that begins there is left out.
const BEGUN: f64 = 0.01;

/// Corners of all walls that a solid may touch, as an outline of points without parts.
#[derive(Clone, Debug, Default)]
pub(super) struct Corners {
    /// Which wall, and where on it, m.
    all: Vec<(usize, [f64; 2])>,
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
            (begun <= BEGUN * spacing).then_some((k, corner.place, corner.length.min(spacing)))
        };
        let all: Vec<_> = wall_corners(scene).iter().filter_map(wall).collect();
        let point = |&(.., length): &(usize, [f64; 2], f64)| Point {
            weights: Vec::new(),
            offset: [0.0; 2],
            length,
            radius: 0.0,
        };
        let points: Vec<Point> = all.iter().map(point).collect();
        let piece = Piece::of_points((0..points.len() as u32).collect());
        Self {
            outline: Outline { points, pieces: vec![piece], spacing, ..Outline::default() },
            all: all.into_iter().map(|(wall, place, _)| (wall, place)).collect(),
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
        let at = |(k, place): &(usize, [f64; 2])| placements[*k].position_of(*place);
        let velocity = |(k, place): &(usize, [f64; 2])| placements[*k].velocity_of(*place);
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

    /// Whether contacts are those of corners and parts that there are.
    pub(super) fn know(&self, solid: &Outline) -> bool {
        let known = |touch: &Touch| {
            (touch.key[1] as usize) < self.all.len() && (touch.part as usize) < solid.parts.len()
        };
        self.touches.iter().all(known)
    }
}
