//! Which particles are near the surface in the reference configuration.

use halfstep_scene::geometry::{Cells, SolidPoint};
use halfstep_sph::neighbours::{PADDING, Rows};

/// Numbers of the particles closer than `reach` to a surface particle, ascending. A surface particle lacks one of its
/// nearest lattice neighbours in its body (the 3^D - 1 within sqrt(D) dx). Every particle for plates thinner than twice
/// the reach.
pub(crate) fn surface_set<const D: usize>(
    points: &[SolidPoint<D>],
    body: &[u32],
    reach: f64,
    resolution: f64,
) -> Vec<u32> {
    let mut x: [Vec<f64>; D] = std::array::from_fn(|d| points.iter().map(|p| p.position[d]).collect());
    let mut id: Vec<u32> = (0..points.len() as u32).collect();
    let (low, high) = ([f64::MIN; D], [f64::MAX; D]);
    let mut rows = Rows::<D>::default();
    rows.sort(&x, &id, reach, low, high);
    for column in &mut x {
        rows.permute(column);
    }
    rows.permute_ids(&mut id);
    let within = |i: usize, radius: f64, visit: &mut dyn FnMut(usize)| {
        let at: [f64; D] = std::array::from_fn(|d| x[d][i]);
        rows.candidates(&x[0], at, at, radius, |first, end| {
            for j in first..end {
                let r2: f64 = (0..D).map(|d| (x[d][i] - x[d][j]).powi(2)).sum();
                if r2 <= radius * radius {
                    visit(j);
                }
            }
        });
    };
    let outer = outer(points, body, resolution);
    let surface: Vec<bool> = id.iter().map(|&p| outer.get(p as usize).is_none_or(|outer| *outer)).collect();
    // At a reach of whole spacings rounding would decide about particles where the kernel ends, at 0.
    let reach = reach * (1.0 - 1e-9);
    let mut set = Vec::new();
    for i in (0..id.len()).filter(|&i| id[i] != PADDING) {
        let mut near = false;
        within(i, reach, &mut |j| near |= surface[j]);
        if near {
            set.push(id[i]);
        }
    }
    set.sort_unstable();
    set
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
        let beside = cells.around(&point.site).filter(|&&other| {
            let r2: f64 = (0..D).map(|d| (point.site[d] - points[other].site[d]).powi(2)).sum();
            r2 <= ring * ring && !apart(p, other)
        });
        beside.count() < 3_usize.pow(D as u32)
    };
    points.iter().enumerate().map(lacks).collect()
}
