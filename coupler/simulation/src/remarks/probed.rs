//! Every probe as it begins: what it measures, where, and what is there.

use super::curves::level_at;
use super::loaded::{Site, at_point, site};
use super::near;
use super::shapes::{length, place};
use halfstep_scene::geometry::{self, Cells, Layout};
use halfstep_scene::{Block, Phase, Probe, ProbeKind, Scene, Spot};
use halfstep_wire::narrow;
use serde::Serialize;
use std::fmt;

/// Distance of a particle from a place that it fills, in spacings: a corner of its cell in space is 0.87 away.
const FILLED: f64 = 0.9;

/// A probe as it begins.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Probed {
    /// Its name.
    pub(crate) name: String,
    kind: &'static str,
    /// The shape, body, solid or phase that it measures.
    #[serde(skip_serializing_if = "Option::is_none")]
    of: Option<String>,
    /// Where, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<String>,
    /// What is there at the start.
    #[serde(skip_serializing_if = "Option::is_none")]
    begins: Option<String>,
}

impl fmt::Display for Probed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.kind)?;
        self.of.iter().try_for_each(|of| write!(f, " of {of}"))?;
        self.place.iter().try_for_each(|place| write!(f, " {place}"))?;
        self.begins.iter().try_for_each(|begins| write!(f, "; begins {begins}"))
    }
}

/// Particles by their places.
struct Around<'s, const D: usize> {
    scene: &'s Scene,
    layout: &'s Layout<D>,
    cells: Cells<(Phase, [f64; D]), D>,
}

impl<'s, const D: usize> Around<'s, D> {
    fn new(scene: &'s Scene, layout: &'s Layout<D>) -> Self {
        let mut cells = Cells::new(scene.resolution);
        layout.fluid.iter().for_each(|p| cells.add(&p.position, (Phase::Fluid, p.position)));
        layout.wall.iter().for_each(|p| cells.add(&p.position, (Phase::Wall, p.position)));
        layout.solid.iter().for_each(|p| cells.add(&p.position, (Phase::Solid, p.position)));
        Self { scene, layout, cells }
    }

    fn phase_at(&self, at: &[f64; D]) -> Option<Phase> {
        let reach = FILLED * self.scene.resolution;
        let fills =
            |wanted: Phase| self.cells.around(at).any(|(phase, x)| *phase == wanted && near(x, at, reach));
        [Phase::Fluid, Phase::Solid, Phase::Wall].into_iter().find(|phase| fills(*phase))
    }

    /// What is at a point.
    fn at(&self, at: &[f64; 3]) -> String {
        match self.phase_at(&narrow(*at)) {
            Some(Phase::Fluid) => "in fluid",
            Some(Phase::Solid) => "in a solid",
            Some(Phase::Wall) => "in a wall",
            None => "dry",
        }
        .to_owned()
    }

    /// What is along a line.
    fn along(&self, from: &[f64; 3], to: &[f64; 3]) -> String {
        let all = geometry::along(self.scene, from, to);
        match all.iter().filter(|at| self.phase_at(at) == Some(Phase::Fluid)).count() {
            0 => "without fluid".to_owned(),
            wet if wet == all.len() => "in fluid".to_owned(),
            wet => format!("with {:.0} % in fluid", 100.0 * wet as f64 / all.len() as f64),
        }
    }

    /// Of a shape, or of the probe's solid, or of all walls, within a box.
    fn in_box(&self, probe: &Probe, shape: Option<usize>, within: Option<&Block>) -> [Option<String>; 3] {
        let scene = self.scene;
        let of = match (shape, probe.solid) {
            (Some(shape), _) => Some(scene.shapes[shape].name.clone()),
            (None, solid) => solid.map(|k| scene.solids[k].name.clone()),
        };
        let place = within.map(|b| format!("within {} to {}", place(&b.min[..D]), place(&b.max[..D])));
        let count = super::loaded::measured(scene, self.layout, probe, shape)
            .filter(|x| within.is_none_or(|b| geometry::holds(b, x, 0.0)))
            .count();
        [of, place, Some(format!("with {count} particles"))]
    }
}

/// The probes of a scene, in its order.
pub(crate) fn probed<const D: usize>(scene: &Scene, layout: &Layout<D>) -> Vec<Probed> {
    if scene.probes.is_empty() {
        return Vec::new();
    }
    let around = Around::new(scene, layout);
    let listed = |probe: &Probe| {
        let [of, place, begins] = about(&around, probe);
        Probed { name: probe.name.clone(), kind: probe.kind.name(), of, place, begins }
    };
    scene.probes.iter().map(listed).collect()
}

/// What a probe measures, where, and what is there.
fn about<const D: usize>(around: &Around<'_, D>, probe: &Probe) -> [Option<String>; 3] {
    let scene = around.scene;
    let solid = || probe.solid.map(|k| scene.solids[k].name.clone());
    let at = |x: &[f64; 3]| format!("at {}", place(&x[..D]));
    let line = |from: &[f64; 3], to: &[f64; 3]| format!("from {} to {}", place(&from[..D]), place(&to[..D]));
    if let Some((x, _)) = at_point(&probe.kind) {
        let Some(Site { shape, away, held, .. }) = site(scene, around.layout, probe) else {
            return [solid(), Some(at(&x)), None];
        };
        let begins = match (away, held) {
            (Some(away), _) => format!("{} m beside it", length(away)),
            (None, true) => "in a clamp".to_owned(),
            (None, false) => "in it".to_owned(),
        };
        return [Some(scene.shapes[shape].name.clone()), Some(at(&x)), Some(begins)];
    }
    match &probe.kind {
        ProbeKind::Pressure { at: from, to, shape } => {
            let rides = shape.map(|k| format!(" on {}", scene.shapes[k].name)).unwrap_or_default();
            let (place, begins) = match to {
                Some(to) => (line(from, to), around.along(from, to)),
                None => (at(from), around.at(from)),
            };
            [None, Some(place + &rides), Some(begins)]
        }
        ProbeKind::Velocity { at: x } => [None, Some(at(x)), Some(around.at(x))],
        ProbeKind::Flux { from, to } => {
            let [x, y] = [0, 1].map(|a| to[a] - from[a]);
            let toward = [y / x.hypot(y), 0.0 - x / x.hypot(y)];
            let place = format!("{}, positive toward {}", line(from, to), place(&toward));
            [None, Some(place), Some(around.along(from, to))]
        }
        ProbeKind::Front => {
            let front = super::curves::front_at(scene, around.layout);
            [None, Some("along +x".to_owned()), Some(format!("at {} m", length(front)))]
        }
        ProbeKind::WaterLevel { x } => {
            let levels = x.iter().map(|x| match level_at(scene, around.layout, *x) {
                Some(level) => format!("at {} m", length(level)),
                None => "dry".to_owned(),
            });
            let levels: Vec<String> = levels.collect();
            let x: Vec<String> = x.iter().map(|x| length(*x)).collect();
            [None, Some(format!("at x = {} m", x.join(", "))), Some(levels.join(", "))]
        }
        ProbeKind::Force { within, shape } => around.in_box(probe, *shape, within.as_ref()),
        ProbeKind::Moment { about, within, shape } => {
            let [of, place, begins] = around.in_box(probe, *shape, within.as_ref());
            let axis = format!("about {}", super::shapes::place(&about[..2]));
            [of, Some(place.map_or(axis.clone(), |place| format!("{axis} {place}"))), begins]
        }
        ProbeKind::Strain { of: Spot::Body(body) }
        | ProbeKind::CauchyStress { of: Spot::Body(body) }
        | ProbeKind::Body { body, .. } => [Some(body.clone()), None, None],
        _ => [solid().or((probe.phase() == Phase::Fluid).then(|| "fluid".to_owned())), None, None],
    }
}
