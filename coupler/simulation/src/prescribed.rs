//! Rows of `explain` for what a scene prescribes: motion, waves, loads, cracks and arrangements. A scene without them
//! has no such row.

use crate::effects::{MOVING_WALLS, row};
use halfstep_output::run_json::EffectReport;
use halfstep_scene::geometry::{self, Counts, Layout};
use halfstep_scene::{Course, Decision, Motion, Phase, Scene, Shape, dispatch};

/// Bytes of a real number.
const REAL: usize = 8;

/// The rows of a scene.
pub(crate) fn rows(scene: &Scene, counts: &Counts) -> Vec<EffectReport> {
    let names = |take: &dyn Fn(&Shape) -> bool| {
        let names: Vec<String> =
            scene.shapes.iter().filter(|s| take(s)).map(|s| format!("`{}`", s.name)).collect();
        (!names.is_empty()).then(|| names.join(", "))
    };
    let mut list = Vec::new();
    let mut put = |name, bytes: Option<usize>, why: String| {
        let bytes_per_particle = bytes.map(|bytes| bytes as f64);
        list.push(EffectReport { bytes_per_particle, ..row(Decision { name, on: true, why }) });
    };
    let moves = |s: &Shape| s.phase == Phase::Wall && s.motion.is_some();
    if let Some(names) = names(&moves) {
        // Where each begins, its normal and its surface's velocity, and its shape.
        let bytes = (3 * scene.dimension + 1) * REAL;
        let of_all = match scene.fluid.is_some() {
            true => {
                format!("all {} wall particles are placed anew", counts.wall)
            }
            false => "they are where it says, within the share of `solid`".into(),
        };
        let bytes = scene.fluid.is_some().then_some(bytes);
        put(MOVING_WALLS, bytes, format!("`motion` of {names}: at each half-step {of_all}"));
    }
    for shape in &scene.shapes {
        let Some(motion) = &shape.motion else { continue };
        let Some(makes) = motion.makes() else { continue };
        let [waves, by] = match is_solitary(motion) {
            true => ["a solitary wave", "Goring's equation for the piston's place is solved"],
            false => ["waves", "sums of sines"],
        };
        put(
            "wave-maker",
            None,
            format!(
                "`motion` of `{}` makes {} of {} m in {} m of water with a stroke of {:.3} m: {} at each half-step, \
                 within the share of `moving-walls`",
                shape.name, waves, makes.height, makes.depth, makes.stroke, by
            ),
        );
    }
    let driven = |s: &Shape| {
        s.phase == Phase::Solid && (s.motion.is_some() || s.clamp_with.iter().any(Option::is_some))
    };
    if let Some(names) = names(&driven) {
        let why = format!("clamps or bodies of {names} move as prescribed, within the share of `solid`");
        put("prescribed-solids", None, why);
    }
    for (index, shape) in scene.shapes.iter().enumerate() {
        let Some(load) = &shape.load else { continue };
        let traction = load.traction[..scene.dimension].iter().map(f64::to_string).collect::<Vec<_>>();
        put(
            "load",
            None,
            format!(
                "`load` of `{}`: ({}) Pa on {} particles over {} s, {} bytes for each, within the share of `solid`",
                shape.name,
                traction.join(", "),
                dispatch!(scene.dimension, D => loaded::<D>(scene, index)).unwrap_or(0),
                load.ramp,
                (scene.dimension + 2) * REAL
            ),
        );
    }
    if let Some(names) = names(&|s: &Shape| s.crack.is_some()) {
        put(
            "crack",
            None,
            format!("`crack` of {names}: pairs are cut at the start, which costs nothing later"),
        );
    }
    for (index, solid) in scene.solids.iter().enumerate() {
        let Some(seed) = solid.irregular() else { continue };
        let off = dispatch!(scene.dimension, D => geometry::solids::<D>(scene).off_lattice(scene, index));
        put(
            "irregular-arrangement",
            None,
            format!(
                "`arrangement` of `{}`, seed {seed}: {} particles lie off the lattice, which costs nothing later",
                solid.name,
                off.unwrap_or(0)
            ),
        );
    }
    list
}

fn is_solitary(motion: &Motion) -> bool {
    let Motion::Composed(composed) = motion else { return false };
    composed.parts.iter().any(|part| matches!(part.course, Course::Solitary(_)))
}

/// Number of particles that the load of a shape of that index acts on.
fn loaded<const D: usize>(scene: &Scene, shape: usize) -> usize {
    let layout: Layout<D> = geometry::solids(scene);
    layout.solid.iter().filter(|p| p.body as usize == shape && !p.clamped && p.is_in_load(scene)).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn how_a_wave_maker_moves() {
        let row = |wave: &str| {
            let text = format!(
                "resolution = 0.02\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
                 phase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [1.0, 0.2] }}\n[[shape]]\nname = \"paddle\"\n\
                 phase = \"wall\"\nbox = {{ min = [-0.06, 0.0], max = [0.0, 0.4] }}\n\
                 motion = {{ wave = {wave}, depth = 0.2 }}\n"
            );
            let scene =
                halfstep_scene::parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
            let rows = rows(&scene, &Counts::default());
            rows.into_iter().find(|row| row.name == "wave-maker").expect("a row").why
        };
        let solitary = row("\"solitary\", height = 0.06");
        assert!(
            solitary.contains("makes a solitary wave of 0.06 m") && solitary.contains("Goring's equation"),
            "{solitary}"
        );
        let regular = row("\"regular\", height = 0.02, period = 0.9");
        assert!(regular.contains("makes waves of 0.02 m") && regular.contains("sums of sines"), "{regular}");
    }
}
