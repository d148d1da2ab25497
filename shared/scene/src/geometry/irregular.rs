//! Irregular arrangements of solid particles: where there are no rows, a crack goes where the stress drives it.
//!
//! The places of the lattice are shifted at random and then push one another apart, as shifted particles do (Lind, Xu,
//! Stansby and Rogers 2012), until they are about as far apart as before. The two rows at the surface, beside clamps
//! and beside cracks stay: the outline, what a clamp holds and the faces of a notch are those of the lattice.

use super::crossing::Cracks;
use super::{Cells, Layout, SolidPoint, pieces, solid_point};
use crate::{Phase, Scene};
use std::collections::BTreeMap;
use xxhash_rust::xxh3::xxh3_64_with_seed;

/// Largest shift along each axis, in spacings.
const SHIFT: f64 = 0.45;
/// How often the places push one another.
const ROUNDS: usize = 100;
/// How far they push, in spacings: the support of the model's kernel, in which each needs others on all sides.
const REACH: f64 = 1.5;
/// By how much one place pushes another that is as good as where it is, in spacings.
const PUSH: f64 = 0.2;

/// A layout with the particles of the solids whose arrangement is irregular where they belong.
pub(super) fn rearranged<const D: usize>(scene: &Scene, mut layout: Layout<D>) -> Layout<D> {
    let Some(moving) = Moving::of(scene, &layout) else { return layout };
    let mut places: Vec<[f64; D]> = layout.solid.iter().map(|p| p.position).collect();
    for (&i, &seed) in &moving.seeds {
        let (place, spacing) = (&mut places[i], moving.spacing[i]);
        for (axis, x) in place.iter_mut().enumerate() {
            *x += SHIFT * spacing * (2.0 * random(seed, i, axis) - 1.0);
        }
    }
    for _ in 0..ROUNDS {
        let pushed: Vec<[f64; D]> = moving.seeds.keys().map(|&i| moving.pushed(&places, i)).collect();
        for (&i, to) in moving.seeds.keys().zip(pushed) {
            places[i] = to;
        }
    }
    for &i in moving.seeds.keys() {
        let SolidPoint { body, copy, .. } = layout.solid[i];
        // With the velocity that the scene has there.
        layout.solid[i] = solid_point(scene, &scene.shapes[body as usize], [body, copy], places[i]);
    }
    layout
}

/// How many particles of each solid of a scene lie off the lattice; `None` where its arrangement is not irregular.
pub fn off_lattice<const D: usize>(scene: &Scene) -> Vec<Option<usize>> {
    let layout = super::on_lattices::<D>(scene, &[Phase::Solid]);
    let moving = Moving::of(scene, &layout);
    let solids: Vec<Option<usize>> = moving.map_or(Vec::new(), |moving| {
        moving.seeds.keys().map(|&i| scene.shapes[layout.solid[i].body as usize].solid).collect()
    });
    let count = |k: usize| solids.iter().filter(|solid| **solid == Some(k)).count();
    scene.solids.iter().enumerate().map(|(k, solid)| solid.irregular().map(|_| count(k))).collect()
}

/// A number from 0 to 1, the same on every machine: half of a hash's bits, which a float holds exactly.
fn random(seed: u32, particle: usize, axis: usize) -> f64 {
    let key = [(particle as u64).to_le_bytes(), (axis as u64).to_le_bytes()].concat();
    (xxh3_64_with_seed(&key, u64::from(seed)) >> 32) as f64 / f64::from(u32::MAX)
}

/// The particles that move, and what pushes them.
struct Moving {
    /// Particles that move, with the seeds of their solids.
    seeds: BTreeMap<usize, u32>,
    /// Of each particle, m.
    spacing: Vec<f64>,
    /// Those of each particle's piece that can come within reach of it.
    near: Vec<Vec<u32>>,
}

impl Moving {
    /// `None` where no solid asks for it.
    fn of<const D: usize>(scene: &Scene, layout: &Layout<D>) -> Option<Self> {
        let shape = |p: &SolidPoint<D>| &scene.shapes[p.body as usize];
        let seed = |p: &SolidPoint<D>| shape(p).solid.and_then(|k| scene.solids.get(k)?.irregular());
        if !layout.solid.iter().any(|p| seed(p).is_some()) {
            return None;
        }
        let spacing: Vec<f64> = layout.solid.iter().map(|p| scene.spacing(shape(p))).collect();
        let near = near(layout, &spacing, &pieces(scene, layout));
        let free = free(scene, layout, &spacing, &near);
        let seeds = layout.solid.iter().zip(free).enumerate();
        let seeds = seeds.filter(|(_, (_, free))| *free).filter_map(|(i, (p, _))| Some((i, seed(p)?)));
        Some(Self { seeds: seeds.collect(), spacing, near })
    }

    /// Where others push a particle to.
    fn pushed<const D: usize>(&self, places: &[[f64; D]], i: usize) -> [f64; D] {
        let reach = REACH * self.spacing[i];
        let mut to = places[i];
        for &j in &self.near[i] {
            let from: [f64; D] = std::array::from_fn(|a| places[i][a] - places[j as usize][a]);
            let r = length(&from);
            if r > 0.0 && r < reach {
                let part = 1.0 - r / reach;
                for a in 0..D {
                    to[a] += PUSH * self.spacing[i] * part * part * from[a] / r;
                }
            }
        }
        to
    }
}

fn length<const D: usize>(way: &[f64; D]) -> f64 {
    way.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Distance of two particles, m.
fn apart<const D: usize>(layout: &Layout<D>, i: usize, j: usize) -> f64 {
    length(&std::array::from_fn::<f64, D, _>(|a| layout.solid[i].position[a] - layout.solid[j].position[a]))
}

/// For each particle those of its piece that can come within reach of it, in their order.
fn near<const D: usize>(layout: &Layout<D>, spacing: &[f64], piece: &[u32]) -> Vec<Vec<u32>> {
    // Each of two moves by a spacing at most.
    let far = REACH + 2.0;
    let widest = spacing.iter().copied().fold(0.0, f64::max);
    let mut cells: Cells<u32, D> = Cells::new(far * widest);
    for (i, point) in layout.solid.iter().enumerate() {
        cells.add(&point.position, i as u32);
    }
    let of = |i: usize| {
        let is_near = |j: usize| j != i && piece[j] == piece[i] && apart(layout, i, j) < far * spacing[i];
        let around = cells.around(&layout.solid[i].position).copied();
        let mut near: Vec<u32> = around.filter(|j| is_near(*j as usize)).collect();
        near.sort_unstable();
        near
    };
    (0..layout.solid.len()).map(of).collect()
}

/// Which particles may move: those in the third row below the surface and deeper, and as far from clamps and cracks.
fn free<const D: usize>(scene: &Scene, layout: &Layout<D>, spacing: &[f64], near: &[Vec<u32>]) -> Vec<bool> {
    let cracks = Cracks::of(scene);
    let whole = 3_usize.pow(D as u32) - 1;
    let beside = |i: usize| {
        // Between the diagonal of a cell and two spacings.
        let reach = 1.1 * (D as f64).sqrt() * spacing[i];
        near[i].iter().map(|j| *j as usize).filter(move |&j| apart(layout, i, j) < reach)
    };
    let inside = |i: usize| {
        let point = &layout.solid[i];
        let is_there = |j: &usize| !layout.solid[*j].clamped && !cracks.part(point, &layout.solid[*j]);
        !point.clamped && beside(i).filter(is_there).count() == whole
    };
    let inside: Vec<bool> = (0..layout.solid.len()).map(inside).collect();
    (0..inside.len()).map(|i| inside[i] && beside(i).all(|j| inside[j])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse;

    fn block(more: &str, shape: &str) -> Layout<2> {
        let text = format!(
            "resolution = 0.1\nend_time = 1.0\n[solid]\ndensity = 1000.0\nyoungs_modulus = 1e6\n\
             poissons_ratio = 0.3\n{more}\n[[shape]]\nname = \"block\"\nphase = \"solid\"\n\
             box = {{ min = [0.0, 0.0], max = [2.0, 2.0] }}\n{shape}\n"
        );
        let scene = parse(&text, "test.toml".as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        super::super::layout(&scene)
    }

    const IRREGULAR: &str = "arrangement = \"irregular\"";

    fn moved(one: &Layout<2>, other: &Layout<2>) -> usize {
        assert_eq!(one.solid.len(), other.solid.len());
        one.solid.iter().zip(&other.solid).filter(|(a, b)| a.position != b.position).count()
    }

    #[test]
    fn two_rows_at_the_surface_stay() {
        let (lattice, irregular) = (block("", ""), block(IRREGULAR, ""));
        // 20 by 20 particles, of which 16 by 16 are deeper.
        assert_eq!(moved(&lattice, &irregular), 16 * 16);
        for (a, b) in lattice.solid.iter().zip(&irregular.solid) {
            let deep = a.position.iter().all(|x| (0.2..1.8).contains(x));
            assert_eq!(a.position != b.position, deep, "{:?}", a.position);
        }
    }

    #[test]
    fn particles_beside_clamps_and_cracks_stay() {
        let clamp = "clamp = { min = [0.0, 0.0], max = [0.5, 2.0] }";
        // The first five columns are clamped, two more stay: 11 by 16 are left.
        assert_eq!(moved(&block("", clamp), &block(IRREGULAR, clamp)), 11 * 16);
        let crack = "crack = [[-0.1, 1.0], [1.0, 1.0]]";
        // Columns up to the tip's lose two rows on both sides, and so does the next: its corners look across. One more
        // has these for neighbours.
        assert_eq!(moved(&block("", crack), &block(IRREGULAR, crack)), 16 * 16 - 4 * (8 + 1) - 4);
    }

    #[test]
    fn places_are_even_and_hang_on_the_seed_alone() {
        let one = block(IRREGULAR, "");
        assert_eq!(one, block(IRREGULAR, ""));
        let other = block("arrangement = \"irregular\"\narrangement_seed = 2", "");
        assert_eq!(moved(&one, &other), 16 * 16);
        for layout in [&one, &other] {
            let n = layout.solid.len();
            let nearest = |i: usize| {
                (0..n).filter(|j| *j != i).map(|j| apart(layout, i, j)).fold(f64::INFINITY, f64::min)
            };
            let least = (0..n).map(nearest).fold(f64::INFINITY, f64::min);
            assert!(least > 0.075, "no two are closer than three quarters of a spacing: {least}");
        }
    }

    #[test]
    fn no_row_of_the_lattice_is_left() {
        // Of directions to neighbours within 1.35 spacings, the mean of exp(4 i angle): 1 on the lattice, whose
        // diagonals are farther.
        let order = |layout: &Layout<2>| {
            let deep = |p: &SolidPoint<2>| p.position.iter().all(|x| (0.4..1.6).contains(x));
            let (mut sum, mut count) = ([0.0; 2], 0.0);
            for i in (0..layout.solid.len()).filter(|i| deep(&layout.solid[*i])) {
                for j in (0..layout.solid.len()).filter(|j| *j != i && apart(layout, i, *j) < 0.135) {
                    let [a, b] = [i, j].map(|k| layout.solid[k].position);
                    let angle = 4.0 * (a[1] - b[1]).atan2(a[0] - b[0]);
                    sum = [sum[0] + angle.cos(), sum[1] + angle.sin()];
                    count += 1.0;
                }
            }
            length(&sum) / count
        };
        assert!((order(&block("", "")) - 1.0).abs() < 1e-9);
        let irregular = order(&block(IRREGULAR, ""));
        assert!(irregular < 0.4, "{irregular}");
    }

    #[test]
    fn a_thin_plate_has_no_row_that_could_move() {
        let plate = |rows: u32| {
            let text = format!(
                "resolution = 0.1\nend_time = 1.0\n[solid]\ndensity = 1000.0\nyoungs_modulus = 1e6\n\
                 poissons_ratio = 0.3\n{IRREGULAR}\n[[shape]]\nname = \"plate\"\nphase = \"solid\"\n\
                 box = {{ min = [0.0, 0.0], max = [2.0, 0.{rows}] }}\n"
            );
            off_lattice::<2>(&parse(&text, "test.toml".as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}")))
        };
        assert_eq!(plate(4), [Some(0)]);
        // The middle row without two particles at both ends.
        assert_eq!(plate(5), [Some(16)]);
    }
}
