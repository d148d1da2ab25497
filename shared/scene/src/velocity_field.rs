//! Initial velocity fields of a fluid with a known solution.
//!
//! Their functions come from the crate libm: a system's own differ in the last bit from machine to machine.

use libm::{cos, exp, sin, tanh};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A solenoidal velocity field in x and y, added to a shape's `velocity`. k = pi / `half_wave`, and x, y are measured
/// from `origin`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VelocityField {
    /// Taylor and Green's vortices (Taylor and Green 1937; in two dimensions an exact solution of the Navier-Stokes
    /// equations): u = U sin(k x) cos(k y), v = -U cos(k x) sin(k y). Cells of side `half_wave` hold one each. Comes
    /// with its pressure rho U² / 4 (cos 2kx + cos 2ky).
    TaylorGreen {
        /// Largest speed U, m/s.
        speed: f64,
        /// A corner of a vortex cell, m.
        origin: [f64; 3],
        /// Side of a cell, m.
        half_wave: f64,
    },
    /// A standing wave of linear theory (Lamb, Hydrodynamics, section 228) as it passes through the flat surface:
    /// u = -a omega sin(k x) cosh(k y) / sinh(k H), v = a omega cos(k x) sinh(k y) / sinh(k H),
    /// omega² = g k tanh(k H).
    StandingWave {
        /// Amplitude a of the surface, m.
        amplitude: f64,
        /// On the floor below a crest, m.
        origin: [f64; 3],
        /// Half a wave length, m.
        half_wave: f64,
        /// Depth H, m.
        depth: f64,
    },
}

impl VelocityField {
    /// Velocity at a point, m/s; `gravity` is its size, m/s².
    pub fn velocity(&self, position: [f64; 2], gravity: f64) -> [f64; 2] {
        match *self {
            Self::TaylorGreen { speed, origin, half_wave } => {
                let [x, y] = phases(position, origin, half_wave);
                [speed * sin(x) * cos(y), -speed * cos(x) * sin(y)]
            }
            Self::StandingWave { amplitude, origin, half_wave, depth } => {
                let k = PI / half_wave;
                let speed = amplitude * (gravity * k * tanh(k * depth)).sqrt();
                let [x, y] = phases(position, origin, half_wave);
                // sinh(ky) / sinh(kH) and cosh(ky) / sinh(kH), which do not overflow where the water is deep.
                let rise = exp(y - k * depth) / (1.0 - exp(-2.0 * k * depth));
                let (sinh, cosh) = (rise * (1.0 - exp(-2.0 * y)), rise * (1.0 + exp(-2.0 * y)));
                [-speed * sin(x) * cosh, speed * cos(x) * sinh]
            }
        }
    }

    /// Pressure at a point beside the hydrostatic one, Pa.
    pub fn pressure(&self, position: [f64; 2], density: f64) -> f64 {
        match *self {
            Self::TaylorGreen { speed, origin, half_wave } => {
                let [x, y] = phases(position, origin, half_wave);
                0.25 * density * speed * speed * (cos(2.0 * x) + cos(2.0 * y))
            }
            // The wave's own pressure is largest at the crest and zero as it passes through the flat surface.
            Self::StandingWave { .. } => 0.0,
        }
    }

    /// Largest speed in the fluid, m/s.
    pub fn fastest(&self, gravity: f64) -> f64 {
        match *self {
            Self::TaylorGreen { speed, .. } => speed.abs(),
            Self::StandingWave { origin, half_wave, depth, .. } => {
                let middle = [origin[0] + 0.5 * half_wave, origin[1] + depth];
                self.velocity(middle, gravity)[0].abs()
            }
        }
    }
}

/// k x and k y.
fn phases(position: [f64; 2], origin: [f64; 3], half_wave: f64) -> [f64; 2] {
    [0, 1].map(|axis| PI * (position[axis] - origin[axis]) / half_wave)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELDS: [VelocityField; 2] = [
        VelocityField::TaylorGreen { speed: 1.5, origin: [0.1, -0.2, 0.0], half_wave: 0.7 },
        VelocityField::StandingWave { amplitude: 0.02, origin: [-0.3, 0.1, 0.0], half_wave: 1.3, depth: 0.6 },
    ];

    /// du/dx, du/dy, dv/dx, dv/dy by central differences.
    fn gradient(field: &VelocityField, [x, y]: [f64; 2]) -> [f64; 4] {
        let d = 1e-5;
        let difference = |a: [f64; 2], b: [f64; 2]| {
            let (a, b) = (field.velocity(a, 9.81), field.velocity(b, 9.81));
            [0, 1].map(|i| (a[i] - b[i]) / (2.0 * d))
        };
        let [ux, vx] = difference([x + d, y], [x - d, y]);
        let [uy, vy] = difference([x, y + d], [x, y - d]);
        [ux, uy, vx, vy]
    }

    #[test]
    fn the_fields_have_no_divergence_and_the_wave_no_rotation() {
        for (field, at) in FIELDS.iter().flat_map(|f| [[0.2, 0.3], [-0.1, 0.55]].map(|at| (f, at))) {
            let [ux, uy, vx, vy] = gradient(field, at);
            let size = ux.abs() + uy.abs() + vx.abs();
            assert!((ux + vy).abs() < 1e-7 * size, "{field:?}");
            let rotation = (vx - uy).abs();
            let vortex = matches!(field, VelocityField::TaylorGreen { .. });
            assert_eq!(rotation > 1e-7 * size, vortex, "{field:?}: {rotation}");
        }
    }

    #[test]
    fn nothing_crosses_the_cells_walls_or_the_floor() {
        let [vortex, wave] = FIELDS;
        for along in [0.0, 0.21, 0.7] {
            for (at, axis) in [([0.1, along], 0), ([0.8, along], 0), ([along, -0.2], 1), ([along, 0.5], 1)] {
                assert!(vortex.velocity(at, 0.0)[axis].abs() < 1e-12, "{at:?}");
            }
            assert!(wave.velocity([along, 0.1], 9.81)[1].abs() < 1e-12);
            assert!(wave.velocity([-0.3, along], 9.81)[0].abs() < 1e-12);
            assert!(wave.velocity([1.0, along], 9.81)[0].abs() < 1e-12);
        }
    }

    #[test]
    fn the_surface_rises_with_the_waves_frequency() {
        // Deep and shallow water: omega² = g k, and g H k².
        for (depth, frequency) in [(50.0, (9.81_f64 * PI).sqrt()), (1e-3, PI * (9.81_f64 * 1e-3).sqrt())] {
            let wave =
                VelocityField::StandingWave { amplitude: 0.01, origin: [0.0; 3], half_wave: 1.0, depth };
            let [u, v] = wave.velocity([0.0, depth], 9.81);
            assert!((v / (0.01 * frequency) - 1.0).abs() < 1e-5, "{v}");
            assert_eq!(u, 0.0);
            let fastest = wave.fastest(9.81);
            assert!(fastest >= v * (1.0 - 1e-6) && fastest.is_finite());
        }
    }

    #[test]
    fn the_vortex_is_low_in_its_middle_and_high_in_its_corners() {
        let [vortex, wave] = FIELDS;
        let half = 0.5 * 1000.0 * 1.5 * 1.5;
        assert!((vortex.pressure([0.45, 0.15], 1000.0) + half).abs() < 1e-9);
        assert!((vortex.pressure([0.1, -0.2], 1000.0) - half).abs() < 1e-9);
        assert_eq!((vortex.fastest(9.81), wave.pressure([0.0, 0.2], 1000.0)), (1.5, 0.0));
    }
}
