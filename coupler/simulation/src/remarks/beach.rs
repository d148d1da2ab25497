//! Remarks on the beach that absorbs waves: whether it takes enough, and where it lies.

use super::makers::paddles;
use super::moving;
use super::shapes::length;
use super::water::depth;
use halfstep_scene::{Beach, ProbeKind, Scene, geometry};

/// Part of a wave's amplitude from which on a beach takes nothing.
const KEPT: f64 = 0.9;
/// Part of a wave's amplitude below which a gauge sees the beach rather than the waves.
const LEFT: f64 = 0.5;
/// Part of the beach's rate that is felt at a wave maker.
const FELT: f64 = 0.01;

/// How far waves that come to a place have gone through the beach, as a way through it where it is strongest, m.
fn passed(beach: &Beach, x: f64) -> f64 {
    let (long, way) = ((beach.to - beach.from).abs(), (x - beach.from) * (beach.to - beach.from).signum());
    if way <= 0.0 {
        0.0
    } else if way < long {
        way.powi(3) / (3.0 * long * long)
    } else {
        long / 3.0 + way - long
    }
}

/// How fast velocities decay at a place, 1/s.
fn decay(beach: &Beach, x: f64) -> f64 {
    beach.rate * ((x - beach.from) / (beach.to - beach.from)).clamp(0.0, 1.0).powi(2)
}

/// A beach that is where no water comes, where waves are made or measured, or takes next to nothing.
pub(super) fn beach(scene: &Scene, all: &mut Vec<String>) {
    let Some(beach) = scene.fluid.as_ref().and_then(|fluid| fluid.beach) else { return };
    let (Some(water), Some(depth)) = (geometry::around(geometry::fluid_boxes(scene)), depth(scene)) else {
        return;
    };
    let paddles = paddles(scene);
    // Water that falls comes to all of the scene.
    let boxes = scene.shapes.iter().map(|shape| geometry::bounding_box(shape, scene));
    let still = !paddles.is_empty();
    let Some(reached) = (if still { Some(water) } else { geometry::around(boxes) }) else { return };
    let end = if beach.from < beach.to { reached.max[0] } else { reached.min[0] };
    if passed(&beach, end) == 0.0 {
        let what = if still { "the water ends" } else { "all shapes end" };
        all.push(format!(
            "fluid.beach begins at x = {} m, and {what} at {} m: it absorbs nothing",
            length(beach.from),
            length(end)
        ));
        return;
    }
    for (paddle, around) in &paddles {
        let felt = decay(&beach, around.min[0]).min(decay(&beach, around.max[0]));
        if felt > FELT * beach.rate {
            all.push(format!(
                "fluid.beach acts at `{}`, which makes waves: velocities decay at {} 1/s there, since they decay from \
                 x = {} m (`from`) over {} m (`to`) to the end of the water",
                paddle.name,
                length(felt),
                length(beach.from),
                length(beach.to)
            ));
            return;
        }
    }
    if let Some((tank, _)) = moving::tanks(scene).first() {
        all.push(format!(
            "fluid.beach takes velocities in space toward zero, and `{}`, which holds the fluid, moves: the beach holds \
             back what the tank takes along (seen from a `[frame]` with this motion the tank rests)",
            tank.name
        ));
    }
    let speed = (scene.gravity[1].abs() * depth).sqrt();
    let kept = (-beach.rate * passed(&beach, end) / speed).exp();
    if kept > KEPT {
        all.push(format!(
            "the beach leaves long waves {kept:.2} of their amplitude, there and back: a larger fluid.beach.rate, or a \
             longer beach, takes more"
        ));
    }
    for probe in &scene.probes {
        let ProbeKind::WaterLevel { x } = &probe.kind else { continue };
        let left = |x: f64| (-0.5 * beach.rate * passed(&beach, x) / speed).exp();
        if let Some(x) = x.iter().copied().find(|x| left(*x) < LEFT) {
            all.push(format!(
                "the gauge `{}` at x = {} m is inside of the beach: long waves that come there have lost {:.0} % of \
                 their amplitude",
                probe.name,
                length(x),
                100.0 * (1.0 - left(x))
            ));
        }
    }
}
