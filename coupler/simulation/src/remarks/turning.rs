//! Remarks on what turns as prescribed into walls and solids that do not stop it.

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

/// Walls and rigid bodies that turn, and are no tanks: what they come into.
pub(super) fn passages<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate() {
        let Some(motion) = shape.motion.as_ref().filter(|motion| motion.pivot().is_some()) else { continue };
        let own: Vec<[f64; D]> = match shape.phase {
            Phase::Wall if !matches!(shape.geometry, Geometry::Tank { .. }) => {
                layout.wall.iter().filter(|p| p.shape as usize == index).map(|p| p.position).collect()
            }
            Phase::Solid if is_rigid(scene, shape) => {
                layout.solid.iter().filter(|p| p.body as usize == index).map(|p| p.position).collect()
            }
            _ => continue,
        };
        let some: Vec<[f64; D]> = own.iter().step_by(own.len().div_ceil(FOLLOWED).max(1)).copied().collect();
        let instant = |k: usize| scene.end_time * k as f64 / INSTANTS as f64;
        for (other, fixed) in scene.shapes.iter().enumerate() {
            let why = match fixed.phase {
                _ if other == index || fixed.motion.is_some() || goes_along(fixed, shape) => continue,
                Phase::Wall if shape.phase == Phase::Wall => "walls do not stop each other",
                Phase::Wall => "nothing stops what `motion` moves",
                Phase::Solid if shape.phase == Phase::Wall && !shape.contact => {
                    "its `contact` is false, so it does not touch solids"
                }
                _ => continue,
            };
            let region = Regions::of(scene, |s| std::ptr::eq(s, fixed));
            let places = |k: usize| {
                let placement = motion.at(instant(k));
                some.iter().map(move |x| placement.position_of(*x))
            };
            let is_in = |k: &usize| places(*k).any(|x| region.hold(&x, -DEEP * scene.resolution));
            // What begins in another shape is another remark.
            let Some(meets) = (0..=INSTANTS).find(is_in).filter(|meets| *meets > 0) else { continue };
            if fixed.phase == Phase::Solid || is_wet(scene, layout, fixed, places(meets)) {
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

fn is_rigid(scene: &Scene, shape: &Shape) -> bool {
    shape.solid.is_some_and(|k| scene.solids[k].rigid().is_some())
}

/// Whether clamps of a solid move with a wall.
fn goes_along(solid: &Shape, wall: &Shape) -> bool {
    solid.clamp_with.iter().flatten().any(|with| *with == wall.name)
}

/// Whether fluid stands where one comes into the other: within the kernel's support, or between both.
fn is_wet<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    fixed: &Shape,
    places: impl Iterator<Item = [f64; D]>,
) -> bool {
    let reach = super::walls::kernel_support(scene);
    let block = geometry::bounding_box(fixed, scene);
    let meeting = |x: &[f64; D]| meet(&Block { min: wide(*x), max: wide(*x) }, &block, scene);
    let met: Vec<[f64; D]> = places.filter(meeting).collect();
    layout.fluid.iter().any(|p| met.iter().any(|x| near(x, &p.position, reach)))
}
