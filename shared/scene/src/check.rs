//! What must hold between keys. A check that would only repeat an error of one of its keys says nothing.

use super::document::Node;
use super::error::{Report, listed, nearest};
use super::*;
use crate::dispatch;
use crate::geometry::Plate;
use crate::geometry::{joined, least_thickness};

/// Frames, rows and steps that no run can be meant to have.
const MAX_FRAMES: f64 = 1e5;
const MAX_CHECKPOINTS: f64 = 1e5;
const MAX_ROWS: f64 = 1e7;
const MAX_STEPS: f64 = 1e9;
/// Resolutions for pairs in single precision, m.
const SINGLE: [f64; 2] = [1e-6, 1e6];

/// The keys that can choose the phase-blind treatment.
pub(super) const PHASE_BLIND_BY: [&str; 2] = ["interface.treatment", "preset"];

pub(super) struct Check<'a> {
    pub(super) scene: &'a Scene,
    pub(super) root: &'a Node,
    pub(super) report: &'a Report,
}

impl Check<'_> {
    pub(super) fn all(&self) {
        self.phases();
        self.solids();
        self.contacts();
        self.rigid_bodies();
        self.shape_names();
        self.sizes();
        self.precision();
        self.time_integration();
        self.thin_plates();
        self.interface();
        self.times();
        self.wave_makers();
        self.beach();
        self.frame();
        self.probes();
        self.references();
        self.metrics();
    }

    pub(super) fn wrong(&self, key: &str, reason: impl Into<String>) {
        self.report.among(self.root, key, &[], reason);
    }

    pub(super) fn place(&self, key: &str, reason: impl Into<String>) {
        self.report.place(key, self.root.origin_of(key), reason);
    }

    /// The key of the shape of that index: by index, since names may be taken twice.
    pub(super) fn shape_key(&self, index: usize) -> String {
        let shape = &self.scene.shapes[index];
        let first = self.scene.shapes.iter().position(|s| s.name == shape.name);
        if first == Some(index) && !shape.name.is_empty() {
            format!("shape.{}", shape.name)
        } else {
            format!("shape.{index}")
        }
    }

    fn phases(&self) {
        if self.report.has("shape") {
            return;
        }
        let shape_of = |phase| self.scene.shapes.iter().position(|s| s.phase == phase);
        for (phase, section, present) in [
            (Phase::Fluid, "fluid", self.scene.fluid.is_some()),
            (Phase::Solid, "solid", !self.scene.solids.is_empty()),
        ] {
            match (shape_of(phase), present) {
                _ if self.report.has(section) => (),
                (None, true) if self.scene.solids.len() > 1 && phase == Phase::Solid => (),
                (None, true) => self.place(section, format!("the scene has no shape of phase \"{section}\"")),
                (Some(index), false) => self.place(
                    &format!("{}.phase", self.shape_key(index)),
                    format!("the scene has no [{section}] section that says what it is made of"),
                ),
                _ => (),
            }
        }
        let moving = [Phase::Fluid, Phase::Solid].into_iter().any(|phase| shape_of(phase).is_some());
        if !moving && self.scene.fluid.is_none() && self.scene.solids.is_empty() {
            self.place("shape", "the scene has no shape of phase \"fluid\" or \"solid\": nothing would move");
        }
    }

    fn shape_names(&self) {
        let mut names: Vec<&str> = self.scene.shapes.iter().map(|s| s.name.as_str()).collect();
        // As they stand in the file.
        for (k, void) in self.scene.voids.iter().enumerate() {
            names.insert(void.before + k, &void.name);
        }
        self.unique("shape", &names);
    }

    pub(super) fn unique(&self, array: &str, names: &[&str]) {
        for (index, name) in names.iter().enumerate() {
            if !name.is_empty() && names[..index].contains(name) {
                // By index: by name the first would be found.
                let place = self.root.child(array).and_then(|items| match &items.value {
                    document::Value::Array(items) => items.get(index)?.child("name"),
                    _ => None,
                });
                if let Some(place) = place {
                    let key = format!("{array}.{index}.name");
                    self.report.value(&key, place.origin, format!("another {array} has this name"));
                }
            }
        }
    }

    /// Notes that no shape is as long as a spacing: one error instead of one for each.
    fn coarse(&self) -> bool {
        let (scene, dx) = (self.scene, self.scene.resolution);
        let longest = |shape: &Shape| {
            let block = match &shape.geometry {
                Geometry::Tank { cavity, .. } => *cavity,
                _ => geometry::bounding_box(shape, scene),
            };
            (0..scene.dimension).map(|a| block.max[a] - block.min[a]).fold(0.0, f64::max)
        };
        let right = || (0..scene.shapes.len()).all(|index| !self.report.has(&self.shape_key(index)));
        let largest = scene.shapes.iter().map(longest).fold(0.0, f64::max);
        let coarse = scene.shapes.len() > 1 && right() && largest < dx;
        if coarse {
            let reason = format!(
                "is more than the largest shape is long, {} m: lengths are in metres",
                largest as f32
            );
            self.report.among(self.root, "resolution", &["preset"], reason);
        }
        coarse
    }

    /// With the phase-blind interface both phases are advanced by one rule.
    fn time_integration(&self) {
        let verlet =
            self.scene.fluid.as_ref().is_some_and(|f| f.time_integration == FluidIntegration::Verlet);
        if verlet && self.scene.interface.treatment == Treatment::PhaseBlind && !self.scene.solids.is_empty()
        {
            let reason =
                "is \"verlet\", but with the phase-blind interface both phases go by the midpoint rule";
            self.report.among(self.root, "fluid.time_integration", &PHASE_BLIND_BY, reason);
        }
    }

    /// Kernels of smaller particles leave the range of single precision.
    fn precision(&self) {
        let [finest, coarsest] = SINGLE;
        let spacing = self.scene.resolution;
        if self.scene.numerics.precision == Precision::Mixed && !(finest..=coarsest).contains(&spacing) {
            let reason = format!(
                "is mixed, but with a resolution of {spacing:e} m the kernel's slopes leave the range of single \
                precision; it takes resolutions from {finest:e} to {coarsest:e} m"
            );
            self.wrong("numerics.precision", reason);
        }
    }

    /// Every shape holds at least one particle.
    fn sizes(&self) {
        if self.report.has_any(&["resolution", "dimension"]) || self.coarse() {
            return;
        }
        for (index, shape) in self.scene.shapes.iter().enumerate() {
            let key = self.shape_key(index);
            if self.report.has(&key) {
                continue;
            }
            let kind = self.geometry_key(&key, &shape.geometry);
            let nodal = self.scene.numerics.lattice == Lattice::Nodal && shape.phase != Phase::Wall;
            let model = shape.solid.and_then(|k| self.model(k));
            let rows = model.map_or(1, |model| if kind == "disc" { 1 } else { model.rules().rows });
            let needed = match model {
                Some(model) if rows > 1 => format!("{rows} particles of the {} model need", model.name()),
                _ => "one particle needs".to_owned(),
            };
            let least = self.scene.spacing(shape) * (f64::from(rows) + f64::from(u8::from(nodal)));
            let mut at = String::new();
            let thickness = match shape.geometry.unmoved() {
                Geometry::Disc { radius, .. } => *radius,
                // Of walls and water an end may be as thin as it likes.
                Geometry::Polygon(polygon)
                    if shape.phase != Phase::Solid && polygon.area().sqrt() >= least * (1.0 - 1e-9) =>
                {
                    polygon.area().sqrt()
                }
                Geometry::Polygon(polygon) => {
                    let (thickness, [x, y]) = polygon.thickness();
                    at = format!(" at [{}, {}]", x as f32, y as f32);
                    if shape.phase == Phase::Solid { thickness } else { thickness.min(polygon.area().sqrt()) }
                }
                geometry => match joined(self.scene, shape, &shape.geometry) {
                    Some(block) => spacing::thickness(&Geometry::Box(block), self.scene.dimension),
                    None => spacing::thickness(geometry, self.scene.dimension),
                },
            };
            let convention = if nodal { " in the nodal lattice" } else { "" };
            if thickness < least * (1.0 - 1e-9) {
                let place = format!("{key}.{kind}");
                let corners = [format!("{place}.min"), format!("{place}.max")];
                let model = format!("{}.model", self.solid_key(shape.solid.unwrap_or(0)));
                let own = [format!("{key}.spacing"), format!("{key}.across")];
                let others = [
                    &corners[0],
                    &corners[1],
                    &own[0],
                    &own[1],
                    "resolution",
                    "numerics.lattice",
                    &model,
                    "preset",
                ];
                // In single precision: without the last digits that a difference leaves.
                let thickness = thickness as f32;
                let reason = format!("is {thickness} m thin{at}, and {needed} {least} m{convention}");
                self.report.among(self.root, &place, &others, reason);
            }
        }
    }

    /// A plate holds water only where the fluid on one face does not reach that on the other.
    fn thin_plates(&self) {
        if self.report.has_any(&["resolution", "dimension", "smoothing_ratio", "interface", "effects"]) {
            return;
        }
        let Some(least) = least_thickness(self.scene) else { return };
        for (index, shape) in self.scene.shapes.iter().enumerate() {
            let key = self.shape_key(index);
            let plate = dispatch!(self.scene.dimension, D => {
                Plate::<D>::of(self.scene, shape).map(|plate| (plate.rows, plate.thickness))
            });
            let Some((rows, thickness)) =
                plate.flatten().filter(|(_, thickness)| thickness * (1.0 + 1e-9) < least)
            else {
                continue;
            };
            if self.report.has(&key) {
                continue;
            }
            let place = format!("{key}.{}", self.geometry_key(&key, &shape.geometry));
            let others =
                ["resolution", "smoothing_ratio", "numerics.lattice", "interface.treatment", "preset"];
            let corners = [format!("{place}.min"), format!("{place}.max")];
            let others: Vec<&str> = corners.iter().map(String::as_str).chain(others).collect();
            let has = match shape.spacing {
                // Rounded to a whole number it may look enough.
                None => {
                    format!("has {} of at least {least} particles across", (100.0 * rows).round() / 100.0)
                }
                Some(_) => {
                    let thickness = thickness as f32;
                    format!("is {thickness} of at least {least} spacings of the fluid thick")
                }
            };
            let reason = format!(
                "{has}: fluid on one face reaches the other through it (2h) and leaks; effects.thin-plate-screen = \
                 \"off\" lets it pass"
            );
            self.report.among(self.root, &place, &others, reason);
        }
    }

    /// The key that says where the shape of a key is.
    pub(super) fn geometry_key(&self, shape: &str, geometry: &Geometry) -> &'static str {
        match geometry.unmoved() {
            Geometry::Box(_) => "box",
            Geometry::Tank { .. } => "tank",
            Geometry::Disc { .. } => "disc",
            Geometry::Ring { .. } => "ring",
            _ if self.root.child_at(&format!("{shape}.outline")).is_some() => "outline",
            _ => "polygon",
        }
    }

    fn interface(&self) {
        if self.report.has("interface.treatment") || self.scene.interface.treatment != Treatment::PhaseBlind {
            return;
        }
        self.phase_blind_solids();
        if self.scene.smoothing_ratio < 1.1 && !self.report.has("smoothing_ratio") {
            let why = "with h / dx = 1.0 the sums over both phases blow up at once";
            let reason = format!("must be at least 1.1 with phase-blind: {why}");
            self.report.among(self.root, "smoothing_ratio", &PHASE_BLIND_BY, reason);
        }
    }

    fn times(&self) {
        if self.report.has("end_time") {
            return;
        }
        let end = self.scene.end_time;
        let step = match self.scene.time_step {
            TimeStep::Fixed(dt) => dt,
            TimeStep::Auto => end,
        };
        if step > end && !self.report.has("time_step") {
            let reason = format!("must be at most end_time, {end} s");
            self.report.among(self.root, "time_step", &["end_time", "preset"], reason);
        }
        let output = &self.scene.output;
        for (key, interval, most, what) in [
            ("time_step", step, MAX_STEPS, "steps"),
            ("output.frame_interval", output.frame_interval, MAX_FRAMES, "frames"),
            ("output.probe_interval", output.probe_interval, MAX_ROWS, "rows in probes.csv"),
            ("output.checkpoint_interval", output.checkpoint_interval, MAX_CHECKPOINTS, "checkpoints"),
        ] {
            let number = end / interval;
            if interval > 0.0 && number > most && !self.report.has(key) {
                let reason = format!("would make {number:.0} {what} until {end} s; at most {most:.0}");
                self.report.among(self.root, key, &["end_time", "preset"], reason);
            }
        }
    }

    fn references(&self) {
        if self.report.has_any(&["reference", "probe"]) {
            return;
        }
        for (index, reference) in self.scene.references.iter().enumerate() {
            self.component(&format!("reference.{index}.probe"), &reference.probe);
        }
    }

    /// Notes that the value of a key is no component of a probe, where it is none.
    pub(super) fn component(&self, key: &str, name: &str) {
        let of_probe = |p: &Probe| {
            let (parts, _) = p.kind.components(self.scene.dimension);
            parts.iter().map(|part| format!("{}.{part}", p.name)).collect::<Vec<_>>()
        };
        let components: Vec<String> = self.scene.probes.iter().flat_map(of_probe).collect();
        if components.iter().any(|component| component == name) {
            return;
        }
        let known = || components.iter().map(String::as_str);
        let note = self.report.value(key, self.root.origin_of(key), "is no component of a probe");
        match nearest(name, known()) {
            Some(near) => note.help(format!("did you mean `{near}`?")),
            None if components.is_empty() => note.help("the scene has no probes"),
            None => note.help(format!("the components are {}", listed(known(), "and"))),
        }
    }

    /// Whether a key's value comes from an override.
    pub(super) fn is_overridden(&self, key: &str) -> bool {
        self.report.is_override(self.root.origin_of(key))
    }
}
