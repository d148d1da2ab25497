//! Sides of a polygon that face each other across it.

use super::{Edge, Edges, dot};

/// Cosine of the angle between the outward normals of two sides that face each other: they differ by at most 26 degrees
/// from parallel.
const FACING: f64 = -0.9;
/// The least length of the boundary between two places that face each other, over their distance: around a rounded end
/// it is pi / 2.
const DETOUR: f64 = 1.5;

/// Least distance of two sides that face each other across the region, m, and the middle between them.
pub(super) fn least(edges: &Edges) -> Option<(f64, [f64; 2])> {
    let lines = line_lengths(edges);
    let mut least: Option<(f64, [f64; 2])> = None;
    for (a, one) in edges.all.iter().enumerate() {
        for (b, other) in edges.all.iter().enumerate() {
            if a == b || one.before == b || one.after == b || dot(&one.normal(), &other.normal()) > FACING {
                continue;
            }
            // Half way along what the two have before each other.
            let along = [other.from, other.to].map(|p| one.coordinates(&p)[0].clamp(0.0, one.length()));
            let half = 0.5 * (along[0] + along[1]) / one.length();
            let here = [0, 1].map(|c| one.from[c] + half * (one.to[c] - one.from[c]));
            let apart = detour(&lines, (one, &here), (other, &other.foot(&here)));
            // The least distance of two segments is that of an end to the other one.
            for end in [one.from, one.to] {
                let foot = other.foot(&end);
                let way = [foot[0] - end[0], foot[1] - end[1]];
                let distance = libm::hypot(way[0], way[1]);
                // Sides turn their backs to each other across a gap.
                let through = dot(&way, &one.normal()) < -0.7 * distance;
                if !through || least.is_some_and(|(least, _)| least <= distance) {
                    continue;
                }
                let middle = [0, 1].map(|c| 0.5 * (end[c] + foot[c]));
                if apart >= DETOUR * distance && edges.contains(&middle, 1e-9 * distance) {
                    least = Some((distance, middle));
                }
            }
        }
    }
    least
}

fn line_lengths(edges: &Edges) -> Vec<f64> {
    let lines = edges.all.iter().map(|edge| edge.line + 1).max().unwrap_or(0);
    let mut lengths = vec![0.0; lines];
    edges.all.iter().for_each(|edge| lengths[edge.line] += edge.length());
    lengths
}

/// Length of the boundary between two of its places, m, the shorter way around.
fn detour(lines: &[f64], a: (&Edge, &[f64; 2]), b: (&Edge, &[f64; 2])) -> f64 {
    if a.0.line != b.0.line {
        return f64::INFINITY;
    }
    let along = |(edge, p): (&Edge, &[f64; 2])| edge.start + edge.coordinates(p)[0];
    let apart = (along(a) - along(b)).abs();
    apart.min(lines[a.0.line] - apart)
}

/// The faces that are nearest to each other across the region at a point in it: the unit normal out of the one, the
/// point's distances from the one and from the other, m.
pub(super) fn across(edges: &Edges, p: &[f64; 2]) -> Option<([f64; 2], [f64; 2])> {
    let mut thinnest: Option<([f64; 2], [f64; 2])> = None;
    for edge in &edges.all {
        let [along, depth] = edge.coordinates(p);
        if depth < 0.0 || along < 0.0 || along > edge.length() {
            continue;
        }
        let normal = edge.normal();
        let Some(behind) = ray(edges, p, &normal.map(|c| -c)) else { continue };
        // What is seen of the side itself: another one may stand before it.
        let Some(before) = ray(edges, p, &normal) else { continue };
        let total = before + behind;
        if thinnest.is_none_or(|(_, [a, b])| total < a + b) {
            thinnest = Some((normal, [before, behind]));
        }
    }
    thinnest
}

/// Distance from a point to the first side along a unit vector, m.
fn ray(edges: &Edges, p: &[f64; 2], along: &[f64; 2]) -> Option<f64> {
    let across = [-along[1], along[0]];
    let hits = edges.all.iter().filter_map(|edge| {
        let at = |q: &[f64; 2]| {
            let from = [q[0] - p[0], q[1] - p[1]];
            [dot(&from, along), dot(&from, &across)]
        };
        let ([s, t], [u, v]) = (at(&edge.from), at(&edge.to));
        if (t <= 0.0) == (v <= 0.0) {
            return None;
        }
        Some(s + t / (t - v) * (u - s)).filter(|distance| *distance >= 0.0)
    });
    hits.min_by(f64::total_cmp)
}
