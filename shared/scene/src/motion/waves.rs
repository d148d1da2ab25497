//! Wave makers: how a piston or a flap moves that makes given waves.
//!
//! Linear theory (Biesel and Suquet 1951; Dean and Dalrymple 1991, section 6.3): with X(z) the paddle's displacement at
//! the height z above the floor over that at the level of the water, the height of the progressive wave over the stroke
//! there is H / S = 4 sinh kd / (sinh 2kd + 2kd) k integral of X(z) cosh kz dz from the floor to d.

use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// What a wave maker makes, as the scene says it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaveMaker {
    /// Height of the waves (irregular: significant height), m.
    pub height: f64,
    /// Depth of the water that it is meant for, m.
    pub depth: f64,
    /// Height of the floor, m.
    pub floor: f64,
    /// Way of the paddle from end to end at the level of the water, m. Of irregular waves the largest in the run.
    pub stroke: f64,
    /// Way of its largest displacements from its place in the scene at the level of the water, toward the waves and
    /// away from them, m.
    pub reach: [f64; 2],
    /// When the paddle stops, s; `None`: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<f64>,
}

/// How the paddle moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Paddle {
    /// As a whole.
    Piston,
    /// About a hinge so high above the floor, m; below it where negative.
    Flap(f64),
}

/// Wave number k of linear waves, 1/m: omega² = g k tanh kd with omega = 2 pi / period.
pub(crate) fn wave_number(period: f64, depth: f64, g: f64) -> f64 {
    let omega = 2.0 * PI / period;
    let deep = omega * omega * depth / g;
    // Newton's iteration for x tanh x = deep from Eckart's (1952) approximation.
    let mut x = deep / libm::tanh(deep).sqrt();
    for _ in 0..50 {
        let t = libm::tanh(x);
        let step = (x * t - deep) / (t + x * (1.0 - t * t));
        x -= step;
        if step.abs() <= 1e-15 * x {
            break;
        }
    }
    x / depth
}

impl Paddle {
    /// Height of the progressive wave over the stroke at the level of the water.
    pub(crate) fn height_by_stroke(&self, k: f64, depth: f64) -> f64 {
        let kd = k * depth;
        // Each times 2 exp(-kd), and so the quotient by exp(-2 kd) below: deep water overflows nothing.
        let e = libm::exp(-kd);
        let (sinh, cosh) = (1.0 - e * e, 1.0 + e * e);
        let integral = match *self {
            Self::Piston => sinh,
            Self::Flap(hinge) => {
                // cosh of the height of the hinge, or of the floor where the hinge lies below it.
                let lower = k * hinge.max(0.0);
                sinh - (cosh - (libm::exp(lower - kd) + libm::exp(-lower - kd))) / (k * (depth - hinge))
            }
        };
        sinh * integral / (0.5 * (1.0 - libm::pow(e, 4.0)) + 2.0 * kd * e * e)
    }
}

/// Height beyond which regular waves break, m: 0.142 L tanh kd (Miche 1944).
pub(crate) fn breaking_height(k: f64, depth: f64) -> f64 {
    0.142 * 2.0 * PI / k * libm::tanh(k * depth)
}

/// One wave of an irregular sea.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Component {
    /// Amplitude of the surface, m.
    pub(crate) amplitude: f64,
    /// Period, s.
    pub(crate) period: f64,
    /// Phase, rad.
    pub(crate) phase: f64,
}

/// A JONSWAP sea (Hasselmann et al. 1973).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sea {
    /// Significant height, m.
    pub(crate) height: f64,
    /// Period of the spectrum's peak, s.
    pub(crate) period: f64,
    /// Peak enhancement gamma.
    pub(crate) peakedness: f64,
    /// Number of waves that are added up.
    pub(crate) components: u32,
    /// Which of its realisations.
    pub(crate) seed: u32,
}

/// Least and largest frequency over that of the peak.
const BAND: [f64; 2] = [0.5, 3.0];

impl Sea {
    /// The spectrum at f / f_p, but for a factor: f^-5 exp(-5/4 f^-4) gamma^exp(-(f - 1)² / (2 sigma²)).
    fn spectrum(&self, f: f64) -> f64 {
        let width = if f <= 1.0 { 0.07 } else { 0.09 };
        let peak = libm::exp(-(f - 1.0) * (f - 1.0) / (2.0 * width * width));
        libm::exp(-1.25 * libm::pow(f, -4.0)) * libm::pow(f, -5.0) * libm::pow(self.peakedness, peak)
    }

    /// The waves: one at a random frequency of each of equally wide bands, with a random phase, its energy that of the
    /// spectrum there. The sum of their energies is that of the significant height: sum a² / 2 = (H / 4)².
    pub(crate) fn waves(&self) -> Vec<Component> {
        let mut random = SplitMix(u64::from(self.seed));
        let width = (BAND[1] - BAND[0]) / f64::from(self.components);
        let mut energy = 0.0;
        let mut waves: Vec<Component> = (0..self.components)
            .map(|n| {
                let f = BAND[0] + width * (f64::from(n) + random.next());
                let phase = 2.0 * PI * random.next();
                let density = self.spectrum(f);
                energy += density;
                Component { amplitude: density.sqrt(), period: self.period / f, phase }
            })
            .collect();
        let scale = self.height / 4.0 * (2.0 / energy).sqrt();
        waves.iter_mut().for_each(|wave| wave.amplitude *= scale);
        waves
    }
}

/// Steele, Lea and Flood's (2014) SplitMix64: few lines whose numbers no version of a library changes.
struct SplitMix(u64);

impl SplitMix {
    /// Uniform in [0, 1).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A solitary wave by a piston (Goring 1978): at each instant the piston has the depth's mean velocity, c eta /
/// (d + eta), of Boussinesq's wave eta = H sech² theta, theta = kappa (c t - X), at the piston's place X; kappa² =
/// 3 H / (4 d³), c² = g (d + H). So X = H / (kappa d) tanh theta, and the stroke is sqrt(16 H d / 3).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solitary {
    /// H / d.
    relative_height: f64,
    /// kappa c, 1/s.
    rate: f64,
    /// H / (kappa d): half of the stroke, m.
    half_stroke: f64,
    /// When it begins, s.
    start: f64,
}

/// Theta at which the piston starts and stops, to either side of zero: its velocity there is 2e-4 of its largest.
const CUT: f64 = 5.0;

impl Solitary {
    /// A wave of that height in water of that depth, m.
    pub(crate) fn new(height: f64, depth: f64, g: f64, start: f64) -> Self {
        let kappa = (0.75 * height / (depth * depth * depth)).sqrt();
        Self {
            relative_height: height / depth,
            rate: kappa * (g * (depth + height)).sqrt(),
            half_stroke: height / (kappa * depth),
            start,
        }
    }

    /// The way from end to end, m.
    pub(crate) fn stroke(&self) -> f64 {
        2.0 * self.half_stroke * libm::tanh(CUT)
    }

    /// How long it moves, s.
    pub(crate) fn duration(&self) -> f64 {
        2.0 * (CUT + self.relative_height * libm::tanh(CUT)) / self.rate
    }

    /// The piston's way since its start, m, with its first two derivatives.
    pub(super) fn at(&self, time: f64) -> [f64; 3] {
        let (t, e) = (time - self.start, self.relative_height);
        if t <= 0.0 {
            return [0.0; 3];
        }
        if t >= self.duration() {
            return [self.stroke(), 0.0, 0.0];
        }
        // theta + H / d tanh theta = kappa c t, t from the instant of the crest: Newton's iteration.
        let crest = self.rate * (t - 0.5 * self.duration());
        let mut theta = crest / (1.0 + e);
        for _ in 0..50 {
            let tanh = libm::tanh(theta);
            let step = (theta + e * tanh - crest) / (1.0 + e * (1.0 - tanh * tanh));
            theta -= step;
            if step.abs() <= 1e-14 {
                break;
            }
        }
        let tanh = libm::tanh(theta);
        let sech2 = 1.0 - tanh * tanh;
        let slope = 1.0 + e * sech2;
        let speed = self.half_stroke * self.rate;
        [
            self.half_stroke * (tanh + libm::tanh(CUT)),
            speed * sech2 / slope,
            -2.0 * speed * self.rate * sech2 * tanh / (slope * slope * slope),
        ]
    }

    /// Its largest velocity, m/s: c H / (d + H).
    pub(super) fn fastest(&self) -> f64 {
        self.half_stroke * self.rate / (1.0 + self.relative_height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dispersion_relation_holds() {
        // 0.9 s in 0.2 m: omega² / g = 4.96828 1/m; k = 5.97195 1/m.
        assert!((wave_number(0.9, 0.2, 9.81) - 5.971_949).abs() < 1e-6);
        for (period, depth) in [(0.3, 5.0), (0.9, 0.2), (8.0, 0.1), (100.0, 0.01)] {
            let (k, omega) = (wave_number(period, depth, 9.81), 2.0 * PI / period);
            let residual = 9.81 * k * libm::tanh(k * depth) / (omega * omega) - 1.0;
            assert!(residual.abs() < 1e-13, "{period} s, {depth} m: {residual}");
        }
        // Deep: k = omega² / g. Shallow: k = omega / sqrt(g d).
        assert!((wave_number(1.0, 50.0, 9.81) - 4.0 * PI * PI / 9.81).abs() < 1e-12);
        assert!((wave_number(100.0, 0.1, 9.81) / (2.0 * PI / 100.0 / 0.981_f64.sqrt()) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn transfer_functions_by_hand() {
        // kd = 1: sinh 1 = 1.175201, cosh 1 = 1.543081, sinh 2 = 3.626860.
        // Piston: 2 (cosh 2 - 1) / (sinh 2 + 2) = 2 * 2.762196 / 5.626860 = 0.981790.
        let piston = Paddle::Piston.height_by_stroke(2.0, 0.5);
        assert!((piston - 0.981_790).abs() < 1e-6, "{piston}");
        // Hinge on the floor: 4 sinh 1 (sinh 1 - (cosh 1 - 1) / 1) / 5.626860 = 4.700805 * 0.632121 / 5.626860.
        let flap = Paddle::Flap(0.0).height_by_stroke(2.0, 0.5);
        assert!((flap - 0.528_088).abs() < 1e-6, "{flap}");
        // Hinge at half the depth: 4.700805 (1.175201 - (1.543081 - cosh 0.5) / 0.5) / 5.626860, cosh 0.5 = 1.127626:
        // 0.835421 * 0.344292.
        let high = Paddle::Flap(0.25).height_by_stroke(2.0, 0.5);
        assert!((high - 0.287_629).abs() < 1e-6, "{high}");
        // Hinge half a depth below the floor: 0.835421 (1.175201 - 0.543081 / 1.5).
        let low = Paddle::Flap(-0.25).height_by_stroke(2.0, 0.5);
        assert!((low - 0.679_322).abs() < 1e-6, "{low}");
        // A hinge far below makes a piston of it; long waves: kd for a piston, kd / 2 for a flap; short waves: 2.
        assert!((Paddle::Flap(-1e9).height_by_stroke(2.0, 0.5) - piston).abs() < 1e-8);
        assert!((Paddle::Piston.height_by_stroke(1e-3, 1.0) / 1e-3 - 1.0).abs() < 1e-5);
        assert!((Paddle::Flap(0.0).height_by_stroke(1e-3, 1.0) / 0.5e-3 - 1.0).abs() < 1e-5);
        assert!((Paddle::Piston.height_by_stroke(1e3, 1.0) - 2.0).abs() < 1e-12);
        // Miche: 0.142 L tanh kd = 0.142 pi 0.761594.
        assert!((breaking_height(2.0, 0.5) - 0.339_752).abs() < 1e-6);
    }

    #[test]
    fn a_sea_has_its_height_and_its_peak() {
        let sea = Sea { height: 0.1, period: 1.5, peakedness: 3.3, components: 200, seed: 7 };
        let waves = sea.waves();
        // The height that the surface itself has, four times its standard deviation over many periods.
        let (mut mean, mut square, rows) = (0.0, 0.0, 200_000);
        for row in 0..rows {
            let t = 0.05 * f64::from(row);
            let of = |w: &Component| w.amplitude * libm::sin(2.0 * PI * t / w.period + w.phase);
            let eta: f64 = waves.iter().map(of).sum();
            mean += eta / f64::from(rows);
            square += eta * eta / f64::from(rows);
        }
        let height = 4.0 * (square - mean * mean).sqrt();
        assert!((height / 0.1 - 1.0).abs() < 0.01, "{height}");
        let highest = waves.iter().max_by(|a, b| a.amplitude.total_cmp(&b.amplitude)).expect("has waves");
        assert!((highest.period / 1.5 - 1.0).abs() < 0.03, "{highest:?}");
        // Spectrum by hand at the peak, exp(-1.25) 3.3 = 0.945466, and at twice its frequency, exp(-5/64) / 32 =
        // 0.0289015.
        assert!(
            (sea.spectrum(1.0) - 0.945_465).abs() < 1e-6 && (sea.spectrum(2.0) - 0.028_901_5).abs() < 1e-6
        );
        // The same seed is the same sea, another one is not.
        assert_eq!(waves, sea.waves());
        assert_ne!(waves, Sea { seed: 8, ..sea }.waves());
    }

    #[test]
    fn the_random_numbers_are_those_of_the_reference() {
        // First output of the published generator for the seed 1234567: 6457827717110365317.
        let first = SplitMix(1_234_567).next();
        assert_eq!(first, (6_457_827_717_110_365_317_u64 >> 11) as f64 / (1_u64 << 53) as f64);
    }

    #[test]
    fn gorings_piston_by_hand() {
        // H = 0.06 m in 0.2 m: stroke sqrt(16 * 0.06 * 0.2 / 3) = 0.252982 m, c = sqrt(9.81 * 0.26) = 1.597060 m/s,
        // largest velocity c H / (d + H) = 0.368552 m/s.
        let wave = Solitary::new(0.06, 0.2, 9.81, 0.5);
        assert!((wave.stroke() / 0.252_982 - 1.0).abs() < 1e-4, "{}", wave.stroke());
        assert!((wave.fastest() - 0.368_552).abs() < 1e-6, "{}", wave.fastest());
        let middle = wave.at(0.5 + 0.5 * wave.duration());
        assert!((middle[0] - 0.5 * wave.stroke()).abs() < 1e-12 && middle[2].abs() < 1e-9, "{middle:?}");
        assert!((middle[1] - wave.fastest()).abs() < 1e-12, "{middle:?}");
        assert_eq!(wave.at(0.5), [0.0; 3]);
        assert_eq!(wave.at(9.0), [wave.stroke(), 0.0, 0.0]);
        // The velocity is that of the water at the piston: c eta / (d + eta), theta = kappa (c t - X).
        let (kappa, c) = ((0.75 * 0.06 / 0.008_f64).sqrt(), (9.81 * 0.26_f64).sqrt());
        for t in [0.7, 1.1, 1.4, 1.9] {
            let [x, v, a] = wave.at(t);
            let (since, from) = (t - 0.5 - 0.5 * wave.duration(), x - 0.5 * wave.stroke());
            let eta = 0.06 / libm::cosh(kappa * (c * since - from)).powi(2);
            assert!((v - c * eta / (0.2 + eta)).abs() < 1e-12, "{t}: {v}");
            let e = 1e-5;
            let [before, after] = [wave.at(t - e), wave.at(t + e)];
            assert!(((after[0] - before[0]) / (2.0 * e) - v).abs() < 1e-7);
            assert!(((after[1] - before[1]) / (2.0 * e) - a).abs() < 1e-6);
        }
    }
}
