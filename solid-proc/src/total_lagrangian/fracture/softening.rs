//! Exponential softening of a crack band.

/// The law of one particle: sigma = f exp(-(e - e0) / e_f) from the strain e0 on, with e0 = f / E' and the area under
/// the whole curve the energy per volume that the band takes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Softening {
    /// e0.
    onset: f64,
    /// e_f.
    fade: f64,
    /// f, Pa.
    strength: f64,
    /// A straight line instead, with the same area: to see what the shape of the curve does.
    #[cfg(test)]
    linear: bool,
}

impl Softening {
    /// From the strain at which damage begins, E' in Pa, and the energy G_f / b, J/m³. A particle under the surface,
    /// whose surface reaches f_t first, begins earlier and takes the same energy.
    pub(super) fn new(onset: f64, modulus: f64, energy: f64) -> Self {
        Self {
            onset,
            fade: energy / (onset * modulus) - 0.5 * onset,
            strength: onset * modulus,
            #[cfg(test)]
            linear: false,
        }
    }

    /// Softens along a straight line, or not.
    #[cfg(test)]
    pub(super) fn straight(self, linear: bool) -> Self {
        Self { linear, ..self }
    }

    /// The strain at which `left` of the strength is left.
    pub(super) fn strain_of(&self, left: f64) -> f64 {
        #[cfg(test)]
        if self.linear {
            return self.onset + 2.0 * self.fade * (1.0 - left);
        }
        self.onset - self.fade * libm::log(left)
    }

    /// sigma of a strain from e0 on, Pa.
    pub(super) fn tension(&self, strain: f64) -> f64 {
        #[cfg(test)]
        if self.linear {
            return self.strength * (1.0 - (strain - self.onset) / (2.0 * self.fade)).max(0.0);
        }
        self.strength * libm::exp(-(strain - self.onset) / self.fade)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_under_the_curve_is_the_energy() {
        let (onset, modulus, energy) = (1e-3, 2e9, 5e3);
        for law in [false, true].map(|linear| Softening::new(onset, modulus, energy).straight(linear)) {
            let (n, end) = (2_000_000, 0.08);
            let step = end / f64::from(n);
            let stress = |e: f64| if e < onset { modulus * e } else { law.tension(e) };
            let area: f64 = (0..n).map(|k| stress((f64::from(k) + 0.5) * step) * step).sum();
            assert!((area / energy - 1.0).abs() < 1e-4, "{area}");
            assert_eq!(law.tension(onset), onset * modulus);
            assert!((law.tension(law.strain_of(0.005)) / (onset * modulus) - 0.005).abs() < 1e-15);
        }
    }
}
