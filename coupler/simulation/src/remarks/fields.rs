//! Remarks on initial velocity fields that do not fit the water, its walls or gravity.

use super::near;
use super::reached::{Matter, by_place};
use super::shapes::length;
use super::water::{DEPTH, bare_side, falls};
use halfstep_scene::geometry::{self, Cells, Layout};
use halfstep_scene::{Geometry, Lattice, Phase, Scene, Shape, VelocityField};

/// Part of its largest speed with which a field may run into a wall: that of a wall 6 % of a cell beside its place.
const INTO_WALLS: f64 = 0.2;

/// Fields of other walls, depths or gravity than the scene's.
pub(super) fn fields<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let gravity = scene.gravity_magnitude();
    for (index, shape) in scene.shapes.iter().enumerate() {
        let Some(field) = &shape.velocity_field else { continue };
        if matches!(field, VelocityField::StandingWave { .. }) && -scene.gravity[1] < gravity
            || field.fastest(gravity) == 0.0
        {
            all.push(format!(
                "the velocity field of `{}` is that of waves under gravity along -y, and gravity is {:?}",
                shape.name,
                &scene.gravity[..D]
            ));
            continue;
        }
        all.extend(other_depth(scene, shape, field));
        all.extend(into_walls(scene, layout, index, (field, gravity)));
    }
}

/// Depth below its shape's surface, in spacings, from which on what lies at a free surface begins under pressure.
const BELOW: f64 = 3.0;
/// Part of the particles at a shape's free surface that begin so.
const STEPPED: f64 = 0.1;

/// Water that begins under the pressure of a surface above its own: one shape with steps or a slope, or a turned one.
pub(super) fn steps<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let (Some(fluid), size) = (&scene.fluid, scene.gravity_magnitude()) else { return };
    if size == 0.0 || !scene.shapes.iter().any(|shape| shape.hydrostatic) {
        return;
    }
    let up: [f64; D] = std::array::from_fn(|a| -scene.gravity[a] / size);
    let (dx, matter) = (scene.resolution, Matter::with_solids(scene, layout));
    let water = by_place(dx, layout.fluid.iter().map(|p| p.position));
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.hydrostatic) {
        let (mut surface, mut low, mut deepest) = (0, 0, 0.0_f64);
        for p in layout.fluid.iter().filter(|p| p.shape as usize == index) {
            let above =
                |k: i32| -> [f64; D] { std::array::from_fn(|a| p.position[a] + f64::from(k) * dx * up[a]) };
            let covered = |x: &[f64; D]| matter.fill(x) || water.around(x).any(|at| near(at, x, 0.7 * dx));
            if (1..=3).any(|k| covered(&above(k))) {
                continue;
            }
            let depth = p.pressure / (fluid.density * size);
            surface += 1;
            low += usize::from(depth > BELOW * dx);
            deepest = deepest.max(depth);
        }
        if low > 0 && low as f64 > STEPPED * surface as f64 {
            all.push(format!(
                "`{}` begins with pressure at its free surface, up to that of {} m of water: `hydrostatic` counts from \
                 the highest point of a shape, and {:.0} % of its surface is lower (a shape for each level)",
                shape.name,
                length(deepest),
                100.0 * low as f64 / surface as f64
            ));
        }
    }
}

/// Rows of water from which on the pressure of its depth matters.
const ROWS: f64 = 5.0;
/// Part of a side of water that nothing holds, up to which it is held.
const OPEN: f64 = 0.1;

/// Water that is held on all sides, and begins without the pressure of its depth.
pub(super) fn unpressed<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let (Some((axis, way)), Some(fluid)) = (falls::<D>(scene), &scene.fluid) else { return };
    let (dx, gravity) = (scene.resolution, scene.gravity[axis].abs());
    let begins = |shape: &Shape| {
        shape.phase == Phase::Fluid
            && !shape.hydrostatic
            && shape.velocity_field.is_none()
            && shape.velocity == [0.0; 3]
    };
    let boxes = scene.shapes.iter().enumerate().filter(|(_, shape)| begins(shape));
    for (index, shape) in boxes {
        let Geometry::Box(block) = &shape.geometry else { continue };
        let depth = block.max[axis] - block.min[axis];
        if depth < ROWS * dx {
            continue;
        }
        let held = |toward: (usize, f64)| bare_side(scene, layout, index, toward) <= OPEN;
        let sides = (0..D).filter(|&a| a != axis).flat_map(|a| [(a, 1.0), (a, -1.0)]);
        if held((axis, way)) && sides.into_iter().all(held) {
            let speed = fluid.sound_speed;
            all.push(format!(
                "`{}` is held on all sides and begins without the pressure of its depth, {:.3e} Pa at the bottom: it \
                 falls by {} m and rings with a period of {:.2e} s, which pressures and forces show \
                 (`pressure = \"hydrostatic\"` begins at rest)",
                shape.name,
                fluid.density * gravity * depth,
                length(0.5 * gravity * depth * depth / (speed * speed)),
                4.0 * depth / speed
            ));
        }
    }
}

/// A standing wave of water of another depth.
fn other_depth(scene: &Scene, shape: &Shape, field: &VelocityField) -> Option<String> {
    let VelocityField::StandingWave { depth, origin, .. } = field else { return None };
    let level = geometry::bounding_box(shape, scene).max[1];
    let off = level - (origin[1] + depth);
    (off.abs() > DEPTH * depth + 0.5 * scene.resolution).then(|| {
        format!(
            "the standing wave of `{}` is that of a surface at y = {} m, {} m above its origin, and the water's is at \
             {} m: it has another frequency",
            shape.name,
            length(origin[1] + depth),
            length(*depth),
            length(level)
        )
    })
}

/// A field that has a velocity into a wall where that touches its fluid.
fn into_walls<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    index: usize,
    (field, gravity): (&VelocityField, f64),
) -> Option<String> {
    let reach = 1.1 * scene.resolution;
    let mut water = Cells::new(reach);
    let own = layout.fluid.iter().filter(|p| p.shape as usize == index);
    own.for_each(|p| water.add(&p.position, p.position));
    let surface = if scene.numerics.lattice == Lattice::Nodal { 0.0 } else { 0.5 * scene.resolution };
    let wet =
        layout.wall.iter().filter(|p| p.has_one_face() && scene.shapes[p.shape as usize].motion.is_none());
    let wet = wet.filter(|p| water.around(&p.position).any(|x| super::near(x, &p.position, reach)));
    let into = wet.map(|p| {
        let at = [0, 1].map(|a| p.position[a] + surface * p.normal[a]);
        let velocity = field.velocity(at, gravity);
        ((velocity[0] * p.normal[0] + velocity[1] * p.normal[1]).abs(), at, p.shape)
    });
    let (speed, [x, y], wall) = into.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (speed > INTO_WALLS * field.fastest(gravity)).then(|| {
        format!(
            "the velocity field of `{}` crosses `{}` at [{}, {}] with {} m/s: nothing crosses lines at multiples of \
             half_wave from its origin, and walls belong there",
            scene.shapes[index].name,
            scene.shapes[wall as usize].name,
            length(x),
            length(y),
            length(speed)
        )
    })
}
