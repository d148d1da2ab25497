//! Remarks on keys of solids that do nothing in their scene, or all that is done.

use super::shapes::length;
use halfstep_scene::geometry::Layout;
use halfstep_scene::{ModelKeys, PairContact, Scene, Solid};

/// Relaxation time over that of the run from which on an arm relaxes by less than a hundredth.
const NEVER: f64 = 100.0;
/// Relaxation time, over that in which a wave goes from particle to particle, below which an arm never bears.
const AT_ONCE: f64 = 0.1;

/// Maxwell arms of which none relaxes within the run, or all do before anything moves.
pub(super) fn arms(scene: &Scene, all: &mut Vec<String>) {
    for (index, solid) in scene.solids.iter().enumerate() {
        let ModelKeys::TotalLagrangian(keys) = &solid.model else { continue };
        let taus = || keys.prony.iter().map(|[_, tau]| *tau);
        let (shortest, longest) = (taus().fold(f64::INFINITY, f64::min), taus().fold(0.0, f64::max));
        let wave = scene.solid_spacing(index) / solid.pressure_wave_speed();
        if keys.prony.is_empty() {
            continue;
        }
        if shortest > NEVER * scene.end_time {
            let stiffer = 1.0 + keys.prony.iter().map(|[share, _]| share).sum::<f64>();
            all.push(format!(
                "the Maxwell arms of `{}` do not relax within the run: the shortest tau is {} s, and it ends at {} s. \
                 They make it {} times as stiff in shear, and damp nothing",
                solid.name,
                length(shortest),
                scene.end_time,
                length(stiffer)
            ));
        } else if longest < AT_ONCE * wave {
            all.push(format!(
                "the Maxwell arms of `{}` relax at once, and do nothing: the longest tau is {longest:e} s, and a wave \
                 needs {wave:.1e} s from one particle to the next",
                solid.name
            ));
        }
    }
}

/// Side friction over weight beyond which nothing slides, whatever water pushes: a plate that is a hundredth as thick
/// as the water is deep feels a hundred times its weight.
const STUCK: f64 = 1000.0;

/// Side friction that holds all.
pub(super) fn side_friction(scene: &Scene, all: &mut Vec<String>) {
    let gravity = scene.gravity_magnitude();
    let fluid = scene.fluid.as_ref().map_or(0.0, |fluid| fluid.density);
    let pushed = |k: usize| {
        let own = scene.shapes.iter().filter(move |shape| shape.solid == Some(k));
        own.into_iter().any(|s| s.load.is_some() || s.motion.is_some() || s.velocity != [0.0; 3])
    };
    for (_, solid) in scene.solids.iter().enumerate().filter(|(k, _)| !pushed(*k)) {
        let weight = solid.density.max(fluid) * gravity;
        if weight > 0.0 && solid.side_friction > STUCK * weight {
            all.push(format!(
                "side_friction = {:e} N/m³ of `{}` is {} times the weight of what is in the scene: nothing of it \
                 slides, and it neither moves nor bends",
                solid.side_friction,
                solid.name,
                length(solid.side_friction / weight)
            ));
        }
    }
}

/// How two solids touch that do not.
pub(super) fn untouched(scene: &Scene, all: &mut Vec<String>) {
    for contact in scene.pair_contacts.iter().filter(|contact| !contact.touch) {
        let plain = PairContact { touch: false, ..PairContact::unsaid(contact.solids) };
        let [a, b] = contact.solids.map(|k| -> &Solid { &scene.solids[k] });
        if *contact != plain {
            all.push(format!(
                "`{}` and `{}` do not touch (touch = false), and pass through each other: what else their [[contact]] \
                 says does nothing",
                a.name, b.name
            ));
        }
    }
}

/// Irregular arrangements of solids of which no particle lies off the lattice.
pub(super) fn arrangements<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (index, solid) in scene.solids.iter().enumerate() {
        if solid.irregular().is_some() && layout.off_lattice(scene, index) == 0 {
            all.push(format!(
                "arrangement = \"irregular\" of `{}` does nothing: two rows at the surface, beside clamps and beside \
                 cracks stay on the lattice, and it has no others",
                solid.name
            ));
        }
    }
}
