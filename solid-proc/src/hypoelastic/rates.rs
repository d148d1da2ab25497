//! The solid's neighbour pass: velocity gradient and momentum in one go.
//!
//!   dv_a/dx_b = sum_j V_j (v_j - v_i)_a F x_ij,b                                        (and D rho / Dt = -rho tr)
//!   D v_i / Dt = sum_j m_j [sigma_i/rho_i² + sigma_j/rho_j² - Pi_ij I + (R_i + R_j) f^n] . grad W    (eqs. 22 to 26)

use super::columns::{Source, State};
use halfstep_scene::ArtificialStress as Keys;
use halfstep_sph::artificial_viscosity::damping;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Lane, Lanes};
use halfstep_sph::pair::{PairLaw, distance, dot, pair_sum};
use std::marker::PhantomData;

/// Correction of the momentum bracket against the tensile instability; `()` is none.
pub(super) trait TensileCorrection<const D: usize>: Copy + Send + Sync {
    /// What it loads of the targets.
    type Own<L: Lanes>: Copy;
    fn own<L: Lanes>(&self, slot: usize) -> Self::Own<L>;
    /// The (a, b) component's addition for a pair at kernel value `w`.
    fn add<A: Arch, L: Lanes>(
        &self,
        own: &Self::Own<L>,
        j: usize,
        w: impl Fn() -> L,
        bracket: &mut [[L; D]; D],
    );
}

impl<const D: usize> TensileCorrection<D> for () {
    type Own<L: Lanes> = ();
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, _: impl Fn() -> L, _: &mut [[L; D]; D]) {}
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

/// A tensor of consecutive slots.
#[inline(always)]
fn load<L: Lanes, const D: usize>(of: impl Fn(usize) -> [[f64; D]; D], slot: usize) -> [[L; D]; D] {
    std::array::from_fn(|a| std::array::from_fn(|b| L::each(|k| of(slot + k)[a][b])))
}

/// The n-th power, n >= 1. The usual 4 takes no loop.
#[inline(always)]
fn power<L: Lanes>(x: L, n: u32) -> L {
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
    type Own<L: Lanes> = [[L; D]; D];
    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> Self::Own<L> {
        load(|s| self.tensors[s], slot)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        own: &Self::Own<L>,
        j: usize,
        w: impl Fn() -> L,
        bracket: &mut [[L; D]; D],
    ) {
        let ratio = w() * L::splat(self.inverse_w0);
        let power = power(ratio, self.exponent);
        let other = &self.tensors[j];
        for a in 0..D {
            for b in 0..D {
                bracket[a][b] = A::mul_add(own[a][b] + L::splat(other[a][b]), power, bracket[a][b]);
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

/// Sums for several particles.
#[derive(Clone, Copy)]
pub(super) struct SolidSum<const D: usize, L = Lane> {
    pub acceleration: [L; D],
    pub gradient: [[L; D]; D],
    pub moment: [[L; D]; D],
}

pair_sum!(SolidSum { D } { acceleration, gradient, moment });

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
pub(super) struct Target<O, L, const D: usize> {
    velocity: [L; D],
    density: L,
    stress_term: [[L; D]; D],
    own: O,
}

impl<K: Kernel<D>, T: TensileCorrection<D>, M: Moment, const D: usize> PairLaw<D>
    for SolidLaw<'_, K, T, M, D>
{
    const WIDE: bool = false;
    type Target<L: Lanes> = Target<T::Own<L>, L, D>;
    type Sum<L: Lanes> = SolidSum<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.state.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        Target {
            velocity: std::array::from_fn(|d| L::load(&self.state.velocity[d], slot)),
            density: L::load(&self.state.density, slot),
            stress_term: load(|s| self.sources[s].stress_term, slot),
            own: self.correction.own(slot),
        }
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.sources[j].position
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        i: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut SolidSum<D, L>,
    ) {
        let source = &self.sources[j];
        let h = self.kernel.smoothing_length();
        let r = distance(r2, h);
        let f = self.kernel.gradient_over_r::<A, L>(r);
        let dv: [L; D] = std::array::from_fn(|d| i.velocity[d] - L::splat(source.velocity[d]));
        let approach = dot::<D, A, L>(dv, dx);
        let density_sum = i.density + L::splat(source.density);
        let pi =
            damping::<A, L>(h, L::splat(self.linear), L::splat(self.quadratic), approach, r2, density_sum);
        let mut bracket: [[L; D]; D] = std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                let t = i.stress_term[a][b] + L::splat(source.stress_term[a][b]);
                if a == b { t - pi } else { t }
            })
        });
        self.correction.add::<A, L>(&i.own, j, || self.kernel.value::<A, L>(r), &mut bracket);
        let mf = L::splat(self.mass) * f;
        let vf = L::splat(source.volume) * f;
        for a in 0..D {
            sum.acceleration[a] = A::mul_add(mf, dot::<D, A, L>(bracket[a], dx), sum.acceleration[a]);
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
