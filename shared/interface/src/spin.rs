//! How a solid turns beside each of its particles, from the velocities of its records: the rotation that fits those of
//! its neighbours k of the same body best,
//!   min_Omega sum_k W_sk | u_k - u_s - Omega (x_k - x_s) |²,  Omega antisymmetric.
//! With the moments A = sum W (u_k - u_s) (x_k - x_s)^T and M = sum W (x_k - x_s) (x_k - x_s)^T that is
//!   Omega M + M Omega = A - A^T,  or  (tr M I - M) omega = the axial vector of A - A^T.
//! Of a rigid body it is exact, of a row of particles in the plane, too.

use super::InterfaceParticles;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lane, Lanes};
use halfstep_sph::neighbours::ClusterList;
use halfstep_sph::pair::{PairLaw, distance, pair_sum};
use halfstep_sph::tensor;
use halfstep_wire::protocol::StateRecord;
use nalgebra::{Matrix3, Vector3};

/// det (tr M I - M) over (tr M)³ below which a rotation about some axis is not known: particles in a row in space.
const SMALLEST: f64 = 1e-6;

/// Omega by slot of the solid, 1/s.
#[derive(Clone, Debug)]
pub(super) struct Spin<const D: usize> {
    /// Components a < b.
    pub(super) columns: [[Vec<f64>; D]; D],
    /// Neighbours of the solid among itself.
    pub(super) list: ClusterList,
    pub(super) sums: Vec<Moments<D>>,
    /// Number of the body by slot.
    pub(super) body: Vec<f64>,
}

impl<const D: usize> Spin<D> {
    pub(super) fn new(list: ClusterList) -> Self {
        let columns = std::array::from_fn(|_| std::array::from_fn(|_| Vec::new()));
        Self { columns, list, sums: Vec::new(), body: Vec::new() }
    }

    /// Loads the numbers of bodies by slot.
    pub(super) fn load(&mut self, solid: &InterfaceParticles<D>, records: &[StateRecord]) {
        self.body.resize(solid.density.len(), 0.0);
        for (slot, record) in solid.slots() {
            self.body[slot] = f64::from(records[record].flags >> 8);
        }
    }

    /// Takes the rotations from the moments.
    pub(super) fn solve(&mut self, slots: usize) {
        self.columns.iter_mut().flatten().for_each(|column| column.resize(slots, 0.0));
        for slot in 0..slots {
            let omega = self.sums[slot / LANES].rotation(slot % LANES);
            for a in 0..D {
                for b in a + 1..D {
                    self.columns[a][b][slot] = omega[(a, b)];
                }
            }
        }
    }
}

/// A and M of several particles; of M the upper half.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments<const D: usize, L = Lane> {
    velocity: [[L; D]; D],
    place: [[L; D]; D],
}
pair_sum!(Moments { D } { velocity, place });

impl<const D: usize> Moments<D> {
    /// Omega of the k-th; zero where its neighbours do not say.
    fn rotation(&self, k: usize) -> Matrix3<f64> {
        let (mut place, mut twist) = (Matrix3::<f64>::zeros(), Matrix3::<f64>::zeros());
        for a in 0..D {
            for b in 0..D {
                place[(a, b)] = self.place[a.min(b)][a.max(b)].0[k];
                twist[(a, b)] = self.velocity[a][b].0[k] - self.velocity[b][a].0[k];
            }
        }
        let trace = place.trace();
        if trace <= 0.0 {
            return Matrix3::zeros();
        }
        let axial = Vector3::new(twist[(2, 1)], twist[(0, 2)], twist[(1, 0)]);
        let inertia = Matrix3::identity() * trace - place;
        let omega = if D == 2 {
            axial / trace
        } else {
            let determinant = tensor::determinant(&inertia);
            let known = determinant > SMALLEST * trace * trace * trace;
            let inverse = known.then(|| tensor::inverse(&inertia, determinant)).flatten();
            inverse.map_or_else(Vector3::zeros, |inverse| inverse * axial)
        };
        omega.cross_matrix()
    }
}

/// The law of the pass over the solid.
pub(super) struct MomentLaw<'a, K, const D: usize> {
    pub(super) kernel: K,
    pub(super) solid: &'a InterfaceParticles<D>,
    /// Number of the body by slot.
    pub(super) body: &'a [f64],
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for MomentLaw<'_, K, D> {
    /// Velocity, body.
    type Target<L: Lanes> = ([L; D], L);
    type Sum<L: Lanes> = Moments<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.solid.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        let velocity = std::array::from_fn(|d| L::load(&self.solid.velocity[d], slot));
        (velocity, L::load(self.body, slot))
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.solid.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        (velocity, body): &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut Moments<D, L>,
    ) {
        // Numbers of bodies are whole: 1 for the same one, else 0.
        let apart = *body - L::splat(self.body[j]);
        let same = (L::splat(1.0) - apart * apart).max(L::ZERO);
        let w = same * self.kernel.value::<A, L>(distance(r2, self.kernel.smoothing_length()));
        for a in 0..D {
            let dv = w * (velocity[a] - L::splat(self.solid.velocity[a][j]));
            for b in 0..D {
                sum.velocity[a][b] = A::mul_add(dv, dx[b], sum.velocity[a][b]);
            }
            let row = w * dx[a];
            for b in a..D {
                sum.place[a][b] = A::mul_add(row, dx[b], sum.place[a][b]);
            }
        }
    }
}
