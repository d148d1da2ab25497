//! Where a clamp holds the material: at the face of its box, not at the last clamped particle's centre.
//!
//! Half a cell lies between the face and the nearest clamped particle; held there, a cantilever of length L swings like
//! one of length L + dx/2. So toward a free particle, clamped particles show a displacement that goes linearly through
//! zero at the face (as the velocity of a no-slip wall in Morris, Fox and Zhu 1997):
//!   u_ij = gain_i u_i,   gain_i = mean over clamped neighbours j of 1 / (part of the way from i to j before the face),
//! at most 2: the face is taken to be no nearer to i than half way. Beyond the face the body is rigid: clamped
//! particles carry no stress and no energy.

use halfstep_scene::geometry::SolidPoint;
use halfstep_scene::{Block, Scene};
use halfstep_sph::neighbours::ClusterList;

/// Most that the displacement of a free particle counts toward a clamped one.
const LARGEST_GAIN: f64 = 2.0;

/// gain - 1 at each slot; zero for clamped particles and those without clamped neighbours. `id` and `list` are the
/// reference configuration's; `body` has a number for each particle's body.
pub(super) fn excess_gain<const D: usize>(
    scene: &Scene,
    points: &[SolidPoint<D>],
    body: &[u32],
    id: &[u32],
    list: &ClusterList,
    reach: f64,
) -> Vec<f64> {
    let point = |slot: usize| points.get(id[slot] as usize);
    let excess = |slot: usize| -> Option<f64> {
        let i = point(slot).filter(|i| !i.clamped)?;
        let (mut sum, mut count) = (0.0, 0);
        let own = |j: &usize| body.get(id[*j] as usize) == body.get(id[slot] as usize);
        let near = list.of(slot).filter(own).filter_map(point);
        for j in near.filter(|j| j.clamped) {
            let r2: f64 = (0..D).map(|d| (i.position[d] - j.position[d]).powi(2)).sum();
            if r2 < reach * reach {
                let boxes = &scene.shapes[j.body as usize].clamp;
                let part = before_face(&i.position, &j.position, boxes).max(1.0 / LARGEST_GAIN);
                sum += 1.0 / part - 1.0;
                count += 1;
            }
        }
        (count > 0).then(|| sum / f64::from(count))
    };
    (0..id.len()).map(|slot| excess(slot).unwrap_or(0.0)).collect()
}

/// Part of the way from a free particle to a clamped one that lies before the first box which holds the latter.
fn before_face<const D: usize>(free: &[f64; D], clamped: &[f64; D], boxes: &[Block]) -> f64 {
    let parts = boxes.iter().filter_map(|block| {
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for d in 0..D {
            let way = clamped[d] - free[d];
            let [low, high] = [block.min[d] - free[d], block.max[d] - free[d]];
            if way == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (low / way, high / way);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        // A clamped particle may lie on the surface of its box.
        (enter <= leave && enter <= 1.0 + 1e-6 && leave >= 1.0 - 1e-6).then_some(enter)
    });
    parts.fold(1.0, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_to_the_face_by_hand() {
        let block = Block { min: [-1.0, 0.0, 0.0], max: [0.0, 1.0, 0.0] };
        let part = |free: [f64; 2], clamped: [f64; 2]| before_face(&free, &clamped, &[block]);
        // Half a spacing before and behind the face, straight and diagonal.
        assert_eq!(part([0.05, 0.55], [-0.05, 0.55]), 0.5);
        assert_eq!(part([0.05, 0.45], [-0.05, 0.55]), 0.5);
        // A clamped particle on the face: the whole way.
        assert_eq!(part([0.1, 0.5], [0.0, 0.5]), 1.0);
        // Three quarters of the way.
        assert!((part([0.075, 0.5], [-0.025, 0.5]) - 0.75).abs() < 1e-15);
        // A box that does not hold the clamped particle does not count.
        assert_eq!(part([0.05, 2.5], [-0.05, 2.5]), 1.0);
    }
}
