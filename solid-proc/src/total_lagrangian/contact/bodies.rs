//! What bodies of one solid do to each other, and the two sides of a cut within one.
//!
//! A particle sees those of other bodies, and those of its own from which it is cut off (see `crate::kernel_sum`). Its
//! depth stores k' delta_i² / 2, so of a pair
//!   F_ij = -k' / sigma (delta_i + delta_j) w'(r) x_ij / r,   k' = M/4 dx^(D-2),   M = K + 4 G / 3,
//! and two flat surfaces that meet push as M/2 dx^(D-2) for each particle. Where a particle begins or is cut off, S_0
//! is what it sees there: nothing pushes. As it sees less, that falls with it to the S_0 of surfaces.

use crate::columns::{Vectors, vectors};
use crate::kernel_sum::KernelSum;
use halfstep_sph::columns::fit;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Isa, LANES, Lane, Lanes};
use halfstep_sph::neighbours::{ClusterList, Neighbours, PADDING};
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
    /// Some depth is not zero.
    touches: bool,
    /// Force by slot, N (2D: N/m).
    force: Vectors<D>,
    /// S from which on a particle pushes, by its number.
    rest: Vec<f64>,
    /// Pairs of one body that are cut, by particle numbers, each both ways, ascending.
    cuts: Vec<[u32; 2]>,
    /// Slot of a particle.
    slot_of: Vec<u32>,
}

impl<const D: usize> Bodies<D> {
    /// Of as many particles as far apart as `spacing`, m; k' is `stiffness`.
    pub(super) fn new(particles: usize, spacing: f64, stiffness: f64) -> Self {
        let law = KernelSum::new(spacing);
        Self {
            law,
            stiffness,
            presence: Vec::new(),
            pushes: Vec::new(),
            sum: Vec::new(),
            gradient: vectors(0),
            depth: Vec::new(),
            touches: false,
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
    pub(super) fn cut(&mut self, cuts: impl Iterator<Item = [u32; 2]>) {
        self.cuts = cuts.flat_map(|[a, b]| [[a, b], [b, a]]).collect();
        self.cuts.sort_unstable();
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
            let sum = self.sum.get(slot as usize).copied().unwrap_or(0.0);
            *rest = rest.min(sum).max(level);
        }
    }

    pub(super) fn rest(&mut self) -> &mut Vec<f64> {
        &mut self.rest
    }

    /// Slots of the particles from which the one at a slot is cut off within its body, x_ij and its length.
    fn across_cuts<'s>(
        &'s self,
        at: Slots<'s, D>,
        slot: usize,
    ) -> impl Iterator<Item = (usize, [f64; D], f64)> + use<'s, D> {
        let id = at.id[slot];
        let first = self.cuts.partition_point(|cut| cut[0] < id);
        let own = self.cuts[first..].iter().take_while(move |cut| cut[0] == id);
        own.map(move |cut| self.slot_of[cut[1] as usize] as usize).filter_map(move |j| self.seen(at, slot, j))
    }

    /// Slots of the particles that the one at a slot sees, x_ij and its length.
    fn all_seen<'s>(
        &'s self,
        at: Slots<'s, D>,
        slot: usize,
    ) -> impl Iterator<Item = (usize, [f64; D], f64)> + use<'s, D> {
        let near = at.list.map_or(Neighbours::NONE, |list| list.of(slot));
        let others = near.filter(move |&j| at.body[j] != at.body[slot]);
        others.filter_map(move |j| self.seen(at, slot, j)).chain(self.across_cuts(at, slot))
    }

    fn seen(&self, at: Slots<'_, D>, i: usize, j: usize) -> Option<(usize, [f64; D], f64)> {
        let x = at.apart(i, j);
        let r = length(x);
        (r < self.law.radius && r > 0.0).then_some((j, x, r))
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
        for slot in at.real().filter(|_| !self.cuts.is_empty()) {
            let mut seen = (self.sum[slot], self.gradient_at(slot));
            for (_, x, r) in self.across_cuts(at, slot) {
                let slope = self.law.kernel.slope_at(r);
                seen.0 += self.law.kernel.at(r);
                seen.1 = std::array::from_fn(|d| seen.1[d] + slope * x[d]);
            }
            self.sum[slot] = seen.0;
            for d in 0..D {
                self.gradient[d][slot] = seen.1[d];
            }
        }
    }

    fn gradient_at(&self, slot: usize) -> [f64; D] {
        std::array::from_fn(|d| self.gradient[d][slot])
    }

    /// Depths and forces of the sums.
    pub(super) fn push(&mut self, isa: Isa, at: Slots<'_, D>) {
        self.depth.fill(0.0);
        self.force.iter_mut().for_each(|column| column.fill(0.0));
        for slot in at.real() {
            self.depth[slot] = self.law.depth(self.sum[slot], self.rest[at.id[slot] as usize]);
        }
        self.touches = self.depth.iter().any(|depth| *depth > 0.0);
        if !self.touches {
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
        for slot in at.real().filter(|_| !self.cuts.is_empty()) {
            let mut force = self.force_at(slot);
            for (j, x, r) in self.across_cuts(at, slot) {
                let both = factor * (self.depth[slot] + self.depth[j]) * self.law.kernel.slope_at(r);
                force = std::array::from_fn(|d| force[d] + both * x[d]);
            }
            for d in 0..D {
                self.force[d][slot] = force[d];
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

    /// Calls `visit` with slots that push each other, the normal of the surface between them toward the first one, and
    /// the force along that, N (2D: N/m).
    pub(super) fn touching(&self, at: Slots<'_, D>, mut visit: impl FnMut([usize; 2], [f64; D], f64)) {
        // Down grad S it is clear.
        let outward = |slot: usize| {
            let gradient = self.gradient_at(slot);
            let size = length(gradient);
            gradient.map(|g| if size > 0.0 { -g / size } else { 0.0 })
        };
        for i in at.real().filter(|_| self.touches) {
            for (j, x, r) in self.all_seen(at, i).filter(|(j, ..)| at.id[i] < at.id[*j]) {
                let depths = self.depth[i] + self.depth[j];
                if depths == 0.0 {
                    continue;
                }
                let (a, b) = (outward(i), outward(j));
                let between: [f64; D] = std::array::from_fn(|d| a[d] - b[d]);
                let size = length(between);
                let normal = if size > 0.0 { between.map(|n| n / size) } else { x.map(|x| x / r) };
                let slope = -self.law.kernel.slope_at(r) / self.law.slope;
                let along: f64 = (0..D).map(|d| x[d] * normal[d]).sum();
                visit([i, j], normal, self.stiffness * depths * slope * along);
            }
        }
    }

    /// What contacts add to a particle's stiffness, N/m (2D: N/m²): the largest sum over a row of their second
    /// derivatives, of particles that no clamp holds.
    pub(super) fn largest_stiffness(&self, at: Slots<'_, D>, held: impl Fn(usize) -> bool) -> f64 {
        let slope = |r: f64| -self.law.kernel.slope_at(r) * r / self.law.slope;
        let own =
            |slot: usize| if held(slot) { 0.0 } else { length(self.gradient_at(slot)) / self.law.slope };
        // How far a depth follows all that give way, per displacement.
        let follows = |slot: usize| {
            let seen = self.all_seen(at, slot).filter(|(j, ..)| !held(*j));
            own(slot) + seen.map(|(.., r)| slope(r)).sum::<f64>()
        };
        let row = |slot: usize| {
            let mut sum = if self.depth[slot] > 0.0 { own(slot) * follows(slot) } else { 0.0 };
            for (j, _, r) in self.all_seen(at, slot) {
                sum += 2.0 * (self.depth[slot] + self.depth[j]) * self.law.curvature(r);
                if self.depth[j] > 0.0 {
                    sum += slope(r) * follows(j);
                }
            }
            sum
        };
        let free = at.real().filter(|&slot| self.touches && !held(slot));
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
