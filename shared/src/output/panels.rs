//! Which curves of `plot.png` share a panel, and what range it shows.

use super::probes::{Table, split_unit};
use crate::scene::{ProbeKind, Scene};
use std::ops::Range;

/// Components share a panel while none of them covers less than this part of the panel's height.
const SMALLEST_SHARE: f64 = 0.15;

/// Points (time s, value in the probe's unit) and their name in the legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    pub(crate) label: String,
    pub(crate) points: Vec<(f64, f64)>,
}

impl Curve {
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
        // What varies by rounding errors only is constant: an axis of a few last digits has no sensible ticks.
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
            let references = references.map(|reference| Curve {
                label: reference.label.clone(),
                points: reference.points.iter().map(|&[time, value]| (time, value)).collect(),
            });
            singles.push(Panel {
                quantity: axis(name, &probe.kind),
                unit: unit.into(),
                references: references.collect(),
                curves: vec![Curve {
                    label: format!("{name}, this run"),
                    points: times.iter().copied().zip(values).collect(),
                }],
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
        ProbeKind::Centroid { .. } => format!("{name} centre of mass"),
        ProbeKind::Front => format!("{name} reach"),
        ProbeKind::Pressure { .. } | ProbeKind::WaterLevel { .. } | ProbeKind::KineticEnergy { .. } => {
            // `p1.pressure` reads well; the component of these is the quantity.
            name.replacen('.', " ", 1)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::fixture;
    use crate::scene::{Probe, Reference};

    fn table(rows: &[[f64; 3]]) -> Table {
        let columns = ["time [s]", "tip.x [m]", "tip.y [m]"].map(String::from).to_vec();
        Table { columns, rows: rows.iter().map(|row| row.to_vec()).collect() }
    }

    fn tip() -> Scene {
        let mut scene = fixture::scene();
        scene.probes = vec![Probe { name: "tip".into(), kind: ProbeKind::Displacement { at: [0.0; 3] } }];
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
        scene.references.push(Reference { probe: "tip.y".into(), label: "measured".into(), points });
        let panels = panels(&scene, &table(&[[0.0, 0.0, 0.0], [0.1, 0.02, 0.02]]));
        assert_eq!(panels.len(), 2);
        assert!(panels[0].references.is_empty());
        assert_eq!(panels[1].references[0].label, "measured");
        // The reference's point after the end of the run does not widen the axis.
        assert_eq!(panels[1].largest(0.1), 0.04);
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
