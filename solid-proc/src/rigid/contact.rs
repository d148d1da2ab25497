//! Where bodies touch walls and each other, and the stops of joints.
//!
//! Points on a body's surface, a disc as a whole, are held against the exact surfaces of walls and of other bodies, and
//! in the plane corners of walls against those of bodies: a contact does not know the spacing of particles. Of the
//! points on one face the outermost two count in the plane, and one between them that is deeper than both.

use super::body::{Ball, Body, Pose};
use super::joint::across;
use super::row::Row;
use super::step::System;
use super::{Vec3, wide};
use halfstep_scene::geometry::Surface;

/// A contact, or a stop that a joint has reached.
#[derive(Clone, Debug)]
pub(super) struct Touch {
    /// Along the normal: b is pushed out of a.
    pub(super) normal: Row,
    /// Across the normal; one in the plane.
    pub(super) tangents: Vec<Row>,
    /// Impulses along these, N s (2D: N s/m).
    pub(super) impulse: f64,
    pub(super) friction: Vec<f64>,
    /// How fast a wall's surface, which stays where it is, goes along these, m/s.
    pub(super) slide: Vec<f64>,
    /// Least rate along the normal, m/s.
    pub(super) target: f64,
}

impl Touch {
    fn new(normal: Row, tangents: Vec<Row>) -> Self {
        let friction = vec![0.0; tangents.len()];
        let slide = friction.clone();
        Self { normal, tangents, impulse: 0.0, friction, slide, target: 0.0 }
    }

    /// A contact of bodies, and no stop of a joint.
    pub(super) fn is_contact(&self) -> bool {
        !self.tangents.is_empty()
    }
}

/// What a contact begins the next search with: the one of the same place in its pair's list.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Remembered {
    pub(super) ends: [usize; 2],
    pub(super) impulse: f64,
    pub(super) friction: [f64; 2],
}

impl Remembered {
    pub(super) fn of(touch: &Touch) -> Self {
        let of = |k: usize| touch.friction.get(k).copied().unwrap_or(0.0);
        Self { ends: touch.normal.ends, impulse: touch.impulse, friction: [of(0), of(1)] }
    }
}

/// The points of one body on one face of another in the plane, each with its place along the face, m.
struct OnFace {
    /// n.
    normal: Vec3,
    low: (f64, Touch),
    high: (f64, Touch),
    deepest: (f64, Touch),
}

impl OnFace {
    fn of(normal: Vec3, along: f64, touch: &Touch) -> Self {
        let [low, high, deepest] = [0; 3].map(|_| (along, touch.clone()));
        Self { normal, low, high, deepest }
    }

    fn add(&mut self, along: f64, touch: Touch) {
        if touch.normal.gap < self.deepest.1.normal.gap {
            self.deepest = (along, touch.clone());
        }
        if along < self.low.0 {
            self.low = (along, touch);
        } else if along > self.high.0 {
            self.high = (along, touch);
        }
    }

    /// Those that count; `rounding`, m, is no depth.
    fn counting(self, rounding: f64, all: &mut Vec<Touch>) {
        let several = self.high.0 > self.low.0;
        let least = self.low.1.normal.gap.min(self.high.1.normal.gap);
        let hump = several && self.deepest.1.normal.gap < least - rounding;
        all.push(self.low.1);
        all.extend(hump.then_some(self.deepest.1));
        all.extend(several.then_some(self.high.1));
    }
}

/// What is no depth of one point below others, in tolerances of contact.
const ROUNDING: f64 = 0.1;

/// How far beside a place a face is looked at, in tolerances of contact.
const BESIDE: f64 = 10.0;

/// How far into its body a ball at a corner is looked at, in tolerances of contact.
const ASIDE: f64 = 0.1;

/// How far from each other two corners are that touch, in tolerances of contact: along either side one at most.
const CORNER: f64 = 1.5;

/// Normals of one face agree to this cosine.
const SAME_FACE: f64 = 1.0 - 1e-9;

impl System {
    /// All contacts of the present state closer than the tolerance, and stops that are reached.
    pub(super) fn touches<const D: usize>(&self) -> Vec<Touch> {
        let mut all = Vec::new();
        let of_bodies =
            (0..self.real).flat_map(|ball| (0..self.bodies.len()).map(move |other| [other, ball]));
        let of_walls = (self.real..self.bodies.len()).flat_map(|ball| (0..self.real).map(move |b| [b, ball]));
        for [surface, ball] in of_bodies.chain(of_walls).filter(|[surface, ball]| surface != ball) {
            if self.may_touch(surface, ball) {
                self.between::<D>(surface, ball, &mut all);
            }
        }
        let mut ways = Vec::new();
        for link in &self.links {
            let Some([least, largest]) = link.limits else { continue };
            ways.clear();
            link.ways(self.plane, &self.bodies, &self.poses, &mut ways);
            for row in &ways {
                if row.gap < least + self.tolerance {
                    all.push(Touch::new(Row { gap: row.gap - least, ..*row }, Vec::new()));
                }
                if row.gap > largest - self.tolerance {
                    let [a, b] = row.ends;
                    let [on_a, on_b] = row.angular;
                    let back = Row { ends: [b, a], angular: [on_b, on_a], gap: largest - row.gap, ..*row };
                    all.push(Touch::new(back, Vec::new()));
                }
            }
        }
        all
    }

    /// Gives contacts the impulses of the last ones between the same bodies, where these are as many, and the bodies
    /// the velocities after them.
    pub(super) fn recall(&mut self, touches: &mut [Touch]) {
        let mut first = 0;
        while first < touches.len() {
            let ends = touches[first].normal.ends;
            let count = touches[first..].iter().take_while(|touch| touch.normal.ends == ends).count();
            let known = self.memory.iter().filter(|one| one.ends == ends);
            if known.clone().count() == count {
                for (touch, known) in touches[first..first + count].iter_mut().zip(known) {
                    touch.impulse = known.impulse;
                    touch.normal.push(&self.bodies, &mut self.poses, known.impulse);
                    for ((row, own), impulse) in
                        touch.tangents.iter().zip(&mut touch.friction).zip(known.friction)
                    {
                        *own = impulse;
                        row.push(&self.bodies, &mut self.poses, impulse);
                    }
                }
            }
            first += count;
        }
    }

    fn may_touch(&self, surface: usize, ball: usize) -> bool {
        let (a, b) = (&self.bodies[surface], &self.bodies[ball]);
        if a.surfaces.is_empty()
            || b.balls.is_empty()
            || !(a.gives_way() || b.gives_way())
            || b.tied.contains(&surface)
        {
            return false;
        }
        let reach = a.radius + b.radius + self.tolerance;
        surface >= self.real
            || ball >= self.real
            || (self.poses[surface].center - self.poses[ball].center).norm_squared() < reach * reach
    }

    /// Contacts of the balls of one body with the surfaces of another.
    fn between<const D: usize>(&self, surface: usize, ball: usize, all: &mut Vec<Touch>) {
        let (a, b): (&Body, &Body) = (&self.bodies[surface], &self.bodies[ball]);
        let (on_a, on_b): (&Pose, &Pose) = (&self.poses[surface], &self.poses[ball]);
        let back = on_a.turn.inverse();
        let mut faces: Vec<OnFace> = Vec::new();
        // Distances and normals of a surface's faces near a ball.
        let mut near: Vec<(f64, [f64; D])> = Vec::new();
        let outward = |own: &[f64; D]| on_a.turn * wide(own);
        for touching in &b.balls {
            let Ball { arm, radius, depth, .. } = touching;
            let at = on_b.center + on_b.turn * arm;
            let reach = a.radius + radius + self.tolerance;
            if ball >= self.real && (at - on_a.center).norm_squared() > reach * reach {
                continue;
            }
            let reference = a.center + back * (at - on_a.center);
            for (k, of) in a.surfaces.iter().enumerate() {
                let within = |distance: f64| (-depth..=self.tolerance).contains(&(distance - radius));
                let meets = |own: &[f64; D]| touching.is_met_from(&on_b.turn, &outward(own));
                near.clear();
                of.nearest::<D>(std::array::from_fn(|d| reference[d]), &mut |distance, own| {
                    if within(distance) {
                        near.push((distance, own));
                    }
                });
                // Where the ball is at a corner, the face that it lies on is as near as the one beside it. It is the
                // nearest one a little farther in the ball's own body.
                if !near.is_empty()
                    && !near.iter().any(|(_, own)| meets(own))
                    && let Some(inward) = touching.inward(&on_b.turn)
                {
                    near.clear();
                    let way = back * inward * (ASIDE * self.tolerance);
                    of.nearest::<D>(std::array::from_fn(|d| reference[d] + way[d]), &mut |distance, own| {
                        let distance = distance - (0..D).map(|d| way[d] * own[d]).sum::<f64>();
                        if within(distance) {
                            near.push((distance, own));
                        }
                    });
                }
                if !near.is_empty() && self.is_corner_on_corner(a, touching, &reference, meets) {
                    continue;
                }
                for &(distance, own) in near.iter().filter(|(_, own)| meets(own)) {
                    let foot = std::array::from_fn(|d| reference[d] - distance * own[d]);
                    if self.plane && self.is_covered::<D>(surface, k, foot, own) {
                        continue;
                    }
                    let normal = outward(&own);
                    let point = at - normal * *radius;
                    let row = Row::between([surface, ball], &self.poses, point, normal, distance - radius);
                    let touch = self.contact(row, point);
                    if !self.plane {
                        all.push(touch);
                        continue;
                    }
                    let along = point[1] * normal[0] - point[0] * normal[1];
                    match faces.iter_mut().find(|face| face.normal.dot(&normal) > SAME_FACE) {
                        None => faces.push(OnFace::of(normal, along, &touch)),
                        Some(face) => face.add(along, touch),
                    }
                }
            }
        }
        for face in faces {
            face.counting(ROUNDING * self.tolerance, all);
        }
    }

    /// Whether a point, in the reference configuration, lies on a corner both of whose faces `meets` it: either could
    /// part the two, and what slides over a seam of two bodies would be held by the one in its way.
    fn is_corner_on_corner<const D: usize>(
        &self,
        body: &Body,
        touching: &Ball,
        reference: &Vec3,
        meets: impl Fn(&[f64; D]) -> bool,
    ) -> bool {
        let near = CORNER * self.tolerance;
        let on = |ball: &&Ball| (body.center + ball.arm - reference).norm_squared() < near * near;
        touching.is_corner()
            && body.balls.iter().filter(|ball| ball.is_corner()).find(on).is_some_and(|corner| {
                corner.between.iter().flatten().all(|n| meets(&std::array::from_fn(|d| n[d])))
            })
    }

    /// Whether a face of a body's surface of that number is covered all around a place on it, by other surfaces of the
    /// body or by walls that move alike: where two are flush neither is touched at its hidden face.
    fn is_covered<const D: usize>(&self, body: usize, own: usize, foot: [f64; D], normal: [f64; D]) -> bool {
        let a = &self.bodies[body];
        if a.surfaces.len() == 1 && a.alike.is_empty() {
            return false;
        }
        let beside = BESIDE * self.tolerance;
        let distance = |surface: &Surface, at: [f64; D]| {
            let mut least = f64::INFINITY;
            surface.nearest::<D>(at, &mut |distance, _| least = least.min(distance));
            least
        };
        let of_body = a.surfaces.iter().enumerate().filter(|(k, _)| *k != own).map(|(_, surface)| surface);
        let of_walls = a.alike.iter().flat_map(|&wall| &self.bodies[wall].surfaces);
        let others = of_body.chain(of_walls);
        [-beside, beside].into_iter().all(|way| {
            let place = |out: f64| -> [f64; D] {
                std::array::from_fn(|d| match d {
                    0 => foot[0] - way * normal[1] + out * normal[0],
                    1 => foot[1] + way * normal[0] + out * normal[1],
                    _ => foot[d],
                })
            };
            let ends = distance(&a.surfaces[own], place(0.0)).abs() > 0.5 * beside;
            ends || others.clone().any(|other| distance(other, place(beside)) < 0.5 * beside)
        })
    }

    /// A contact at a point with friction across its normal.
    fn contact(&self, normal: Row, point: Vec3) -> Touch {
        let n = normal.linear;
        let directions = if self.plane { vec![Vec3::new(-n[1], n[0], 0.0)] } else { across(&n).to_vec() };
        let row = |d: Vec3| Row::between(normal.ends, &self.poses, point, d, 0.0);
        let tangents: Vec<Row> = directions.into_iter().map(row).collect();
        let [a, b] = normal.ends.map(|end| self.bodies[end].surface_velocity);
        let surface = a - b;
        let slide = tangents.iter().map(|row| row.linear.dot(&surface)).collect();
        Touch { slide, ..Touch::new(normal, tangents) }
    }
}
