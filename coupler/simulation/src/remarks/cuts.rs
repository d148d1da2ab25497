//! What voids leave of a solid: how thick it is beside them, as asked and as computed.

use super::shapes::{NOTABLE, length, place};
use halfstep_scene::{Block, Geometry, Phase, Scene, Shape};

/// What is left of a solid beside a void along a line.
#[derive(Clone, Copy)]
struct Left {
    /// Thickness, asked and computed, m.
    thick: [f64; 2],
    at: [f64; 2],
}

/// Boxes of solids in the plane whose narrowest part beside a void, or an arm, has another thickness than asked for.
pub(super) fn cuts<const D: usize>(scene: &Scene, all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate() {
        let rigid = shape.solid.is_some_and(|k| scene.solids[k].rigid().is_some());
        let Geometry::Box(block) = &shape.geometry else { continue };
        if shape.phase != Phase::Solid || rigid || shape.lattice_angle != 0.0 || D != 2 {
            continue;
        }
        let voids = scene.voids.iter().filter(|void| void.before <= index).map(|void| &void.geometry);
        let voids: Vec<&Geometry> = voids.collect();
        let both = [(0, 1), (1, 0)].map(|axes| worst(scene, shape, block, &voids, axes));
        for Left { thick: [asked, computed], at } in both.into_iter().flatten() {
            let factor = computed / asked;
            if (factor - 1.0).abs() >= NOTABLE {
                all.push(format!(
                    "`{}` is {} m thick at {} beside a void in the scene and {} m of whole rows as computed: {:.2} \
                     times the bending stiffness (its spacing is {})",
                    shape.name,
                    length(asked),
                    place(&at),
                    length(computed),
                    factor.powi(3),
                    length(scene.spacing(shape))
                ));
            }
        }
    }
}

/// Lines on which a part is as thick as on the others: an arm is straight.
const STRAIGHT: usize = 3;

/// Of the thinnest part that voids leave of a box along an axis and of straight ones, the one that differs most; none
/// that is thicker than half of the box.
fn worst(
    scene: &Scene,
    shape: &Shape,
    block: &Block,
    voids: &[&Geometry],
    (along, across): (usize, usize),
) -> Option<Left> {
    let dx = scene.spacing(shape);
    let count = |a: usize| ((block.max[a] - block.min[a]) / dx).round() as usize;
    let row = |a: usize, k: usize| block.min[a] + (k as f64 + 0.5) * dx;
    let mut all: Vec<Left> = Vec::new();
    for at in (0..count(across)).map(|k| row(across, k)) {
        let mut holes: Vec<[f64; 2]> =
            voids.iter().flat_map(|void| openings(void, along, across, at)).collect();
        holes.retain(|hole| hole[1] > block.min[along] && hole[0] < block.max[along]);
        holes.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let ends = holes.iter().scan(block.min[along], |last, hole| {
            let from = std::mem::replace(last, last.max(hole[1]));
            Some([from, hole[0]])
        });
        let last = holes.iter().map(|hole| hole[1]).reduce(f64::max).map(|end| [end, block.max[along]]);
        for [a, b] in ends.chain(last) {
            let asked = b - a;
            let inside = |k: &usize| a < row(along, *k) && row(along, *k) < b;
            let thick = [asked, (0..count(along)).filter(inside).count() as f64 * dx];
            if asked > 1e-6 * dx && asked < 0.5 * (block.max[along] - block.min[along]) {
                let mut place = [at; 2];
                place[along] = 0.5 * (a + b);
                all.push(Left { thick, at: place });
            }
        }
    }
    all.sort_by(|a, b| a.thick[0].total_cmp(&b.thick[0]));
    let alike = all.chunk_by(|one, other| other.thick[0] - one.thick[0] < 1e-6 * dx);
    let counts = alike.enumerate().filter(|(k, lines)| *k == 0 || lines.len() >= STRAIGHT);
    let off = |left: &Left| (left.thick[1] / left.thick[0] - 1.0).abs();
    let most = counts.flat_map(|(_, lines)| lines).reduce(|a, b| if off(b) > off(a) + 1e-9 { b } else { a });
    most.copied()
}

/// Where a box or a disc that is not turned crosses a line along an axis, m.
fn openings(void: &Geometry, along: usize, across: usize, at: f64) -> Vec<[f64; 2]> {
    match void {
        Geometry::Box(b) if b.min[across] < at && at < b.max[across] => vec![[b.min[along], b.max[along]]],
        Geometry::Disc { center, radius } if (at - center[across]).abs() < *radius => {
            let half = (radius * radius - (at - center[across]).powi(2)).sqrt();
            vec![[center[along] - half, center[along] + half]]
        }
        Geometry::Moved(moved) if moved.angle == 0.0 => {
            let way = |copy: u32, axis: usize| moved.translate[axis] + f64::from(copy) * moved.step[axis];
            let of = |copy: u32| {
                openings(&moved.geometry, along, across, at - way(copy, across))
                    .into_iter()
                    .map(move |ends| ends.map(|x| x + way(copy, along)))
                    .collect::<Vec<_>>()
            };
            moved.copies().flat_map(of).collect()
        }
        _ => Vec::new(),
    }
}
