//! What must hold between the keys of a rigid solid, its shapes and walls.

use super::check::Check;
use super::error::listed;
use super::*;

impl Check<'_> {
    pub(super) fn rigid_bodies(&self) {
        if self.report.has_any(&["shape", "solid"]) {
            return;
        }
        for (index, shape) in self.scene.shapes.iter().enumerate() {
            self.rigid_shape(index, shape);
        }
        for (index, solid) in self.scene.solids.iter().enumerate() {
            let Some(keys) = solid.rigid() else { continue };
            let key = self.solid_key(index);
            let of = |name: &str, list: &str, k: usize, names: &[&str]| {
                // By index where a name is taken twice or missing.
                let alone = !name.is_empty() && names.iter().position(|other| *other == name) == Some(k);
                if alone { format!("{key}.{list}.{name}") } else { format!("{key}.{list}.{k}") }
            };
            let names: Vec<&str> = keys.bodies.iter().map(|body| body.name.as_str()).collect();
            for (k, body) in keys.bodies.iter().enumerate() {
                let place = of(&body.name, "bodies", k, &names);
                self.is_one_body(index, &format!("{place}.name"), &body.name);
                if names[..k].contains(&body.name.as_str()) {
                    self.wrong(&format!("{place}.name"), "another table of `bodies` is about this body");
                }
            }
            let names: Vec<&str> = keys.joints.iter().map(|joint| joint.name.as_str()).collect();
            for (k, joint) in keys.joints.iter().enumerate() {
                let place = of(&joint.name, "joints", k, &names);
                if names[..k].contains(&joint.name.as_str()) {
                    self.wrong(&format!("{place}.name"), "another joint has this name");
                }
                self.joint(index, joint, &place);
            }
        }
    }

    /// What a rigid shape cannot have, and what only it has.
    fn rigid_shape(&self, index: usize, shape: &Shape) {
        let Some(solid) = shape.solid.and_then(|k| self.scene.solids.get(k)) else { return };
        let key = self.shape_key(index);
        let refuse = |name: &str, reason: &str| {
            let place = format!("{key}.{name}");
            self.report.among(self.root, &place, &[], reason);
        };
        let Some(keys) = solid.rigid() else {
            if shape.density.is_some() {
                refuse("density", "only a shape of a rigid solid has a density of its own");
            }
            return;
        };
        if !shape.clamp.is_empty() {
            refuse("clamp", "a rigid body is not clamped: `joints` of its solid hold it");
        }
        if shape.cantilever_mode.is_some() {
            refuse("cantilever_mode", "a rigid body does not bend");
        }
        let Some(motion) = &shape.motion else { return };
        if shape.velocity != [0.0; 3] {
            refuse(
                "velocity",
                "is that of a body whose `motion` prescribes where it is: leave one of the two out",
            );
        }
        let same = |other: &&Shape| other.solid == shape.solid && other.body() == shape.body();
        if let Some(other) = self.scene.shapes.iter().filter(same).find(|s| s.motion.as_ref() != Some(motion))
        {
            refuse("motion", &format!("is not that of `{}`, which is of the same rigid body", other.name));
        }
        if let Some(joint) = keys.joints.iter().find(|joint| joint.holds() && joint.body == shape.body()) {
            refuse(
                "motion",
                &format!("prescribes where the body is, and the joint `{}` holds it", joint.name),
            );
        }
    }

    fn joint(&self, solid: usize, joint: &Joint, key: &str) {
        if !self.is_one_body(solid, &format!("{key}.body"), &joint.body) || joint.with.is_empty() {
            return;
        }
        let with = format!("{key}.with");
        if joint.with == joint.body {
            return self.wrong(&with, "is the body itself");
        }
        let is_wall = |shape: &Shape| shape.phase == Phase::Wall && shape.name == joint.with;
        if !self.scene.shapes.iter().any(is_wall) {
            self.is_one_body(solid, &with, &joint.with);
        }
    }

    /// The value of a key names one body of the solid.
    pub(super) fn is_one_body(&self, solid: usize, key: &str, name: &str) -> bool {
        let shapes = || self.scene.shapes.iter().filter(|shape| shape.solid == Some(solid));
        let mut own = shapes().filter(|shape| shape.body() == name);
        let Some(first) = own.next() else {
            let mut known: Vec<&str> = shapes().map(Shape::body).collect();
            known.dedup();
            let walls = if key.ends_with(".with") { ", nor a wall" } else { "" };
            let reason = format!("is no body of this solid{walls}; its bodies are {}", listed(known, "and"));
            self.wrong(key, reason);
            return false;
        };
        if let (true, Geometry::Moved(moved)) = (first.body.is_empty(), &first.geometry)
            && moved.count > 1
        {
            let reason = format!("is {} bodies: copies of one shape, each free of the others", moved.count);
            self.wrong(key, reason);
            return false;
        }
        true
    }
}
