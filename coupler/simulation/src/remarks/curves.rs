//! Remarks on curves: how many points they have, what they are compared with, and numbers that nothing comes to.

use super::shapes::length;
use super::units::{self, about};
use halfstep_scene::geometry::{self, Layout, SolidPoint};
use halfstep_scene::{
    BodyQuantity, Column, Course, MetricKind, Motion, Phase, Probe, ProbeKind, Reference, Scene, Shape,
};

/// Points that a curve of a run has, and points of each period of what moves, below which it is no curve.
const POINTS: f64 = 10.0;

/// The period of the widest swing of a motion, s.
fn period(motion: &Motion) -> Option<f64> {
    if let Motion::Oscillating { period, .. } = motion {
        return Some(*period);
    }
    let swings = motion.parts().iter().filter_map(|part| match part.course {
        Course::Sine { period, .. } => {
            Some((period, part.angle.abs() + part.translation.iter().map(|x| x.abs()).sum::<f64>()))
        }
        _ => None,
    });
    swings.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(period, _)| period)
}

/// Intervals of frames and rows beside the run's length and the motions' periods.
pub(super) fn intervals(scene: &Scene, all: &mut Vec<String>) {
    let (end, output) = (scene.end_time, &scene.output);
    if output.frame_interval > end {
        all.push(format!(
            "output.frame_interval is {} s and the run ends at {end} s: it has frames of its start and its end alone",
            output.frame_interval
        ));
    }
    let interval = output.probe_interval;
    if scene.probes.is_empty() {
        return;
    }
    if interval * POINTS > end * (1.0 + 1e-9) {
        all.push(format!(
            "output.probe_interval is {interval} s and the run ends at {end} s: the curves of the probes have {} \
             points",
            (end / interval).floor() + 1.0
        ));
        return;
    }
    let motions = scene.shapes.iter().filter_map(|shape| Some((shape.name.as_str(), shape.motion.as_ref()?)));
    let of_frame = scene.frame.iter().map(|frame| ("[frame]", &frame.motion));
    let swings = motions.chain(of_frame).filter_map(|(name, motion)| Some((name, period(motion)?)));
    let Some((name, period)) = swings.min_by(|a, b| a.1.total_cmp(&b.1)) else { return };
    if interval * POINTS > period * (1.0 + 1e-9) {
        all.push(format!(
            "output.probe_interval is {interval} s and `{name}` swings with a period of {period} s: the curves of the \
             probes have {:.1} points a period",
            period / interval
        ));
    }
}

/// Metrics whose window holds no two rows of their probe.
pub(super) fn windows(scene: &Scene, all: &mut Vec<String>) {
    let interval = scene.output.probe_interval;
    for metric in scene.metrics.iter().filter(|metric| !matches!(metric.kind, MetricKind::Value { .. })) {
        let to = metric.to.unwrap_or(scene.end_time);
        if to - metric.from < interval * (1.0 - 1e-9) {
            all.push(format!(
                "the metric `{}` looks from {} to {to} s, and rows are {interval} s apart: it holds one of them at \
                 most",
                metric.name, metric.from
            ));
        }
    }
}

/// What units of a title are worth in the unit of a probe.
const UNITS: [(&str, &[(&str, f64)]); 7] = [
    ("m", &[("mm", 1e-3), ("cm", 1e-2)]),
    ("m/s", &[("mm", 1e-3), ("cm", 1e-2)]),
    ("Pa", &[("kpa", 1e3), ("mpa", 1e6), ("hpa", 1e2), ("mbar", 1e2), ("bar", 1e5)]),
    ("N", &[("kn", 1e3)]),
    ("N m", &[("knm", 1e3), ("kn", 1e3)]),
    ("J", &[("kj", 1e3)]),
    ("rad", &[("deg", units::DEGREE), ("degrees", units::DEGREE)]),
];

/// The unit that a probe's component has.
fn unit_of(scene: &Scene, component: &str) -> Option<&'static str> {
    let (name, _) = component.rsplit_once('.')?;
    let probe = scene.probes.iter().find(|probe| probe.name == name)?;
    Some(probe.kind.components(scene.dimension).1)
}

/// Curves of the literature in other units, and those that no time of the run has a part in.
pub(super) fn references(scene: &Scene, all: &mut Vec<String>) {
    for Reference { probe, label, points, column } in &scene.references {
        let what = format!("the curve `{label}` of {probe}");
        let times = points.iter().map(|[time, _]| *time);
        let span = [times.clone().fold(f64::INFINITY, f64::min), times.fold(f64::NEG_INFINITY, f64::max)];
        let late = || {
            (span[0] > scene.end_time || span[1] < 0.0).then(|| {
                format!(
                    "{what} lasts from {} to {} s, and the run from 0 to {} s: nothing of it is compared",
                    length(span[0]),
                    length(span[1]),
                    scene.end_time
                )
            })
        };
        let of_times = column.as_ref().and_then(|column| units::times(&what, column, span, scene.end_time));
        all.extend(of_times.or_else(late));
        let unit = unit_of(scene, probe);
        all.extend(column.as_ref().zip(unit).and_then(|(column, unit)| of_values(&what, column, unit)));
    }
}

/// Values whose title says another unit than their probe has.
fn of_values(what: &str, Column { title, scale, .. }: &Column, unit: &str) -> Option<String> {
    if let Some(rate) = units::rate(title).filter(|_| unit == "m" || unit == "rad") {
        return Some(format!(
            "{what} has the column `{title}`, whose title says {rate}, and the probe has {unit}"
        ));
    }
    let (_, others) = UNITS.iter().find(|(of, _)| *of == unit)?;
    let (said, worth) = others.iter().find_map(|(other, worth)| {
        let mut words = title.split(|c: char| !c.is_alphabetic());
        words.find(|word| word.to_lowercase() == *other).map(|word| (word, worth))
    })?;
    (!about(*scale, *worth)).then(|| {
        format!(
            "{what} has the column `{title}`, whose title says {said}, times scale = {scale}, in {unit} (scale = \
             {worth} makes {unit} of it)"
        )
    })
}

/// Levels that a water level or a front cannot come to, or is above from the start.
pub(super) fn levels<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let floor =
        geometry::around(geometry::fluid_boxes(scene)).map_or(f64::NEG_INFINITY, |water| water.min[1]);
    let domain = geometry::domain(scene);
    for metric in &scene.metrics {
        let (level, swings) = match metric.kind {
            MetricKind::FirstAbove { level } => (level, false),
            MetricKind::Period { level } | MetricKind::Decay { level } => (level, true),
            _ => continue,
        };
        let Some((name, component)) = metric.probe.rsplit_once('.') else { continue };
        let Some(probe) = scene.probes.iter().find(|probe| probe.name == name) else { continue };
        let Some(First { axis, at: starts, size }) = at_first(scene, layout, probe, component) else {
            continue;
        };
        let (low, high) = (domain.min[axis], domain.max[axis]);
        let why = if swings && size.is_some_and(|size| (level - starts).abs() > size) {
            format!(
                "begins at {} m: it does not swing about it (`level` is where it comes to rest)",
                length(starts)
            )
        } else if level > high || swings && level < low {
            format!("stays in the domain, from {} to {} m: it never comes there", length(low), length(high))
        } else if swings && axis == 1 && level <= floor && starts > floor {
            format!(
                "begins at {} m over a floor at {} m: it does not swing about it",
                length(starts),
                length(floor)
            )
        } else if !swings && metric.from == 0.0 && starts > level + scene.resolution {
            format!("begins at {} m: it is above from the start", length(starts))
        } else if !swings && metric.from == 0.0 && (starts - level).abs() <= 0.25 * scene.resolution {
            "begins there: the first stir is above it".to_owned()
        } else {
            continue;
        };
        all.push(format!("the metric `{}` has level = {level} m, and {} {why}", metric.name, metric.probe));
    }
}

/// How a curve of places begins.
struct First {
    axis: usize,
    /// m; minus infinity where it is dry.
    at: f64,
    /// Of what moves, along that axis, m; `None` where it may come far: a level, a front.
    size: Option<f64>,
}

/// Of the water's level or front, of the fluid's or a solid's centre, of a body or a point of a solid.
fn at_first<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    probe: &Probe,
    component: &str,
) -> Option<First> {
    let along = || ["x", "y", "z"].iter().position(|axis| *axis == component).filter(|axis| *axis < D);
    let mean = |places: &[[f64; D]]| {
        let axis = along()?;
        let all = || places.iter().map(|x| x[axis]);
        let (low, high) = (all().reduce(f64::min)?, all().reduce(f64::max)?);
        let at = all().sum::<f64>() / places.len() as f64;
        Some(First { axis, at, size: Some(high - low + scene.resolution) })
    };
    let of_solid = |own: &dyn Fn(&Shape) -> bool| -> Vec<[f64; D]> {
        let own = |p: &&SolidPoint<D>| own(&scene.shapes[p.body as usize]);
        layout.solid.iter().filter(own).map(|p| p.position).collect()
    };
    match &probe.kind {
        ProbeKind::Front => Some(First { axis: 0, at: front_at(scene, layout), size: None }),
        ProbeKind::WaterLevel { x } => {
            let gauge: usize =
                component.rsplit_once('-').map_or(1, |(_, number)| number.parse().unwrap_or(1));
            let level = level_at(scene, layout, *x.get(gauge.checked_sub(1)?)?);
            Some(First { axis: 1, at: level.unwrap_or(f64::NEG_INFINITY), size: None })
        }
        ProbeKind::Body { body, quantity: BodyQuantity::Position } => {
            mean(&of_solid(&|shape| shape.solid == probe.solid && shape.body() == body))
        }
        ProbeKind::Centroid { .. } if probe.phase() == Phase::Fluid => {
            mean(&layout.fluid.iter().map(|p| p.position).collect::<Vec<_>>())
        }
        ProbeKind::Centroid { .. } => mean(&of_solid(&|shape| shape.solid == probe.solid)),
        ProbeKind::Position { at } => {
            let axis = along()?;
            let solid = mean(&of_solid(&|shape| shape.solid == probe.solid))?;
            Some(First { axis, at: at[axis], ..solid })
        }
        _ => None,
    }
}

/// Farthest reach of the fluid along x at the start, m.
pub(super) fn front_at<const D: usize>(scene: &Scene, layout: &Layout<D>) -> f64 {
    let farthest = layout.fluid.iter().map(|p| p.position[0]).fold(f64::NEG_INFINITY, f64::max);
    farthest + 0.5 * scene.resolution
}

/// Level of the water at a gauge at the start, m; `None` where it is dry.
pub(super) fn level_at<const D: usize>(scene: &Scene, layout: &Layout<D>, x: f64) -> Option<f64> {
    let dx = scene.resolution;
    let column = layout.fluid.iter().filter(|p| (p.position[0] - x).abs() <= dx);
    column.map(|p| p.position[1] + 0.5 * dx).reduce(f64::max)
}
