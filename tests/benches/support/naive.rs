//! The pass as one writes it first: particles as structs of vectors, a grid of cells, one pair at a time.

use nalgebra::Vector2;

/// A particle.
#[derive(Clone, Debug)]
pub(crate) struct Particle {
    pub(crate) position: Vector2<f64>,
    pub(crate) velocity: Vector2<f64>,
    pub(crate) density: f64,
    pub(crate) pressure: f64,
}

/// The particles in the order that they have after a while of mixing: none.
pub(crate) fn shuffled(particles: &[Particle]) -> Vec<Particle> {
    let mut shuffled = particles.to_vec();
    // Fisher and Yates with a linear congruential generator (Knuth's MMIX).
    let mut state = 1_u64;
    for i in (1..shuffled.len()).rev() {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        shuffled.swap(i, ((state >> 33) % (i as u64 + 1)) as usize);
    }
    shuffled
}

/// Parameters of the pass.
pub(crate) struct Pass {
    pub(crate) h: f64,
    pub(crate) mass: f64,
    /// A c0.
    pub(crate) linear: f64,
    /// delta h c0.
    pub(crate) diffusion: f64,
}

/// Cells of side 2h.
pub(crate) struct Grid {
    width: usize,
    cells: Vec<Vec<usize>>,
}

impl Grid {
    pub(crate) fn new(particles: &[Particle], side: f64) -> Self {
        let index = |x: f64| (x / side).floor() as usize + 1;
        let width = particles.iter().map(|p| index(p.position.x)).max().unwrap_or(0) + 2;
        let height = particles.iter().map(|p| index(p.position.y)).max().unwrap_or(0) + 2;
        let mut cells = vec![Vec::new(); width * height];
        for (i, p) in particles.iter().enumerate() {
            cells[index(p.position.y) * width + index(p.position.x)].push(i);
        }
        Self { width, cells }
    }
}

impl Pass {
    /// Acceleration and density rate of each particle: pressure, continuity, artificial viscosity, simple diffusion.
    pub(crate) fn run(&self, particles: &[Particle], grid: &Grid) -> Vec<(Vector2<f64>, f64)> {
        let h = self.h;
        let slope = -5.0 * 7.0 / (4.0 * std::f64::consts::PI * h * h) / (h * h);
        let mut rates = vec![(Vector2::zeros(), 0.0); particles.len()];
        for (c, cell) in grid.cells.iter().enumerate() {
            for &i in cell {
                let a = &particles[i];
                let (mut acceleration, mut rate) = (Vector2::zeros(), 0.0);
                for row in [c - grid.width, c, c + grid.width] {
                    for near in [row - 1, row, row + 1] {
                        for &j in &grid.cells[near] {
                            let b = &particles[j];
                            let x = a.position - b.position;
                            let r2 = x.norm_squared();
                            if j == i || r2 >= 4.0 * h * h {
                                continue;
                            }
                            let f = slope * (1.0 - 0.5 * r2.sqrt() / h).powi(3);
                            let approach = (a.velocity - b.velocity).dot(&x);
                            let mut bracket =
                                a.pressure / (a.density * a.density) + b.pressure / (b.density * b.density);
                            if approach < 0.0 {
                                let theta = h * approach / (r2 + 0.01 * h * h);
                                bracket -= 2.0 * self.linear * theta / (a.density + b.density);
                            }
                            acceleration -= self.mass * bracket * f * x;
                            let volume = self.mass / b.density;
                            rate += volume
                                * f
                                * (a.density * approach + 2.0 * self.diffusion * (a.density - b.density));
                        }
                    }
                }
                rates[i] = (acceleration, rate);
            }
        }
        rates
    }
}
