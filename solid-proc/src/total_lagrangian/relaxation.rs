//! Relaxation: a generalised Maxwell solid (`solid.prony`), on the deviator of the second Piola-Kirchhoff stress.
//!
//! The law with E and nu is the long-time one. Beside it stand Maxwell arms i of shear modulus g_i G and relaxation
//! time tau_i, driven by the elastic deviator s = 2 G dev(E) of Green's strain E (Simo and Hughes 1998, section 10.3;
//! Holzapfel 2000, section 6.10), which rotations do not change:
//!   dh_i/dt + h_i / tau_i = g_i ds/dt,   S = S_law + sum_i h_i,   P = F S.
//! Over a sub-step dt in which s goes in a straight line that is solved exactly, whatever dt:
//!   h_i <- exp(-dt / tau_i) h_i + g_i (tau_i / dt) (1 - exp(-dt / tau_i)) (s(n + 1) - s(n)).
//! An arm holds the energy h : h / (4 g_i G) per reference volume. In 2D: plane strain, and h_zz = -(h_xx + h_yy).

use super::account::lost_by_arm;
use super::material::{Cauchy, Matrix, green};
use halfstep_wire::state::{Fields, State, StateError};

/// A Maxwell arm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arm {
    /// g: its shear modulus over G.
    pub(super) share: f64,
    /// tau, s.
    time: f64,
}

/// What an arm does over a sub-step.
#[derive(Clone, Copy, Debug)]
struct Advance {
    /// exp(-dt / tau).
    kept: f64,
    /// g (tau / dt) (1 - exp(-dt / tau)).
    gained: f64,
}

impl Arm {
    /// Over `dt`, s; 0: an instant.
    fn over(self, dt: f64) -> Advance {
        let x = dt / self.time;
        let mean = if x > 0.0 { -libm::expm1(-x) / x } else { 1.0 };
        Advance { kept: libm::exp(-x), gained: self.share * mean }
    }
}

impl Advance {
    fn of<const D: usize>(self, h: &Matrix<D>, change: &Matrix<D>) -> Matrix<D> {
        h * self.kept + change * self.gained
    }
}

/// What the arms of each particle remember, by slot; nothing where there are no arms.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory<const D: usize> {
    /// s, Pa.
    elastic: Vec<Matrix<D>>,
    /// h of each arm, Pa.
    arms: Vec<Vec<Matrix<D>>>,
}

impl<const D: usize> Memory<D> {
    /// Of an unstrained solid.
    pub(super) fn new(slots: usize, arms: usize) -> Self {
        let column = || vec![Matrix::zeros(); slots];
        Self {
            elastic: if arms > 0 { column() } else { Vec::new() },
            arms: (0..arms).map(|_| column()).collect(),
        }
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.elastic.clone_from(&other.elastic);
        for (arm, from) in self.arms.iter_mut().zip(&other.arms) {
            arm.clone_from(from);
        }
    }

    /// sum h of a particle, Pa; `None` without arms.
    pub(super) fn stress(&self, slot: usize) -> Option<Matrix<D>> {
        let (first, others) = self.arms.split_first()?;
        Some(others.iter().fold(first[slot], |sum, arm| sum + arm[slot]))
    }

    /// The Cauchy stress with that of the arms.
    pub(super) fn added_to(&self, cauchy: Cauchy<D>, slot: usize, f: &Matrix<D>, j: f64) -> Cauchy<D> {
        let Some(h) = self.stress(slot) else { return cauchy };
        let sigma = f * h * f.transpose() / j;
        let out_of_plane = if D == 2 { -h.trace() / j } else { 0.0 };
        let pressure = -(sigma.trace() + out_of_plane) / 3.0;
        Cauchy {
            pressure: cauchy.pressure + pressure,
            deviator: cauchy.deviator + sigma + Matrix::identity() * pressure,
        }
    }

    /// Energy in a particle's arms per reference volume, J/m³, of a solid of this shear modulus, Pa.
    pub(super) fn energy(&self, slot: usize, arms: &[Arm], shear_modulus: f64) -> f64 {
        let of = |(h, arm): (&Vec<Matrix<D>>, &Arm)| {
            let h = &h[slot];
            let out_of_plane = if D == 2 { h.trace() * h.trace() } else { 0.0 };
            (h.component_mul(h).sum() + out_of_plane) / (4.0 * arm.share * shear_modulus)
        };
        self.arms.iter().zip(arms).map(of).sum()
    }
}

impl<const D: usize> State for Memory<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let slots = self.elastic.len();
        let mut column = |name: &str, column: &mut Vec<Matrix<D>>| {
            let mut flat: Vec<f64> = column.iter().flat_map(|m| m.iter().copied()).collect();
            fields.reals(name, &mut flat)?;
            fields.length(name, slots * D * D, flat.len())?;
            *column = flat.chunks_exact(D * D).map(Matrix::from_column_slice).collect();
            Ok(())
        };
        column("elastic", &mut self.elastic)?;
        self.arms.iter_mut().enumerate().try_for_each(|(k, arm)| column(&format!("arm_{k}"), arm))
    }
}

/// What the pass over the particles adds to the law's stress; `()` is nothing.
pub(super) trait Relaxation<const D: usize> {
    const ACTS: bool;
    /// Advances a particle's memory to its deformation gradient; S of its arms, Pa.
    fn advance(&mut self, slot: usize, f: &Matrix<D>) -> Matrix<D>;
}

impl<const D: usize> Relaxation<D> for () {
    const ACTS: bool = false;
    fn advance(&mut self, _: usize, _: &Matrix<D>) -> Matrix<D> {
        Matrix::zeros()
    }
}

/// The arms of a solid over a sub-step.
pub(super) struct Arms<'a, const D: usize> {
    memory: &'a mut Memory<D>,
    advances: Vec<Advance>,
    /// 2 G, Pa.
    modulus: f64,
    lost: Option<Loss<'a>>,
}

/// What arms lose over a sub-step.
struct Loss<'a> {
    arms: &'a [Arm],
    /// s.
    dt: f64,
    /// Sum over the particles per reference volume, J/m³.
    energy: f64,
}

impl<'a, const D: usize> Arms<'a, D> {
    /// Over `dt`, s.
    pub(super) fn over(dt: f64, arms: &[Arm], shear_modulus: f64, memory: &'a mut Memory<D>) -> Self {
        let advances = arms.iter().map(|arm| arm.over(dt)).collect();
        Self { memory, advances, modulus: 2.0 * shear_modulus, lost: None }
    }

    /// The same, with account kept of what the arms lose.
    pub(super) fn with_account(mut self, dt: f64, arms: &'a [Arm]) -> Self {
        self.lost = (dt > 0.0).then_some(Loss { arms, dt, energy: 0.0 });
        self
    }

    /// Energy lost, sum over the particles per reference volume, J/m³.
    pub(super) fn lost(&self) -> f64 {
        self.lost.as_ref().map_or(0.0, |loss| loss.energy)
    }
}

impl<const D: usize> Relaxation<D> for Arms<'_, D> {
    const ACTS: bool = true;
    fn advance(&mut self, slot: usize, f: &Matrix<D>) -> Matrix<D> {
        let e = green(f);
        let s = (e - Matrix::identity() * (e.trace() / 3.0)) * self.modulus;
        let change = s - self.memory.elastic[slot];
        self.memory.elastic[slot] = s;
        let mut sum = Matrix::zeros();
        for (k, (arm, advance)) in self.memory.arms.iter_mut().zip(&self.advances).enumerate() {
            let before = arm[slot];
            arm[slot] = advance.of(&before, &change);
            sum += arm[slot];
            if let Some(Loss { arms, dt, energy }) = &mut self.lost {
                let Arm { share, time } = arms[k];
                *energy += lost_by_arm((share, time), *dt, self.modulus, &change, [&before, &arm[slot]]);
            }
        }
        sum
    }
}

/// The arms that a scene gives, [g, tau] each.
pub(super) fn arms(prony: &[[f64; 2]]) -> Vec<Arm> {
    prony.iter().map(|&[share, time]| Arm { share, time }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix2;

    const ARM: Arm = Arm { share: 0.5, time: 0.06 };

    #[test]
    fn a_straight_strain_path_is_exact_in_steps_of_any_length() {
        // s = t: h = g tau (1 - exp(-t / tau)).
        let (mut h, mut time) = (Matrix2::zeros(), 0.0);
        for dt in [1e-6, 0.01, 0.3, 2.0, 1e-3] {
            let change = Matrix2::new(dt, 0.0, 0.0, -dt);
            h = ARM.over(dt).of(&h, &change);
            time += dt;
            let exact = 0.5 * 0.06 * (1.0 - (-time / 0.06_f64).exp());
            assert!((h[(0, 0)] - exact).abs() < 1e-15 && h[(1, 1)] == -h[(0, 0)], "{time}: {h}");
        }
    }

    #[test]
    fn creep_under_a_constant_shear_stress_by_hand() {
        // Zener solid: 2 G e + h = 1, 2 G = 1: e = 1 - g / (1 + g) exp(-t / ((1 + g) tau)), from 1 / (1 + g) on.
        let (g, tau) = (ARM.share, ARM.time);
        let creep = |t: f64| 1.0 - g / (1.0 + g) * (-t / ((1.0 + g) * tau)).exp();
        let (mut e, steps, end) = (creep(0.0), 200_000, 0.12);
        let mut h = Matrix2::new(0.0, g * e, g * e, 0.0);
        let advance = ARM.over(end / f64::from(steps));
        let mut worst = 0.0_f64;
        for k in 1..=steps {
            // 2 G e' + kept h + gained 2 G (e' - e) = 1.
            let next = (1.0 - advance.kept * h[(0, 1)] + advance.gained * e) / (1.0 + advance.gained);
            h = advance.of(&h, &Matrix2::new(0.0, next - e, next - e, 0.0));
            e = next;
            worst = worst.max((e - creep(end * f64::from(k) / f64::from(steps))).abs());
        }
        assert!(worst < 1e-10, "{worst}");
    }
}
