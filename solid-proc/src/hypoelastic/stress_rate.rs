//! Rate of the deviatoric stress, Kayaki's eqs. (7) and (8): Hooke's law with the Jaumann rate,
//!   ds_ab/dt = 2 G (e_ab - delta_ab e_cc / 3) + s_ac w_bc + s_bc w_ac,
//!   e_ab = (dv_a/dx_b + dv_b/dx_a) / 2,  w_ab = (dv_a/dx_b - dv_b/dx_a) / 2.
//! The third of the trace is right in plane strain as well, where e_zz = 0 and s_zz = -(s_xx + s_yy).

/// The rate from shear modulus G, velocity gradient `l[a][b]` = dv_a/dx_b and deviatoric stress.
#[inline]
pub(super) fn jaumann<const D: usize>(g: f64, l: [[f64; D]; D], s: [[f64; D]; D]) -> [[f64; D]; D] {
    let third: f64 = (0..D).map(|c| l[c][c]).sum::<f64>() / 3.0;
    let w = |a: usize, b: usize| 0.5 * (l[a][b] - l[b][a]);
    std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let strain = 0.5 * (l[a][b] + l[b][a]) - if a == b { third } else { 0.0 };
            let mut rate = 2.0 * g * strain;
            for c in 0..D {
                rate += s[a][c] * w(b, c) + s[b][c] * w(a, c);
            }
            rate
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simple_shear_by_hand() {
        // dv_x/dy = 2, G = 3, no stress yet: e_xy = 1, s_xy grows at 2 G e_xy = 6.
        let rate = jaumann(3.0, [[0.0, 2.0], [0.0, 0.0]], [[0.0; 2]; 2]);
        assert_eq!(rate, [[0.0, 6.0], [6.0, 0.0]]);
    }

    #[test]
    fn stretch_by_hand() {
        // dv_x/dx = 3, plane strain: e_xx - 1 = 2, e_yy - 1 = -1, times 2 G = 2.
        let rate = jaumann(1.0, [[3.0, 0.0], [0.0, 0.0]], [[0.0; 2]; 2]);
        assert_eq!(rate, [[4.0, 0.0], [0.0, -2.0]]);
    }

    #[test]
    fn rotation_turns_the_stress() {
        // Anticlockwise rotation at rate 1: dv_x/dy = -1, dv_y/dx = 1, so w_xy = -1. A stress s_xx = 1 turns toward
        // s_xy: with w = w_xy, ds_xx = 2 s_xy w = 0, ds_xy = (s_yy - s_xx) w = 1.
        let rate = jaumann(5.0, [[0.0, -1.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, 0.0]]);
        assert_eq!(rate, [[0.0, 1.0], [1.0, 0.0]]);
    }

    #[test]
    fn rotation_follows_the_exact_tensor() {
        // A unit stress along x, rotated by 90 degrees, ends along y.
        let (mut s, n) = ([[1.0, 0.0], [0.0, 0.0]], 100_000);
        let dt = std::f64::consts::FRAC_PI_2 / f64::from(n);
        let l = [[0.0, -1.0], [1.0, 0.0]];
        for _ in 0..n {
            let k1 = jaumann(5.0, l, s);
            let mid: [[f64; 2]; 2] =
                std::array::from_fn(|a| std::array::from_fn(|b| s[a][b] + 0.5 * dt * k1[a][b]));
            let k2 = jaumann(5.0, l, mid);
            s = std::array::from_fn(|a| std::array::from_fn(|b| s[a][b] + dt * k2[a][b]));
        }
        assert!(s[0][0].abs() < 1e-8 && s[0][1].abs() < 1e-8 && (s[1][1] - 1.0).abs() < 1e-8, "{s:?}");
    }
}
