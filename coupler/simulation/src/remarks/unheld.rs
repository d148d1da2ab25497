//! Remarks on bodies that nothing holds, where no wall does either.

use super::bodies::{names, on_spring};
use super::overlap;
use super::shapes::length;
use halfstep_scene::geometry::{self, Layout, Surface};
use halfstep_scene::{Body, Geometry, Phase, Scene, Shape};
use halfstep_wire::wide;

/// Solids that strain and begin in a wall: the clamp that roots them there was forgotten.
pub(super) fn sunk<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    bodies: &[Body],
    all: &mut Vec<String>,
) {
    let of_wall = |(_, wall)| (wall, geometry::bounding_box(wall, scene), Surface::new(&wall.geometry, None));
    let walls: Vec<_> = scene.walls_to_touch().map(of_wall).collect();
    let held = |index: usize| bodies.iter().any(|body| body.held && body.shapes.contains(&index));
    // A void makes room in a wall.
    let in_void =
        |at: &[f64; D]| scene.voids.iter().any(|void| geometry::distance(&void.geometry, &wide(*at)) == 0.0);
    for (index, shape) in scene.shapes.iter().enumerate() {
        if !strains(scene, shape) || held(index) {
            continue;
        }
        for (wall, around, surface) in &walls {
            let own = || layout.solid.iter().filter(|p| p.body as usize == index).map(|p| p.position);
            if !own().any(|at| geometry::holds(around, &at, 0.0)) {
                continue;
            }
            let mut deepest = 0.0_f64;
            for at in own().filter(|at| !in_void(at)) {
                surface.nearest(at, &mut |distance, _| deepest = deepest.max(-distance));
            }
            if deepest > 0.0 {
                let why = match shape.solid.is_some_and(|solid| scene.leaves_walls_to_coupler(solid)) {
                    true => "a wall does not hold what begins in it, which falls through or is thrown out",
                    false => "it stands loosely in a socket of the wall, which does not keep it from leaving",
                };
                all.push(format!(
                    "`{}` begins {} m deep in `{}`, and no clamp holds it: {why} (a box of `clamp` around that part \
                     roots it)",
                    shape.name,
                    length(deepest + 0.5 * scene.spacing(shape)),
                    wall.name
                ));
                break;
            }
        }
    }
}

/// Bodies at rest that have nothing below them, however deep, beside walls.
pub(super) fn beside_walls(scene: &Scene, bodies: &[Body], all: &mut Vec<String>) {
    let moved = |phase: Phase| scene.shapes.iter().any(|s| s.phase == phase && s.motion.is_some());
    let walls = scene.shapes.iter().any(|shape| shape.phase == Phase::Wall);
    let Some((axis, gravity)) = upright(scene).filter(|_| walls && scene.frame.is_none()) else { return };
    if moved(Phase::Wall) || moved(Phase::Solid) {
        return;
    }
    // A tank's walls have no end toward rigid bodies.
    let tank =
        scene.walls_to_touch().any(|(_, wall)| matches!(wall.geometry.unmoved(), Geometry::Tank { .. }));
    let endless = |body: &Body| tank && !strains(scene, &scene.shapes[body.shapes[0]]);
    let box_of = |k: usize| geometry::bounding_box(&scene.shapes[k], scene);
    for body in bodies.iter().filter(|body| !body.held && !on_spring(scene, body) && !endless(body)) {
        let thrown = body.shapes.iter().any(|&k| scene.shapes[k].velocity != [0.0; 3]);
        let Some(own) = geometry::around(body.shapes.iter().map(|&k| box_of(k))).filter(|_| !thrown) else {
            continue;
        };
        // From the body on down without end.
        let mut column = own;
        match gravity < 0.0 {
            true => column.min[axis] = f64::NEG_INFINITY,
            false => column.max[axis] = f64::INFINITY,
        }
        let mut others = (0..scene.shapes.len()).filter(|k| !body.shapes.contains(k));
        let carried = others.any(|k| overlap(&column, &box_of(k), scene));
        let text = format!(
            "nothing is below {}, however deep: beside all walls it falls by {} m until {} s under gravity",
            names(scene, body),
            length(0.5 * gravity.abs() * scene.end_time.powi(2)),
            scene.end_time
        );
        if !carried && !all.contains(&text) {
            all.push(text);
        }
    }
}

/// A shape of a solid that is not rigid.
fn strains(scene: &Scene, shape: &Shape) -> bool {
    shape.solid.is_some_and(|k| scene.solids[k].rigid().is_none())
}

/// The axis along which gravity acts, and gravity, m/s²; `None` where it is zero or oblique.
fn upright(scene: &Scene) -> Option<(usize, f64)> {
    let mut axes = (0..scene.dimension).filter(|&a| scene.gravity[a] != 0.0);
    let axis = axes.next()?;
    axes.next().is_none().then_some((axis, scene.gravity[axis]))
}
