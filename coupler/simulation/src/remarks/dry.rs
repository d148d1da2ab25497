//! Remarks on probes of the fluid in walls, at rest and moving.

use super::curves::front_at;
use super::passages::movers;
use super::reached::{Matter, Places, reached};
use super::shapes::{length, place};
use super::walls::kernel_support;
use halfstep_scene::geometry::{self, Layout, cell};
use halfstep_scene::{Block, Phase, ProbeKind, Scene};
use halfstep_wire::narrow;

/// Distance from places that the fluid reaches, in spacings, up to which a point is at a wall's face, not in the wall.
const AT_FACE: f64 = 1.0;
/// Distance from a line at which a wall is right beside it, in spacings.
const RIGHT_BESIDE: f64 = 0.75;

/// Where the fluid can come in the box around all shapes; walls that move may leave any of their places.
struct Reach<'s, const D: usize> {
    scene: &'s Scene,
    places: Places<D>,
    around: Block,
}

impl<const D: usize> Reach<'_, D> {
    /// Whether a place that the fluid can come to, or one beside all shapes, is within a distance of a point.
    fn comes_within(&self, at: &[f64; D], distance: f64) -> bool {
        let dx = self.scene.resolution;
        let (home, far) = (cell(at, dx), (distance / dx).ceil() as i64);
        let side = 2 * far + 1;
        !geometry::holds(&self.around, at, 0.0)
            || (0..side.pow(D as u32)).any(|code| {
                let near: [i64; D] =
                    std::array::from_fn(|a| home[a] - far + code / side.pow(a as u32) % side);
                let away = |a: usize| ((near[a] as f64 + 0.5) * dx - at[a]).powi(2);
                (0..D).map(away).sum::<f64>() <= distance * distance && self.places.contains(&near)
            })
    }

    /// Whether it comes into the columns that a gauge looks at, below the top of all shapes.
    fn rises_at(&self, x: f64) -> bool {
        let dx = self.scene.resolution;
        let beside = |k: i64| ((k as f64 + 0.5) * dx - x).abs() <= 1.5 * dx;
        x < self.around.min[0] || x > self.around.max[0] || self.places.iter().any(|at| beside(at[0]))
    }

    /// Whether it can come beyond a place along x.
    fn goes_beyond(&self, x: f64) -> bool {
        let dx = self.scene.resolution;
        x + dx > self.around.max[0] || self.places.iter().any(|at| at[0] as f64 * dx > x + 0.5 * dx)
    }

    /// Whether a wall is right beside all of a line.
    fn walled(&self, from: &[f64; 3], to: &[f64; 3]) -> bool {
        let dx = self.scene.resolution;
        let [x, y] = [0, 1].map(|a| to[a] - from[a]);
        let normal = [y / x.hypot(y), -x / x.hypot(y), 0.0];
        geometry::along::<D>(self.scene, from, to).iter().all(|at| {
            [-RIGHT_BESIDE, RIGHT_BESIDE].into_iter().any(|side| {
                let beside: [f64; D] = std::array::from_fn(|a| at[a] + side * dx * normal[a]);
                geometry::holds(&self.around, &beside, 0.0) && !self.places.contains(&cell(&beside, dx))
            })
        })
    }
}

/// Probes in and at walls that stay, where no fluid comes.
pub(super) fn walled<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let stays = |shape: &Option<usize>| {
        shape.is_none_or(|k| scene.shapes[k].solid.is_none() && scene.shapes[k].motion.is_none())
    };
    let looks = |kind: &ProbeKind| match kind {
        ProbeKind::Pressure { shape, .. } => stays(shape),
        ProbeKind::Velocity { .. }
        | ProbeKind::WaterLevel { .. }
        | ProbeKind::Flux { .. }
        | ProbeKind::Front => true,
        _ => false,
    };
    let mut probes = scene.probes.iter().filter(|probe| looks(&probe.kind)).peekable();
    let boxes = scene.shapes.iter().map(|shape| geometry::bounding_box(shape, scene));
    let (Some(around), Some(_), false) = (geometry::around(boxes), probes.peek(), layout.fluid.is_empty())
    else {
        return;
    };
    let mut places = reached(scene, layout, &Matter::at_rest(scene, layout), true);
    // The last cells reach out of the box: over the rims of tanks.
    let dx = scene.resolution;
    places.retain(|k| geometry::holds(&around, &k.map(|k| (k as f64 + 0.5) * dx), 0.0));
    let reach = Reach { scene, places, around };
    let support = kernel_support(scene);
    let front = front_at(scene, layout);
    for probe in probes {
        let name = &probe.name;
        match &probe.kind {
            ProbeKind::Velocity { at } if !reach.comes_within(&narrow(*at), AT_FACE * scene.resolution) => {
                let measured = match reach.comes_within(&narrow(*at), support) {
                    true => format!("it measures the fluid beside the wall, up to 2h = {} m away", length(support)),
                    false => "no fluid comes near it, and it measures 0 throughout".to_owned(),
                };
                all.push(format!("the probe `{name}` at {} is in a wall: {measured}", place(&at[..D])));
            }
            ProbeKind::Pressure { at, to, .. } => {
                let ends = [Some(at), to.as_ref()];
                if !ends.into_iter().flatten().any(|at| reach.comes_within(&narrow(*at), support)) {
                    all.push(format!(
                        "the probe `{name}` at {} is in a wall: no fluid comes within 2h = {} m of it, and it measures \
                         0 throughout",
                        place(&at[..D]),
                        length(support)
                    ));
                }
            }
            ProbeKind::WaterLevel { x } => {
                for x in x.iter().filter(|x| !reach.rises_at(**x)) {
                    all.push(format!(
                        "the gauge `{name}` at x = {} m has walls alone below and above it: fluid comes there over \
                         their top at most",
                        length(*x)
                    ));
                }
            }
            ProbeKind::Front if !reach.goes_beyond(front) => all.push(format!(
                "the front `{name}` is {} m throughout: it is the farthest reach along +x, where the fluid begins at a \
                 wall",
                length(front)
            )),
            ProbeKind::Flux { from, to } if reach.walled(from, to) => all.push(format!(
                "the flux `{name}` is 0 throughout: a wall is beside all of its line, {} to {}, and nothing crosses it",
                place(&from[..D]),
                place(&to[..D])
            )),
            _ => (),
        }
    }
}

/// Probes of the fluid that a wall holds in itself wherever it moves.
pub(super) fn driven<const D: usize>(scene: &Scene, all: &mut Vec<String>) {
    let support = kernel_support(scene);
    let walls = movers(scene).filter(|mover| mover.shape.phase == Phase::Wall);
    for (mover, inside) in walls.filter_map(|mover| Some((mover.shape, mover.throughout()?))) {
        let deep = |at: &[f64; 3], by: f64| geometry::holds::<D>(&inside, &narrow(*at), -by);
        for probe in &scene.probes {
            let place = match &probe.kind {
                ProbeKind::Velocity { at } if deep(at, support) => {
                    format!("probe `{}` at {}", probe.name, place(&at[..D]))
                }
                ProbeKind::Pressure { at, to, shape: None }
                    if [Some(at), to.as_ref()].into_iter().flatten().all(|at| deep(at, support)) =>
                {
                    format!("probe `{}` at {}", probe.name, place(&at[..D]))
                }
                ProbeKind::WaterLevel { x } => {
                    let beside = scene.resolution;
                    let within = |x: &&f64| inside.min[0] + beside <= **x && **x <= inside.max[0] - beside;
                    let Some(x) = x.iter().find(within) else { continue };
                    format!("gauge `{}` at x = {} m", probe.name, length(*x))
                }
                _ => continue,
            };
            all.push(format!(
                "the {place} is in `{}` throughout, which moves: no fluid comes there",
                mover.name
            ));
        }
    }
}
