//! Remarks on the fluid: what carries it, how fast it may become.

use super::shapes::place;
use halfstep_scene::geometry::{self, Cells, FluidPoint, Layout};
use halfstep_scene::{Geometry, Motion, Phase, Scene, Shape, expected_speed_of_fluid as fastest};
use halfstep_scene::{auto_sound_speed, expected_speed as scene_speed, viscosity};
use std::collections::HashMap;

/// Part of the sound speed that viscous stress asks for below which a scene is warned: there the stress is 0.006 of
/// rho c0².
const SOFTEST: f64 = 0.7;
/// Mach number above which the density error, about its square, exceeds 3 %.
const HIGHEST_MACH: f64 = 0.17;

/// Along which axis things fall, and which way; `None` without gravity.
pub(super) fn falls<const D: usize>(scene: &Scene) -> Option<(usize, f64)> {
    let axis = (0..D).max_by(|&a, &b| scene.gravity[a].abs().total_cmp(&scene.gravity[b].abs()))?;
    (scene.gravity[axis] != 0.0).then(|| (axis, scene.gravity[axis].signum()))
}

/// Fluid with nothing right below it.
pub(super) fn hanging<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some((axis, down)) = falls::<D>(scene) else { return };
    // What has a velocity is thrown.
    let rests = |shape: &Shape| shape.phase == Phase::Fluid && shape.velocity == [0.0; 3];
    let shapes = || scene.shapes.iter().enumerate().filter(|(_, shape)| rests(shape));
    let reach = 1.5 * scene.resolution;
    for (index, shape) in shapes() {
        let text = match &shape.geometry {
            Geometry::Box(_) => {
                let bare = bare_side(scene, layout, index, (axis, down));
                (bare > MOSTLY).then(|| match (100.0 * bare).round() {
                    100.0 => "nothing is right below it".to_owned(),
                    percent => format!("nothing is right below {percent:.0} % of its bottom"),
                })
            }
            _ => (!carried(layout, index, reach, others(layout, index), (axis, down)))
                .then(|| "nothing is right below it".to_owned()),
        };
        if let Some(text) = text {
            // Whoever writes this means the other way, mostly.
            let up = if axis == 1 && down > 0.0 { " up, as gravity points along +y" } else { "" };
            all.push(format!("`{}` hangs in the air: {text}, so it falls{up}", shape.name));
        }
    }
}

/// Part of the bottom of a box of fluid from which on it hangs.
const MOSTLY: f64 = 0.5;

/// Places of all that is not of a shape of fluid.
pub(super) fn others<const D: usize>(layout: &Layout<D>, shape: usize) -> impl Iterator<Item = &[f64; D]> {
    let fluid = layout.fluid.iter().filter(move |p| p.shape as usize != shape).map(|p| &p.position);
    let solid = layout.solid.iter().map(|p| &p.position);
    fluid.chain(solid).chain(layout.wall.iter().map(|p| &p.position))
}

/// Part of a box's outermost row along an axis, in the sense of `way`, 0 to 1, beyond which there is nothing. 0 of a
/// box without particles.
pub(super) fn bare_side<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    shape: usize,
    toward: (usize, f64),
) -> f64 {
    let dx = scene.resolution;
    let own = layout.fluid.iter().filter(|p| p.shape as usize == shape).map(|p| p.position);
    let row = outermost(own, toward, dx);
    let depths = depths_below(&row, others(layout, shape), toward, dx, 2.0 * dx);
    let bare = depths.into_iter().filter(Option::is_none).count();
    if row.is_empty() { 0.0 } else { bare as f64 / row.len() as f64 }
}

/// The places farthest along an axis, in the sense of `way`.
pub(super) fn outermost<const D: usize>(
    places: impl Iterator<Item = [f64; D]>,
    (axis, way): (usize, f64),
    dx: f64,
) -> Vec<[f64; D]> {
    let places: Vec<[f64; D]> = places.collect();
    let farthest = places.iter().map(|x| x[axis] * way).fold(f64::NEG_INFINITY, f64::max);
    places.into_iter().filter(|x| x[axis] * way > farthest - 0.5 * dx).collect()
}

/// How far below each place of a row the nearest of `others` is, m: `None` where none is within `most`.
pub(super) fn depths_below<'l, const D: usize>(
    row: &[[f64; D]],
    others: impl Iterator<Item = &'l [f64; D]>,
    (axis, down): (usize, f64),
    dx: f64,
    most: f64,
) -> Vec<Option<f64>> {
    let level = row.iter().map(|x| x[axis] * down).fold(f64::NEG_INFINITY, f64::max);
    // What is right below, whatever its depth.
    let column = |x: &[f64; D]| -> [f64; D] { std::array::from_fn(|a| if a == axis { 0.0 } else { x[a] }) };
    let mut below = Cells::new(dx);
    for x in others {
        let depth = x[axis] * down - level;
        if 0.1 * dx < depth && depth < most {
            below.add(&column(x), (*x, depth));
        }
    }
    let nearest = |p: &[f64; D]| {
        let beside = |x: &[f64; D]| (0..D).all(|a| a == axis || (x[a] - p[a]).abs() < 0.75 * dx);
        let at = column(p);
        let found = below.around(&at).filter(|(x, _)| beside(x));
        found.map(|(_, depth)| *depth).reduce(f64::min)
    };
    row.iter().map(nearest).collect()
}

/// Whether one of `others` is near a particle of a shape, and rather below it than beside it. True where it has none.
fn carried<'l, const D: usize>(
    layout: &'l Layout<D>,
    shape: usize,
    reach: f64,
    others: impl Iterator<Item = &'l [f64; D]>,
    (axis, down): (usize, f64),
) -> bool {
    let mut own = Cells::new(reach);
    let of_shape = layout.fluid.iter().filter(|p| p.shape as usize == shape);
    of_shape.for_each(|p| own.add(&p.position, p.position));
    let below = |x: &[f64; D], p: &[f64; D]| {
        let r2: f64 = (0..D).map(|a| (x[a] - p[a]).powi(2)).sum();
        let depth = (x[axis] - p[axis]) * down;
        r2 < reach * reach && depth > 0.0 && 2.0 * depth * depth > 1.1 * r2
    };
    let mut others = others;
    !layout.fluid.iter().any(|p| p.shape as usize == shape)
        || others.any(|x| own.around(x).any(|p| below(x, p)))
}

/// Fluid below which there is nothing at all, however deep: it is outside of what should hold it.
pub(super) fn outside<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some((axis, down)) = falls::<D>(scene) else { return };
    let dx = scene.resolution;
    // Columns of half the width dx, and how deep the lowest wall or solid in each lies.
    let column = |x: &[f64; D]| -> [i64; D] {
        std::array::from_fn(|a| if a == axis { 0 } else { (x[a] / (0.5 * dx)).round() as i64 })
    };
    let mut floors: HashMap<[i64; D], f64> = HashMap::new();
    let solid = layout.solid.iter().map(|p| &p.position);
    // Walls of a large basin that are nowhere below fluid are none of its floors.
    let Some(fluid) = geometry::around(geometry::fluid_boxes(scene)) else { return };
    let below =
        |x: &&[f64; D]| (0..D).all(|a| a == axis || (fluid.min[a] - dx <= x[a] && x[a] <= fluid.max[a] + dx));
    for x in layout.wall.iter().map(|p| &p.position).chain(solid).filter(below) {
        let depth = x[axis] * down;
        let lowest = floors.entry(column(x)).or_insert(depth);
        *lowest = lowest.max(depth);
    }
    let carried = |x: &[f64; D]| {
        let home = column(x);
        (0..3_usize.pow(D as u32)).any(|code| {
            let near: [i64; D] =
                std::array::from_fn(|a| home[a] + (code / 3_usize.pow(a as u32) % 3) as i64 - 1);
            floors.get(&near).is_some_and(|floor| *floor > x[axis] * down)
        })
    };
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.phase == Phase::Fluid) {
        let own = || layout.fluid.iter().filter(|p| p.shape as usize == index);
        let (count, mut astray) = (own().count(), own().filter(|p| !carried(&p.position)));
        let Some(first) = astray.next().map(|p| p.position) else { continue };
        let astray = 1 + astray.count();
        // What hangs altogether is remarked on as that.
        if astray < count {
            all.push(format!(
                "{astray} of {count} particles of `{}` have neither wall nor solid below them, however deep, and fall: \
                 the first is at {}",
                shape.name,
                place(&first)
            ));
        }
    }
}

/// Pressure that is missing under other fluid, over that of the own depth, from which on it is remarked.
const MISSING: f64 = 0.02;

/// Fluid that begins with the pressure of its own depth although other fluid stands on it.
pub(super) fn stacked<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let (Some((axis, down)), Some(fluid)) = (falls::<D>(scene), &scene.fluid) else { return };
    let reach = 1.5 * scene.resolution;
    let size = scene.gravity_magnitude();
    let mut cells = Cells::new(reach);
    layout.fluid.iter().for_each(|p| cells.add(&p.position, p));
    let top = |index: usize| {
        let around = geometry::bounding_box(&scene.shapes[index], scene);
        (-down * around.min[axis]).max(-down * around.max[axis])
    };
    let height = |index: usize| {
        let around = geometry::bounding_box(&scene.shapes[index], scene);
        around.max[axis] - around.min[axis]
    };
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.hydrostatic) {
        let own = layout.fluid.iter().filter(|p| p.shape as usize == index);
        let above = |p: &FluidPoint<D>| {
            let stands = |q: &&&FluidPoint<D>| {
                let r2: f64 = (0..D).map(|a| (q.position[a] - p.position[a]).powi(2)).sum();
                let up = (p.position[axis] - q.position[axis]) * down;
                q.shape != p.shape && r2 < reach * reach && up > 0.0 && up * up > 0.9 * r2
            };
            cells
                .around(&p.position)
                .filter(stands)
                .map(|q| q.shape as usize)
                .max_by(|&a, &b| top(a).total_cmp(&top(b)))
        };
        let highest = own.filter_map(above).max_by(|&a, &b| top(a).total_cmp(&top(b)));
        let Some(other) = highest else { continue };
        let missing = top(other) - top(index);
        if missing > MISSING * height(index) {
            all.push(format!(
                "`{}` begins with the pressure of its own depth, and `{}` stands on it: {:.0} Pa are missing (one \
                 shape, a polygon for instance, has the pressure of its whole depth)",
                shape.name,
                scene.shapes[other].name,
                fluid.density * size * missing
            ));
        }
    }
}

/// Falls that compress the fluid.
pub(super) fn expected_speed(scene: &Scene, all: &mut Vec<String>) {
    let Some(fluid) = &scene.fluid else { return };
    let fastest = fastest(scene);
    let mach = fastest / fluid.sound_speed;
    if mach > HIGHEST_MACH {
        all.push(format!(
            "the fluid can come to {fastest:.2} m/s, Mach {mach:.2}: it is compressed by about {:.0} %; \
             fluid.sound_speed = {:.0} keeps it below 1 %",
            100.0 * mach * mach,
            (10.0 * fastest).ceil()
        ));
    }
}

/// Viscous stress that compresses the fluid: what walls and shapes that move press out of corners.
pub(super) fn viscous_stress(scene: &Scene, all: &mut Vec<String>) {
    let Some(fluid) = scene.fluid.as_ref().filter(|_| viscosity(scene).on) else { return };
    let auto = auto_sound_speed(scene);
    if auto > 10.0 * scene_speed(scene) && fluid.sound_speed < SOFTEST * auto {
        all.push(format!(
            "viscous stress between neighbouring rows compresses the fluid: fluid.sound_speed = {} m/s, and {auto:.1} \
             keeps that below 0.3 %; fluid may be pressed out of corners",
            fluid.sound_speed as f32
        ));
    }
}

/// Part of its depth by which the water may differ from what a wave maker is meant for.
pub(super) const DEPTH: f64 = 0.05;

/// Depth of the water, m; `None` where there is none.
pub(super) fn depth(scene: &Scene) -> Option<f64> {
    geometry::around(geometry::fluid_boxes(scene)).map(|water| water.max[1] - water.min[1])
}

/// Wave makers for water of another depth.
pub(super) fn wave_makers(scene: &Scene, all: &mut Vec<String>) {
    let depth = depth(scene);
    for shape in &scene.shapes {
        let Some(makes) = shape.motion.as_ref().and_then(Motion::makes) else { continue };
        if let Some(end) = makes.end.filter(|end| *end > scene.end_time) {
            all.push(format!(
                "`{}` moves until {end:.3} s for its wave, and the run ends at {} s",
                shape.name, scene.end_time
            ));
        }
        let other = |d: &f64| (d - makes.depth).abs() > DEPTH * makes.depth + 0.5 * scene.resolution;
        if let Some(depth) = depth.filter(other) {
            all.push(format!(
                "`{}` makes waves for a depth of {} m, and the water is {} m deep: they have another height and length",
                shape.name, makes.depth as f32, depth as f32
            ));
        }
    }
}

/// Instants of a run at which walls are looked at.
pub(super) const INSTANTS: usize = 1000;
