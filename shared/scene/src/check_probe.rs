//! What must hold between a probe and the rest of the scene.

use super::check::Check;
use super::*;

/// Longest line along which something is measured, in particle spacings: it has as many points.
const MAX_LINE: f64 = 1e5;

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
            let phase = probe.phase();
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
            self.probe_model(probe, &key);
            self.probe_place(probe, &key);
        }
    }

    /// What a solid's model does not have cannot be measured: it would be zero for ever.
    fn probe_model(&self, probe: &Probe, key: &str) {
        let Some(solid) = probe.solid.and_then(|k| self.scene.solids.get(k)) else { return };
        let reason = match probe.kind {
            ProbeKind::CrackEnergy | ProbeKind::CrackArea | ProbeKind::Bodies
                if solid.fracture().is_none() =>
            {
                "without `fracture` of the solid nothing breaks"
            }
            ProbeKind::Stress { .. }
            | ProbeKind::Strain { .. }
            | ProbeKind::CauchyStress { .. }
            | ProbeKind::StrainEnergy
                if solid.model.name() == SolidModelName::Rigid =>
            {
                "a rigid body does not strain"
            }
            _ => return,
        };
        self.wrong(&format!("{key}.kind"), reason);
    }

    fn probe_place(&self, probe: &Probe, key: &str) {
        if self.report.has_any(&["resolution", "shape", "dimension"]) {
            return;
        }
        let solids = || self.scene.shapes.iter().filter(|s| s.phase == Phase::Solid);
        if let Some(at) = probe.kind.point_of_solid() {
            let near = |s: &Shape| {
                let bounds = geometry::bounding_box(s, self.scene);
                geometry::holds(&bounds, &at, 2.0 * self.scene.resolution)
            };
            if !solids().any(near) {
                self.wrong(&format!("{key}.at"), "is in or beside no solid shape");
            }
            return;
        }
        match &probe.kind {
            ProbeKind::Pressure { at, to, shape } => {
                let first = if to.is_some() { "from" } else { "at" };
                if let Some(shape) = shape.map(|shape| &self.scene.shapes[shape]) {
                    self.rides(key, first, at, shape);
                    to.iter().for_each(|to| self.rides(key, "to", to, shape));
                }
                self.in_domain(&format!("{key}.{first}"), at);
                to.iter().for_each(|to| self.in_domain(&format!("{key}.to"), to));
                self.line(key, at, to.as_ref());
            }
            ProbeKind::Velocity { at } => self.in_domain(&format!("{key}.at"), at),
            ProbeKind::Flux { from, to } => {
                self.in_domain(&format!("{key}.from"), from);
                self.in_domain(&format!("{key}.to"), to);
                self.line(key, from, Some(to));
            }
            ProbeKind::WaterLevel { x } if !self.report.has("numerics.domain") => {
                let domain = geometry::domain(self.scene);
                for (k, x) in x.iter().enumerate() {
                    if *x < domain.min[0] || *x > domain.max[0] {
                        let place = [format!("{key}.x.{k}"), format!("{key}.x")];
                        let place = &place[usize::from(self.root.child_at(&place[0]).is_none())];
                        self.wrong(place, "is outside the domain: no fluid gets there");
                    }
                }
            }
            ProbeKind::Force { within, shape } | ProbeKind::Moment { within, shape, .. } => {
                self.loaded(probe, key, within.as_ref(), *shape);
            }
            ProbeKind::Strain { of: Spot::Body(body) } | ProbeKind::CauchyStress { of: Spot::Body(body) } => {
                if let Some(solid) = probe.solid {
                    self.is_one_body(solid, &format!("{key}.body"), body);
                }
            }
            ProbeKind::Body { body, quantity } => {
                let key = format!("{key}.body");
                let known = |k: &usize| !quantity.is_of_rigid() || self.scene.solids[*k].rigid().is_some();
                match probe.solid.filter(known) {
                    Some(solid) => _ = self.is_one_body(solid, &key, body),
                    None => self.wrong(&key, "is no rigid body: the solid's model strains"),
                }
            }
            _ => (),
        }
    }

    /// A point that goes with a solid lies where the solid says how it moves, and where water may come.
    fn rides(&self, key: &str, end: &str, at: &[f64; 3], shape: &Shape) {
        let Some(solid) = shape.solid.and_then(|k| self.scene.solids.get(k)) else { return };
        if solid.fracture().is_some() {
            let reason =
                "is of a solid that may break: a crack would part the particles that take the point along";
            return self.wrong(&format!("{key}.shape"), reason);
        }
        let reach = 2.0 * self.scene.smoothing_ratio * self.scene.resolution;
        let mut depth = f64::INFINITY;
        let mut visit = |distance: f64| depth = depth.min(distance);
        let surface = geometry::Surface::new(&shape.geometry, None);
        match self.scene.dimension {
            2 => surface.nearest([at[0], at[1]], &mut |distance, _: [f64; 2]| visit(distance)),
            _ => surface.nearest(*at, &mut |distance, _: [f64; 3]| visit(distance)),
        }
        if depth.abs() > reach {
            let side = if depth > 0.0 { "outside" } else { "inside" };
            let [away, reach] = [depth.abs(), reach].map(|x| x / self.scene.resolution);
            let reason = format!(
                "is {away:.1} dx {side} of `{}`: what rides on a solid lies within the reach of the water's kernel, \
                 2h = {reach:.1} dx, from its surface",
                shape.name
            );
            self.wrong(&format!("{key}.{end}"), reason);
        }
    }

    fn in_domain(&self, key: &str, at: &[f64; 3]) {
        if !self.report.has("numerics.domain") && !geometry::holds(&geometry::domain(self.scene), at, 0.0) {
            self.wrong(key, "is outside the domain: no fluid gets there");
        }
    }

    /// A line has a length, and no more points than can be meant.
    fn line(&self, key: &str, from: &[f64; 3], to: Option<&[f64; 3]>) {
        let Some(to) = to else { return };
        if from == to {
            return self
                .wrong(&format!("{key}.to"), "must be another point than `from`: the line has no length");
        }
        let length = from.iter().zip(to).map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt();
        if length > MAX_LINE * self.scene.resolution {
            let reason = format!("is {length} m from `from`, more than {MAX_LINE} particle spacings");
            self.wrong(&format!("{key}.to"), reason);
        }
    }

    /// Forces on a solid, or on a shape: there is a fluid, and the box holds a part of what it is about.
    fn loaded(&self, probe: &Probe, key: &str, within: Option<&Block>, shape: Option<usize>) {
        let solids = !self.scene.solids.is_empty();
        if self.scene.fluid.is_none() || (shape.is_none() && !solids) {
            return self.wrong(&format!("{key}.kind"), "needs a fluid and a solid");
        }
        let Some(within) = within else { return };
        let of_probe = |(index, s): &(usize, &Shape)| match shape {
            Some(shape) => *index == shape,
            None => s.solid.is_some_and(|k| probe.solid == Some(k)),
        };
        let near = |s: &Shape| {
            let bounds = geometry::bounding_box(s, self.scene);
            (0..self.scene.dimension).all(|a| bounds.min[a] < within.max[a] && within.min[a] < bounds.max[a])
        };
        if self.scene.shapes.iter().enumerate().filter(of_probe).any(|(_, s)| near(s)) {
            return;
        }
        let reason = match (shape, &self.scene.solids[..]) {
            (Some(shape), _) => format!("holds no part of `{}`", self.scene.shapes[shape].name),
            (None, [_]) => "holds no part of a solid shape".to_owned(),
            (None, several) => {
                let name = probe.solid.map_or("", |k| &several[k].name);
                format!("holds no part of a shape of `{name}`")
            }
        };
        self.wrong(&format!("{key}.within"), reason);
    }
}
