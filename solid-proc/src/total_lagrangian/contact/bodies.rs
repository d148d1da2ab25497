//! What bodies of one solid do to each other, and the two sides of a cut within one.
//!
//! A particle sees those of other bodies, and those of its own from which it is cut off (see `crate::kernel_sum`). Its
//! depth stores k' delta_i² / 2, so of a pair
//!   F_ij = -k' / sigma (delta_i + delta_j) w'(r) x_ij / r,   k' = M/4 dx^(D-2),   M = K + 4 G / 3,
//! and two flat surfaces that meet push as M/2 dx^(D-2) for each particle. Where a particle begins or is cut off, S_0 is
//! what it sees there: nothing pushes. As it sees less, that falls with it to the S_0 of surfaces.

use crate::columns::{Vectors, vectors};
use crate::kernel_sum::KernelSum;
use halfstep_sph::columns::fit;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Isa, LANES, Lane, Lanes};
use halfstep_sph::neighbours::{ClusterList, PADDING};
use halfstep_sph::pair::{self, PairLaw, distance, pair_sum};

/// The particles of contacts, by slot.
#[derive(Clone, Copy)]
pub(super) struct Slots<'a, const D: usize> {
    /// Particle number, or padding.
    pub(super) id: &'a [u32],
    /// m.
    pub(super) position: &'a Vectors<D>,
    /// Number of the body.
    pub(super) body: &'a [f64],
    /// Who is near whom, where there are several bodies.
    pub(super) list: Option<&'a ClusterList>,
}

impl<const D: usize> Slots<'_, D> {
    fn apart(&self, i: usize, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.position[d][i] - self.position[d][j])
    }

    fn real(&self) -> impl Iterator<Item = usize> + use<'_, D> {
        (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING)
    }
}

fn length<const D: usize>(a: [f64; D]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Sums of what particles of other bodies are to those of one.
pub(super) struct Bodies<const D: usize> {
    law: KernelSum<D>,
    /// k', N/m (2D: N/m²).
    stiffness: f64,
    presence: Vec<Presence<D>>,
    pushes: Vec<Push<D>>,
    /// S by slot.
    sum: Vec<f64>,
    /// grad_i S_i by slot.
    gradient: Vectors<D>,
    /// delta by slot, m.
    depth: Vec<f64>,
    /// Force by slot, N (2D: N/m).
    force: Vectors<D>,
    /// S from which on a particle pushes, by its number.
    rest: Vec<f64>,
    /// Pairs of one body that are cut, by particle numbers.
    cuts: Vec<[u32; 2]>,
    /// Slot of a particle.
    slot_of: Vec<u32>,
}

impl<const D: usize> Bodies<D> {
    /// Of as many particles as far apart as `spacing`, m; k' is `stiffness`.
    pub(super) fn new(particles: usize, spacing: f64, stiffness: f64) -> Self {
        let law = KernelSum::new(spacing, spacing);
        Self {
            law,
            stiffness,
            presence: Vec::new(),
            pushes: Vec::new(),
            sum: Vec::new(),
            gradient: vectors(0),
            depth: Vec::new(),
            force: vectors(0),
            rest: vec![law.level; particles],
            cuts: Vec::new(),
            slot_of: vec![PADDING; particles],
        }
    }

    /// Distance up to which particles see each other, m.
    pub(super) fn radius(&self) -> f64 {
        self.law.radius
    }

    /// Some pairs of one body are cut.
    pub(super) fn has_cuts(&self) -> bool {
        !self.cuts.is_empty()
    }

    /// Fits the columns to slots that were sorted or listed anew.
    pub(super) fn fit(&mut self, at: Slots<'_, D>) {
        let fours = at.list.map_or(0, ClusterList::fours);
        fit(&mut self.presence, fours, Presence::default());
        fit(&mut self.pushes, fours, Push::default());
        let slots = at.id.len();
        let columns = [&mut self.sum, &mut self.depth].into_iter();
        columns.chain(&mut self.gradient).chain(&mut self.force).for_each(|column| fit(column, slots, 0.0));
        for slot in at.real() {
            self.slot_of[at.id[slot] as usize] = slot as u32;
        }
    }

    /// S of each particle, by its number.
    pub(super) fn sums(&self) -> Vec<f64> {
        let seen = |&slot: &u32| self.sum.get(slot as usize).copied().unwrap_or(0.0);
        self.slot_of.iter().map(seen).collect()
    }

    /// Pairs of one body that are cut from now on.
    pub(super) fn cut(&mut self, cuts: Vec<[u32; 2]>) {
        self.cuts = cuts;
    }

    /// What has come into view since the sums were these, by particle number, pushes no one: who was pushed is pushed
    /// as before.
    pub(super) fn rest_since(&mut self, before: &[f64]) {
        let now = self.sums();
        for ((rest, now), before) in self.rest.iter_mut().zip(now).zip(before) {
            *rest = if *before > *rest { *rest + (now - before).max(0.0) } else { rest.max(now) };
        }
    }

    /// Who sees less than what it pushes from pushes from there on.
    pub(super) fn leave(&mut self) {
        let level = self.law.level;
        let raised = self.rest.iter_mut().zip(&self.slot_of).filter(|(rest, _)| **rest > level);
        for (rest, &slot) in raised {
            *rest = rest.min(self.sum[slot as usize]).max(level);
        }
    }

    pub(super) fn rest(&mut self) -> &mut Vec<f64> {
        &mut self.rest
    }

    /// Slots, x_ij and its length of the cuts.
    fn seen_cuts<'s>(
        &'s self,
        at: Slots<'s, D>,
    ) -> impl Iterator<Item = ([usize; 2], [f64; D], f64)> + use<'s, D> {
        let of = move |pair: &[u32; 2]| {
            let [i, j] = pair.map(|id| self.slot_of[id as usize] as usize);
            let x = at.apart(i, j);
            ([i, j], x, length(x))
        };
        self.cuts.iter().map(of).filter(|(_, _, r)| *r < self.law.radius)
    }

    /// Sums over who is seen now.
    pub(super) fn look(&mut self, isa: Isa, at: Slots<'_, D>) {
        if let Some(list) = at.list {
            pair::pass(isa, &Look { law: &self.law, at }, list, &mut self.presence);
        }
        for slot in 0..at.id.len() {
            let lane = slot % LANES;
            let seen = at.list.map_or_else(Presence::default, |_| self.presence[slot / LANES]);
            self.sum[slot] = seen.sum.0[lane];
            for d in 0..D {
                self.gradient[d][slot] = seen.gradient[d].0[lane];
            }
        }
        let cuts: Vec<_> = self.seen_cuts(at).collect();
        for ([i, j], x, r) in cuts {
            let (value, slope) = (self.law.kernel.at(r), self.law.kernel.slope_at(r));
            for (slot, sign) in [(i, 1.0), (j, -1.0)] {
                self.sum[slot] += value;
                for d in 0..D {
                    self.gradient[d][slot] += sign * slope * x[d];
                }
            }
        }
    }

    /// Depths and forces of the sums.
    pub(super) fn push(&mut self, isa: Isa, at: Slots<'_, D>) {
        self.depth.fill(0.0);
        self.force.iter_mut().for_each(|column| column.fill(0.0));
        let mut touches = false;
        for slot in at.real() {
            self.depth[slot] = self.law.depth(self.sum[slot], self.rest[at.id[slot] as usize]);
            touches |= self.depth[slot] > 0.0;
        }
        if !touches {
            return;
        }
        let factor = -self.stiffness / self.law.slope;
        if let Some(list) = at.list {
            pair::pass(isa, &Repel { law: &self.law, at, depth: &self.depth }, list, &mut self.pushes);
            for slot in at.real() {
                for d in 0..D {
                    self.force[d][slot] = factor * self.pushes[slot / LANES].0[d].0[slot % LANES];
                }
            }
        }
        let cuts: Vec<_> = self.seen_cuts(at).collect();
        for ([i, j], x, r) in cuts {
            let both = factor * (self.depth[i] + self.depth[j]) * self.law.kernel.slope_at(r);
            for (slot, sign) in [(i, 1.0), (j, -1.0)] {
                for d in 0..D {
                    self.force[d][slot] += sign * both * x[d];
                }
            }
        }
    }

    /// Force on the particle at a slot, N (2D: N/m).
    pub(super) fn force_at(&self, slot: usize) -> [f64; D] {
        std::array::from_fn(|d| self.force[d][slot])
    }

    /// Energy stored, J (2D: J/m).
    pub(super) fn energy(&self) -> f64 {
        0.5 * self.stiffness * self.depth.iter().map(|depth| depth * depth).sum::<f64>()
    }

    /// Pairs that push each other: slots, the lower number's first, x_ij and its length.
    fn pushing(&self, at: Slots<'_, D>) -> Vec<([usize; 2], [f64; D], f64)> {
        let pushes = |i: usize, j: usize| self.depth[i] + self.depth[j] > 0.0;
        let mut pairs = Vec::new();
        if let Some(list) = at.list {
            for i in at.real() {
                for j in
                    list.of(i).filter(|&j| at.id[i] < at.id[j] && at.body[i] != at.body[j] && pushes(i, j))
                {
                    let x = at.apart(i, j);
                    pairs.push(([i, j], x, length(x)));
                }
            }
        }
        pairs.extend(self.seen_cuts(at).filter(|&([i, j], ..)| pushes(i, j)));
        pairs.retain(|(_, _, r)| *r < self.law.radius && *r > 0.0);
        pairs
    }

    /// Calls `visit` with slots that push each other, the normal of the surface between them toward the first one, and
    /// the force along that, N (2D: N/m).
    pub(super) fn touching(&self, at: Slots<'_, D>, mut visit: impl FnMut([usize; 2], [f64; D], f64)) {
        // Down grad S it is clear.
        let outward = |slot: usize| {
            let gradient: [f64; D] = std::array::from_fn(|d| self.gradient[d][slot]);
            let size = length(gradient);
            gradient.map(|g| if size > 0.0 { -g / size } else { 0.0 })
        };
        for ([i, j], x, r) in self.pushing(at) {
            let (a, b) = (outward(i), outward(j));
            let between: [f64; D] = std::array::from_fn(|d| a[d] - b[d]);
            let size = length(between);
            let normal = if size > 0.0 { between.map(|n| n / size) } else { x.map(|x| x / r) };
            let slope = -self.law.kernel.slope_at(r) / self.law.slope;
            let along: f64 = (0..D).map(|d| x[d] * normal[d]).sum();
            visit([i, j], normal, self.stiffness * (self.depth[i] + self.depth[j]) * slope * along);
        }
    }

    /// What contacts add to a particle's stiffness, N/m (2D: N/m²): the largest sum over a row of their second
    /// derivatives, of particles that no clamp holds.
    pub(super) fn largest_stiffness(&self, at: Slots<'_, D>, held: impl Fn(usize) -> bool) -> f64 {
        let pairs = self.pushing(at);
        let mut rows = vec![0.0; at.id.len()];
        // Sum of how far each depth follows all that give way, per displacement.
        let own = |slot: usize| {
            let gradient: [f64; D] = std::array::from_fn(|d| self.gradient[d][slot]);
            if held(slot) { 0.0 } else { length(gradient) / self.law.slope }
        };
        let mut follows: Vec<f64> = (0..rows.len()).map(own).collect();
        let slope = |r: f64| -self.law.kernel.slope_at(r) * r / self.law.slope;
        for &([i, j], _, r) in &pairs {
            for (slot, other) in [(i, j), (j, i)] {
                follows[slot] += if held(other) { 0.0 } else { slope(r) };
            }
        }
        for &([i, j], _, r) in &pairs {
            for (slot, other) in [(i, j), (j, i)].into_iter().filter(|&(slot, _)| self.depth[slot] > 0.0) {
                rows[other] += slope(r) * follows[slot];
                let turned = 2.0 * self.depth[slot] * self.law.curvature(r);
                rows[slot] += turned;
                rows[other] += turned;
            }
        }
        let free = at.real().filter(|&slot| !held(slot));
        let row = |slot: usize| {
            let itself = if self.depth[slot] > 0.0 { own(slot) * follows[slot] } else { 0.0 };
            rows[slot] + itself
        };
        self.stiffness * free.map(row).fold(0.0, f64::max)
    }
}

/// What several particles see of other bodies.
#[derive(Clone, Copy)]
struct Presence<const D: usize, L = Lane> {
    /// S.
    sum: L,
    /// grad S.
    gradient: [L; D],
}
pair_sum!(Presence { D } { sum, gradient });

/// 1 between different bodies, which have whole numbers, else 0.
#[inline(always)]
fn other<L: Lanes>(body: L, of: f64) -> L {
    let apart = body - L::splat(of);
    apart.max(-apart).min(L::splat(1.0))
}

struct Look<'a, const D: usize> {
    law: &'a KernelSum<D>,
    at: Slots<'a, D>,
}

impl<const D: usize> PairLaw<D> for Look<'_, D> {
    type Target<L: Lanes> = L;
    type Sum<L: Lanes> = Presence<D, L>;
    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.at.position
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.at.position[d][j])
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> L {
        L::load(self.at.body, slot)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, body: &L, j: usize, dx: [L; D], r2: L, sum: &mut Presence<D, L>) {
        let (r, other) = (distance(r2, self.law.radius), other(*body, self.at.body[j]));
        sum.sum = A::mul_add(other, self.law.kernel.value::<A, L>(r), sum.sum);
        let slope = other * self.law.kernel.gradient_over_r::<A, L>(r);
        for d in 0..D {
            sum.gradient[d] = A::mul_add(slope, dx[d], sum.gradient[d]);
        }
    }
}

/// Sums over particles of other bodies, to be multiplied by -k' / sigma.
#[derive(Clone, Copy)]
struct Push<const D: usize, L = Lane>([L; D]);
pair_sum!(Push { D } { 0 });

struct Repel<'a, const D: usize> {
    law: &'a KernelSum<D>,
    at: Slots<'a, D>,
    depth: &'a [f64],
}

impl<const D: usize> PairLaw<D> for Repel<'_, D> {
    /// Body and depth.
    type Target<L: Lanes> = [L; 2];
    type Sum<L: Lanes> = Push<D, L>;
    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.at.position
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.at.position[d][j])
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> [L; 2] {
        [L::load(self.at.body, slot), L::load(self.depth, slot)]
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        [body, depth]: &[L; 2],
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut Push<D, L>,
    ) {
        let slope = self.law.kernel.gradient_over_r::<A, L>(distance(r2, self.law.radius));
        let push = other(*body, self.at.body[j]) * (*depth + L::splat(self.depth[j])) * slope;
        for d in 0..D {
            sum.0[d] = A::mul_add(push, dx[d], sum.0[d]);
        }
    }
}
