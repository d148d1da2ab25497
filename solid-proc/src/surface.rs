//! Which particles are near the surface in the reference configuration.

use halfstep_scene::geometry::{Cells, SolidPoint};

/// Numbers of the particles closer than `reach` to a surface particle, ascending. A surface particle lacks one of its
/// nearest lattice neighbours in its body (the 3^D - 1 within sqrt(D) dx). Every particle for plates thinner than twice
/// the reach.
pub(crate) fn surface_set<const D: usize>(
    points: &[SolidPoint<D>],
    body: &[u32],
    reach: f64,
    resolution: f64,
) -> Vec<u32> {
    // At a reach of whole spacings rounding would decide about particles where the kernel ends, at 0.
    let reach = reach * (1.0 - 1e-9);
    let mut surface: Cells<[f64; D], D> = Cells::new(reach);
    for (point, _) in points.iter().zip(outer(points, body, resolution)).filter(|(_, outer)| *outer) {
        surface.add(&point.position, point.position);
    }
    let is_near = |at: &[f64; D]| surface.around(at).any(|other| squared(at, other) <= reach * reach);
    (0..points.len() as u32).filter(|&p| is_near(&points[p as usize].position)).collect()
}

fn squared<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|d| (a[d] - b[d]).powi(2)).sum()
}

/// Whether each particle lacks one of the neighbours of its site on the lattice: it is of the outermost row.
pub(crate) fn outer<const D: usize>(points: &[SolidPoint<D>], body: &[u32], resolution: f64) -> Vec<bool> {
    let ring = (D as f64).sqrt() * 1.05 * resolution;
    let mut cells: Cells<usize, D> = Cells::new(ring);
    for (p, point) in points.iter().enumerate() {
        cells.add(&point.site, p);
    }
    let apart = |a: usize, b: usize| body.get(a).zip(body.get(b)).is_some_and(|(a, b)| a != b);
    let lacks = |(p, point): (usize, &SolidPoint<D>)| {
        let beside = cells
            .around(&point.site)
            .filter(|&&other| squared(&point.site, &points[other].site) <= ring * ring && !apart(p, other));
        beside.count() < 3_usize.pow(D as u32)
    };
    points.iter().enumerate().map(lacks).collect()
}
