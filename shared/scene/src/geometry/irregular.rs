//! Irregular arrangements of solid particles: where there are no rows, a crack goes where the stress drives it.
//!
//! The places of the lattice are shifted at random and then push one another apart, as shifted particles do (Lind, Xu,
//! Stansby and Rogers 2012), until they are about as far apart as before. The two rows at the surface, beside clamps
//! and beside cracks stay: the outline, what a clamp holds and the faces of a notch are those of the lattice.

use super::crossing::Cracks;
use super::{Cells, Layout, SolidPoint, pieces, solid_point};
use crate::Scene;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use xxhash_rust::xxh3::{xxh3_64_with_seed, xxh3_128};

/// Largest shift along each axis, in spacings. What is shifted by less than half of a spacing finds back to its site.
const SHIFT: f64 = 1.0;
/// How often a shift is drawn that would leave the sites that others left; then there is none.
const DRAWS: u64 = 16;
/// How often the places push one another.
const ROUNDS: usize = 200;
/// How far they push, in spacings: the support of the model's kernel, in which each needs others on all sides.
const REACH: f64 = 1.5;
/// By how much one place pushes another that is as good as where it is, in spacings.
const PUSH: f64 = 0.2;
/// How much farther the lists of those that push reach, in spacings.
const MARGIN: f64 = 1.0;

/// A layout with the particles of the solids whose arrangement is irregular where they belong.
pub(super) fn rearranged<const D: usize>(scene: &Scene, mut layout: Layout<D>) -> Layout<D> {
    let Some(moving) = Moving::of(scene, &layout) else { return layout };
    let places = moving.places(scene, &layout);
    for &i in moving.seeds.keys() {
        let SolidPoint { body, copy, site, .. } = layout.solid[i];
        // With the velocity that the scene has there.
        let point = solid_point(scene, &scene.shapes[body as usize], [body, copy], places[i]);
        layout.solid[i] = SolidPoint { site, ..point };
    }
    layout
}

impl<const D: usize> Layout<D> {
    /// How many particles of a solid of the scene lie off its lattice.
    pub fn off_lattice(&self, scene: &Scene, solid: usize) -> usize {
        let is_off =
            |p: &&SolidPoint<D>| p.position != p.site && scene.shapes[p.body as usize].solid == Some(solid);
        self.solid.iter().filter(is_off).count()
    }
}

/// Seed of the arrangement of a particle's solid; `None`: it lies on its lattice.
fn seed<const D: usize>(scene: &Scene, point: &SolidPoint<D>) -> Option<u32> {
    scene.solids.get(scene.shapes[point.body as usize].solid?)?.irregular()
}

/// A number from 0 to 1, the same on every machine: half of a hash's bits, which a float holds exactly.
fn random(seed: u32, shape: &str, numbers: [u64; 4]) -> f64 {
    let numbers = numbers.iter().flat_map(|number| number.to_le_bytes());
    let key: Vec<u8> = shape.bytes().chain(numbers).collect();
    (xxh3_64_with_seed(&key, u64::from(seed)) >> 32) as f64 / f64::from(u32::MAX)
}

fn distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis])).sum::<f64>().sqrt()
}

/// The particles that move, and what pushes them.
struct Moving {
    /// Particles that move, with the seeds of their solids.
    seeds: BTreeMap<usize, u32>,
    /// Of each particle, m.
    spacing: Vec<f64>,
    widest: f64,
    /// The connected piece of each particle; of those on lattices, none.
    piece: Vec<Option<u32>>,
}

impl Moving {
    /// `None` where no solid asks for it.
    fn of<const D: usize>(scene: &Scene, layout: &Layout<D>) -> Option<Self> {
        let seeds: Vec<Option<u32>> = layout.solid.iter().map(|point| seed(scene, point)).collect();
        seeds.iter().flatten().next()?;
        let spacing = |p: &SolidPoint<D>| scene.spacing(&scene.shapes[p.body as usize]);
        let spacing: Vec<f64> = layout.solid.iter().map(spacing).collect();
        let asks = seeds.iter().zip(&spacing).filter(|(seed, _)| seed.is_some());
        let widest = asks.map(|(_, dx)| *dx).fold(0.0, f64::max);
        let piece = pieces(scene, layout).into_iter().zip(&seeds).map(|(piece, seed)| seed.map(|_| piece));
        let mut moving = Self { seeds: BTreeMap::new(), spacing, widest, piece: piece.collect() };
        let free = moving.free(scene, layout);
        let seeds = seeds.into_iter().zip(free).enumerate();
        moving.seeds = seeds.filter_map(|(i, (seed, free))| Some((i, seed.filter(|_| free)?))).collect();
        Some(moving)
    }

    /// Cells of this side, in spacings, with the particles that are at these places.
    fn cells<const D: usize>(&self, places: &[[f64; D]], side: f64) -> Cells<u32, D> {
        let mut cells = Cells::new(side * self.widest);
        for (i, place) in places.iter().enumerate().filter(|(i, _)| self.piece[*i].is_some()) {
            cells.add(place, i as u32);
        }
        cells
    }

    /// Particles of the same piece within some spacings of a particle, without itself.
    fn near<const D: usize>(
        &self,
        cells: &Cells<u32, D>,
        places: &[[f64; D]],
        i: usize,
        reach: f64,
    ) -> Vec<u32> {
        let is_near = |j: usize| {
            j != i
                && self.piece[j] == self.piece[i]
                && distance(&places[i], &places[j]) < reach * self.spacing[i]
        };
        let mut near: Vec<u32> = cells.around(&places[i]).copied().filter(|j| is_near(*j as usize)).collect();
        near.sort_unstable();
        near
    }

    /// Which particles may move: those in the third row below the surface and deeper, and as far from clamps and
    /// cracks.
    fn free<const D: usize>(&self, scene: &Scene, layout: &Layout<D>) -> Vec<bool> {
        let cracks = Cracks::of(scene);
        let sites: Vec<[f64; D]> = layout.solid.iter().map(|p| p.site).collect();
        // Between the diagonal of a cell and two spacings.
        let reach = 1.1 * (D as f64).sqrt();
        let cells = self.cells(&sites, reach);
        let of = |i: usize| match self.piece[i] {
            Some(_) => self.near(&cells, &sites, i, reach),
            None => Vec::new(),
        };
        let beside: Vec<Vec<u32>> = (0..sites.len()).map(of).collect();
        let whole = 3_usize.pow(D as u32) - 1;
        let inside = |i: usize| {
            let point = &layout.solid[i];
            let is_there = |j: &&u32| {
                let other = &layout.solid[**j as usize];
                !other.clamped && !cracks.part(point, other)
            };
            !point.clamped && beside[i].iter().filter(is_there).count() == whole
        };
        let inside: Vec<bool> = (0..sites.len()).map(inside).collect();
        (0..sites.len()).map(|i| inside[i] && beside[i].iter().all(|j| inside[*j as usize])).collect()
    }

    /// Where all particles lie. A process lays out its scene several times: it remembers the last answer.
    fn places<const D: usize>(&self, scene: &Scene, layout: &Layout<D>) -> Vec<[f64; D]> {
        static LAST: Mutex<Option<(u128, Vec<f64>)>> = Mutex::new(None);
        let shifted = self.shifted(scene, layout);
        let numbers = shifted.iter().flatten().chain(&self.spacing).map(|x| x.to_bits());
        let pieces = self.piece.iter().map(|piece| piece.map_or(u64::MAX, u64::from));
        let moved = self.seeds.keys().map(|i| *i as u64);
        let question: Vec<u8> = numbers.chain(pieces).chain(moved).flat_map(u64::to_le_bytes).collect();
        let question = xxh3_128(&question);
        let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, places)) = last.as_ref().filter(|(of, _)| *of == question) {
            return places.chunks_exact(D).map(|place| std::array::from_fn(|axis| place[axis])).collect();
        }
        let places = self.apart(shifted);
        *last = Some((question, places.concat()));
        places
    }

    /// Places that have pushed one another apart.
    fn apart<const D: usize>(&self, mut places: Vec<[f64; D]>) -> Vec<[f64; D]> {
        let (mut lists, mut listed) = (self.lists(&places), places.clone());
        for _ in 0..ROUNDS {
            let far = |&i: &usize| distance(&places[i], &listed[i]) > 0.5 * MARGIN * self.spacing[i];
            if self.seeds.keys().any(far) {
                (lists, listed) = (self.lists(&places), places.clone());
            }
            let pushed = self.seeds.keys().zip(&lists).map(|(&i, near)| self.pushed(&places, i, near));
            let pushed: Vec<[f64; D]> = pushed.collect();
            for (&i, to) in self.seeds.keys().zip(pushed) {
                places[i] = to;
            }
        }
        places
    }

    /// Places after the shifts, which stay among the sites of those that move.
    fn shifted<const D: usize>(&self, scene: &Scene, layout: &Layout<D>) -> Vec<[f64; D]> {
        let sites: Vec<[f64; D]> = layout.solid.iter().map(|p| p.site).collect();
        let cells = self.cells(&sites, 1.0);
        let mut places = sites.clone();
        // Of the particle's own shape and copy: what else is in the scene does not matter.
        let mut numbers: BTreeMap<[u32; 2], u64> = BTreeMap::new();
        for (i, point) in layout.solid.iter().enumerate() {
            let number = numbers.entry([point.body, point.copy]).or_insert(0);
            *number += 1;
            let Some(&seed) = self.seeds.get(&i) else { continue };
            let name = &scene.shapes[point.body as usize].name;
            let draw = |draw: u64| -> [f64; D] {
                std::array::from_fn(|axis| {
                    let random = random(seed, name, [u64::from(point.copy), *number, axis as u64, draw]);
                    sites[i][axis] + SHIFT * self.spacing[i] * (2.0 * random - 1.0)
                })
            };
            let is_left = |place: &[f64; D]| {
                let around = cells.around(place).map(|j| *j as usize);
                let closest = around.min_by(|a, b| {
                    distance(place, &sites[*a]).total_cmp(&distance(place, &sites[*b])).then(a.cmp(b))
                });
                closest.is_some_and(|j| self.seeds.contains_key(&j) && self.piece[j] == self.piece[i])
            };
            places[i] = (0..DRAWS).map(draw).find(is_left).unwrap_or(sites[i]);
        }
        places
    }

    /// For each particle that moves those that can come within reach of it before the lists are made again.
    fn lists<const D: usize>(&self, places: &[[f64; D]]) -> Vec<Vec<u32>> {
        let cells = self.cells(places, REACH + MARGIN);
        self.seeds.keys().map(|&i| self.near(&cells, places, i, REACH + MARGIN)).collect()
    }

    /// Where others push a particle to.
    fn pushed<const D: usize>(&self, places: &[[f64; D]], i: usize, near: &[u32]) -> [f64; D] {
        let reach = REACH * self.spacing[i];
        let mut to = places[i];
        for &j in near {
            let other = &places[j as usize];
            let r = distance(&places[i], other);
            if r > 0.0 && r < reach {
                let part = 1.0 - r / reach;
                for axis in 0..D {
                    to[axis] += PUSH * self.spacing[i] * part * part * (places[i][axis] - other[axis]) / r;
                }
            }
        }
        to
    }
}

#[cfg(test)]
mod tests {
    use super::super::layout;
    use super::*;
    use crate::parse;

    /// Of boxes from the origin's height up: name, sides [min x, max x, height], and more keys.
    fn scene(keys: &str, boxes: &[(&str, [f64; 3], &str)]) -> Scene {
        let solid = "resolution = 0.1\nend_time = 1.0\n[solid]\ndensity = 1000.0\nyoungs_modulus = 1e6\n\
                     poissons_ratio = 0.3\n";
        let shapes = boxes.iter().map(|(name, [from, to, height], more)| {
            format!(
                "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\n\
                 box = {{ min = [{from}, 0.0], max = [{to}, {height}] }}\n{more}\n"
            )
        });
        let text = format!("{solid}{keys}\n{}", shapes.collect::<String>());
        parse(&text, "test.toml".as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}"))
    }

    fn block(keys: &str, more: &str) -> Layout<2> {
        layout(&scene(keys, &[("block", [0.0, 2.0, 2.0], more)]))
    }

    /// Distance of two particles, m.
    fn apart(layout: &Layout<2>, i: usize, j: usize) -> f64 {
        distance(&layout.solid[i].position, &layout.solid[j].position)
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

    /// Magnitude of the mean of exp(2 pi i x / dx) along both axes: 1 on the lattice. A shift of 0.45 dx leaves 0.11,
    /// and the pushes make 0.6 of that.
    #[test]
    fn no_order_of_the_lattice_is_left() {
        let order = |layout: &Layout<2>| {
            let deep = |p: &&SolidPoint<2>| p.position.iter().all(|x| (0.5..1.5).contains(x));
            let deep: Vec<&SolidPoint<2>> = layout.solid.iter().filter(deep).collect();
            [0, 1].map(|axis| {
                let wave = |p: &&SolidPoint<2>| {
                    let phase = 2.0 * std::f64::consts::PI * p.position[axis] / 0.1;
                    [phase.cos(), phase.sin()]
                };
                let sum = deep.iter().map(wave).fold([0.0; 2], |sum, w| [sum[0] + w[0], sum[1] + w[1]]);
                sum[0].hypot(sum[1]) / deep.len() as f64
            })
        };
        assert!(order(&block("", "")).iter().all(|order| (order - 1.0).abs() < 1e-9));
        // A hundred particles in no order have 0.1 by chance.
        let mut mean = 0.0;
        for seed in 1..=8 {
            let found = order(&block(&format!("{IRREGULAR}\narrangement_seed = {seed}"), ""));
            mean += (found[0] + found[1]) / 16.0;
        }
        assert!(mean < 0.2, "{mean}");
    }

    #[test]
    fn other_solids_leave_an_arrangement_as_it_is() {
        let block = ("block", [0.0, 2.0, 2.0], "");
        let alone = layout(&scene(IRREGULAR, &[block]));
        let beside = layout(&scene(IRREGULAR, &[("other", [5.0, 5.4, 0.4], ""), block]));
        let places = |layout: &Layout<2>| -> Vec<[f64; 2]> {
            layout.solid.iter().rev().take(400).map(|p| p.position).collect()
        };
        assert_eq!(places(&alone), places(&beside));
    }

    #[test]
    fn a_thin_plate_has_no_row_that_could_move() {
        let plate = |height: f64| {
            let scene = scene(IRREGULAR, &[("plate", [0.0, 2.0, height], "")]);
            layout::<2>(&scene).off_lattice(&scene, 0)
        };
        assert_eq!(plate(0.4), 0);
        // The middle row without two particles at both ends.
        assert_eq!(plate(0.5), 16);
    }
}
