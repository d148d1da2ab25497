//! Every shape as asked and as computed.

use super::beams::{self, Bends};
use super::nodal;
use super::thickness::{self, Thinnest};
use halfstep_scene::geometry::{self, Layout, Moved, Plate};
use halfstep_scene::{Block, Geometry, Phase, Plane, Scene, Shape, SolidModelName};
use serde::{Serialize, Serializer};
use std::fmt;

/// From which relative difference on a size is remarked.
pub(super) const NOTABLE: f64 = 0.02;
/// The same of a bending stiffness: that of a thickness that much larger.
const NOTABLY_STIFFER: f64 = 0.06;

/// A shape with its particles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Placed {
    /// Name of the shape.
    pub(crate) name: String,
    #[serde(serialize_with = "phase_name")]
    pub(super) phase: Phase,
    /// Sizes along the axes that the scene asks for, m; a disc's diameter, a ring's thickness.
    pub(super) asked: Vec<f64>,
    /// The same as computed, m.
    computed: Vec<f64>,
    /// Particles that it has.
    pub(super) particles: usize,
    /// Particles that lie in shapes that take their places.
    pub(super) lost: usize,
    /// Of its particles, those that a clamp holds.
    clamped: usize,
    /// Mass, kg (2D: kg/m).
    mass: f64,
    /// Rows across a plate.
    pub(super) rows: Option<f64>,
    /// A prescribed motion, of a wall or of clamps.
    moves: bool,
    /// Walls that its clamps move with.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    with: Vec<String>,
    /// The body that it is part of: of a solid.
    #[serde(skip_serializing_if = "Option::is_none")]
    body: Option<String>,
    /// Bending stiffness of a plate that can bend, asked and computed, N m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) bending: Option<[f64; 2]>,
    /// The computed one is that of the particles' area: they lie in no rectangle whose second moment is known.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    bending_by_area: bool,
    /// Of a clamped plate.
    #[serde(flatten)]
    pub(super) bends: Option<Bends>,
    /// Where it is too thin to hold fluid.
    #[serde(skip)]
    pub(super) thinnest: Option<Thinnest>,
    /// Of its sizes.
    unit: &'static str,
}

/// The shapes of a scene, in its order.
pub(crate) fn placed<const D: usize>(scene: &Scene, layout: &Layout<D>) -> Vec<Placed> {
    let mut counts = vec![[0; 2]; scene.shapes.len()];
    let of_solids = layout.solid.iter().map(|p| (p.body, p.clamped));
    let of_others = layout.fluid.iter().map(|p| p.shape).chain(layout.wall.iter().map(|p| p.shape));
    for (shape, clamped) in of_solids.chain(of_others.map(|shape| (shape, false))) {
        let [particles, held] = &mut counts[shape as usize];
        (*particles, *held) = (*particles + 1, *held + usize::from(clamped));
    }
    let mut all: Vec<Placed> =
        counts.into_iter().enumerate().map(|(index, counts)| of_shape::<D>(scene, index, counts)).collect();
    for (index, thinnest) in thickness::thinnest(scene, layout).into_iter().enumerate() {
        let shape = &mut all[index];
        shape.thinnest = thinnest;
        let rows = thinnest.map(|thin| thin.thickness / scene.spacing(&scene.shapes[index]));
        // What voids and other shapes leave of a plate.
        shape.rows = shape.rows.map(|whole| rows.map_or(whole, |rows| rows.min(whole)));
    }
    for (index, shape) in all.iter_mut().enumerate() {
        shape.bends = beams::deflection(scene, layout, index);
    }
    give_masses(scene, &mut all);
    all
}

/// Bodies whose mass the scene says share it among their shapes as these share that of their densities.
fn give_masses(scene: &Scene, placed: &mut [Placed]) {
    for (solid, keys) in scene.solids.iter().enumerate().filter_map(|(k, s)| Some((k, s.rigid()?))) {
        for (body, mass) in keys.bodies.iter().filter_map(|body| Some((&body.name, body.mass?))) {
            let own = |k: &usize| {
                let shape = &scene.shapes[*k];
                shape.solid == Some(solid) && shape.body() == body
            };
            let own: Vec<usize> = (0..placed.len()).filter(own).collect();
            let whole: f64 = own.iter().map(|&k| placed[k].mass).sum();
            if whole > 0.0 {
                own.into_iter().for_each(|k| placed[k].mass *= mass / whole);
            }
        }
    }
}

/// Of so many particles, and so many of them that a clamp holds.
fn of_shape<const D: usize>(scene: &Scene, index: usize, [particles, clamped]: [usize; 2]) -> Placed {
    let shape = &scene.shapes[index];
    let dx = scene.spacing(shape);
    let density = match shape.phase {
        Phase::Solid => {
            let solid = shape.solid.and_then(|k| scene.solids.get(k));
            shape.density.or(solid.map(|solid| solid.density)).unwrap_or(0.0)
        }
        Phase::Fluid => scene.fluid.as_ref().map_or(0.0, |fluid| fluid.density),
        Phase::Wall => 0.0,
    };
    let whole = geometry::places_alone::<D>(scene, index).len();
    // The nodal lattice has no particles on the surface of a solid.
    let missing = f64::from(u8::from(nodal::lacks(scene, shape)));
    let cells = |extent: f64| ((extent / dx).round() - missing) * dx;
    let measure = || geometry::measure_alone::<D>(scene, index) / f64::from(shape.geometry.copies());
    let (asked, computed) = match shape.geometry.unmoved() {
        Geometry::Box(b) if shape.lattice_angle != 0.0 => {
            (vec![(0..D).map(|a| b.max[a] - b.min[a]).product()], vec![measure()])
        }
        Geometry::Box(b) | Geometry::Tank { cavity: b, .. } => {
            let asked: Vec<f64> = (0..D).map(|a| b.max[a] - b.min[a]).collect();
            let computed = asked.iter().map(|&extent| cells(extent)).collect();
            (asked, computed)
        }
        // What has the area (volume) of its particles.
        Geometry::Disc { radius, .. } => (vec![2.0 * radius], vec![2.0 * equivalent_radius::<D>(measure())]),
        Geometry::Ring { inner, outer, .. } => {
            let hole = inner.powi(D as i32);
            let radius = (equivalent_radius::<D>(measure()).powi(D as i32) + hole).powf(1.0 / D as f64);
            (vec![outer - inner], vec![radius - inner])
        }
        Geometry::Polygon(polygon) => (vec![polygon.area()], vec![measure()]),
        Geometry::Moved(_) => (Vec::new(), Vec::new()),
    };
    let plate = Plate::<D>::of(scene, shape);
    let bending = plate.as_ref().and_then(|plate| bending(scene, shape, plate, &asked, &computed));
    let by_area = bending.is_some_and(|(_, by_area)| by_area);
    let mut with: Vec<String> = shape.clamp_with.iter().flatten().cloned().collect();
    with.dedup();
    Placed {
        name: shape.name.clone(),
        phase: shape.phase,
        asked,
        computed,
        particles,
        lost: whole.saturating_sub(particles),
        clamped,
        mass: density * particles as f64 * dx.powi(D as i32),
        rows: plate.map(|plate| plate.rows),
        moves: shape.motion.is_some(),
        with,
        body: (shape.phase == Phase::Solid).then(|| shape.body().to_owned()),
        bending: bending.map(|(both, _)| both),
        bending_by_area: by_area,
        bends: None,
        thinnest: None,
        unit: if !is_measured(shape) {
            "m"
        } else if D == 2 {
            "m²"
        } else {
            "m³"
        },
    }
}

/// Whether the size of a shape is the area of its particles: no lattice fits it along its sides.
fn is_measured(shape: &Shape) -> bool {
    match shape.geometry.unmoved() {
        Geometry::Polygon(_) => true,
        Geometry::Box(_) => shape.lattice_angle != 0.0,
        _ => false,
    }
}

/// Bending stiffness of a plate per width, asked and computed, N m, and whether the computed one follows from the
/// particles' area alone. `None` of what cannot bend.
fn bending<const D: usize>(
    scene: &Scene,
    shape: &Shape,
    plate: &Plate<D>,
    asked: &[f64],
    computed: &[f64],
) -> Option<([f64; 2], bool)> {
    let solid = shape.solid.and_then(|k| scene.solids.get(k)).filter(|solid| solid.rigid().is_none())?;
    let modulus = solid.bending_modulus();
    let of = |thickness: f64| modulus * thickness.powi(3) / 12.0;
    let thin = (0..asked.len()).min_by(|&a, &b| asked[a].total_cmp(&asked[b]))?;
    let factor = computed[thin] / asked[thin];
    if !is_measured(shape) {
        return Some(([of(asked[thin]), of(factor * asked[thin])], false));
    }
    match (D == 2).then(|| geometry::second_moments::<D>(scene, shape)).flatten() {
        Some(moments) => Some((moments.map(|moment| modulus * moment), false)),
        // An area is larger where its plate is thicker.
        None => {
            let thickness = plate.rows * scene.spacing(shape);
            Some(([of(thickness), of(factor * thickness)], true))
        }
    }
}

/// Radius of the disc or ball of an area or volume, m.
fn equivalent_radius<const D: usize>(measure: f64) -> f64 {
    let unit = if D == 2 { std::f64::consts::PI } else { 4.0 / 3.0 * std::f64::consts::PI };
    (measure / unit).powf(1.0 / D as f64)
}

impl Placed {
    /// The axis on which the computed size differs most, and by which factor.
    fn worst(&self) -> Option<(usize, f64)> {
        let factors = self.asked.iter().zip(&self.computed).map(|(asked, computed)| computed / asked);
        factors.enumerate().max_by(|a, b| (a.1 - 1.0).abs().total_cmp(&(b.1 - 1.0).abs()))
    }
}

impl fmt::Display for Placed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = |of: &[f64]| of.iter().map(|x| length(*x)).collect::<Vec<_>>().join(" x ");
        write!(f, "{:<7}{} {}", name_of(self.phase), size(&self.asked), self.unit)?;
        if self.worst().is_some_and(|(_, factor)| (factor - 1.0).abs() >= 5e-4) {
            write!(f, " asked, {} {} computed", size(&self.computed), self.unit)?;
        }
        write!(f, "; {} particles", self.particles)?;
        if self.lost > 0 {
            write!(f, " ({} more lie in other shapes)", self.lost)?;
        }
        if let Some(rows) = self.rows {
            write!(f, ", {rows:.0} across")?;
        }
        if self.mass > 0.0 {
            write!(f, ", {} kg/m", length(self.mass))?;
        }
        if self.clamped > 0 {
            write!(f, ", {} clamped", self.clamped)?;
        }
        if let Some([asked, computed]) = self.bending {
            write!(f, ", bending stiffness {} N m", length(asked))?;
            if (computed / asked - 1.0).abs() >= 1e-3 {
                let by = if self.bending_by_area { " from its area" } else { "" };
                write!(f, " asked, {} computed{by}", length(computed))?;
            }
        }
        if let Some(Bends { way: [way, free], under, .. }) = &self.bends {
            let (way, free) = (*way, *free);
            write!(f, ", bends {} of {} m under {under}", length(way), length(free))?;
        }
        if let Some(body) = self.body.as_ref().filter(|body| **body != self.name) {
            write!(f, ", of body {body}")?;
        }
        if !self.with.is_empty() {
            write!(f, ", moves with {}", self.with.join(" and "))?;
        }
        if self.moves {
            write!(f, ", moves")?;
        }
        Ok(())
    }
}

fn name_of(phase: Phase) -> &'static str {
    match phase {
        Phase::Fluid => "fluid",
        Phase::Solid => "solid",
        Phase::Wall => "wall",
    }
}

fn phase_name<S: Serializer>(phase: &Phase, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(name_of(*phase))
}

/// A number with four digits that count.
pub(super) fn length(x: f64) -> String {
    // What rounding leaves of zero.
    let x = if x.abs() < 1e-12 { 0.0 } else { x };
    let rounded: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    format!("{rounded}")
}

/// A place, m.
pub(crate) fn place(x: &[f64]) -> String {
    let all: Vec<String> = x.iter().map(|x| (*x as f32).to_string()).collect();
    format!("[{}]", all.join(", "))
}

/// Shapes whose size is another one than asked for.
pub(super) fn sizes(scene: &Scene, placed: &[Placed], all: &mut Vec<String>) {
    for (shape, of_scene) in placed.iter().zip(&scene.shapes) {
        let Some((axis, factor)) = shape.worst() else { continue };
        // Of what is no box along its lattice.
        let stiffer = shape.bending.filter(|_| shape.unit != "m" && !shape.bending_by_area);
        let stiffer = stiffer.map(|[asked, computed]| computed / asked);
        let bends_otherwise = stiffer.is_some_and(|factor| (factor - 1.0).abs() >= NOTABLY_STIFFER);
        if (factor - 1.0).abs() < NOTABLE && !bends_otherwise {
            continue;
        }
        let box_or_polygon = matches!(of_scene.geometry.unmoved(), Geometry::Box(_) | Geometry::Polygon(_));
        if shape.phase == Phase::Wall && box_or_polygon || nodal::lacks(scene, of_scene) {
            // A wall's thickness is nobody's question; what the nodal lattice lacks is another remark.
            continue;
        }
        let (asked, computed) = (length(shape.asked[axis]), length(shape.computed[axis]));
        let what = match of_scene.geometry.unmoved() {
            _ if shape.unit != "m" => "large",
            Geometry::Box(_) | Geometry::Tank { .. } => ["wide", "high", "deep"][axis],
            Geometry::Disc { .. } => "across",
            Geometry::Ring { .. } => "thick",
            _ => "large",
        };
        let thin = shape.bending.is_some() && shape.asked.iter().all(|extent| *extent >= shape.asked[axis]);
        let stiffness = match thin {
            true if shape.unit == "m" => format!(": {:.2} times the bending stiffness", factor.powi(3)),
            _ => stiffer.map_or(String::new(), |factor| format!(": {factor:.2} times the bending stiffness")),
        };
        let dx = scene.spacing(of_scene);
        let remedy = match shape.phase {
            Phase::Solid if of_scene.lattice_angle != 0.0 => {
                format!(" (its spacing is {}, and `lattice_angle` turns its rows)", length(dx))
            }
            Phase::Solid => format!(" (its spacing is {}; `across` at the shape makes it fit)", length(dx)),
            _ => format!(" (the resolution is {})", length(dx)),
        };
        all.push(format!(
            "`{}` is {asked} {unit} {what} in the scene and {computed} {unit} as computed{stiffness}{remedy}",
            shape.name,
            unit = shape.unit
        ));
    }
}

/// Plates whose part beyond the clamp is longer or shorter than asked for: they have whole rows.
pub(super) fn free_lengths(scene: &Scene, placed: &[Placed], all: &mut Vec<String>) {
    for (shape, of_scene) in placed.iter().zip(&scene.shapes) {
        let Some(bends) = shape.bends.as_ref().filter(|_| shape.unit == "m") else { continue };
        let long = |sizes: &[f64]| sizes.iter().copied().fold(0.0, f64::max);
        let dx = scene.spacing(of_scene);
        let asked = bends.way[1];
        let computed = asked + long(&shape.computed) - long(&shape.asked);
        let factor = computed / asked;
        if (factor - 1.0).abs() >= NOTABLE {
            all.push(format!(
                "`{}` is free over {} m in the scene and over {} m of whole rows as computed: a force bends its tip \
                 {:.2} times as far (its spacing is {})",
                shape.name,
                length(asked),
                length(computed),
                factor.powi(3),
                length(dx)
            ));
        }
    }
}

/// Poisson's ratio from which on few rows of the total-Lagrangian model lock, and rows that do not.
const LOCKS: (f64, f64) = (0.45, 7.5);

/// Plates of nearly incompressible solids that are too stiff because their volume cannot change.
pub(super) fn locking(scene: &Scene, placed: &[Placed], all: &mut Vec<String>) {
    for (shape, of_scene) in placed.iter().zip(&scene.shapes) {
        let Some(solid) = of_scene.solid.map(|k| &scene.solids[k]) else { continue };
        let (Some(rows), Some(_)) = (shape.rows, shape.bending) else { continue };
        // Where nothing holds the faces across the plane, thickness makes up for what bending squeezes.
        let locks = solid.model.name() == SolidModelName::TotalLagrangian
            && solid.plane() == Plane::Strain
            && solid.poissons_ratio >= LOCKS.0;
        if locks && rows < LOCKS.1 {
            all.push(format!(
                "`{}` is {rows:.0} particles across, and with poissons_ratio = {} the total-Lagrangian model locks: it \
                 bends too little (8 across, or model = \"finite-element\", bend as they should at 0.49)",
                shape.name, solid.poissons_ratio
            ));
        }
    }
}

/// The box around one of the copies of a shape.
pub(super) fn around_copy(scene: &Scene, shape: &Shape, moved: &Moved, copy: u32) -> Block {
    let translate = std::array::from_fn(|a| moved.translate[a] + f64::from(copy) * moved.step[a]);
    let one = Geometry::Moved(Moved { count: 1, translate, ..moved.clone() });
    geometry::bounding_box(&Shape { geometry: one, ..shape.clone() }, scene)
}
