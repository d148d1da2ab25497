//! Remarks on probes of solids and of forces that measure nothing, or something else.

use super::near;
use super::reached::by_place;
use super::shapes::{length, place};
use super::walls::kernel_support;
use halfstep_scene::geometry::{self, Layout, SolidPoint};
use halfstep_scene::{Block, Probe, ProbeKind, Scene};

/// Distance from a solid's nearest particle from which on a point is not in the solid, in spacings of the solid. On the
/// corner of a cell it is 0.9, in the nodal lattice twice that.
const BESIDE: f64 = 2.0;
/// Distance up to which a place is that of a particle of the lattice, in spacings.
const ALIKE: f64 = 0.2;
/// What a clamp holds is not strained where it holds everything within so many spacings, or the kernel's support.
const HELD: f64 = 2.5;

/// Places of the particles whose forces a probe measures: of a shape, or of its solid.
pub(super) fn measured<'l, const D: usize>(
    scene: &'l Scene,
    layout: &'l Layout<D>,
    probe: &Probe,
    shape: Option<usize>,
) -> impl Iterator<Item = &'l [f64; D]> {
    let solid = probe.solid;
    let own = move |index: u32| match shape {
        Some(shape) => index as usize == shape,
        None => scene.shapes[index as usize].solid.is_some_and(|of| solid == Some(of)),
    };
    let of_solids = layout.solid.iter().filter(move |p| own(p.body)).map(|p| &p.position);
    of_solids.chain(layout.wall.iter().filter(move |p| own(p.shape)).map(|p| &p.position))
}

/// Probes of a force or moment in a box, with that box and the shape that they name.
fn boxes_of_forces(scene: &Scene) -> impl Iterator<Item = (&Probe, &Block, Option<usize>)> {
    scene.probes.iter().filter_map(|probe| match &probe.kind {
        ProbeKind::Force { within: Some(within), shape }
        | ProbeKind::Moment { within: Some(within), shape, .. } => Some((probe, within, *shape)),
        _ => None,
    })
}

/// Boxes of forces and moments that hold no particle.
pub(super) fn empty<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (probe, within, shape) in boxes_of_forces(scene) {
        let away = |x: &[f64; D]| {
            let beside = |a: usize| (within.min[a] - x[a]).max(x[a] - within.max[a]).max(0.0);
            (0..D).map(|a| beside(a).powi(2)).sum::<f64>()
        };
        let nearest = measured(scene, layout, probe, shape).min_by(|a, b| away(a).total_cmp(&away(b)));
        let Some(nearest) = nearest.filter(|x| !geometry::holds(within, x, 0.0)) else { continue };
        let of = match (shape, probe.solid) {
            (Some(shape), _) => &scene.shapes[shape].name,
            (None, solid) => &scene.solids[solid.unwrap_or(0)].name,
        };
        let Block { min, max } = within;
        all.push(format!(
            "the probe `{}` measures 0 throughout: its `within`, {} to {}, holds no particle of `{of}`, the nearest of \
             which is at {}",
            probe.name,
            place(&min[..D]),
            place(&max[..D]),
            place(nearest)
        ));
    }
}

/// Forces on what a clamp holds in a wall: of the fluid, of which there is hardly any, and no reaction.
pub(super) fn in_clamps<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (probe, within, shape) in boxes_of_forces(scene) {
        let of = |p: &&SolidPoint<D>| match shape {
            Some(shape) => p.body as usize == shape,
            None => probe.solid.is_some() && scene.shapes[p.body as usize].solid == probe.solid,
        };
        let own = || layout.solid.iter().filter(of).filter(|p| geometry::holds(within, &p.position, 0.0));
        if own().next().is_some() && own().all(|p| p.clamped) {
            all.push(format!(
                "the probe `{}` looks at particles that a clamp holds: it measures the force of the fluid on them, and \
                 not that of the clamp (which is what the fluid does to the whole, and inertia and weight)",
                probe.name
            ));
        }
    }
}

/// Part of the surface in a box behind which rows are left out, from which on it is remarked.
const MISSED: f64 = 0.5;

/// Boxes that hold a face, and not all rows behind it that feel the fluid before it.
pub(super) fn partial<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (probe, within, shape) in boxes_of_forces(scene) {
        let own: Vec<[f64; D]> = measured(scene, layout, probe, shape).copied().collect();
        let dx = match (shape, probe.solid) {
            (Some(shape), _) => scene.spacing(&scene.shapes[shape]),
            (None, solid) => scene.solid_spacing(solid.unwrap_or(0)),
        };
        let places = by_place(dx, own.iter().copied());
        let is_there = |x: &[f64; D]| places.around(x).any(|p| near(p, x, ALIKE * dx));
        // Rows of which fluid beyond the face is within 2h.
        let rows = ((kernel_support(scene) / dx - 1.0).ceil() as i32).max(1);
        let (mut faces, mut missed, mut held) = (0, 0, 1);
        for x in own.iter().filter(|x| geometry::holds(within, x, 0.0)) {
            let beside = |axis: usize, by: i32| -> [f64; D] {
                std::array::from_fn(|a| x[a] + if a == axis { f64::from(by) * dx } else { 0.0 })
            };
            for (axis, out) in (0..D).flat_map(|axis| [(axis, -1), (axis, 1)]) {
                if is_there(&beside(axis, out)) || !is_there(&beside(axis, -out)) {
                    continue;
                }
                faces += 1;
                let behind = (1..rows).map(|k| beside(axis, -out * k)).take_while(&is_there);
                let count = behind.clone().take_while(|x| geometry::holds(within, x, 0.0)).count();
                if count < behind.count() {
                    missed += 1;
                    held = held.max(count + 1);
                }
            }
        }
        if faces > 0 && f64::from(missed) > MISSED * f64::from(faces) {
            all.push(format!(
                "`within` of the probe `{}` holds {held} of the {rows} rows behind the surface that feel the fluid, \
                 within 2h of it: it measures a part of the force (a box that ends {} m behind the surface holds them \
                 all)",
                probe.name,
                length(f64::from(rows) * dx)
            ));
        }
    }
}

/// What a probe at a point measures of a solid.
pub(super) fn at_point(kind: &ProbeKind) -> Option<([f64; 3], &'static str)> {
    let what = match kind {
        ProbeKind::SolidVelocity { .. } => "velocity",
        ProbeKind::CauchyStress { .. } => "stress",
        _ => kind.name(),
    };
    Some((kind.point_of_solid()?, what))
}

/// What a probe at a point of a solid looks at.
pub(super) struct Site<const D: usize> {
    /// Index of the shape.
    pub(super) shape: usize,
    /// The particle nearest to the point, m.
    nearest: [f64; D],
    /// How far away that is where the point is not in the solid, m.
    pub(super) away: Option<f64>,
    /// Whether clamps that do not move hold what it looks at.
    pub(super) held: bool,
    /// The particle nearest to the point that they do not hold, m.
    free: Option<[f64; D]>,
}

/// Of a probe at a point of a solid.
pub(super) fn site<const D: usize>(scene: &Scene, layout: &Layout<D>, probe: &Probe) -> Option<Site<D>> {
    let ((at, what), solid) = (at_point(&probe.kind)?, probe.solid?);
    let at: [f64; D] = std::array::from_fn(|d| at[d]);
    let distance = |a: &[f64; D], b: &[f64; D]| (0..D).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt();
    let own: Vec<&SolidPoint<D>> =
        layout.solid.iter().filter(|p| scene.shapes[p.body as usize].solid == Some(solid)).collect();
    let near = geometry::nearest(own.iter().map(|p| p.position), at);
    let first = own[*near.first()?];
    let spacing = scene.spacing(&scene.shapes[first.body as usize]);
    // A strain is that of a neighbourhood.
    let reach = match what {
        "stress" | "strain" => spacing * HELD.max(2.0 * scene.solids[solid].smoothing_ratio),
        _ => 1e-9 * spacing,
    };
    let is_held = |p: &SolidPoint<D>| p.clamped && geometry::clamp_motion(scene, p).is_none();
    let looked_at =
        |p: &SolidPoint<D>| near.iter().any(|&k| distance(&own[k].position, &p.position) <= reach);
    let free = own.iter().filter(|p| !is_held(p)).map(|p| p.position);
    let away = distance(&at, &first.position);
    Some(Site {
        shape: first.body as usize,
        nearest: first.position,
        away: (away > BESIDE * spacing).then_some(away),
        held: own.iter().all(|p| is_held(p) || !looked_at(p)),
        free: free.min_by(|a, b| distance(a, &at).total_cmp(&distance(b, &at))),
    })
}

/// Points in clamps, and points beside their solid.
pub(super) fn points<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for probe in &scene.probes {
        let Some((at, what)) = at_point(&probe.kind) else { continue };
        let Some(Site { shape, nearest, away, held, free }) = site(scene, layout, probe) else { continue };
        let (name, shape) = (&probe.name, &scene.shapes[shape].name);
        if let Some(away) = away {
            all.push(format!(
                "the probe `{name}` at {} is beside `{shape}`: it measures the {what} of its nearest particle, at {}, \
                 {} m away",
                place(&at[..D]),
                place(&nearest),
                length(away)
            ));
        } else if held {
            let free =
                free.map_or(String::new(), |x| format!(" (the nearest that is free is at {})", place(&x)));
            let never = if what == "position" { "never changes" } else { "is 0 throughout" };
            all.push(format!(
                "the {what} of the probe `{name}` {never}: a clamp of `{shape}` holds what it looks at{free}"
            ));
        }
    }
}
