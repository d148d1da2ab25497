//! Remarks on what turns as prescribed into walls and solids that do not stop it, whether these move or not.

use super::water::INSTANTS;
use super::{meet, near};
use halfstep_scene::geometry::{self, Layout, Regions};
use halfstep_scene::{Block, Geometry, Phase, Scene, Shape};
use halfstep_wire::wide;

/// How deep a particle of it is in another shape when that is remarked, in spacings: what stands on a floor and turns
/// about its foot is in it by less.
const DEEP: f64 = 0.25;
/// Most particles of what turns that are followed.
const FOLLOWED: usize = 400;

/// What turns: what it comes into.
pub(super) fn passages<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate() {
        let Some(motion) = shape.motion.as_ref().filter(|_| turns(scene, shape)) else { continue };
        let of_walls = layout.wall.iter().filter(|p| p.shape as usize == index).map(|p| p.position);
        let of_solids = layout.solid.iter().filter(|p| p.body as usize == index).map(|p| p.position);
        let own: Vec<[f64; D]> = of_walls.chain(of_solids).collect();
        let some: Vec<[f64; D]> = own.iter().step_by(own.len().div_ceil(FOLLOWED).max(1)).copied().collect();
        let instant = |k: usize| scene.end_time * k as f64 / INSTANTS as f64;
        for (other, fixed) in scene.shapes.iter().enumerate() {
            let why = match fixed.phase {
                _ if other == index || goes_along(fixed, shape) => continue,
                // Of two that turn the first one is followed.
                _ if other < index && turns(scene, fixed) => continue,
                Phase::Wall if shape.phase == Phase::Wall => "walls do not stop each other",
                Phase::Wall => "nothing stops what `motion` moves",
                Phase::Solid if shape.phase == Phase::Wall && !shape.contact => {
                    "its `contact` is false, so it does not touch solids"
                }
                _ => continue,
            };
            let region = Regions::of(scene, |s| std::ptr::eq(s, fixed));
            let own = |k: usize| fixed.motion.as_ref().map(|motion| motion.at(instant(k)));
            let places = |k: usize| {
                let placement = motion.at(instant(k));
                some.iter().map(move |x| placement.position_of(*x))
            };
            let is_in = |k: usize, x: &[f64; D]| {
                let point = own(k).map_or(*x, |placement| placement.point_at(*x));
                region.hold(&point, -DEEP * scene.resolution)
            };
            // What begins in another shape is another remark.
            let meets = (0..=INSTANTS).find(|&k| places(k).any(|x| is_in(k, &x)));
            let Some(meets) = meets.filter(|meets| *meets > 0) else { continue };
            let wet = match &fixed.motion {
                None => is_wet(scene, layout, places(meets).filter(|x| is_beside(scene, fixed, x))),
                Some(_) => is_wet(scene, layout, places(meets).filter(|x| is_in(meets, x))),
            };
            if fixed.phase == Phase::Solid || wet {
                all.push(format!(
                    "`{}` turns into `{}` from about {:.3} s on: {why}",
                    shape.name,
                    fixed.name,
                    instant(meets)
                ));
            }
        }
    }
}

/// Whether it is a wall or a rigid body that turns, and no tank.
fn turns(scene: &Scene, shape: &Shape) -> bool {
    let followed = match shape.phase {
        Phase::Wall => !matches!(shape.geometry, Geometry::Tank { .. }),
        Phase::Solid => scene.is_rigid(shape),
        Phase::Fluid => false,
    };
    followed && shape.motion.as_ref().is_some_and(|motion| motion.pivot().is_some())
}

/// Whether clamps of a solid move with a wall.
fn goes_along(solid: &Shape, wall: &Shape) -> bool {
    solid.clamp_with.iter().flatten().any(|with| *with == wall.name)
}

fn is_beside<const D: usize>(scene: &Scene, fixed: &Shape, x: &[f64; D]) -> bool {
    let block = geometry::bounding_box(fixed, scene);
    meet(&Block { min: wide(*x), max: wide(*x) }, &block, scene)
}

/// Whether fluid stands at one of the places at the start: within the kernel's support.
fn is_wet<const D: usize>(scene: &Scene, layout: &Layout<D>, places: impl Iterator<Item = [f64; D]>) -> bool {
    let reach = super::walls::kernel_support(scene);
    let met: Vec<[f64; D]> = places.collect();
    layout.fluid.iter().any(|p| met.iter().any(|x| near(x, &p.position, reach)))
}
