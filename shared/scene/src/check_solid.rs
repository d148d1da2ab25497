//! What must hold between solids and the rest of the scene.

use super::check::{Check, PHASE_BLIND_BY};
use super::document::{Node, Value};
use super::*;

/// How far from its place in the scene a motion may begin, in particle spacings.
const START: f64 = 1e-3;

/// Key of the section of the solid of that index.
pub(super) fn solid_key(scene: &Scene, root: &Node, index: usize) -> String {
    let listed = root.child("solid").is_some_and(|node| matches!(node.value, Value::Array(_)));
    let name = scene.solids.get(index).map_or("", |s| s.name.as_str());
    let first = scene.solids.iter().position(|s| s.name == name);
    match (listed, first == Some(index) && !name.is_empty()) {
        (false, _) => "solid".to_owned(),
        (true, true) => format!("solid.{name}"),
        (true, false) => format!("solid.{index}"),
    }
}

impl Check<'_> {
    pub(super) fn solids(&self) {
        let names: Vec<&str> = self.scene.solids.iter().map(|s| s.name.as_str()).collect();
        self.unique("solid", &names);
        if names.len() > 1 && !self.report.has_any(&["shape", "solid"]) {
            for (k, name) in names.iter().enumerate() {
                if self.scene.shapes.iter().all(|s| s.solid != Some(k)) {
                    self.place(&self.solid_key(k), format!("no solid shape says `solid = \"{name}\"`"));
                }
            }
        }
        self.solid_time_step();
        self.spacings();
        self.fractures();
        self.loads();
        self.bodies();
        self.clamps();
    }

    /// The key that says a shape's own spacing.
    fn spacing_key(&self, shape: usize) -> String {
        let key = self.shape_key(shape);
        let across = format!("{key}.across");
        if self.root.child_at(&across).is_some() { across } else { format!("{key}.spacing") }
    }

    /// One solid has one spacing, and none that the fluid would slip through.
    fn spacings(&self) {
        if self.report.has_any(&["resolution", "shape", "solid"]) {
            return;
        }
        let scene = self.scene;
        for (index, shape) in scene.shapes.iter().enumerate() {
            let (Some(solid), Some(spacing)) = (shape.solid, shape.spacing) else { continue };
            let key = self.spacing_key(index);
            let first = scene.shapes.iter().position(|s| s.solid == Some(solid)).unwrap_or(index);
            let other = scene.solid_spacing(solid);
            let differs = (spacing - other).abs() > 1e-9 * other;
            let too_wide = scene.fluid.is_some() && spacing > scene.resolution * (1.0 + 1e-9);
            // In single precision: without the last digits that a division leaves.
            let (spacing, other) = (spacing as f32, other as f32);
            if differs {
                let name = &scene.shapes[first].name;
                let why =
                    format!("`{name}`, of the same solid, has {other} m, and one solid has one spacing");
                self.report.among(self.root, &key, &[], format!("makes {spacing} m, but {why}"));
            } else if too_wide {
                let (dx, why) = (scene.resolution, "the fluid would slip between the solid's particles");
                let reason = format!("makes {spacing} m, and must be at most the resolution, {dx} m: {why}");
                self.report.among(self.root, &key, &["resolution"], reason);
            }
        }
    }

    /// Tractions and cracks are of a model that has them, and a traction finds a particle.
    fn loads(&self) {
        for (index, shape) in self.scene.shapes.iter().enumerate() {
            let other =
                shape.solid.and_then(|k| self.model(k)).filter(|m| *m != SolidModelName::TotalLagrangian);
            let key = self.shape_key(index);
            for (name, present) in [("load", shape.load.is_some()), ("crack", shape.crack.is_some())] {
                if present && other.is_some() && !self.report.has_any(&["shape", "solid"]) {
                    let reason = format!("only the total-lagrangian model knows `{name}`");
                    self.report.among(self.root, &format!("{key}.{name}"), &[], reason);
                }
            }
            let Some(load) = &shape.load else { continue };
            let bounds = geometry::bounding_box(shape, self.scene);
            let apart = |a: usize| bounds.max[a] < load.within.min[a] || load.within.max[a] < bounds.min[a];
            if !self.report.has_any(&["resolution", "shape", "dimension"])
                && (0..self.scene.dimension).any(apart)
            {
                let reason = format!("holds no part of `{}`", shape.name);
                self.report.among(self.root, &format!("{key}.load.within"), &[], reason);
            }
        }
    }

    /// The band of a crack softens, and is not torn far apart before it breaks.
    fn fractures(&self) {
        if self.report.has_any(&["resolution", "shape", "solid", "dimension"]) {
            return;
        }
        for (k, solid) in self.scene.solids.iter().enumerate() {
            let Some(fracture) = solid.fracture() else { continue };
            let of_solid = self.solid_key(k);
            let key = format!("{of_solid}.fracture");
            let wrong = |others: &[&str], reason: String| self.report.among(self.root, &key, others, reason);
            if solid.smoothing_ratio > Fracture::SMOOTHING {
                let why = "farther neighbours see across a crack, and the width of its band is that of the nearest ones";
                let reason = format!("needs a smoothing_ratio of at most {}: {why}", Fracture::SMOOTHING);
                wrong(&[&format!("{of_solid}.smoothing_ratio"), "preset"], reason);
            } else if self.scene.numerics.lattice == Lattice::Nodal {
                let why = "clamps at the middle of a row give the rows beside it 1.6 and 0.8 of the stress, and a crack \
                           there half of its energy";
                wrong(&["numerics.lattice", "preset"], format!("needs a centred lattice: {why}"));
            } else if let Some(reason) = self.unfit_band(k, solid, &fracture) {
                let enters =
                    ["fracture.strength", "fracture.energy", "youngs_modulus", "poissons_ratio", "plane"];
                let mut others: Vec<String> = enters.iter().map(|of| format!("{of_solid}.{of}")).collect();
                let own = |shape: &Shape| shape.solid == Some(k) && shape.spacing.is_some();
                others.extend(self.scene.shapes.iter().position(own).map(|shape| self.spacing_key(shape)));
                others.extend(["resolution", "dimension"].map(str::to_owned));
                wrong(&others.iter().map(String::as_str).collect::<Vec<_>>(), reason);
            }
        }
    }

    /// What is wrong with the band of a crack, with the values in force: they may be a file's and overrides'.
    fn unfit_band(&self, index: usize, solid: &Solid, fracture: &Fracture) -> Option<String> {
        let band = Fracture::BAND * self.scene.solid_spacing(index);
        let modulus = solid.strip_modulus(self.scene.dimension);
        let (widest, narrowest) = (fracture.widest_band(modulus), fracture.narrowest_band());
        // In single precision: without the last digits that a division leaves.
        let [band_, widest_, narrowest_] = [band, widest, narrowest].map(|length| length as f32);
        let [strength, energy, modulus] = [fracture.strength, fracture.energy, modulus].map(|x| x as f32);
        let smears = format!("smears a crack over a band of {band_} m, {} spacings", Fracture::BAND);
        let in_force = format!("f_t = {strength} Pa, G_f = {energy} J/m²");
        if band >= widest {
            let why = "a wider band holds more energy than its fracture takes and snaps back";
            Some(format!(
                "{smears}, which must be below 2 E' G_f / f_t² = {widest_} m with E' = {modulus} Pa, {in_force}: {why}"
            ))
        } else if band < narrowest {
            let why = "the opening at which a crack breaks would tear its band far apart";
            let widest = Fracture::WIDEST;
            Some(format!(
                "{smears}, which must be at least G_f / ({widest} f_t) = {narrowest_} m with {in_force}: {why}"
            ))
        } else {
            None
        }
    }

    /// A body lies in one solid, and so on one spacing.
    fn bodies(&self) {
        if self.report.has_any(&["shape", "solid"]) {
            return;
        }
        let shapes = &self.scene.shapes;
        for (index, shape) in shapes.iter().enumerate().filter(|(_, shape)| !shape.body.is_empty()) {
            let unsaid_or_before = |k: usize| k < index || shapes[k].body.is_empty();
            let other = shapes.iter().enumerate().find(|(k, s)| {
                s.body() == shape.body && s.solid.is_some() && s.solid != shape.solid && unsaid_or_before(*k)
            });
            if let Some((other, solid)) = other.and_then(|(_, s)| Some((s, self.scene.solids.get(s.solid?)?)))
            {
                let reason = format!(
                    "is also the body of `{}`, which is of the solid `{}`: a body lies in one solid, and so on one \
                     spacing",
                    other.name, solid.name
                );
                self.report.among(self.root, &format!("{}.body", self.shape_key(index)), &[], reason);
            }
        }
    }

    /// A clamp moves with a wall that moves, or by its shape's own motion, of a model that can follow.
    fn clamps(&self) {
        for (index, shape) in self.scene.shapes.iter().enumerate() {
            self.own_motion(index, shape);
            for (clamp, name) in shape.clamp_with.iter().enumerate() {
                let Some(name) = name else { continue };
                let key = format!("{}.clamp", self.shape_key(index));
                let item = format!("{key}.{clamp}");
                let key = if self.root.child_at(&item).is_some() { item } else { key };
                let model = shape.solid.and_then(|k| self.model(k));
                let wall = self.scene.shapes.iter().find(|wall| wall.name == *name);
                let reason = match wall {
                    _ if self.report.has_any(&["shape", "solid"]) => continue,
                    Some(wall) if wall.phase == Phase::Wall && wall.motion.is_some() => match model {
                        Some(SolidModelName::Hypoelastic) => {
                            "only the total-lagrangian model has clamps that move".to_owned()
                        }
                        _ => continue,
                    },
                    Some(_) => format!("`{name}` is no wall with a `motion`"),
                    None => "is no shape of the scene".to_owned(),
                };
                self.report.among(self.root, &format!("{key}.with"), &[], reason);
            }
        }
    }

    /// What moves by prescription begins where the scene has it; of a solid only clamps move.
    fn own_motion(&self, index: usize, shape: &Shape) {
        let key = format!("{}.motion", self.shape_key(index));
        let Some(motion) = shape.motion.as_ref().filter(|_| !self.report.has_any(&["shape", "resolution"]))
        else {
            return;
        };
        let model = shape.solid.and_then(|k| self.model(k));
        let rigid = model == Some(SolidModelName::Rigid);
        if shape.phase == Phase::Solid && shape.clamp.is_empty() && !rigid {
            return self.wrong(&key, "moves the clamps of a solid, and the shape has none");
        }
        if model == Some(SolidModelName::Hypoelastic) {
            return self.wrong(&key, "only the total-lagrangian model has clamps that move");
        }
        let around = geometry::bounding_box(shape, self.scene);
        let start = motion.at(0.0);
        let radius = motion.pivot().map_or(0.0, |pivot| motion::farthest(&pivot, &around));
        let off = start.moved_since(&Placement::default(), radius);
        if off > START * self.scene.resolution {
            let reason = format!(
                "begins {} m away from where the scene has the shape: at 0 s it is there",
                off as f32
            );
            self.wrong(&key, reason);
        }
    }

    /// The key of the solid of that index: by index where its name is taken twice.
    pub(super) fn solid_key(&self, index: usize) -> String {
        solid_key(self.scene, self.root, index)
    }

    pub(super) fn model(&self, solid: usize) -> Option<SolidModelName> {
        self.scene.solids.get(solid).map(|s| s.model.name())
    }

    /// A model, and what a solid asks of it, may be stable to less than `numerics.solid_cfl` allows in general.
    fn solid_time_step(&self) {
        let (key, given) = ("numerics.solid_cfl", self.scene.numerics.solid_cfl);
        for (k, solid) in self.scene.solids.iter().enumerate() {
            let name = solid.model.name();
            let of_model =
                name.rules().largest_cfl.map(|(most, why)| (most, "model", Some(name.name()), why));
            let of_fracture = solid.fracture().map(|_| {
                let why = "corners and crumbs of a nearly incompressible solid are stable to little more";
                (Fracture::LARGEST_CFL, "fracture", None, why)
            });
            let of_arrangement = solid.irregular().map(|_| {
                let why = "where particles are closer than their spacing, waves take less time";
                (TotalLagrangianKeys::LARGEST_IRREGULAR_CFL, "arrangement", Some("irregular"), why)
            });
            let limits = [of_model, of_fracture, of_arrangement].into_iter().flatten();
            let Some((most, what, value, why)) = limits.into_iter().find(|(most, ..)| given > *most) else {
                continue;
            };
            if !self.report.has(key) {
                let what = format!("{}.{what}", self.solid_key(k));
                let value = value.map_or(String::new(), |value| format!(" = \"{value}\""));
                let reason = format!("must be at most {most} with {what}{value}: {why}");
                self.report.among(self.root, key, &[&what], reason);
            }
        }
    }

    /// What the phase-blind treatment asks of solids.
    pub(super) fn phase_blind_solids(&self) {
        let key = "interface.treatment";
        if self.scene.solids.len() > 1 {
            let why =
                "its sums do not ask what a neighbour is, so each would need the particles of the others";
            let reason = format!("cannot be phase-blind with several solids: {why}");
            self.report.among(self.root, key, &["preset"], reason);
            return;
        }
        let Some(solid) = self.scene.solids.first() else { return };
        let of_solid = self.solid_key(0);
        let name = solid.model.name();
        if let Some(why) = name.rules().not_phase_blind {
            let model = format!("{of_solid}.model");
            let reason = format!("cannot be phase-blind with {model} = \"{}\": {why}", name.name());
            self.report.among(self.root, key, &[&model, "preset"], reason);
        }
        let own = |shape: &Shape| shape.spacing.is_some_and(|spacing| spacing != self.scene.resolution);
        if let Some(shape) = self.scene.shapes.iter().position(own) {
            let why = "its sums do not ask what a neighbour is, so all have one smoothing length";
            let reason = format!("must be that of the resolution with phase-blind: {why}");
            self.report.among(self.root, &self.spacing_key(shape), &PHASE_BLIND_BY, reason);
        }
        if matches!(solid.sub_steps, SubSteps::Fixed(n) if n != 1) {
            let why = "a particle close to the interface hangs on a spring as stiff as the solid";
            let reason = format!("must be \"auto\" or 1 with phase-blind: {why}");
            self.report.among(self.root, &format!("{of_solid}.sub_steps"), &PHASE_BLIND_BY, reason);
        }
    }
}
