//! Faces on tips. Where a corner of one solid is inside of another, its points are pushed along the other's normal. The
//! other's points beside it are inside of the tip as well, nearest to one of its flanks: pushed along the flanks'
//! normals they would hold the tip between them, as friction does.

use super::law::{Foot, dot, less, nearest};
use super::outline::{Outline, Part};
use super::placed::Placed;

/// Two parts meet at a corner where the cosine of what they turn by is less: not those of a disc two spacings across.
const CORNER: f64 = 0.9;

/// Cosine of the angle from a point's normal to that against a flank from which on the flank does not push it, and
/// below which it does in full: bodies that lie flat on each other strain and rock.
const OBLIQUE: [f64; 2] = [0.8, 0.95];

/// A part that a point faces pushes it instead of a nearer flank within so many times the flank's distance.
const NEAR: f64 = 2.0;

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The normal of a part's line, out of the solid on its left.
fn out(line: [f64; 2]) -> [f64; 2] {
    let length = libm::hypot(line[0], line[1]);
    [line[1] / length, -line[0] / length]
}

/// Finds the convex corners at which the sides of a piece's parts, of these lines, m, begin and end.
pub(super) fn find_corners(parts: &mut [Part], first: u32, lines: &[[f64; 2]]) {
    let own = |part: u32| (part - first) as usize;
    let turn = |[from, to]: [u32; 2]| {
        let [from, to] = [from, to].map(|part| out(lines[own(part)]));
        (dot(from, to) < CORNER).then(|| cross(from, to) > 0.0)
    };
    for end in 0..2 {
        for start in first..first + lines.len() as u32 {
            let Part { beside, ends, .. } = parts[own(start)];
            let met = if end == 0 { [beside[0], start] } else { [start, beside[1]] };
            // Beyond a convex corner a side begins.
            if turn(met) != Some(true) {
                continue;
            }
            let mut part = start;
            loop {
                parts[own(part)].corners[end] = Some(ends[end]);
                let next = parts[own(part)].beside[1 - end];
                let on = if end == 0 { [part, next] } else { [next, part] };
                if next == part || turn(on).is_some() {
                    break;
                }
                part = next;
            }
        }
    }
}

/// The normals of a point's own outline before and after it; `None` of a particle alone.
fn own_normals((outline, placed): (&Outline, &Placed), point: u32) -> Option<[[f64; 2]; 2]> {
    let normal = |part: u32| {
        let [from, to] = outline.parts[part as usize].ends.map(|end| placed.position[end as usize]);
        out(less(to, from))
    };
    let beside = outline.points[point as usize].beside.map(|parts| parts.map(normal));
    beside.or_else(|| placed.normals.get(point as usize).copied())
}

/// How much of a push along `normal` a point with these normals takes: all of one against its own outline, none of one
/// along it.
fn share_of_push([before, after]: [[f64; 2]; 2], normal: [f64; 2]) -> f64 {
    let against = normal.map(|n| -n);
    if is_convex([before, after]) && cross(before, against) >= 0.0 && cross(against, after) >= 0.0 {
        return 1.0;
    }
    let cosine = dot(before, against).max(dot(after, against));
    let way = ((cosine - OBLIQUE[0]) / (OBLIQUE[1] - OBLIQUE[0])).clamp(0.0, 1.0);
    way * way * (3.0 - 2.0 * way)
}

fn is_convex([before, after]: [[f64; 2]; 2]) -> bool {
    cross(before, after) > 0.0
}

fn is_corner([before, after]: [[f64; 2]; 2]) -> bool {
    is_convex([before, after]) && dot(before, after) < CORNER
}

/// Where a point is pushed that is `nearest` to a part of the other's piece, and how much of the push it takes; `None`
/// where nothing pushes it but flanks that its own surface does not face.
pub(super) fn facing(
    [own, other]: [(&Outline, &Placed); 2],
    [own_piece, piece]: [usize; 2],
    point: u32,
    nearest: Foot,
) -> Option<(Foot, f64)> {
    let Some(normals) = own_normals(own, point) else { return Some((nearest, 1.0)) };
    let share = share_of_push(normals, nearest.normal);
    if share == 1.0 {
        return Some((nearest, 1.0));
    }
    let at = own.1.position[point as usize];
    let met = |part: u32| {
        let [from, to] = other.0.parts[part as usize].ends.map(|end| other.1.position[end as usize]);
        let (line, way) = (less(to, from), less(at, from));
        let (normal, along) = (out(line), dot(way, line) / dot(line, line));
        let (depth, share) = (-dot(way, normal), share_of_push(normals, normal));
        let met = depth > 0.0 && (0.0..=1.0).contains(&along) && share > 0.0;
        met.then_some((Foot { part, share: along, depth, normal }, share))
    };
    let all = other.0.pieces[piece].parts.clone().filter_map(met);
    let faced = all.min_by(|(a, _), (b, _)| a.depth.total_cmp(&b.depth));
    let corners = other.0.parts[nearest.part as usize].corners.into_iter().flatten();
    let mut places = corners.map(|corner| other.1.position[corner as usize]);
    let is_near = faced.as_ref().is_some_and(|(faced, _)| faced.depth <= NEAR * nearest.depth);
    if !is_near && !is_corner(normals) && !places.any(|corner| is_inside(own, own_piece, corner)) {
        return Some((nearest, 1.0));
    }
    let (foot, share) = faced?;
    // The flank beside the point is where its push begins: all of it from where the faced part is as near, or where
    // all of the point's length is inside.
    let all_of_it = foot.depth.min(0.5 * own.0.points[point as usize].length);
    let begun = (nearest.depth / all_of_it).min(1.0);
    Some((foot, share * begun))
}

/// A wall's face does not push a point of a solid, or how much of its push the point takes: `corners` says whether a
/// corner of the face is in the solid.
pub(super) fn share_of_wall(
    solid: (&Outline, &Placed),
    point: u32,
    normal: [f64; 2],
    corners: impl FnOnce() -> bool,
) -> f64 {
    let Some(normals) = own_normals(solid, point) else { return 1.0 };
    let share = share_of_push(normals, normal);
    if share == 1.0 || is_corner(normals) || corners() { share } else { 1.0 }
}

/// A place is inside of a piece of an outline that is whole.
fn is_inside(of: (&Outline, &Placed), piece: usize, at: [f64; 2]) -> bool {
    of.1.targets.get(piece).is_some_and(|target| target.holds(at, 0.0))
        && nearest(of, piece, at, 0.0).is_some()
}
