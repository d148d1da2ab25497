//! What must hold between a probe and the rest of the scene.

use super::check::Check;
use super::*;

impl Check<'_> {
    pub(super) fn probes(&self) {
        let names: Vec<&str> = self.scene.probes.iter().map(|p| p.name.as_str()).collect();
        if !self.report.has("probe") {
            self.unique("probe", &names);
        }
        // Those of the fluid, then those of each solid.
        for probe in &self.scene.probes {
            let key = format!("probe.{}", probe.name);
            if self.report.has(&key) {
                continue;
            }
            let phase = probe.kind.phase();
            let (name, section) = match phase {
                Phase::Solid => ("solid", !self.scene.solids.is_empty()),
                _ => ("fluid", self.scene.fluid.is_some()),
            };
            // A shape without its section has been noted.
            let present = section || self.scene.shapes.iter().any(|s| s.phase == phase);
            if !present && !self.report.has(name) {
                self.place(&key, format!("measures a {name}, and the scene has none"));
                continue;
            }
            self.probe_place(probe, &key);
        }
    }

    fn probe_place(&self, probe: &Probe, key: &str) {
        if self.report.has_any(&["resolution", "shape", "dimension"]) {
            return;
        }
        match &probe.kind {
            ProbeKind::Displacement { at } => {
                let near = |s: &&Shape| {
                    let bounds = geometry::bounding_box(s, self.scene);
                    s.phase == Phase::Solid && geometry::holds(&bounds, at, 2.0 * self.scene.resolution)
                };
                if !self.scene.shapes.iter().any(|s| near(&s)) {
                    self.wrong(&format!("{key}.at"), "is in or beside no solid shape");
                }
            }
            ProbeKind::Pressure { at }
                if !self.report.has("numerics.domain")
                    && !geometry::holds(&geometry::domain(self.scene), at, 0.0) =>
            {
                self.wrong(&format!("{key}.at"), "is outside the domain: no fluid gets there");
            }
            ProbeKind::WaterLevel { x } if !self.report.has("numerics.domain") => {
                let domain = geometry::domain(self.scene);
                if *x < domain.min[0] || *x > domain.max[0] {
                    self.wrong(&format!("{key}.x"), "is outside the domain: no fluid gets there");
                }
            }
            ProbeKind::Force { .. } if self.scene.fluid.is_none() || self.scene.solids.is_empty() => {
                self.wrong(&format!("{key}.kind"), "needs a fluid and a solid");
            }
            ProbeKind::Force { within: Some(within) } => {
                let near = |s: &&Shape| {
                    let bounds = geometry::bounding_box(s, self.scene);
                    s.solid.is_some_and(|k| probe.solid == Some(k))
                        && (0..self.scene.dimension)
                            .all(|a| bounds.min[a] < within.max[a] && within.min[a] < bounds.max[a])
                };
                if !self.scene.shapes.iter().any(|s| near(&s)) {
                    let reason = match &self.scene.solids[..] {
                        [_] => "holds no part of a solid shape".to_owned(),
                        several => {
                            let name = probe.solid.map_or("", |k| &several[k].name);
                            format!("holds no part of a shape of `{name}`")
                        }
                    };
                    self.wrong(&format!("{key}.within"), reason);
                }
            }
            _ => (),
        }
    }
}
