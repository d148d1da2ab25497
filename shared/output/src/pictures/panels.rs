//! Which curves of `plot.png` share a panel, and what range it shows.

use crate::pictures::units;
use crate::probes::{Table, split_unit};
use halfstep_scene::{ProbeKind, Scene};
use std::ops::Range;

/// Components share a panel while none of them covers less than this part of the panel's height.
const SMALLEST_SHARE: f64 = 0.15;
/// A reference all of whose values are so many times the run's largest is named but not drawn: the run would look flat.
const FAR: f64 = 20.0;

/// Points (time s, value in the probe's unit) and their name in the legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    pub(crate) label: String,
    pub(crate) points: Vec<(f64, f64)>,
}

impl Curve {
    /// Whether the points are in the order of time: those of a cloud, one for each author, are not.
    pub(crate) fn is_line(&self) -> bool {
        self.points.windows(2).all(|pair| pair[0].0 < pair[1].0)
    }

    /// The points up to `last` that have a value.
    pub(crate) fn visible(&self, last: f64) -> Vec<(f64, f64)> {
        self.points.iter().copied().filter(|(t, v)| (0.0..=last).contains(t) && v.is_finite()).collect()
    }
}

/// One coordinate system.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Panel {
    /// What the vertical axis shows: `tip.x displacement`.
    pub(crate) quantity: String,
    /// SI unit of the values.
    pub(crate) unit: String,
    pub(crate) curves: Vec<Curve>,
    pub(crate) references: Vec<Curve>,
}

impl Panel {
    /// Lowest and highest visible value, with some room.
    pub(crate) fn range(&self, last: f64) -> Range<f64> {
        let (low, high) = extent(self.curves.iter().chain(&self.references), last).unwrap_or((0.0, 0.0));
        let largest = low.abs().max(high.abs());
        // A curve that varies by rounding errors only is constant: an axis of a few last digits has no sensible ticks.
        let room = if high - low > 1e-9 * largest { 0.06 * (high - low) } else { 0.1 * largest };
        if room > f64::MIN_POSITIVE { low - room..high + room } else { -1.0..1.0 }
    }

    /// Largest visible absolute value.
    pub(crate) fn largest(&self, last: f64) -> f64 {
        let extent = extent(self.curves.iter().chain(&self.references), last);
        extent.map_or(0.0, |(low, high)| low.abs().max(high.abs()))
    }
}

fn extent<'a>(curves: impl Iterator<Item = &'a Curve>, last: f64) -> Option<(f64, f64)> {
    curves
        .flat_map(|curve| curve.visible(last))
        .map(|(_, value)| (value, value))
        .reduce(|(low, high), (value, _)| (low.min(value), high.max(value)))
}

/// The panels of a scene, in the order of its probes. Components of a probe share one, unless the literature has
/// curves for them or one would look flat beside another. Columns that the table lacks are left out.
pub(crate) fn panels(scene: &Scene, table: &Table) -> Vec<Panel> {
    let times = table.times();
    let last = times.iter().copied().filter(|t| t.is_finite()).fold(0.0, f64::max);
    let mut panels = Vec::new();
    for probe in &scene.probes {
        let mut singles: Vec<Panel> = Vec::new();
        for column in probe.columns(scene.dimension) {
            let Some(values) = table.column(&column) else { continue };
            let (name, unit) = split_unit(&column);
            let references = scene.references.iter().filter(|reference| reference.probe == name);
            let mut references: Vec<Curve> = references
                .map(|reference| Curve {
                    label: reference.label.clone(),
                    points: reference.points.iter().map(|&[time, value]| (time, value)).collect(),
                })
                .collect();
            let curve = Curve {
                label: format!("{name}, this run"),
                points: times.iter().copied().zip(values).collect(),
            };
            references.iter_mut().for_each(|reference| leave_out_if_far(reference, &curve, unit, last));
            singles.push(Panel {
                quantity: axis(name, &probe.kind),
                unit: unit.into(),
                references,
                curves: vec![curve],
            });
        }
        if singles.len() > 1 && share_well(&singles, last) {
            let mut merged = singles.remove(0);
            merged.curves.extend(singles.into_iter().flat_map(|panel| panel.curves));
            merged.quantity = axis(&probe.name, &probe.kind);
            panels.push(merged);
        } else {
            panels.append(&mut singles);
        }
    }
    panels
}

/// Replaces the points of a reference that is far beyond the run's own values by their range in its label.
fn leave_out_if_far(reference: &mut Curve, run: &Curve, unit: &str, last: f64) {
    let own = extent([run].into_iter(), last).map_or(0.0, |(low, high)| low.abs().max(high.abs()));
    let Some((low, high)) = extent([&*reference].into_iter(), last) else { return };
    if own > 0.0 && low.abs().min(high.abs()) > FAR * own && low * high > 0.0 {
        let (factor, shown) = units::shown(unit, low.abs().max(high.abs()));
        let [low, high] = [low, high].map(|value| units::number(value * factor));
        let range = if low == high { low } else { format!("{low} to {high}") };
        reference.label += &format!(": {range} {shown}, off the axis");
        reference.points.clear();
    }
}

fn share_well(singles: &[Panel], last: f64) -> bool {
    let Some((low, high)) = extent(singles.iter().flat_map(|panel| &panel.curves), last) else { return true };
    let wide = |panel: &Panel| {
        extent(panel.curves.iter(), last).is_none_or(|(a, b)| b - a >= SMALLEST_SHARE * (high - low))
    };
    singles.iter().all(|panel| panel.references.is_empty() && wide(panel))
}

/// Name of a probe or of its component, with what it measures where that is not the component's name.
fn axis(name: &str, kind: &ProbeKind) -> String {
    match kind {
        ProbeKind::Displacement { .. } => format!("{name} displacement"),
        ProbeKind::Position { .. } => format!("{name} position"),
        ProbeKind::Velocity { .. } | ProbeKind::SolidVelocity { .. } => format!("{name} velocity"),
        ProbeKind::Strain { .. } => format!("{name} strain"),
        ProbeKind::CauchyStress { .. } => format!("{name} stress"),
        ProbeKind::Centroid { .. } => format!("{name} centre of mass"),
        ProbeKind::Front => format!("{name} reach"),
        ProbeKind::Force { .. } => format!("{name} force"),
        ProbeKind::Body { quantity, .. } if !quantity.turns() => format!("{name} {}", quantity.name()),
        ProbeKind::Pressure { .. }
        | ProbeKind::WaterLevel { .. }
        | ProbeKind::KineticEnergy { .. }
        | ProbeKind::StrainEnergy
        | ProbeKind::CrackEnergy
        | ProbeKind::CrackArea
        | ProbeKind::Bodies
        | ProbeKind::Energy { .. }
        | ProbeKind::Stress { .. }
        | ProbeKind::Flux { .. }
        | ProbeKind::Moment { .. }
        | ProbeKind::Body { .. } => {
            // `p1.pressure` reads well; the component of these is the quantity.
            name.replacen('.', " ", 1)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pictures::fixture;
    use halfstep_scene::{Probe, Reference};

    fn table(rows: &[[f64; 3]]) -> Table {
        let columns = ["time [s]", "tip.x [m]", "tip.y [m]"].map(String::from).to_vec();
        Table { columns, rows: rows.iter().map(|row| row.to_vec()).collect() }
    }

    fn tip() -> Scene {
        let mut scene = fixture::scene();
        scene.probes = vec![Probe {
            name: "tip".into(),
            kind: ProbeKind::Displacement { at: [0.0; 3] },
            solid: Some(0),
        }];
        scene.references.clear();
        scene
    }

    #[test]
    fn components_share_a_panel() {
        let panels = panels(&tip(), &table(&[[0.0, 0.0, 0.0], [0.1, 0.02, -0.01]]));
        assert_eq!(panels.len(), 1);
        assert_eq!((&*panels[0].quantity, &*panels[0].unit), ("tip displacement", "m"));
        assert_eq!(panels[0].curves[1].points, [(0.0, 0.0), (0.1, -0.01)]);
    }

    #[test]
    fn a_flat_component_or_a_reference_gets_its_own() {
        let table_flat = table(&[[0.0, 0.0, 0.0], [0.1, 0.02, -0.0001]]);
        assert_eq!(panels(&tip(), &table_flat).len(), 2);
        let mut scene = tip();
        let points = vec![[0.0, 0.0], [0.05, 0.04], [9.0, 70.0]];
        scene.references.push(Reference {
            probe: "tip.y".into(),
            label: "measured".into(),
            points,
            column: None,
        });
        let panels = panels(&scene, &table(&[[0.0, 0.0, 0.0], [0.1, 0.02, 0.02]]));
        assert_eq!(panels.len(), 2);
        assert!(panels[0].references.is_empty());
        assert_eq!(panels[1].references[0].label, "measured");
        // The reference's point after the end of the run does not widen the axis.
        assert_eq!(panels[1].largest(0.1), 0.04);
    }

    #[test]
    fn a_reference_far_off_is_named_with_its_range() {
        let mut scene = tip();
        let far = vec![[0.05, 0.05], [0.04, 0.041]];
        let near = vec![[0.0, 0.0], [0.1, 0.05]];
        for (label, points) in [("far", far), ("near", near)] {
            scene.references.push(Reference {
                probe: "tip.x".into(),
                label: label.into(),
                points,
                column: None,
            });
        }
        let panel = |x: f64| panels(&scene, &table(&[[0.0, 0.0, 0.0], [0.1, x, 0.0]])).remove(0);
        let flat = panel(0.002);
        assert_eq!(flat.references[0].label, "far: 41 to 50 mm, off the axis");
        assert!(flat.references[0].points.is_empty());
        assert_eq!(flat.references[1].label, "near", "it begins where the run does");
        let comparable = panel(0.003);
        assert_eq!(
            (comparable.references[0].label.as_str(), comparable.references[0].points.len()),
            ("far", 2)
        );
        assert!(!comparable.references[0].is_line() && comparable.references[1].is_line());
    }

    #[test]
    fn a_range_is_never_empty_and_ignores_what_is_not_finite() {
        let range = |rows: &[[f64; 3]]| panels(&tip(), &table(rows))[0].range(1.0);
        assert_eq!(range(&[]), -1.0..1.0);
        assert_eq!(range(&[[0.0, 0.0, 0.0]]), -1.0..1.0);
        let rounding = range(&[[0.0, 1e5, 1e5], [0.1, 1e5 + 3e-11, 1e5]]);
        assert!((rounding.start / 9e4 - 1.0).abs() < 1e-9 && (rounding.end / 1.1e5 - 1.0).abs() < 1e-9);
        let diverged = range(&[[0.0, 0.0, 0.0], [0.1, 1.0, 1.0], [0.2, f64::NAN, f64::INFINITY]]);
        assert!((diverged.start + 0.06).abs() < 1e-12 && (diverged.end - 1.06).abs() < 1e-12, "{diverged:?}");
    }
}
