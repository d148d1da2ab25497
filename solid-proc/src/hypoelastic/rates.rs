//! The solid's neighbour pass: velocity gradient and momentum in one go.
//!
//!   dv_a/dx_b = sum_j V_j (v_j - v_i)_a F x_ij,b                                        (and D rho / Dt = -rho tr)
//!   D v_i / Dt = sum_j m_j [sigma_i/rho_i² + sigma_j/rho_j² - Pi_ij I + (R_i + R_j) f^n] . grad W    (eqs. 22 to 26)

use super::columns::{Source, State};
use halfstep_scene::ArtificialStress as Keys;
use halfstep_sph::artificial_viscosity::damping;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lane};
use halfstep_sph::pair::{PairLaw, distance, dot};
use std::marker::PhantomData;

/// Correction of the momentum bracket against the tensile instability; `()` is none.
pub(super) trait TensileCorrection<const D: usize>: Copy + Send + Sync {
    /// What it loads of four targets.
    type Own: Copy;
    fn own(&self, slot: usize) -> Self::Own;
    /// The (a, b) component's addition for a pair at kernel value `w`.
    fn add<A: Arch>(&self, own: &Self::Own, j: usize, w: impl Fn() -> Lane, bracket: &mut [[Lane; D]; D]);
}

impl<const D: usize> TensileCorrection<D> for () {
    type Own = ();
    #[inline(always)]
    fn own(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch>(&self, _: &(), _: usize, _: impl Fn() -> Lane, _: &mut [[Lane; D]; D]) {}
}

/// The artificial stress with its tensors R.
#[derive(Clone, Copy)]
pub(super) struct ArtificialStress<'a, const D: usize> {
    pub tensors: &'a [[[f64; D]; D]],
    /// 1 / W(d0).
    pub inverse_w0: f64,
    pub exponent: u32,
}

impl<'a, const D: usize> ArtificialStress<'a, D> {
    /// From the scene's keys, where the effect takes part, with the tensors of all slots.
    pub(super) fn of<K: Kernel<D>>(
        keys: Option<Keys>,
        tensors: &'a [[[f64; D]; D]],
        kernel: K,
        spacing: f64,
    ) -> Option<Self> {
        let exponent = keys?.exponent.round() as u32;
        Some(Self { tensors, inverse_w0: 1.0 / kernel.at(spacing), exponent })
    }
}

/// A tensor of four consecutive slots.
#[inline(always)]
fn load<const D: usize>(of: impl Fn(usize) -> [[f64; D]; D], slot: usize) -> [[Lane; D]; D] {
    let four: [_; LANES] = std::array::from_fn(|k| of(slot + k));
    std::array::from_fn(|a| std::array::from_fn(|b| Lane(std::array::from_fn(|k| four[k][a][b]))))
}

/// The n-th power, n >= 1. The usual 4 takes no loop.
#[inline(always)]
fn power(x: Lane, n: u32) -> Lane {
    if n == 4 {
        let square = x * x;
        return square * square;
    }
    let mut power = x;
    for _ in 1..n {
        power = power * x;
    }
    power
}

impl<const D: usize> TensileCorrection<D> for ArtificialStress<'_, D> {
    type Own = [[Lane; D]; D];
    #[inline(always)]
    fn own(&self, slot: usize) -> Self::Own {
        load(|s| self.tensors[s], slot)
    }
    #[inline(always)]
    fn add<A: Arch>(&self, own: &Self::Own, j: usize, w: impl Fn() -> Lane, bracket: &mut [[Lane; D]; D]) {
        let ratio = w() * Lane::splat(self.inverse_w0);
        let power = power(ratio, self.exponent);
        let other = &self.tensors[j];
        for a in 0..D {
            for b in 0..D {
                bracket[a][b] = A::mul_add(own[a][b] + Lane::splat(other[a][b]), power, bracket[a][b]);
            }
        }
    }
}

/// Renormalisation of the velocity gradient: whether the moment matrix is summed up.
pub(super) trait Moment: Copy + Send + Sync {
    const SUMMED: bool;
}
/// As the paper has it.
#[derive(Clone, Copy)]
pub(super) struct Plain;
/// Corrected with the inverse moment matrix.
#[derive(Clone, Copy)]
pub(super) struct Renormalised;
impl Moment for Plain {
    const SUMMED: bool = false;
}
impl Moment for Renormalised {
    const SUMMED: bool = true;
}

/// Sums for four particles.
#[derive(Clone, Copy)]
pub(super) struct SolidSum<const D: usize> {
    pub acceleration: [Lane; D],
    pub gradient: [[Lane; D]; D],
    pub moment: [[Lane; D]; D],
}

impl<const D: usize> Default for SolidSum<D> {
    fn default() -> Self {
        Self { acceleration: [Lane::ZERO; D], gradient: [[Lane::ZERO; D]; D], moment: [[Lane::ZERO; D]; D] }
    }
}

/// The law.
pub(super) struct SolidLaw<'a, K, T, M, const D: usize> {
    pub kernel: K,
    pub correction: T,
    /// Whether the moment matrix is summed.
    pub gradient: PhantomData<M>,
    pub state: &'a State<D>,
    /// Columns as neighbours read them.
    pub sources: &'a [Source<D>],
    pub mass: f64,
    /// A c_s.
    pub linear: f64,
    /// B.
    pub quadratic: f64,
}

#[derive(Clone, Copy)]
pub(super) struct Target<O, const D: usize> {
    velocity: [Lane; D],
    density: Lane,
    stress_term: [[Lane; D]; D],
    own: O,
}

impl<K: Kernel<D>, T: TensileCorrection<D>, M: Moment, const D: usize> PairLaw<D>
    for SolidLaw<'_, K, T, M, D>
{
    type Target = Target<T::Own, D>;
    type Sum = SolidSum<D>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.state.position
    }
    #[inline(always)]
    fn target(&self, slot: usize) -> Self::Target {
        Target {
            velocity: std::array::from_fn(|d| Lane::load(&self.state.velocity[d], slot)),
            density: Lane::load(&self.state.density, slot),
            stress_term: load(|s| self.sources[s].stress_term, slot),
            own: self.correction.own(slot),
        }
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.sources[j].position
    }
    #[inline(always)]
    fn add<A: Arch>(&self, i: &Self::Target, j: usize, dx: [Lane; D], r2: Lane, sum: &mut SolidSum<D>) {
        let source = &self.sources[j];
        let h = self.kernel.smoothing_length();
        let r = distance(r2, h);
        let f = self.kernel.gradient_over_r::<A>(r);
        let dv: [Lane; D] = std::array::from_fn(|d| i.velocity[d] - Lane::splat(source.velocity[d]));
        let approach = dot::<D, A>(dv, dx);
        let density_sum = i.density + Lane::splat(source.density);
        let pi =
            damping::<A>(h, Lane::splat(self.linear), Lane::splat(self.quadratic), approach, r2, density_sum);
        let mut bracket: [[Lane; D]; D] = std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                let t = i.stress_term[a][b] + Lane::splat(source.stress_term[a][b]);
                if a == b { t - pi } else { t }
            })
        });
        self.correction.add::<A>(&i.own, j, || self.kernel.value::<A>(r), &mut bracket);
        let mf = Lane::splat(self.mass) * f;
        let vf = Lane::splat(source.volume) * f;
        for a in 0..D {
            sum.acceleration[a] = A::mul_add(mf, dot::<D, A>(bracket[a], dx), sum.acceleration[a]);
            let row = -(vf * dv[a]);
            for b in 0..D {
                sum.gradient[a][b] = A::mul_add(row, dx[b], sum.gradient[a][b]);
            }
            if M::SUMMED {
                let row = -(vf * dx[a]);
                for b in a..D {
                    sum.moment[a][b] = A::mul_add(row, dx[b], sum.moment[a][b]);
                }
            }
        }
    }
}
