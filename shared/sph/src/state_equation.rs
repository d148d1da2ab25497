//! Equation of state of the weakly compressible fluid.
//!
//! Tait's equation, Kayaki's eq. (3): p = p0 [(rho / rho0)^7 - 1] + p_b, p0 = rho0 c0² / 7. Both phases need it: a wall
//! or a solid particle shows the fluid the density that belongs to its pressure.

/// Tait's equation with gamma = 7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateEquation {
    /// Reference density rho0, kg/m³.
    pub density: f64,
    /// Speed of sound c0 at rho0, m/s.
    pub sound_speed: f64,
    /// p0, Pa.
    pub stiffness: f64,
    /// Background pressure p_b, Pa.
    pub background: f64,
}

impl StateEquation {
    /// From reference density, sound speed and background pressure.
    pub fn new(density: f64, sound_speed: f64, background: f64) -> Self {
        Self { density, sound_speed, stiffness: density * sound_speed * sound_speed / 7.0, background }
    }

    /// Pressure at a density, Pa.
    #[inline]
    pub fn pressure(&self, density: f64) -> f64 {
        let x = density / self.density;
        let x2 = x * x;
        let x3 = x2 * x;
        self.stiffness * (x3 * x3 * x - 1.0) + self.background
    }

    /// Work that compressed a kilogram from the reference density, J/kg: the integral of p / rho² d rho.
    pub fn energy(&self, density: f64) -> f64 {
        let x = density / self.density;
        let x3 = x * x * x;
        let compressed = self.stiffness * (x3 * x3 - 1.0) / 6.0;
        (compressed + (self.stiffness - self.background) * (1.0 / x - 1.0)) / self.density
    }

    /// Density at a pressure, kg/m³. Pressures at or below the equation's vacuum (-p0) give the density of 1e-3 p0
    /// above it, so that the result is always positive.
    pub fn density_at(&self, pressure: f64) -> f64 {
        let y = ((pressure - self.background) / self.stiffness + 1.0).max(1e-3);
        self.density * libm::pow(y, 1.0 / 7.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tait_by_hand() {
        // rho0 = 1000, c0 = 10: p0 = 1e5 / 7. At 1.01 rho0: 1.01^7 - 1 = 0.072135352107...
        let e = StateEquation::new(1000.0, 10.0, 0.0);
        assert!((e.pressure(1010.0) - 1e5 / 7.0 * 0.072_135_352_107).abs() < 1e-5);
        assert_eq!(e.pressure(1000.0), 0.0);
        assert!((StateEquation::new(1000.0, 10.0, 5.0).pressure(1000.0) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn the_energy_is_the_work_of_the_pressure() {
        let e = StateEquation::new(1000.0, 16.0, 100.0);
        assert_eq!(e.energy(1000.0), 0.0);
        for rho in [900.0, 1100.0] {
            let slope = (e.energy(rho + 0.1) - e.energy(rho - 0.1)) / 0.2;
            assert!((slope * rho * rho / e.pressure(rho) - 1.0).abs() < 1e-6, "{slope}");
        }
    }

    #[test]
    fn density_of_pressure_inverts_pressure_of_density() {
        let e = StateEquation::new(1000.0, 16.0, 100.0);
        for rho in [900.0, 990.0, 1000.0, 1001.0, 1100.0] {
            assert!((e.density_at(e.pressure(rho)) - rho).abs() < 1e-9);
        }
        assert!(e.density_at(-1e12) > 0.0);
    }
}
