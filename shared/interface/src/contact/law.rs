//! The law of contact, and the search for points of one outline inside of another.

use super::flanks::{beyond, share_at_first};
use super::outline::Outline;
use super::placed::Placed;
use super::{Side, THETA};
use halfstep_scene::{PairContact, Scene};

/// Decay time of the damper along the surface, in steps of the limit.
const ALONG: f64 = 2.0;

/// Part of the fastest approach within which a force changes from that of coming to that of leaving, unless a step
/// changes more.
const SLOW: f64 = 0.01;

/// Steps of the limit in which gravity gives the speed of a body at rest.
const REST: f64 = 4.0;

/// Room between the step that a derived stiffness allows and the fluid's.
const ROOM: f64 = 1.01;

/// Law of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// Coulomb's coefficient.
    friction: f64,
    /// Speed after an impact over that before it.
    restitution: f64,
    /// Pressure over penetration, Pa/m.
    pub stiffness: f64,
    said: Option<f64>,
    /// Speed below which an approach is no impact, m/s: what gravity gives in a few steps.
    rest: f64,
    /// Largest stable time step, s.
    pub limit: f64,
}

/// Depth beyond which a contact of a torn solid does not begin at the surface, in spacings.
const DEEP: f64 = 0.5;

/// A point of one solid inside of a piece of the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Touch {
    /// Which pass, point and piece.
    pub(super) key: [u32; 3],
    /// The part of the outline on which the point sticks.
    pub(super) part: u32,
    /// Where along that part, over its length.
    pub(super) share: f64,
    /// Largest approach so far, m/s.
    pub(super) approach: f64,
    /// How much of the push it takes.
    pub(super) share_of_push: f64,
    /// Depth from which on it is pushed, m: of a point of a torn solid that came to be deep inside.
    pub(super) rest: f64,
}

/// What is nearest to a point.
struct Foot {
    part: u32,
    share: f64,
    /// How far inside the point is, m.
    depth: f64,
    normal: [f64; 2],
}

pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn less(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// The normal of a part's line, out of the solid on its left.
pub(super) fn out(line: [f64; 2]) -> [f64; 2] {
    let length = libm::hypot(line[0], line[1]);
    [line[1] / length, -line[0] / length]
}

impl Law {
    pub(super) fn of(contact: &PairContact) -> Self {
        Self {
            friction: contact.friction,
            restitution: contact.restitution,
            stiffness: 0.0,
            said: contact.stiffness,
            rest: 0.0,
            limit: f64::INFINITY,
        }
    }

    /// Finds stiffness and limit from the least masses behind a length of both outlines, kg/m (2D: kg/m²). A stiffness
    /// that the scene does not say leaves the fluid its step.
    pub(super) fn fit(&mut self, scene: &Scene, solids: [usize; 2], masses: [f64; 2]) {
        let give: f64 = masses.iter().map(|mass| 1.0 / mass).sum();
        if give <= 0.0 {
            // An outline without particles touches nothing.
            return;
        }
        self.stiffness = self.said.unwrap_or_else(|| {
            let derived = scene.contact_stiffness(solids);
            let Some(fluid) = &scene.fluid else { return derived };
            let step =
                ROOM * scene.numerics.cfl * scene.smoothing_ratio * scene.resolution / fluid.sound_speed;
            derived.min((THETA / step).powi(2) / give)
        });
        self.limit = THETA / (self.stiffness * give).sqrt();
        let gravity = scene.gravity_magnitude();
        self.rest = REST * gravity * self.limit;
    }

    /// Points of the first solid inside of the second, in a time step, s; returns the largest penetration, m. Of one
    /// solid twice: points of bodies inside of those after them, and in the second pass of those before them.
    pub(super) fn pass(
        &self,
        pass: u32,
        [own, other]: [(&Outline, &Placed); 2],
        [on_own, on_other]: [&mut Side; 2],
        (touches, dt): (&[Touch], f64),
        found: &mut Vec<Touch>,
    ) -> f64 {
        let (outline, placed) = own;
        let mut deepest = 0.0_f64;
        let one_solid = on_own.solid == on_other.solid;
        let is_other = |own: usize, target: usize| match pass {
            0 => own < target,
            _ => own > target,
        };
        for (own_piece, (piece, around)) in outline.pieces.iter().zip(&placed.pieces).enumerate() {
            let singles = if placed.has_torn() { &piece.singles[..] } else { &[] };
            let margin = if singles.is_empty() { 0.0 } else { 0.5 * outline.spacing };
            for (k, target) in other.1.targets.iter().enumerate() {
                if one_solid && !is_other(own_piece, k) || !around.meets(target, margin) {
                    continue;
                }
                for &point in piece.points.iter().chain(singles) {
                    let at = placed.position[point as usize];
                    let radius = outline.points[point as usize].radius;
                    if placed.is_torn(point) || !target.holds(at, radius) {
                        continue;
                    }
                    let Some(foot) = nearest(other, k, at, radius) else { continue };
                    let key = [pass, point, k as u32];
                    let before =
                        touches.binary_search_by(|touch| touch.key.cmp(&key)).ok().map(|k| touches[k]);
                    let share = before.map_or_else(
                        || {
                            let beyond = beyond(other, foot.part, own, own_piece);
                            share_at_first(own, point, foot.normal, beyond)
                        },
                        |touch| touch.share_of_push,
                    );
                    if share > 0.0 {
                        deepest = deepest.max(foot.depth);
                    }
                    let (forces, touch) = self.force([own, other], key, (&foot, share), (before, dt));
                    found.push(touch);
                    let part = &other.0.parts[foot.part as usize];
                    for (kind, force) in forces.into_iter().enumerate() {
                        give(outline, point, force, &mut on_own.forces[kind]);
                        for (end, share) in [(0, 1.0 - foot.share), (1, foot.share)] {
                            let back = force.map(|f| -share * f);
                            give(other.0, part.ends[end], back, &mut on_other.forces[kind]);
                        }
                    }
                }
            }
        }
        // By pass, point and piece: points of a piece are not numbered after those of the one before it.
        let start = found.iter().position(|touch| touch.key[0] == pass).unwrap_or(found.len());
        found[start..].sort_unstable_by_key(|touch| touch.key);
        deepest
    }

    /// Forces on a point along the normal and along the surface, N (2D: N/m), and the contact as it goes on.
    fn force(
        &self,
        [(outline, placed), (other, surface)]: [(&Outline, &Placed); 2],
        key: [u32; 3],
        (foot, share_of_push): (&Foot, f64),
        (before, dt): (Option<Touch>, f64),
    ) -> ([[f64; 2]; 2], Touch) {
        let point = key[1] as usize;
        let on = |part: u32, share: f64, of: &[[f64; 2]]| {
            let [from, to] = other.parts[part as usize].ends.map(|end| of[end as usize]);
            [0, 1].map(|d| (1.0 - share) * from[d] + share * to[d])
        };
        let slip = less(placed.velocity[point], on(foot.part, foot.share, &surface.velocity));
        let normal = foot.normal;
        let tangent = [-normal[1], normal[0]];
        let approach = -dot(slip, normal);
        // Where cracks are, a point may come to be deep inside at once: it has new particles about it, or old ones
        // apart.
        let deep = placed.has_torn() && foot.depth > DEEP * outline.spacing;
        let rest = if deep { foot.depth } else { 0.0 };
        let Foot { part, share, .. } = *foot;
        let mut touch = before.unwrap_or(Touch { key, part, share, approach: 0.0, share_of_push, rest });
        touch.rest = touch.rest.min(foot.depth);
        touch.approach = touch.approach.max(approach);
        let spring = 0.5 * self.stiffness * share_of_push * outline.points[point].length;
        let push = self.push(spring, foot.depth - touch.rest, [approach, touch.approach], dt);
        let stuck = on(touch.part, touch.share, &surface.position);
        let from = less(placed.position[point], stuck);
        let (along, slipped) = self.along(spring, push, dot(from, tangent), dot(slip, tangent));
        if let Some(left) = slipped {
            let [start, end] = other.parts[foot.part as usize].ends.map(|end| surface.position[end as usize]);
            let line = less(end, start);
            touch.part = foot.part;
            touch.share = foot.share - left * dot(tangent, line) / dot(line, line);
        }
        ([normal.map(|n| push * n), tangent.map(|t| along * t)], touch)
    }

    /// Force along the normal, N (2D: N/m), on a point with a spring (N/m; 2D: N/m²) that is so deep (m) and comes so
    /// fast (m/s), `fastest` at most in this contact; in a time step, s.
    pub(super) fn push(&self, spring: f64, depth: f64, [approach, fastest]: [f64; 2], dt: f64) -> f64 {
        let kept = self.restitution * self.restitution;
        // No less than what the step changes at this depth: else the half-step sees the force of leaving before the
        // step has turned the motion round, and bodies sink into each other.
        let omega = THETA / self.limit;
        let change = 0.5 * omega * omega * dt.min(self.limit) * depth * (1.0 - kept);
        let slow = change.max(SLOW * fastest).max(self.rest);
        let way = if slow > 0.0 { libm::tanh(approach / slow) } else { sign(approach) };
        spring * depth * 0.5 * (1.0 + kept + (1.0 - kept) * way)
    }

    /// Force along the surface, N (2D: N/m), on a point that is pressed on it with `push`, lies so far along it from
    /// where it sticks (m), and goes so fast along it (m/s); where it slips, how far off it sticks then, m.
    pub(super) fn along(&self, spring: f64, push: f64, from: f64, rate: f64) -> (f64, Option<f64>) {
        let most = self.friction * push;
        let pull = -spring * (from + ALONG * self.limit * rate);
        let along = pull.clamp(-most, most);
        let slipped = (along != pull || self.friction == 0.0).then(|| {
            // What stays of the spring holds no more than friction does.
            let most = if spring > 0.0 { most / spring } else { 0.0 };
            from.clamp(-most, most)
        });
        (along, slipped)
    }

    /// Coulomb's coefficient, and the speed after an impact over that before it.
    pub fn said(&self) -> [f64; 2] {
        [self.friction, self.restitution]
    }
}

fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Adds a force on a point of an outline to those on the records that carry it.
pub(super) fn give(outline: &Outline, point: u32, force: [f64; 2], forces: &mut [[f64; 2]]) {
    for (record, w) in &outline.points[point as usize].weights {
        let sum = &mut forces[*record as usize];
        *sum = [sum[0] + w * force[0], sum[1] + w * force[1]];
    }
}

/// How deep a place is in a piece, m: zero outside.
pub(super) fn depth_in(of: (&Outline, &Placed), piece: usize, at: [f64; 2]) -> f64 {
    nearest(of, piece, at, 0.0).map_or(0.0, |foot| foot.depth)
}

/// The nearest place on a piece to a point whose surface, at a distance before it, is inside of it.
fn nearest((outline, placed): (&Outline, &Placed), piece: usize, at: [f64; 2], radius: f64) -> Option<Foot> {
    let ends = |part: u32| outline.parts[part as usize].ends.map(|end| placed.position[end as usize]);
    let mut best: Option<(f64, u32, f64)> = None;
    for part in outline.pieces[piece].parts.clone() {
        let [from, to] = ends(part);
        let (line, way) = (less(to, from), less(at, from));
        let share = (dot(way, line) / dot(line, line)).clamp(0.0, 1.0);
        let away = less(way, line.map(|x| share * x));
        let square = dot(away, away);
        if best.is_none_or(|(least, ..)| square < least) {
            best = Some((square, part, share));
        }
    }
    let (square, part, share) = best?;
    let normal = |part: u32| {
        let [from, to] = ends(part);
        out(less(to, from))
    };
    let [from, to] = ends(part);
    let line = less(to, from);
    let away = less(less(at, from), line.map(|x| share * x));
    // At a corner both of its parts say which side is out.
    let beside = outline.parts[part as usize].beside;
    let side = match share {
        s if s <= 0.0 => [normal(part), normal(beside[0])],
        s if s >= 1.0 => [normal(part), normal(beside[1])],
        _ => [normal(part); 2],
    };
    let apart = square.sqrt();
    let outside = dot(away, side[0]) + dot(away, side[1]) >= 0.0;
    if outside && apart >= radius {
        return None;
    }
    let sign = if outside { 1.0 } else { -1.0 };
    let corner = apart > 0.0 && !(share > 0.0 && share < 1.0);
    let normal = if corner { away.map(|x| sign * x / apart) } else { side[0] };
    Some(Foot { part, share, depth: radius - sign * apart, normal })
}
