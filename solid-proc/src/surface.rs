//! Which particles are near the surface in the reference configuration.

use halfstep_scene::geometry::SolidPoint;
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
    let body_at = |slot: usize| body.get(id[slot] as usize);
    let apart = |i: usize, j: usize| body_at(i).zip(body_at(j)).is_some_and(|(a, b)| a != b);
    let ring = (D as f64).sqrt() * 1.05 * resolution;
    let full = 3_usize.pow(D as u32);
    let mut surface = vec![false; id.len()];
    for i in 0..id.len() {
        let mut count = 0;
        within(i, ring, &mut |j| count += usize::from(!apart(i, j)));
        surface[i] = count < full;
    }
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
