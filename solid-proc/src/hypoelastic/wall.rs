//! Rigid walls toward the solid (Kayaki section 4.1, after Adami): velocity zero always, pressure extrapolated from the
//! solid around, density rho_w = rho_s0 (1 + p_w / K), no deviatoric stress. A wall that could pull would glue the solid
//! to it, so only pressures above zero act, and only walls that the scene lets the solid touch are here.

use super::columns::{State, Vectors, vectors};
use super::rates::artificial_viscosity;
use halfstep_shared::extrapolation::ExtrapolationSum;
use halfstep_shared::geometry::WallPoint;
use halfstep_shared::kernel::Kernel;
use halfstep_shared::lane::{Arch, LANES, Lane};
use halfstep_shared::neighbours::{ClusterList, Rows};
use halfstep_shared::pair::{PairLaw, distance, dot};

/// Wall particles that the solid may touch.
pub(super) struct Walls<const D: usize> {
    id: Vec<u32>,
    pub position: Vectors<D>,
    pub pressure: Vec<f64>,
    pub density: Vec<f64>,
    pub rows: Rows<D>,
    /// Walls' solid neighbours.
    pub sources: ClusterList,
    /// The solid's wall neighbours.
    pub neighbours: ClusterList,
    pub sums: Vec<ExtrapolationSum>,
    pub forces: Vec<WallForce<D>>,
}

impl<const D: usize> Walls<D> {
    /// `None` where the solid may touch no wall.
    pub(super) fn new(points: &[WallPoint<D>], height: f64) -> Option<Self> {
        let points: Vec<_> = points.iter().filter(|p| p.contact).collect();
        if points.is_empty() {
            return None;
        }
        let n = points.len();
        let mut walls = Self {
            id: (0..n as u32).collect(),
            position: vectors(n),
            pressure: Vec::new(),
            density: Vec::new(),
            rows: Rows::default(),
            sources: ClusterList::default(),
            neighbours: ClusterList::default(),
            sums: Vec::new(),
            forces: Vec::new(),
        };
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for (i, p) in points.iter().enumerate() {
            for d in 0..D {
                walls.position[d][i] = p.position[d];
                low[d] = low[d].min(p.position[d]);
                high[d] = high[d].max(p.position[d]);
            }
        }
        walls.rows.sort(&walls.position, &walls.id, height, low, high);
        for d in 0..D {
            walls.rows.permute(&mut walls.position[d]);
        }
        walls.rows.permute_ids(&mut walls.id);
        walls.pressure = vec![0.0; walls.rows.slots()];
        walls.density = vec![0.0; walls.rows.slots()];
        Some(walls)
    }

    /// Pressure and density shown to the solid.
    pub(super) fn show(&mut self, density: f64, bulk_modulus: f64) {
        for (c, sum) in self.sums.iter().enumerate() {
            for k in 0..LANES {
                let p = sum.pressure(k).unwrap_or(0.0).max(0.0);
                self.pressure[c * LANES + k] = p;
                self.density[c * LANES + k] = density * (1.0 + p / bulk_modulus);
            }
        }
    }
}

/// Acceleration of four solid particles by the walls.
#[derive(Clone, Copy)]
pub(super) struct WallForce<const D: usize>(pub [Lane; D]);

impl<const D: usize> Default for WallForce<D> {
    fn default() -> Self {
        Self([Lane::ZERO; D])
    }
}

/// The walls push the solid.
pub(super) struct Push<'a, K, const D: usize> {
    pub kernel: K,
    pub solid: &'a State<D>,
    /// Pressure of the solid, Pa.
    pub pressure: &'a [f64],
    pub walls: &'a Walls<D>,
    pub mass: f64,
    pub linear: f64,
    pub quadratic: f64,
}

#[derive(Clone, Copy)]
pub(super) struct Target<const D: usize> {
    velocity: [Lane; D],
    density: Lane,
    pressure_term: Lane,
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for Push<'_, K, D> {
    type Target = Target<D>;
    type Sum = WallForce<D>;
    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.solid.position
    }
    #[inline(always)]
    fn target(&self, slot: usize) -> Target<D> {
        let density = Lane::load(&self.solid.density, slot);
        let pressure = Lane::load(self.pressure, slot).max(Lane::ZERO);
        Target {
            velocity: std::array::from_fn(|d| Lane::load(&self.solid.velocity[d], slot)),
            density,
            pressure_term: pressure / (density * density),
        }
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.walls.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch>(&self, i: &Target<D>, j: usize, dx: [Lane; D], r2: Lane, sum: &mut WallForce<D>) {
        let h = self.kernel.smoothing_length();
        let f = self.kernel.gradient_over_r::<A>(distance(r2, h));
        let approach = dot::<D, A>(i.velocity, dx);
        let rho = self.walls.density[j];
        let pi = artificial_viscosity::<A>(
            h,
            self.linear,
            self.quadratic,
            approach,
            r2,
            i.density + Lane::splat(rho),
        );
        let term = i.pressure_term + Lane::splat(self.walls.pressure[j] / (rho * rho)) + pi;
        let coefficient = Lane::splat(-self.mass) * f * term;
        for d in 0..D {
            sum.0[d] = A::mul_add(coefficient, dx[d], sum.0[d]);
        }
    }
}
