//! What a scene asks of the machine, and what follows from its shapes: checked when everything else is right.

use super::check_solid::solid_key;
use super::document::Node;
use super::error::Report;
use super::support::free_shapes;
use super::*;
use crate::dispatch;
use crate::geometry::{self, Counts};

/// Memory of a process without particles, bytes. These figures and the next ones are the largest resident sizes of runs
/// with 0.1 to 5 million particles, pictures included, rounded up.
const BYTES_PER_PROCESS: u64 = 30 << 20;
/// Memory for a particle where there is a fluid alone, bytes.
const BYTES_PER_FLUID: u64 = 850;
/// Memory for a solid particle, bytes.
const BYTES_PER_SOLID: u64 = 1300;
/// Memory of all processes of a coupled run for any particle, bytes.
const BYTES_COUPLED: u64 = 1000;

/// Spacings from the origin within which places are told apart to 1e-6 dx.
const MAX_SPACINGS: f64 = 1e9;

/// Memory that a run with that many particles needs, bytes: of all its processes, without what they share.
pub fn memory_needed(counts: &Counts) -> u64 {
    let is_coupled = counts.fluid > 0 && counts.solid > 0;
    let (processes, other, all) = if is_coupled { (3, 0, BYTES_COUPLED) } else { (1, BYTES_PER_FLUID, 0) };
    let of_solids = counts.solid.saturating_mul(BYTES_PER_SOLID);
    let of_others = counts.fluid.saturating_add(counts.wall).saturating_mul(other);
    let of_all = counts.total().saturating_mul(all);
    (processes * BYTES_PER_PROCESS).saturating_add(of_solids).saturating_add(of_others).saturating_add(of_all)
}

/// Memory that the machine has free for new programs, bytes; `None` where it does not say.
pub fn memory_available() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// Refuses more particles than memory or their numbers hold.
pub(super) fn check_memory(scene: &Scene, root: &Node, report: &Report, available: Option<u64>) {
    let counts = geometry::estimate(scene);
    let needed = memory_needed(&counts);
    let limit = match available {
        Some(available) if needed > available => format!("{} of memory are available", bytes(available)),
        _ if counts.total() > u64::from(u32::MAX) => "particle numbers have 32 bits".to_owned(),
        _ => return,
    };
    let Counts { fluid, solid, wall } = counts;
    let [fluid, solid, wall] = [fluid, solid, wall].map(rounded);
    let particles = format!("{fluid} fluid, {solid} solid and {wall} wall particles");
    let reason = format!("makes {particles}, which need about {}; {limit}", bytes(needed));
    report.value("resolution", root.origin_of("resolution"), reason);
}

fn rounded(n: u64) -> String {
    if n < 10_000_000 { n.to_string() } else { format!("{:.1e}", n as f64) }
}

/// Refuses shapes so far away that floats no longer tell particles apart.
pub(super) fn check_reach(scene: &Scene, root: &Node, report: &Report) {
    for shape in &scene.shapes {
        let bounds = geometry::bounding_box(shape, scene);
        let far = bounds.min.iter().chain(&bounds.max).fold(0.0_f64, |far, x| far.max(x.abs()));
        let limit = MAX_SPACINGS * scene.spacing(shape);
        if far > limit {
            let key = format!("shape.{}", shape.name);
            let reason = format!("reaches {far:e} m from the origin; at this resolution at most {limit:e} m");
            report.place(&key, root.origin_of(&key), reason);
        }
    }
}

fn bytes(n: u64) -> String {
    const UNITS: [&str; 7] = ["B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
    let (mut size, mut unit) = (n as f64, 0);
    while size >= 1024.0 && unit + 1 < UNITS.len() {
        size /= 1024.0;
        unit += 1;
    }
    format!("{size:.1} {}", UNITS[unit])
}

/// Refuses a clamp that holds no particle: it places the solid's particles, so memory is checked first.
pub(super) fn check_clamps(scene: &Scene, root: &Node, report: &Report) {
    for shape in scene.shapes.iter().filter(|s| !s.clamp.is_empty()) {
        for (index, caught) in geometry::clamp_catches(scene, shape).into_iter().enumerate() {
            let key = format!("shape.{}.clamp", shape.name);
            let item = format!("{key}.{index}");
            // A single table has no index.
            let key = if root.child_at(&item).is_some() { item } else { key };
            if !caught {
                let reason = format!("holds no particle of `{}`", shape.name);
                let corners = [format!("{key}.min"), format!("{key}.max")];
                let shape = ["box", "box.min", "box.max"].map(|part| format!("shape.{}.{part}", shape.name));
                let others: Vec<&str> = corners.iter().chain(&shape).map(String::as_str).collect();
                report.among(root, &key, &others, reason);
            }
        }
    }
}

/// Refuses a traction on particles that a clamp holds, all of them, and one on none.
pub(super) fn check_loads(scene: &Scene, root: &Node, report: &Report) {
    if scene.shapes.iter().all(|shape| shape.load.is_none()) {
        return;
    }
    let found = dispatch!(scene.dimension, D => {
        let points = geometry::solids::<D>(scene).solid;
        let of = |(index, shape): (usize, &Shape)| {
            shape.load.as_ref()?;
            let own = points.iter().filter(|p| p.body as usize == index);
            let held = own.filter(|p| p.is_in_load(scene)).map(|p| p.clamped);
            Some((index, held.fold([0, 0], |[free, clamped], is| [free + u32::from(!is), clamped + u32::from(is)])))
        };
        scene.shapes.iter().enumerate().filter_map(of).collect::<Vec<_>>()
    });
    for (index, [free, clamped]) in found.unwrap_or_default() {
        if free > 0 {
            continue;
        }
        let shape = &scene.shapes[index];
        let reason = match clamped {
            0 => format!("holds no particle of `{}`, and would load nothing", shape.name),
            n => format!(
                "holds {n} particles of `{}`, all of them clamped: a load would move nothing",
                shape.name
            ),
        };
        report.among(root, &format!("shape.{}.load.within", shape.name), &[], reason);
    }
}

/// Refuses what has no particle since earlier shapes, or voids, lie over all of it: a solid, where there are several,
/// and a body that a joint or a probe is about.
pub(super) fn check_particles(scene: &Scene, root: &Node, report: &Report) {
    let asked = bodies_asked_for(scene, root);
    if scene.solids.len() < 2 && asked.is_empty() {
        return;
    }
    let counts = dispatch!(scene.dimension, D => geometry::solids::<D>(scene).shape_counts(scene));
    let Some(counts) = counts else { return };
    // None where there is no such shape.
    let particles = |is_own: &dyn Fn(&Shape) -> bool| {
        let own = scene.shapes.iter().zip(&counts).filter(|(shape, _)| is_own(shape));
        own.map(|(_, count)| *count).reduce(|sum, count| sum + count)
    };
    for (k, solid) in scene.solids.iter().enumerate().filter(|_| scene.solids.len() > 1) {
        let first = scene.shapes.iter().find(|shape| shape.solid == Some(k));
        if let (Some(0), Some(shape)) = (particles(&|shape| shape.solid == Some(k)), first) {
            let key = format!("shape.{}", shape.name);
            let why = "shapes that come before it in the file lie there, and the first one keeps the place";
            let reason = format!("leaves the solid `{}` without a particle: {why}", solid.name);
            report.place(&key, root.origin_of(&key), reason);
        }
    }
    for (solid, body, key) in asked {
        if particles(&|shape| shape.solid == Some(solid) && shape.body() == body) == Some(0) {
            let why = "shapes that come before it in the file, or voids, lie there";
            let reason = format!("is of `{body}`, which has no particle: {why}");
            report.place(&key, root.origin_of(&key), reason);
        }
    }
}

/// Bodies that joints and probes are about: index of the solid, name, and key of the joint or probe.
fn bodies_asked_for<'s>(scene: &'s Scene, root: &Node) -> Vec<(usize, &'s str, String)> {
    let probes = scene.probes.iter().filter_map(|probe| match &probe.kind {
        ProbeKind::Body { body, .. } => Some((probe.solid?, body.as_str(), format!("probe.{}", probe.name))),
        _ => None,
    });
    let rigid = scene.solids.iter().enumerate().filter_map(|(k, solid)| Some((k, solid.rigid()?)));
    let joints = rigid.flat_map(|(k, keys)| {
        let section = solid_key(scene, root, k);
        keys.joints.iter().flat_map(move |joint| {
            let key = format!("{section}.joints.{}", joint.name);
            [&joint.body, &joint.with].map(|body| (k, body.as_str(), key.clone()))
        })
    });
    probes.chain(joints).collect()
}

/// The speed that a scene's fluid may reach, m/s: the largest of that of a fall from its highest point to the lowest
/// floor or solid, sqrt(2 g H), of a free body's fall to the fluid, and of the fastest shape's initial speed, or
/// field's, with that of the corner of a rigid body that turns.
pub fn expected_speed(scene: &Scene) -> f64 {
    speed_with(scene, |_| true)
}

/// The same without walls that sweep no place where fluid is at the start: they slide along it or leave it.
pub fn expected_speed_of_fluid(scene: &Scene) -> f64 {
    let fluid = geometry::fluid_boxes(scene);
    let slack = 1e-6 * scene.resolution;
    speed_with(scene, |shape| {
        let Some(motion) = &shape.motion else { return true };
        let swept = motion.swept(&geometry::bounding_box(shape, scene), scene.end_time);
        let meets = |b: &Block, a: usize| swept.min[a] + slack < b.max[a] && b.min[a] + slack < swept.max[a];
        fluid.iter().any(|block| (0..scene.dimension).all(|a| meets(block, a)))
    })
}

fn speed_with(scene: &Scene, pushes: impl Fn(&Shape) -> bool) -> f64 {
    let g = length(&scene.gravity);
    let falls = if g > 0.0 { falls(scene, scene.gravity.map(|c| c / g)) } else { [0.0; 2] };
    falls.into_iter().map(|height| (2.0 * g * height).sqrt()).fold(given_speed(scene, pushes), f64::max)
}

/// The length of a vector.
fn length(v: &[f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// The fastest that the scene itself gives anything, m/s.
fn given_speed(scene: &Scene, pushes: impl Fn(&Shape) -> bool) -> f64 {
    let g = length(&scene.gravity);
    let field = |s: &Shape| s.velocity_field.map_or(0.0, |field| field.fastest(g));
    let moving = |s: &Shape| match s.motion.as_ref().filter(|_| pushes(s)) {
        Some(motion) => motion.fastest(&geometry::bounding_box(s, scene)),
        None => 0.0,
    };
    let fastest = scene.shapes.iter().map(|s| length(&s.velocity) + field(s) + moving(s)).fold(0.0, f64::max);
    let fastest = fastest.max(spins(scene));
    let frame = scene.frame.as_ref().zip(geometry::around(geometry::fluid_boxes(scene)));
    fastest + frame.map_or(0.0, |(frame, water)| frame.motion.fastest(&water))
}

/// How fast the fastest corner of a rigid body that turns at the start goes, m/s: about a hinge, else about its middle.
fn spins(scene: &Scene) -> f64 {
    let fastest = bounds::turning(scene).map(|(solid, body, Block { min, max }, hinges)| {
        let middle = || std::array::from_fn(|d| 0.5 * (min[d] + max[d]));
        let pivot = hinges.first().copied().unwrap_or_else(middle);
        let way = (0..scene.dimension).map(|d| (max[d] - pivot[d]).max(pivot[d] - min[d]).powi(2));
        let own = scene.shapes.iter().filter(|s| s.solid == Some(solid) && s.body() == body.name);
        let goes = own.map(|shape| length(&shape.velocity)).fold(0.0, f64::max);
        goes + length(&body.angular_velocity) * way.sum::<f64>().sqrt()
    });
    fastest.fold(0.0, f64::max)
}

/// Largest part of rho c0² that viscous stress between neighbouring rows may be. Below 0.003 cavities and slots keep
/// their fluid, at 0.02 it is pressed out of the corners of their lids.
const VISCOUS_STRESS: f64 = 0.003;

/// The sound speed that keeps a fluid weakly compressible, m/s: ten times the expected speed, and no less than what
/// makes the viscous stress mu U / dx of the speed U that the scene gives a small part of rho c0² (after Morris, Fox
/// and Zhu 1997, eq. 11). A flow that gravity drives has no more stress than the depth's, for which the fall is enough.
pub fn auto_sound_speed(scene: &Scene) -> f64 {
    let stress = scene.fluid.as_ref().map_or(0.0, |fluid| fluid.viscosity / fluid.density)
        * given_speed(scene, |_| true)
        / scene.resolution;
    (10.0 * expected_speed(scene)).max((stress / VISCOUS_STRESS).sqrt())
}

pub(super) fn sound_speed(scene: &Scene, root: &Node, report: &Report) -> Option<f64> {
    let auto = auto_sound_speed(scene);
    if auto > 0.0 && auto.is_finite() {
        return Some(auto);
    }
    let why = "without gravity and initial velocity the expected speed is unknown";
    let key = "fluid.sound_speed";
    report.place(key, root.origin_of(key), format!("must be given: {why}"));
    None
}

/// How far the fluid may fall along a unit vector, m: from where it is highest to where it is lowest, or to the lowest
/// wall's or solid's upper side. And how far a free body falls until it meets the fluid.
fn falls(scene: &Scene, down: [f64; 3]) -> [f64; 2] {
    let project = |v: &[f64; 3]| (0..3).map(|a| v[a] * down[a]).sum::<f64>();
    let ends = |shape: &Shape| match &shape.geometry {
        Geometry::Disc { center, radius: r } | Geometry::Ring { center, outer: r, .. } => {
            [project(center) - r, project(center) + r]
        }
        Geometry::Box(b) | Geometry::Tank { cavity: b, .. } => {
            let ends = (0..3).map(|a| [b.min[a] * down[a], b.max[a] * down[a]]);
            ends.fold([0.0, 0.0], |[l, h], [p, q]| [l + p.min(q), h + p.max(q)])
        }
        Geometry::Polygon(_) | Geometry::Moved(_) => {
            geometry::extent(&shape.geometry, scene.dimension, 0.0, down)
        }
    };
    let (mut highest, mut lowest) = (f64::INFINITY, f64::NEG_INFINITY);
    for shape in &scene.shapes {
        let [upper, lower] = ends(shape);
        match (shape.phase, shape.geometry.unmoved()) {
            (Phase::Fluid, _) => (highest, lowest) = (highest.min(upper), lowest.max(lower)),
            // What lies in a tank may reach its floor.
            (Phase::Wall, Geometry::Tank { .. }) => lowest = lowest.max(lower),
            (Phase::Wall | Phase::Solid, _) => lowest = lowest.max(upper),
        }
    }
    if highest.is_infinite() {
        return [0.0; 2];
    }
    let free = free_shapes(&scene.shapes, &scene.solids).map(|shape| highest - ends(shape)[1]);
    [(lowest - highest).max(0.0), free.fold(0.0, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meminfo_is_read() {
        let available = memory_available().unwrap();
        assert!((1 << 20..1 << 50).contains(&available), "{available}");
    }

    #[test]
    fn bytes_are_shown_in_their_unit() {
        assert_eq!(bytes(512), "512.0 B");
        assert_eq!(bytes(3 << 29), "1.5 GiB");
        assert_eq!(bytes(u64::MAX), "16.0 EiB");
    }
}
