//! Rigid walls toward the solid (Kayaki section 4.1, after Adami): velocity zero always, pressure extrapolated from the
//! solid around, density rho_w = rho_s0 (1 + p_w / K), no deviatoric stress. A wall that could pull would glue the
//! solid to it, so only pressures above zero act, and only walls that the scene lets the solid touch are here.
//!
//! The pressure at a surface is nearly zero, so that alone a wall would carry a body by its damping only, and a body at
//! rest would creep into it. Below the spacing dx (the mean of the two), at which two surfaces meet, particles repel each other as those of
//! different bodies do: F = k (dx - r) x / r with k = (K + 4 G / 3) / 2 dx^(D-2).

use crate::columns::{Vectors, vectors};
use halfstep_scene::geometry::WallPoint;
use halfstep_sph::artificial_viscosity::damping;
use halfstep_sph::columns::{bounds, fit};
use halfstep_sph::extrapolation::{Extrapolation, ExtrapolationSum};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Isa, LANES, Lane};
use halfstep_sph::neighbours::{ClusterList, Rows};
use halfstep_sph::pair::{self, PairLaw, distance, dot};

/// Wall particles that the solid may touch.
pub(crate) struct Walls<const D: usize> {
    id: Vec<u32>,
    position: Vectors<D>,
    pressure: Vec<f64>,
    density: Vec<f64>,
    rows: Rows<D>,
    /// Walls' solid neighbours.
    sources: ClusterList,
    /// The solid's wall neighbours.
    neighbours: ClusterList,
    sums: Vec<ExtrapolationSum>,
    forces: Vec<WallForce<D>>,
}

impl<const D: usize> Walls<D> {
    /// `None` where the solid may touch no wall.
    pub(crate) fn new(points: &[WallPoint<D>], height: f64) -> Option<Self> {
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
        for (i, p) in points.iter().enumerate() {
            for d in 0..D {
                walls.position[d][i] = p.position[d];
            }
        }
        let (low, high) = bounds(&walls.position);
        walls.rows.sort(&walls.position, &walls.id, height, low, high);
        for d in 0..D {
            walls.rows.permute(&mut walls.position[d]);
        }
        walls.rows.permute_ids(&mut walls.id);
        walls.pressure = vec![0.0; walls.rows.slots()];
        walls.density = vec![0.0; walls.rows.slots()];
        Some(walls)
    }

    /// Lists who is near whom, to `reach`. The solid is sorted by `rows`.
    pub(crate) fn relist(&mut self, solid: &Vectors<D>, rows: &Rows<D>, reach: f64) {
        self.neighbours.build(solid, &self.position, &self.rows, reach);
        self.sources.build(&self.position, solid, rows, reach);
        fit(&mut self.sums, self.sources.clusters(), ExtrapolationSum::default());
        fit(&mut self.forces, self.neighbours.clusters(), WallForce::default());
    }

    /// Pairs listed between walls and solid, four targets each.
    pub(crate) fn pairs(&self) -> usize {
        LANES * (self.sources.entries() + self.neighbours.entries())
    }

    /// Evaluates the push on every solid particle.
    pub(crate) fn act<K: Kernel<D>>(
        &mut self,
        isa: Isa,
        kernel: K,
        gravity: [f64; D],
        solid: Touching<'_, D>,
    ) {
        let law = Extrapolation {
            kernel,
            gravity,
            targets: &self.position,
            sources: solid.position,
            density: solid.density,
            pressure: solid.pressure,
        };
        pair::pass(isa, &law, &self.sources, &mut self.sums);
        self.show(solid.reference_density, solid.bulk_modulus);
        let law = Push {
            kernel,
            solid,
            position: &self.position,
            pressure: &self.pressure,
            density: &self.density,
        };
        pair::pass(isa, &law, &self.neighbours, &mut self.forces);
    }

    /// Acceleration of the solid particle at a slot, m/s².
    pub(crate) fn acceleration(&self, slot: usize) -> [f64; D] {
        self.forces[slot / LANES].0.map(|a| a.0[slot % LANES])
    }

    /// Pressure and density shown to the solid.
    fn show(&mut self, density: f64, bulk_modulus: f64) {
        for (c, sum) in self.sums.iter().enumerate() {
            for k in 0..LANES {
                let p = sum.pressure(k).unwrap_or(0.0).max(0.0);
                self.pressure[c * LANES + k] = p;
                self.density[c * LANES + k] = density * (1.0 + p / bulk_modulus);
            }
        }
    }
}

/// The solid as walls see it: columns sorted by the rows that the lists were made with.
#[derive(Clone, Copy)]
pub(crate) struct Touching<'a, const D: usize> {
    /// m.
    pub(crate) position: &'a Vectors<D>,
    /// m/s.
    pub(crate) velocity: &'a Vectors<D>,
    /// kg/m³.
    pub(crate) density: &'a [f64],
    /// Pa.
    pub(crate) pressure: &'a [f64],
    /// What a wall particle's cell holds of the solid's material, kg (2D: kg/m).
    pub(crate) wall_mass: f64,
    /// kg/m³.
    pub(crate) reference_density: f64,
    /// Pa.
    pub(crate) bulk_modulus: f64,
    /// A c_s of the artificial viscosity.
    pub(crate) linear: f64,
    /// B of the artificial viscosity.
    pub(crate) quadratic: f64,
    /// Mean of the spacings of solid and walls, m.
    pub(crate) spacing: f64,
    /// k over a particle's mass, 1/s²: see [`repulsion`].
    pub(crate) repulsion: f64,
}

/// k over a particle's mass, 1/s², for a material's pressure waves and spacing.
pub(crate) fn repulsion(pressure_wave_speed: f64, spacing: f64) -> f64 {
    0.5 * (pressure_wave_speed / spacing).powi(2)
}

/// Acceleration of four solid particles by the walls.
#[derive(Clone, Copy)]
struct WallForce<const D: usize>([Lane; D]);

impl<const D: usize> Default for WallForce<D> {
    fn default() -> Self {
        Self([Lane::ZERO; D])
    }
}

/// The walls push the solid.
struct Push<'a, K, const D: usize> {
    kernel: K,
    solid: Touching<'a, D>,
    /// Of the wall particles, m.
    position: &'a Vectors<D>,
    /// Of the wall particles, Pa.
    pressure: &'a [f64],
    /// Of the wall particles, kg/m³.
    density: &'a [f64],
}

#[derive(Clone, Copy)]
struct Target<const D: usize> {
    velocity: [Lane; D],
    density: Lane,
    pressure_term: Lane,
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for Push<'_, K, D> {
    type Target = Target<D>;
    type Sum = WallForce<D>;
    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.solid.position
    }
    #[inline(always)]
    fn target(&self, slot: usize) -> Target<D> {
        let density = Lane::load(self.solid.density, slot);
        let pressure = Lane::load(self.solid.pressure, slot).max(Lane::ZERO);
        Target {
            velocity: std::array::from_fn(|d| Lane::load(&self.solid.velocity[d], slot)),
            density,
            pressure_term: pressure / (density * density),
        }
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch>(&self, i: &Target<D>, j: usize, dx: [Lane; D], r2: Lane, sum: &mut WallForce<D>) {
        let h = self.kernel.smoothing_length();
        let f = self.kernel.gradient_over_r::<A>(distance(r2, h));
        let approach = dot::<D, A>(i.velocity, dx);
        let rho = self.density[j];
        let pi = damping::<A>(
            h,
            Lane::splat(self.solid.linear),
            Lane::splat(self.solid.quadratic),
            approach,
            r2,
            i.density + Lane::splat(rho),
        );
        let term = i.pressure_term + Lane::splat(self.pressure[j] / (rho * rho)) + pi;
        let r = distance(r2, self.solid.spacing);
        let overlap = (Lane::splat(self.solid.spacing) - r).max(Lane::ZERO);
        let coefficient =
            Lane::splat(-self.solid.wall_mass) * f * term + Lane::splat(self.solid.repulsion) * overlap / r;
        for d in 0..D {
            sum.0[d] = A::mul_add(coefficient, dx[d], sum.0[d]);
        }
    }
}
