//! What is measured of the fluid. Forces on walls are in [`crate::walls::load`].

use crate::effects::FluidEffect;
use crate::fluid::Fluid;
use crate::riders::Riders;
use halfstep_scene::geometry::{self, Layout, WallPoint, holds};
use halfstep_scene::{Block, EnergyPart, Phase, ProbeKind, Scene};
use halfstep_sph::kernel;
use halfstep_sph::neighbours::PADDING;
use halfstep_wire::narrow;

/// A probe of the fluid, or of what the fluid does to walls.
pub(crate) enum Gauge<const D: usize> {
    /// Mean pressure over points.
    Pressure(Points<D>),
    Velocity([f64; D]),
    /// Mean velocity across a line, times its length.
    Flux {
        points: Vec<[f64; D]>,
        normal: [f64; D],
        length: f64,
    },
    /// x of each column.
    WaterLevel(Vec<f64>),
    Front,
    KineticEnergy,
    Centroid,
    /// Force on the wall particles that are marked, by number.
    Force(Vec<bool>),
    /// Moment of the same forces about an axis along z through a point.
    Moment(Vec<bool>, [f64; D]),
    /// The ledger or a part of it.
    Energy(Option<EnergyPart>),
}

/// Where a probe of pressure looks.
pub(crate) enum Points<const D: usize> {
    /// At points that stay where they are.
    Still(Vec<[f64; D]>),
    /// At points that move with the wall of that shape.
    OnWall(usize, Vec<[f64; D]>),
    /// At some of the points that ride on solids.
    OnSolid(std::ops::Range<usize>),
}

/// The fluid's probes in the scene's order, and the points of theirs that ride on solids.
pub(crate) fn of_fluid<const D: usize>(scene: &Scene, layout: &Layout<D>) -> (Vec<Gauge<D>>, Riders<D>) {
    let walls = &layout.wall;
    let mut riders = Riders::new();
    let chosen = |shape: Option<usize>, within: &Option<Block>| {
        let of_shape = |w: &WallPoint<D>| shape.is_none_or(|shape| w.shape as usize == shape);
        let inside = |w: &WallPoint<D>| within.is_none_or(|block| holds(&block, &w.position, 0.0));
        walls.iter().map(|w| of_shape(w) && inside(w)).collect()
    };
    let mut gauge = |kind: &ProbeKind| match kind {
        ProbeKind::Pressure { at, to, shape } => {
            let points = to.map_or(vec![narrow(*at)], |to| geometry::along(scene, at, &to));
            let on_solid = shape.and_then(|shape| riders.add(scene, layout, shape, &points));
            Some(Gauge::Pressure(match (on_solid, shape) {
                (Some(places), _) => Points::OnSolid(places),
                (None, Some(shape)) => Points::OnWall(*shape, points),
                (None, None) => Points::Still(points),
            }))
        }
        ProbeKind::Velocity { at } => Some(Gauge::Velocity(narrow(*at))),
        ProbeKind::Flux { from, to } => {
            let way: [f64; D] = std::array::from_fn(|d| to[d] - from[d]);
            let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
            let mut normal = [0.0; D];
            (normal[0], normal[1]) = (way[1] / length, -way[0] / length);
            Some(Gauge::Flux { points: geometry::along(scene, from, to), normal, length })
        }
        ProbeKind::WaterLevel { x } => Some(Gauge::WaterLevel(x.clone())),
        ProbeKind::Front => Some(Gauge::Front),
        ProbeKind::KineticEnergy { phase: Phase::Fluid } => Some(Gauge::KineticEnergy),
        ProbeKind::Centroid { phase: Phase::Fluid } => Some(Gauge::Centroid),
        ProbeKind::Force { within, shape } => Some(Gauge::Force(chosen(*shape, within))),
        ProbeKind::Moment { about, within, shape } => {
            Some(Gauge::Moment(chosen(*shape, within), narrow(*about)))
        }
        ProbeKind::Energy { part, .. } => Some(Gauge::Energy(*part)),
        _ => None,
    };
    let of_fluid = scene.probes.iter().filter(|probe| probe.phase() == Phase::Fluid);
    let gauges = of_fluid.filter_map(|probe| gauge(&probe.kind)).collect();
    (gauges, riders)
}

/// Kernel averages at a point.
struct Average<const D: usize> {
    pressure: f64,
    velocity: [f64; D],
    /// Part of the kernel that fluid fills: 1 within it, half at a surface.
    filled: f64,
}

impl<const D: usize, X: FluidEffect<D>> Fluid<D, X> {
    /// `None` where there is no fluid within 2h.
    fn average(&self, at: [f64; D]) -> Option<Average<D>> {
        let h = self.smoothing_length;
        let (mut pressure, mut weight, mut filled, mut velocity) = (0.0, 0.0, 0.0, [0.0; D]);
        let mut unextrapolated = 0.0;
        self.rows.candidates(&self.columns.reference[0], at, at, 2.0 * h + self.skin, |first, end| {
            for s in first..end {
                let x = self.position(s);
                let r2: f64 = (0..D).map(|d| (x[d] - at[d]).powi(2)).sum();
                if r2 < 4.0 * h * h {
                    let w = kernel::value_at::<D>(self.kernel, h, r2.sqrt());
                    // Extrapolated along gravity, as toward a wall: exact at rest.
                    let head: f64 = (0..D).map(|d| self.gravity[d] * (at[d] - x[d])).sum();
                    let particle = &self.columns.now.sources[s];
                    pressure += w * (particle.pressure + particle.density * head);
                    unextrapolated += w * particle.pressure;
                    weight += w;
                    filled += w * particle.volume;
                    for d in 0..D {
                        velocity[d] += w * particle.velocity[d];
                    }
                }
            }
        });
        (weight > 0.0).then(|| Average {
            // Above a surface there is air: what is extrapolated beyond it is no suction.
            pressure: (pressure / weight).max((unextrapolated / weight).min(0.0)),
            velocity: velocity.map(|v| v / weight),
            filled,
        })
    }

    fn pressure_at(&self, at: [f64; D]) -> f64 {
        self.average(at).map_or(0.0, |average| average.pressure)
    }

    fn mean_pressure(&self, points: impl ExactSizeIterator<Item = [f64; D]>) -> f64 {
        let count = points.len() as f64;
        points.map(|at| self.pressure_at(at)).sum::<f64>() / count
    }

    /// Highest fluid particle within a spacing of x, with half a spacing.
    fn level(&self, x: f64) -> f64 {
        let half = 0.5 * self.resolution;
        self.real_slots()
            .filter(|&s| (self.columns.now.position[0][s] - x).abs() <= 2.0 * half)
            .map(|s| self.columns.now.position[1][s] + half)
            .reduce(f64::max)
            .unwrap_or(0.0)
    }

    /// Probes ask for forces on walls.
    pub(crate) fn measures_loads(&self) -> bool {
        self.probes.iter().any(|p| matches!(p, Gauge::Force(_) | Gauge::Moment(..)))
    }

    /// Appends the values of the fluid's probes.
    pub(crate) fn measure(&self, out: &mut Vec<f64>) {
        let half = 0.5 * self.resolution;
        let loads = if self.measures_loads() { (X::passes().wall_loads)(self) } else { Vec::new() };
        for probe in &self.probes {
            match probe {
                Gauge::Pressure(points) => out.push(match points {
                    Points::Still(points) => self.mean_pressure(points.iter().copied()),
                    Points::OnWall(shape, points) => self.mean_pressure(
                        points
                            .iter()
                            .map(|&at| self.walls.as_ref().map_or(at, |walls| walls.carry(*shape, at))),
                    ),
                    Points::OnSolid(places) => {
                        self.mean_pressure(self.riders.now[places.clone()].iter().copied())
                    }
                }),
                Gauge::Velocity(at) => {
                    out.extend(self.average(*at).map_or([0.0; D], |average| average.velocity));
                }
                Gauge::Flux { points, normal, length } => {
                    let across = |&at: &[f64; D]| match self.average(at).filter(|a| a.filled > 0.5) {
                        Some(average) => (0..D).map(|d| average.velocity[d] * normal[d]).sum(),
                        None => 0.0,
                    };
                    out.push(points.iter().map(across).sum::<f64>() * length / points.len() as f64);
                }
                Gauge::WaterLevel(places) => out.extend(places.iter().map(|&x| self.level(x))),
                Gauge::Front => out.push(
                    self.real_slots()
                        .map(|s| self.columns.now.position[0][s] + half)
                        .reduce(f64::max)
                        .unwrap_or(f64::NAN),
                ),
                Gauge::KineticEnergy => out.push(self.kinetic_energy()),
                Gauge::Centroid => {
                    // NaN without fluid.
                    let count = self.columns.particles as f64;
                    for d in 0..D {
                        let sum: f64 = self.real_slots().map(|s| self.columns.now.position[d][s]).sum();
                        out.push(sum / count);
                    }
                }
                Gauge::Force(chosen) => out.extend(self.force(&loads, chosen)),
                Gauge::Moment(chosen, about) => out.push(self.moment(&loads, chosen, about)),
                Gauge::Energy(part) => {
                    if let Some(own) = &self.ledger {
                        own.ledger.measure(*part, out);
                    }
                }
            }
        }
    }

    /// Slots of wall particles that are marked by number.
    fn marked<'a>(&'a self, chosen: &'a [bool]) -> impl Iterator<Item = (usize, [f64; D])> + 'a {
        let walls = self.walls.iter().flat_map(|walls| (0..walls.slots()).map(move |s| (s, walls)));
        walls
            .filter(|(s, walls)| walls.id[*s] != PADDING && chosen[walls.id[*s] as usize])
            .map(|(s, walls)| (s, std::array::from_fn(|d| walls.shown.position[d][s])))
    }

    fn force(&self, loads: &[[f64; D]], chosen: &[bool]) -> [f64; D] {
        let mut force = [0.0; D];
        for (slot, _) in self.marked(chosen) {
            (0..D).for_each(|d| force[d] += loads[slot][d]);
        }
        force
    }

    fn moment(&self, loads: &[[f64; D]], chosen: &[bool], about: &[f64; D]) -> f64 {
        let of = |(slot, x): (usize, [f64; D])| {
            let f = loads[slot];
            (x[0] - about[0]) * f[1] - (x[1] - about[1]) * f[0]
        };
        self.marked(chosen).map(of).sum()
    }
}
