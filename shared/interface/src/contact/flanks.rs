//! Faces on tips. Where a corner of one solid is inside of another, its points are pushed along the other's normal. The
//! other's points beside it are inside of the tip as well, nearest to one of its flanks: pushed along the flanks'
//! normals they would hold the tip between them, as friction does. (At the edge of a body that lies flat one of the two
//! sides at the corner faces these points, and all of them are pushed.) How much of the push a point takes is found
//! when its contact begins and stays until that ends, so the force follows from an energy.

use super::law::{depth_in, dot, out};
use super::outline::{Outline, Part};
use super::placed::Placed;

/// Two parts meet at a corner where they turn by an angle whose cosine is less, 26 degrees: not those of a disc 2.2
/// spacings across.
const CORNER: f64 = 0.9;

/// A part pushes a point in full whose own normal is against the part's within 18 degrees, and not at all one off by
/// more than 37: the cosines, the second one first. Bodies that lie flat on each other strain and rock.
const OBLIQUE: [f64; 2] = [0.8, 0.95];

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
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

/// How much of the push of a part with that normal a point takes whose contact begins now. `beyond`: normals of the
/// sides that the part's own side meets at corners inside of the point's body. Where there is such a corner, and the
/// point lies within a face, it takes what the face is turned toward the nearer of the two sides.
pub(super) fn share_at_first(
    (outline, placed): (&Outline, &Placed),
    point: u32,
    normal: [f64; 2],
    mut beyond: impl Iterator<Item = [f64; 2]>,
) -> f64 {
    let Some(beside) = outline.points[point as usize].beside else { return 1.0 };
    let ends = beside.map(|part| outline.parts[part as usize].ends);
    // Beside a crack there is no face.
    if ends.iter().flatten().any(|&end| placed.is_torn(end)) {
        return 1.0;
    }
    let own = ends.map(|ends| out(placed.line(ends)));
    let toward = |normal: [f64; 2]| -dot(own[0], normal).min(dot(own[1], normal));
    if toward(normal) >= OBLIQUE[1] || dot(own[0], own[1]) < CORNER {
        return 1.0;
    }
    let Some(first) = beyond.next() else { return 1.0 };
    let cosine = beyond.fold(toward(normal).max(toward(first)), |most, normal| most.max(toward(normal)));
    let way = ((cosine - OBLIQUE[0]) / (OBLIQUE[1] - OBLIQUE[0])).clamp(0.0, 1.0);
    way * way * (3.0 - 2.0 * way)
}

/// Normals of the sides that a part's side meets at corners inside of a whole piece of another outline.
pub(super) fn beyond<'a>(
    (outline, placed): (&'a Outline, &'a Placed),
    part: u32,
    of: (&'a Outline, &'a Placed),
    piece: usize,
) -> impl Iterator<Item = [f64; 2]> {
    let corners = outline.parts[part as usize].corners.into_iter().enumerate();
    corners.filter_map(move |(end, corner)| {
        let corner = corner? as usize;
        let at = placed.position[corner];
        let side = outline.points[corner].beside?[end];
        let inside = of.1.targets[piece].holds(at, 0.0) && depth_in(of, piece, at) > 0.0;
        inside.then(|| out(placed.line(outline.parts[side as usize].ends)))
    })
}
