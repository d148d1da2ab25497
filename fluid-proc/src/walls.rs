//! Rigid walls toward the fluid (Adami, Hu and Adams 2012; Kayaki's eqs. 27 and 28).
//!
//! For wall particle w, sums over the fluid particles f around it with weights W_wf:
//!   v~ = sum v_f W / sum W,   p_w = sum [ p_f + rho_f g . (x_w - x_f) ] W / sum W;
//! the velocity shown to the fluid is 2 u_w - v~ along the normal and v~ (free slip) or 2 u_w - v~ (no slip) along the
//! wall, u_w its own velocity, without slip that of the surface; in a corner all components are reversed. The density
//! shown is the equation of state's at p_w, the mass rho0 V. Without fluid around: p_w = 0, rho0, u_w. Of a wall that
//! moves by prescription, g is less its own acceleration.

mod load;
pub mod moving;

use crate::columns::{PairParticles, Source, Vectors, fit, vectors};
use halfstep_scene::Motion;
use halfstep_scene::geometry::WallPoint;
use halfstep_sph::columns::bounds;
use halfstep_sph::extrapolation::ExtrapolationSum;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lane, Lanes, Precision};
use halfstep_sph::neighbours::Rows;
use halfstep_sph::pair::{PairLaw, pair_sum};
use halfstep_sph::state_equation::StateEquation;
use moving::{Moving, Seen};

/// The wall particles, sorted once, or with the fluid where some of them move.
#[derive(Clone, Debug)]
pub struct Walls<const D: usize> {
    /// Wall particle number of a slot, or padding.
    pub id: Vec<u32>,
    /// What the fluid sees.
    pub shown: PairParticles<D>,
    /// Own velocity u_w, m/s.
    pub(crate) own_velocity: Vectors<D>,
    pub(crate) normal: Vectors<D>,
    /// 1 where all components are reversed (corner or no slip), else 0.
    pub(crate) reverse_all: Vec<f64>,
    /// 1 where water sticks to it, but in corners, else 0.
    pub(crate) sticky: Vec<f64>,
    /// Depth below the surface where water sticks to it, m; else, in corners and behind edges infinite.
    pub(crate) depth: Vec<f64>,
    /// 1 behind edges and beside them, else 0.
    pub(crate) at_edge: Vec<f64>,
    /// Order of the slots.
    pub rows: Rows<D>,
    pub(crate) moving: Option<Moving<D>>,
    height: f64,
    non_negative: bool,
}

impl<const D: usize> Walls<D> {
    /// Sorts the wall particles into rows of at least `height`.
    pub fn new(
        points: &[WallPoint<D>],
        state: &StateEquation,
        volume: f64,
        height: f64,
        non_negative: bool,
        motions: &[Option<Motion>],
        precision: Precision,
    ) -> Self {
        let n = points.len();
        let mut walls = Self {
            id: (0..n as u32).collect(),
            shown: PairParticles::new(n, state.density * volume, state.density),
            own_velocity: vectors(n),
            normal: vectors(n),
            reverse_all: vec![0.0; n],
            sticky: vec![0.0; n],
            depth: vec![f64::INFINITY; n],
            at_edge: points.iter().map(|p| f64::from(u8::from(p.at_edge))).collect(),
            rows: Rows::new(precision),
            moving: Moving::new(points, motions),
            height,
            non_negative,
        };
        for (i, p) in points.iter().enumerate() {
            for d in 0..D {
                walls.shown.position[d][i] = p.position[d];
                walls.own_velocity[d][i] = p.velocity[d];
                walls.normal[d][i] = p.normal[d];
            }
            let reversed = p.corner || !p.free_slip;
            walls.reverse_all[i] = f64::from(u8::from(reversed));
            if !p.free_slip && !p.corner {
                (walls.sticky[i], walls.depth[i]) = (1.0, p.depth);
            }
        }
        walls.sort();
        (0..walls.slots()).for_each(|slot| walls.shown.sources[slot] = walls.alone(slot, state));
        walls
    }

    /// Sorts the wall particles by where they are.
    pub fn sort(&mut self) {
        let (low, high) = bounds(&self.shown.position);
        self.rows.sort(&self.shown.position, &self.id, self.height, low, high);
        for d in 0..D {
            self.rows.permute(&mut self.shown.position[d]);
            self.rows.permute(&mut self.own_velocity[d]);
            self.rows.permute(&mut self.normal[d]);
        }
        self.rows.permute(&mut self.reverse_all);
        self.rows.permute(&mut self.sticky);
        self.rows.permute(&mut self.depth);
        self.rows.permute(&mut self.at_edge);
        if let Some(moving) = &mut self.moving {
            moving.permute(&mut self.rows);
        }
        self.rows.permute_ids(&mut self.id);
        fit(&mut self.shown.sources, self.rows.slots(), Source::ZERO);
    }

    /// Brings the walls that move to where they are at a time.
    pub fn set_time(&mut self, time: f64) {
        let Some(moving) = &mut self.moving else { return };
        let (position, velocity) = (&mut self.shown.position, &mut self.own_velocity);
        moving.place(time, Seen { position, velocity, normal: &mut self.normal });
    }

    /// Places them where they are, which changes nothing.
    pub(crate) fn place_again(&mut self) {
        if let Some(now) = self.moving.as_ref().map(|moving| moving.time) {
            self.set_time(now);
        }
    }

    /// Where a point of the scene is that goes along with the wall of a shape.
    pub(crate) fn carry(&self, shape: usize, point: [f64; D]) -> [f64; D] {
        self.moving.as_ref().map_or(point, |moving| moving.carry(shape, point))
    }

    /// Largest displacement of a wall particle since the last sort, m.
    pub fn displacement(&self) -> f64 {
        self.moving.as_ref().map_or(0.0, |m| m.displacement)
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.id.len()
    }

    /// A slot shows the reverse of all components of the fluid's velocity: it lies in a corner or does not let slip.
    pub fn reverses_all(&self, slot: usize) -> bool {
        self.reverse_all[slot] > 0.0
    }

    /// A slot lies within the kernel's support of an edge, round which water flows.
    pub fn is_at_edge(&self, slot: usize) -> bool {
        self.at_edge[slot] > 0.0
    }

    /// By how much the velocity that a slot shows is another than that of a wall that lets slip, m/s; `None` where it
    /// lets slip, and in corners, which reverse all in any case.
    pub fn shown_beyond_slip(&self, slot: usize) -> Option<[f64; D]> {
        self.sticks(slot).then(|| {
            let (relative, along) = self.shown_relative(slot);
            std::array::from_fn(|d| 2.0 * (relative[d] - along * self.normal[d][slot]))
        })
    }

    /// The same of all slots, zero where there is none.
    pub fn beyond_slip(&self, out: &mut [[f64; D]]) {
        for (slot, excess) in out.iter_mut().enumerate() {
            *excess = self.shown_beyond_slip(slot).unwrap_or([0.0; D]);
        }
    }

    /// A slot stands for a surface along which water does not slip.
    pub fn sticks(&self, slot: usize) -> bool {
        self.sticky[slot] > 0.0
    }

    /// The velocity that a slot shows relative to its surface, and that along the normal, m/s.
    fn shown_relative(&self, slot: usize) -> ([f64; D], f64) {
        let (velocity, surface) = (self.shown.sources[slot].velocity, self.surface_velocity(slot));
        let relative: [f64; D] = std::array::from_fn(|d| velocity[d] - surface[d]);
        (relative, (0..D).map(|d| relative[d] * self.normal[d][slot]).sum())
    }

    /// By how much the velocity that a slot shows is another than that of the water around it, m/s, `but_for_slip`
    /// without what is [beyond slip](Self::shown_beyond_slip); `None` unless that water leaves a wall that does not
    /// push.
    pub fn shown_to_leaving(&self, slot: usize, but_for_slip: bool) -> Option<[f64; D]> {
        // The wall shows v~ reversed, relative to its own velocity: along the normal, or as a whole.
        let (relative, along) = self.shown_relative(slot);
        let whole = self.reverses_all(slot) && !(but_for_slip && self.sticks(slot));
        let leaves = self.shown.sources[slot].pressure <= 0.0 && along < 0.0;
        leaves.then(|| {
            std::array::from_fn(|d| 2.0 * if whole { relative[d] } else { along * self.normal[d][slot] })
        })
    }

    /// What the four wall particles at `slot..slot + 4` show, from the sums over the fluid.
    // Inlined, its scalar arithmetic would break up the vectors of the loop before it.
    #[inline(never)]
    pub fn shows(&self, slot: usize, sum: &WallSum<D>, state: &StateEquation) -> [Source<D>; LANES] {
        std::array::from_fn(|k| self.one_shows(slot + k, k, sum, state))
    }

    fn one_shows(&self, slot: usize, k: usize, sum: &WallSum<D>, state: &StateEquation) -> Source<D> {
        let Some(mut pressure) = sum.extrapolated.pressure(k) else { return self.alone(slot, state) };
        let weight = sum.extrapolated.weight(k);
        let u = self.surface_velocity(slot);
        let v: [f64; D] = std::array::from_fn(|d| sum.velocity[d].0[k] / weight);
        let mut along_normal = 0.0;
        for d in 0..D {
            along_normal += (v[d] - u[d]) * self.normal[d][slot];
        }
        let velocity = std::array::from_fn(|d| {
            if self.reverses_all(slot) {
                2.0 * u[d] - v[d]
            } else {
                v[d] - 2.0 * along_normal * self.normal[d][slot]
            }
        });
        if let Some(moving) = &self.moving {
            let a = moving.acceleration(slot);
            let lever = |d: usize| sum.lever[d].0[k] / weight;
            pressure -= (0..D).map(|d| a[d] * lever(d)).sum::<f64>();
        }
        if self.non_negative {
            pressure = pressure.max(0.0);
        }
        Source::new(self.position(slot), velocity, state.density_at(pressure), pressure, self.shown.mass)
    }

    /// Velocity of the surface that a slot stands for, m/s: of a wall that turns another one than its own, which counts
    /// where water sticks.
    fn surface_velocity(&self, slot: usize) -> [f64; D] {
        match &self.moving {
            Some(moving) if self.depth[slot].is_finite() => moving.velocity_above(slot, self.depth[slot]),
            _ => std::array::from_fn(|d| self.own_velocity[d][slot]),
        }
    }

    /// What a wall particle shows without fluid around.
    fn alone(&self, slot: usize, state: &StateEquation) -> Source<D> {
        let velocity = std::array::from_fn(|d| self.own_velocity[d][slot]);
        Source::new(self.position(slot), velocity, state.density, 0.0, self.shown.mass)
    }

    fn position(&self, slot: usize) -> [f64; D] {
        std::array::from_fn(|d| self.shown.position[d][slot])
    }
}

/// Sums over the fluid for several wall particles.
#[derive(Clone, Copy, Debug)]
pub struct WallSum<const D: usize, L = Lane> {
    extrapolated: ExtrapolationSum<L>,
    velocity: [L; D],
    /// sum rho_f (x_w - x_f) W; only where walls move.
    lever: [L; D],
}

pair_sum!(WallSum { D } { extrapolated, velocity, lever });

/// The law of the pass over wall particles: the pressure's extrapolation, and the fluid's velocity with the same
/// weights.
pub struct WallLaw<'a, K, const D: usize> {
    kernel: K,
    gravity: [f64; D],
    targets: &'a Vectors<D>,
    sources: &'a PairParticles<D>,
    moving: bool,
}

impl<'a, K: Kernel<D>, const D: usize> WallLaw<'a, K, D> {
    /// From the fluid to the walls.
    pub fn new(kernel: K, gravity: [f64; D], walls: &'a Walls<D>, sources: &'a PairParticles<D>) -> Self {
        Self { kernel, gravity, targets: &walls.shown.position, sources, moving: walls.moving.is_some() }
    }
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for WallLaw<'_, K, D> {
    const SINGLE: bool = true;
    type Target<L: Lanes> = ();
    type Sum<L: Lanes> = WallSum<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.targets
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.sources.sources[j].position
    }
    #[inline(always)]
    fn source_numbers<L: Lanes>(&self, j: usize) -> [L::Number; D] {
        self.sources.at::<L>(j)
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), j: usize, dx: [L; D], r2: L, sum: &mut WallSum<D, L>) {
        let fluid = self.sources.beside::<L>(j);
        let (extrapolated, pair) = (&mut sum.extrapolated, (dx, r2));
        let w = extrapolated.add_particle::<K, D, A>(
            &self.kernel,
            self.gravity,
            pair,
            fluid.density,
            fluid.pressure,
        );
        for d in 0..D {
            sum.velocity[d] = A::mul_add(fluid.velocity[d], w, sum.velocity[d]);
        }
        if self.moving {
            let weight = fluid.density * w;
            for d in 0..D {
                sum.lever[d] = A::mul_add(weight, dx[d], sum.lever[d]);
            }
        }
    }
}
