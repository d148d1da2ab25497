//! Linear theory of waves in a tank: what water does whose waves are low and that loses nothing.

use crate::curve::Curve;
use halfstep_scene::Motion;
use std::f64::consts::PI;

const GRAVITY: f64 = 9.81;

/// Centre of mass, m, of water of this length and depth, m, relative to the tank that shakes it along x.
///
/// The surface is the sum over odd n of eta_n cos(k_n x), k_n = n pi / L. The tank's acceleration a tilts the level
/// surface by -a / g, which is the mode b_n = 4 L a / (n² pi² g): eta_n'' = -omega_n² (eta_n - b_n), omega_n² = g k_n
/// tanh(k_n H).
pub fn shaken_tank(length: f64, depth: f64, motion: &Motion, until: f64) -> Curve {
    const STEP: f64 = 1e-3;
    let modes: Vec<(f64, f64)> = (0..15)
        .map(|m| {
            let n = f64::from(2 * m + 1);
            let k = n * PI / length;
            (GRAVITY * k * (k * depth).tanh(), 1.0 / (n * PI).powi(2))
        })
        .collect();
    let mut state = vec![(0.0, 0.0); modes.len()];
    let mut curve = Curve { times: Vec::new(), values: Vec::new() };
    for step in 0..=(until / STEP).ceil() as u32 {
        let time = f64::from(step) * STEP;
        let swing = |(eta, _): &(f64, f64), (_, share): &(f64, f64)| -eta * 2.0 * length * share / depth;
        curve.times.push(time);
        curve.values.push(state.iter().zip(&modes).map(|(s, m)| swing(s, m)).sum());
        // Verlet: exact to (omega dt)² / 24, 1e-3 in the highest mode.
        let a = motion.at(time + 0.5 * STEP).acceleration[0];
        for ((eta, rate), (omega2, share)) in state.iter_mut().zip(&modes) {
            *eta += 0.5 * STEP * *rate;
            *rate -= STEP * omega2 * (*eta - 4.0 * length * share * a / GRAVITY);
            *eta += 0.5 * STEP * *rate;
        }
    }
    curve
}

/// A box that floats in the middle of a tank, all lengths in m.
#[derive(Clone, Copy, Debug)]
pub struct Float {
    /// Length of the tank.
    pub tank: f64,
    /// Depth of the water.
    pub depth: f64,
    /// Width of the box.
    pub width: f64,
    /// Its draft at rest.
    pub draft: f64,
}

/// Potential flow in one half of the tank, in square cells. Cells of a column are those below the surface or the box.
struct Cells {
    size: f64,
    columns: usize,
    rows: usize,
    /// Columns under the box.
    under: usize,
    /// Rows that the box takes of these.
    sunk: usize,
}

impl Cells {
    fn height(&self, column: usize) -> usize {
        if column < self.under { self.rows - self.sunk } else { self.rows }
    }

    /// -size² times the Laplacian, with zero potential at the surface.
    fn apply(&self, phi: &[f64], out: &mut [f64]) {
        let at = |c: usize, r: usize| c * self.rows + r;
        out.fill(0.0);
        for c in 0..self.columns {
            for r in 0..self.height(c) {
                let k = at(c, r);
                let mut sum = 0.0;
                let mut beside = |wet: bool, other: usize| sum += if wet { phi[k] - phi[other] } else { 0.0 };
                beside(c > 0 && r < self.height(c.max(1) - 1), at(c.max(1) - 1, r));
                beside(c + 1 < self.columns, at((c + 1).min(self.columns - 1), r));
                beside(r > 0, at(c, r.max(1) - 1));
                beside(r + 1 < self.height(c), at(c, (r + 1).min(self.rows - 1)));
                let surface = c >= self.under && r + 1 == self.rows;
                out[k] = sum + if surface { 2.0 * phi[k] } else { 0.0 };
            }
        }
    }

    /// Conjugate gradients.
    fn solve(&self, right: Vec<f64>) -> Vec<f64> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (mut x, mut r) = (vec![0.0; right.len()], right);
        let (mut p, mut ap) = (r.clone(), vec![0.0; x.len()]);
        let mut rr = dot(&r, &r);
        let small = 1e-20 * rr;
        while rr > small {
            self.apply(&p, &mut ap);
            let alpha = rr / dot(&p, &ap);
            x.iter_mut().zip(&p).for_each(|(x, p)| *x += alpha * p);
            r.iter_mut().zip(&ap).for_each(|(r, a)| *r -= alpha * a);
            let next = dot(&r, &r);
            p.iter_mut().zip(&r).for_each(|(p, r)| *p = r + next / rr * *p);
            rr = next;
        }
        x
    }
}

impl Float {
    /// Height of the box over its height at rest, m, after it was let go `lift` above it, in cells of this size, m.
    ///
    /// On the surface phi' = -g eta and eta' = d phi / dy; under the box d phi / dy = V, its velocity; p = -rho (phi'
    /// + g z) bears it. Per kg/m³ of water and half a metre of depth.
    pub fn heave(&self, lift: f64, cell: f64, until: f64) -> Curve {
        const STEP: f64 = 5e-4;
        let count = |length: f64| (length / cell).round() as usize;
        let (columns, under) = (count(0.5 * self.tank), count(0.5 * self.width));
        let (rows, sunk) = (count(self.depth), count(self.draft));
        let cells = Cells { size: cell, columns, rows, under, sunk };
        let right = |at: usize, value: f64| {
            let mut right = vec![0.0; columns * rows];
            right[at] = value;
            right
        };
        // Potential of each surface cell's unit potential, and of the box's unit velocity.
        let of_surface: Vec<Vec<f64>> =
            (under..columns).map(|c| cells.solve(right(c * rows + rows - 1, 2.0))).collect();
        let mut pushed = vec![0.0; columns * rows];
        (0..under).for_each(|c| pushed[c * rows + rows - sunk - 1] = cells.size);
        let of_box = cells.solve(pushed);
        let below = |phi: &[f64]| (0..under).map(|c| phi[c * rows + rows - sunk - 1]).sum::<f64>() * cell;
        let half = 0.5 * self.width;
        let mass = half * self.draft + below(&of_box) + half * 0.5 * cell;
        let lifts: Vec<f64> = of_surface.iter().map(|phi| below(phi)).collect();
        let n = columns - under;
        let top = |phi: &[f64], s: usize| phi[(under + s) * rows + rows - 1];
        let rates = |y: &[f64]| -> Vec<f64> {
            let (eta, phi, z, v) = (&y[..n], &y[n..2 * n], y[2 * n], y[2 * n + 1]);
            let risen = |s: usize| {
                let inner: f64 = of_surface.iter().zip(phi).map(|(unit, p)| p * top(unit, s)).sum();
                (phi[s] - inner - v * top(&of_box, s)) * 2.0 / cell
            };
            let borne: f64 = lifts.iter().zip(eta).map(|(l, e)| l * e).sum();
            let mut out: Vec<f64> = (0..n).map(risen).collect();
            out.extend(eta.iter().map(|e| -GRAVITY * e));
            out.extend([v, GRAVITY * (borne - half * z) / mass]);
            out
        };
        let mut y = vec![0.0; 2 * n + 2];
        y[2 * n] = lift;
        let mut curve = Curve { times: vec![0.0], values: vec![lift] };
        let along =
            |y: &[f64], k: &[f64], t: f64| y.iter().zip(k).map(|(y, k)| y + t * k).collect::<Vec<_>>();
        for step in 1..=(until / STEP).ceil() as u32 {
            let k1 = rates(&y);
            let k2 = rates(&along(&y, &k1, 0.5 * STEP));
            let k3 = rates(&along(&y, &k2, 0.5 * STEP));
            let k4 = rates(&along(&y, &k3, STEP));
            for (i, y) in y.iter_mut().enumerate() {
                *y += STEP / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
            curve.times.push(f64::from(step) * STEP);
            curve.values.push(y[2 * n]);
        }
        curve
    }
}
