//! Remarks on numbers that are right and yet hardly meant.

use super::shapes::{length, place};
use super::{moving, units};
use halfstep_scene::{Block, Geometry, Motion, ProbeKind, Scene, Shape, WholeAngle, geometry};

/// Softer than any gel, stiffer than diamond, Pa.
pub(super) const STIFFNESS: [f64; 2] = [1e3, 2e12];
/// Lighter than aerogel, heavier than osmium, kg/m³.
pub(super) const DENSITY: [f64; 2] = [50.0, 25_000.0];
/// Less than a small moon's, more than that of a giant planet, m/s².
const GRAVITY: [f64; 2] = [0.1, 50.0];
/// Of fresh and salt water, kg/m³.
const WATER: [f64; 2] = [980.0, 1040.0];
/// Viscosity of water in mPa s (cP), from cold to warm.
const CENTIPOISE: [f64; 2] = [0.8, 1.4];
/// A hundred times that of water, Pa s.
const VISCOUS: f64 = 0.1;
/// Kinematic viscosities of water between 90 and 0 °C, m²/s: no liquid of its density has so few Pa s.
const KINEMATIC: [f64; 2] = [3e-7, 2e-6];
/// Smaller than a drop, larger than a tank, larger than a harbour, m.
const SIZE: [f64; 3] = [1e-3, 20.0, 1e3];
/// Part of the time in which a long wave crosses a basin as long as it is deep: no run of one beyond a tank's size is
/// shorter.
const GLIMPSE: f64 = 0.5;
/// Of a way over the size of the scene.
const FAR: f64 = 5.0;
/// Of an axis' distance over the size of the scene: beyond the arm of a pendulum or a centrifuge.
const REMOTE: f64 = 30.0;
/// Largest swing that is meant, rad: of what is hinged, and of a tank, which spills.
const SWING: [f64; 2] = [std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_4];

/// Materials that hardly exist.
pub(super) fn materials(scene: &Scene, all: &mut Vec<String>) {
    let mut check = |what: String, value: f64, [low, high]: [f64; 2], unit: &str| {
        if !(low..=high).contains(&value) {
            let word = if value < low { "little" } else { "much" };
            all.push(format!("{what} = {value} {unit} is very {word}: is the unit right?"));
        }
    };
    if let Some(fluid) = &scene.fluid {
        check("fluid.density".into(), fluid.density, DENSITY, "kg/m³");
    }
    for (k, solid) in scene.solids.iter().enumerate() {
        // Foam is meant where ballast goes with it.
        let heavy = |shape: &Shape| shape.density.is_some_and(|density| density >= DENSITY[0]);
        let ballasted = scene.shapes.iter().any(|shape| shape.solid == Some(k) && heavy(shape));
        if !ballasted || solid.density > DENSITY[1] {
            check(format!("{}.density", solid.name), solid.density, DENSITY, "kg/m³");
        }
        if solid.rigid().is_some() {
            continue;
        }
        check(format!("{}.youngs_modulus", solid.name), solid.youngs_modulus, STIFFNESS, "Pa");
    }
}

/// Gravity that is none of a planet's.
pub(super) fn gravity(scene: &Scene, all: &mut Vec<String>) {
    let size = scene.gravity_magnitude();
    if size > 0.0 && !(GRAVITY[0]..=GRAVITY[1]).contains(&size) {
        all.push(format!(
            "gravity is {} m/s², {} times that of the Earth: are the units metres and seconds?",
            size as f32,
            (size / 9.81) as f32
        ));
    }
}

/// Water that flows like oil, and a kinematic viscosity in Pa s; fluids alone have what a theory asks for.
pub(super) fn viscosity(scene: &Scene, all: &mut Vec<String>) {
    let water = |density| (WATER[0]..=WATER[1]).contains(&density);
    let Some(fluid) = scene.fluid.as_ref().filter(|fluid| water(fluid.density)) else { return };
    if (KINEMATIC[0]..=KINEMATIC[1]).contains(&fluid.viscosity) {
        all.push(format!(
            "fluid.viscosity = {:e} Pa s in a fluid of the density of water is the kinematic viscosity of water, in \
             m²/s: it has 0.001 Pa s",
            fluid.viscosity
        ));
    }
    let is_centipoise =
        scene.gravity_magnitude() > 0.0 && (CENTIPOISE[0]..=CENTIPOISE[1]).contains(&fluid.viscosity);
    if is_centipoise || fluid.viscosity > VISCOUS && !scene.solids.is_empty() {
        all.push(format!(
            "fluid.viscosity = {} Pa s in a fluid of the density of water, which has 0.001 Pa s: is the unit right?",
            fluid.viscosity
        ));
    }
}

/// The box around all shapes, and its longest side, m.
fn extent(scene: &Scene) -> Option<(Block, f64)> {
    let boxes = scene.shapes.iter().map(|shape| geometry::bounding_box(shape, scene));
    let around = geometry::around(boxes)?;
    Some((around, (0..scene.dimension).map(|a| around.max[a] - around.min[a]).fold(0.0, f64::max)))
}

/// How far an axis along z lies beside the scene, m, and the same over the scene's size, where that is hardly meant.
fn remote(scene: &Scene, axis: &[f64; 3]) -> Option<[f64; 2]> {
    let (around, extent) = extent(scene)?;
    let beside = |a: usize| (around.min[a] - axis[a]).max(axis[a] - around.max[a]).max(0.0);
    let away = beside(0).hypot(beside(1));
    (away > REMOTE * extent).then(|| [away, away / extent])
}

/// Axes far beside the scene: their units are hardly those meant.
pub(super) fn axes(scene: &Scene, all: &mut Vec<String>) {
    let mut said: Vec<[f64; 3]> = Vec::new();
    let moments = scene.probes.iter().filter_map(|probe| match probe.kind {
        ProbeKind::Moment { about, .. } => Some((format!("the probe `{}` takes moments", probe.name), about)),
        _ => None,
    });
    let turns = scene.shapes.iter().filter_map(|shape| {
        let pivot = shape.motion.as_ref()?.pivot()?;
        Some((format!("the motion of `{}` turns", shape.name), pivot))
    });
    for (what, axis) in turns.chain(moments) {
        if let Some([away, times]) = remote(scene, &axis).filter(|_| !said.contains(&axis)) {
            said.push(axis);
            all.push(format!(
                "{what} about {}, {} m beside the scene, {times:.0} times its size: lengths are in metres",
                place(&axis[..2]),
                length(away)
            ));
        }
    }
}

/// Copies and shifted shapes that turn about the one point that their motion says.
pub(super) fn pivots(scene: &Scene, all: &mut Vec<String>) {
    for shape in &scene.shapes {
        let (Geometry::Moved(moved), Some(pivot)) =
            (&shape.geometry, shape.motion.as_ref().and_then(Motion::pivot))
        else {
            continue;
        };
        if moved.count > 1 {
            all.push(format!(
                "all {} copies of `{}` turn about the one `pivot`, {}: `repeat` does not take it along (a shape for \
                 each has its own)",
                moved.count,
                shape.name,
                place(&pivot[..2])
            ));
            continue;
        }
        let beside = |geometry: &Geometry| geometry::distance(geometry, &pivot) > scene.resolution;
        if moved.translate != [0.0; 3] && !beside(&moved.geometry) && beside(&shape.geometry) {
            all.push(format!(
                "`{}` turns about {}, where it would be without `translate`: the `pivot` is a place of the scene, \
                 which `translate` does not take along",
                shape.name,
                place(&pivot[..2])
            ));
        }
    }
}

/// An angle beyond a limit, rad. Of a column in degrees more is said.
fn swings(what: &str, motion: &Motion, limit: f64, all: &mut Vec<String>) {
    let angle = motion.swings_by();
    if angle > limit && !units::has_degrees(motion) {
        all.push(format!(
            "{what} swings by {} rad, {:.0} degrees: angles are in radians",
            angle as f32,
            angle.to_degrees()
        ));
    }
}

/// Motions that swing further than a quarter of a turn, or lead far away: their units are hardly those meant.
pub(super) fn motions(scene: &Scene, all: &mut Vec<String>) {
    let Some((_, extent)) = extent(scene) else { return };
    if let Some(frame) = &scene.frame {
        swings("the `[frame]`", &frame.motion, SWING[1], all);
    }
    let tanks = moving::tanks(scene);
    for shape in &scene.shapes {
        let Some(motion) = &shape.motion else { continue };
        let is_tank = tanks.iter().any(|(tank, _)| tank.name == shape.name);
        swings(&format!("the motion of `{}`", shape.name), motion, SWING[usize::from(is_tank)], all);
        // What goes on at a rate goes away: a gate for instance.
        if motion.is_steady() {
            continue;
        }
        let reach = motion.reach(scene.end_time);
        let way = reach.iter().map(|(low, high)| high.max(-low)).fold(0.0, f64::max);
        if way > FAR * extent {
            all.push(format!(
                "the motion of `{}` leads {} m away, {:.0} times the size of the scene: lengths are in metres",
                shape.name,
                way as f32,
                way / extent
            ));
        }
    }
}

/// Parameters whose change would change nothing.
pub(super) fn parameters(scene: &Scene, all: &mut Vec<String>) {
    for name in &scene.doubtful.unused {
        all.push(format!("no key needs the parameter `{name}`: whatever its value, the scene is the same"));
    }
    for WholeAngle { key, call, angle, radians } in &scene.doubtful.whole_angles {
        all.push(format!(
            "`{call}` in {key} takes {radians} radians, {:.0} degrees: that of {radians} degrees is `{}(({angle}) * \
             pi / 180)`",
            radians.to_degrees(),
            &call[..3]
        ));
    }
    for [key, formula] in &scene.doubtful.radians {
        all.push(format!(
            "{key} is in degrees, and `{formula}` is in radians: in degrees it is `({formula}) * 180 / pi`"
        ));
    }
}

/// Scenes of a size that is hardly meant.
pub(super) fn lengths(scene: &Scene, all: &mut Vec<String>) {
    let boxes = scene.shapes.iter().map(|shape| match &shape.geometry {
        Geometry::Tank { cavity, .. } => *cavity,
        _ => geometry::bounding_box(shape, scene),
    });
    let extent = |b: Block| (0..scene.dimension).map(|a| b.max[a] - b.min[a]).fold(0.0, f64::max);
    let largest = boxes.map(extent).fold(0.0, f64::max);
    // A long wave needs sqrt(L / g) to cross a basin as long as it is deep: a run of a real one is longer.
    let gravity = scene.gravity_magnitude();
    let crossings = if gravity == 0.0 { 0.0 } else { scene.end_time / (largest / gravity).sqrt() };
    let [drop, tank, harbour] = SIZE;
    let large =
        largest > harbour && crossings < 1.0 || largest > tank && gravity > 0.0 && crossings < GLIMPSE;
    if largest > 0.0 && (largest < drop || large) {
        all.push(format!("the largest shape is {largest} m long: lengths are in metres"));
    }
}
