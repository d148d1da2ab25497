//! Remarks on what moves as prescribed into walls and solids that do not stop it.

use super::water::INSTANTS;
use super::{meet, overlap};
use halfstep_scene::{Block, Geometry, Phase, Scene, Shape, geometry};

/// What moves, with the boxes around it at the instants of the run.
pub(super) struct Mover<'s> {
    pub(super) shape: &'s Shape,
    way: Vec<Block>,
}

/// Walls and rigid bodies that move as prescribed and do not turn.
pub(super) fn movers(scene: &Scene) -> impl Iterator<Item = Mover<'_>> {
    let moves = move |shape: &&Shape| shape.phase == Phase::Wall || scene.is_rigid(shape);
    scene.shapes.iter().filter(moves).filter_map(|shape| Mover::of(scene, shape))
}

fn instant(scene: &Scene, k: usize) -> f64 {
    scene.end_time * k as f64 / INSTANTS as f64
}

impl<'s> Mover<'s> {
    fn of(scene: &Scene, shape: &'s Shape) -> Option<Self> {
        let motion = shape.motion.as_ref().filter(|motion| motion.pivot().is_none())?;
        let block = geometry::bounding_box(shape, scene);
        let at = |k: usize| {
            let (way, mut now) = (motion.at(instant(scene, k)).displacement, block);
            (0..3).for_each(|a| (now.min[a], now.max[a]) = (now.min[a] + way[a], now.max[a] + way[a]));
            now
        };
        Some(Self { shape, way: (0..=INSTANTS).map(at).collect() })
    }

    /// The first instant at which it is in what stays; `None` where it begins in it, never comes there, or through a
    /// slot.
    fn enters(&self, fixed: &Block, scene: &Scene) -> Option<usize> {
        let is_in = |now: &Block| overlap(now, fixed, scene) && !in_a_slot(now, fixed, scene);
        let first = self.way.iter().position(is_in)?;
        (first > 0).then_some(first)
    }

    /// The box that it fills throughout; `None` where there is none, or its shape is no box.
    pub(super) fn throughout(&self) -> Option<Block> {
        let Geometry::Box(_) = self.shape.geometry else { return None };
        let common = self.way.iter().copied().reduce(|a, b| common(&a, &b))?;
        (0..3).all(|a| common.min[a] <= common.max[a]).then_some(common)
    }
}

/// The box that two have in common: one whose least corner is beyond its largest where there is none.
fn common(a: &Block, b: &Block) -> Block {
    let [mut min, mut max] = [a.min, a.max];
    for k in 0..3 {
        (min[k], max[k]) = (min[k].max(b.min[k]), max[k].min(b.max[k]));
    }
    Block { min, max }
}

/// Whether a void is where two boxes meet, to half a spacing.
fn in_a_slot(a: &Block, b: &Block, scene: &Scene) -> bool {
    let both = common(a, b);
    let corner = |code: usize| [0, 1, 2].map(|k| if code >> k & 1 == 0 { both.min[k] } else { both.max[k] });
    let half = 0.5 * scene.resolution;
    scene
        .voids
        .iter()
        .any(|void| (0..8).all(|code| geometry::distance(&void.geometry, &corner(code)) <= half))
}

/// All that moves through what it cannot.
pub(super) fn passages(scene: &Scene, all: &mut Vec<String>) {
    for mover in movers(scene) {
        through_solids(scene, &mover, all);
        through_walls(scene, &mover, all);
    }
    into_each_other(scene, all);
}

/// Boxes that both move, and come into each other where fluid is.
fn into_each_other(scene: &Scene, all: &mut Vec<String>) {
    let boxes: Vec<Mover<'_>> =
        movers(scene).filter(|mover| matches!(mover.shape.geometry, Geometry::Box(_))).collect();
    let fluid = geometry::fluid_boxes(scene);
    for (k, one) in boxes.iter().enumerate() {
        for other in &boxes[k + 1..] {
            let at = |k: usize| (&one.way[k], &other.way[k]);
            let is_in = |k: &usize| {
                let (one, other) = at(*k);
                overlap(one, other, scene) && !in_a_slot(one, other, scene)
            };
            let Some(meets) = (0..=INSTANTS).find(is_in).filter(|meets| *meets > 0) else { continue };
            let wet = |k: usize| {
                let (one, other) = at(k);
                fluid.iter().any(|f| meet(one, f, scene) && meet(other, f, scene))
            };
            if (0..=meets).any(wet) {
                all.push(format!(
                    "`{}` and `{}` move into each other from about {:.3} s on: nothing stops what `motion` moves, and \
                     fluid between them is crushed",
                    one.shape.name,
                    other.shape.name,
                    instant(scene, meets)
                ));
            }
        }
    }
}

/// Walls that do not touch solids, through which they go.
fn through_solids(scene: &Scene, mover: &Mover<'_>, all: &mut Vec<String>) {
    let name = &mover.shape.name;
    if mover.shape.phase != Phase::Wall || mover.shape.contact {
        return;
    }
    for solid in scene.shapes.iter().filter(|s| s.phase == Phase::Solid && s.motion.is_none()) {
        let along = solid.clamp_with.iter().flatten().any(|with| with == name);
        let fixed = geometry::bounding_box(solid, scene);
        if let (false, Some(meets)) = (along, mover.enters(&fixed, scene)) {
            all.push(format!(
                "`{name}` goes through `{}` from about {:.3} s on: its `contact` is false, so it does not touch solids",
                solid.name,
                instant(scene, meets)
            ));
        }
    }
}

/// Walls at rest through which it goes where fluid is: what is dry may overlap.
fn through_walls(scene: &Scene, mover: &Mover<'_>, all: &mut Vec<String>) {
    let fluid = geometry::fluid_boxes(scene);
    let walls = scene.shapes.iter().filter(|s| s.phase == Phase::Wall && s.motion.is_none());
    for (what, fixed, tank) in walls.flat_map(|wall| parts(scene, wall)) {
        let Some(meets) = mover.enters(&fixed, scene) else { continue };
        let wet = |now: &Block| {
            fluid.iter().any(|f| {
                let between = meet(now, f, scene) && meet(&fixed, f, scene);
                between || (!tank && overlap(now, f, scene))
            })
        };
        if mover.way[..=meets].iter().any(wet) {
            let why = match mover.shape.phase {
                Phase::Wall => "walls do not stop each other",
                _ => "nothing stops what `motion` moves",
            };
            all.push(format!(
                "`{}` goes through {what} from about {:.3} s on: {why}, and fluid between them is crushed",
                mover.shape.name,
                instant(scene, meets)
            ));
        }
    }
}

/// Names of a tank's sides along each axis.
const SIDES: [[&str; 2]; 3] =
    [["the left wall", "the right wall"], ["the bottom", "the top"], ["the back wall", "the front wall"]];

/// A wall's boxes, each with what it is called and whether it is a tank's: of other walls what slides along them and
/// what meets them is not told apart.
fn parts(scene: &Scene, wall: &Shape) -> Vec<(String, Block, bool)> {
    match &wall.geometry {
        Geometry::Box(block) => vec![(format!("`{}`", wall.name), *block, false)],
        Geometry::Tank { cavity, open } => {
            let around = geometry::bounding_box(wall, scene);
            let side = |axis: usize, k: usize| {
                let (side, called) = (geometry::sides(axis)[k], SIDES[axis][k]);
                let mut block = around;
                match k {
                    0 => block.max[axis] = cavity.min[axis],
                    _ => block.min[axis] = cavity.max[axis],
                }
                (!open.contains(&side)).then(|| (format!("{called} of `{}`", wall.name), block, true))
            };
            (0..scene.dimension).flat_map(|axis| (0..2).filter_map(move |k| side(axis, k))).collect()
        }
        _ => Vec::new(),
    }
}
