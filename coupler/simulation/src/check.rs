//! What a scene asks for, before anything is run.

use crate::forecast::{self, Forecast, megabytes};
use crate::step_cost::step_cost;
use crate::{effects, remarks};
use halfstep_coupling::roles;
use halfstep_scene::geometry;
use halfstep_scene::{self as scene, Phase, Scene, TimeStep, dispatch};
use halfstep_solid::SubStepping;
use halfstep_sph::lane::Isa;
use std::fmt::Write;
use std::path::Path;

/// A text of counts, time steps, memory and an estimate of the run time.
///
/// The estimate times the sums of a few half-steps of each phase on one thread; a run whose particles spread out takes
/// longer.
pub fn describe(scene: &Scene, isa: Isa) -> String {
    let unknown = || "three dimensions are not available yet\n".to_owned();
    dispatch!(scene.dimension, D => describe_in::<D>(scene, isa)).unwrap_or_else(unknown)
}

fn describe_in<const D: usize>(scene: &Scene, isa: Isa) -> String {
    let layout = geometry::layout::<D>(scene);
    let counts = layout.counts();
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<15} {value}");
    };
    line("scene", format!("{} ({})", scene.name, scene.path.display()));
    line("particles", format!("{} fluid, {} solid, {} wall", counts.fluid, counts.solid, counts.wall));
    let placed = remarks::placed(scene, &layout);
    for shape in &placed {
        line(&format!("  {}", shape.name), shape.to_string());
    }
    if counts.solid > 0 {
        line("bodies", remarks::bodies_listed(scene, &scene.bodies_of(&layout)));
    }
    for (k, solid) in scene.solids.iter().enumerate() {
        let spacing = scene.solid_spacing(k);
        if spacing != scene.resolution {
            let text = format!("{:.4e} m, of the fluid and walls {:.4e} m", spacing, scene.resolution);
            line(&format!("{} spacing", solid.name), text);
        }
    }
    let mut limit = f64::INFINITY;
    let mut solid_limits = Vec::new();
    let mut built = Vec::new();
    for place in 0..scene.participants().len() {
        let Some(role) = roles::build(place, scene, isa) else { continue };
        let own = role.dt_limit();
        line(&format!("{} dt limit", role.name()), format!("{own:.3e} s"));
        limit = limit.min(own);
        if role.phase() == Phase::Solid {
            solid_limits.push((role.name(), own));
        }
        built.push(role);
    }
    let dt = match scene.time_step {
        TimeStep::Auto => limit,
        TimeStep::Fixed(dt) => dt,
    };
    line(
        "time step",
        format!("{dt:.3e} s: {:.0} steps to t = {} s", (scene.end_time / dt).ceil(), scene.end_time),
    );
    for (solid, (name, limit)) in solid_limits.iter().enumerate().filter(|_| scene.fluid.is_some()) {
        let stepping = SubStepping::of(scene, solid);
        let own = limit / f64::from(stepping.most());
        line(
            &format!("{name} sub-steps"),
            format!("{} (one is stable to {own:.3e} s)", stepping.choose(dt, own)),
        );
    }
    if scene.solids.len() > 1 {
        line(
            "between solids",
            "nothing acts but the water: where they meet they pass through each other".into(),
        );
        for (solid, count) in scene.solids.iter().zip(layout.solid_counts(scene)) {
            line(&solid.name, format!("{count} particles"));
        }
    }
    line("memory", format!("about {:.1} MB", scene::memory_needed(&counts) as f64 / 1e6));
    let Forecast { shared, disk, frames } = Forecast::of(scene, &layout, &[]);
    if shared > 0 {
        line("shared memory", megabytes(shared));
    }
    let free = forecast::free_disk(Path::new(".")).map(|free| format!(", {} are free here", megabytes(free)));
    line("disk", format!("about {}, {frames} frames{}", megabytes(disk), free.unwrap_or_default()));
    let costs: Option<Vec<f64>> = built.into_iter().map(|role| step_cost(role, dt)).collect();
    let seconds = costs.map(|costs| costs.into_iter().fold(0.0, f64::max) * scene.end_time / dt);
    line(
        "expected time",
        match seconds {
            Some(seconds) => {
                format!("about {seconds:.0} s, one thread a role ({})", isa.bits_name())
            }
            None => "unknown: the first steps leave their bounds".into(),
        },
    );
    text.push('\n');
    for effect in effects::reports(scene, &counts) {
        let _ =
            writeln!(text, "{:<28}{:<5}{}", effect.name, if effect.on { "on" } else { "off" }, effect.why);
    }
    for (k, warning) in remarks::on(scene, &layout, &placed).into_iter().enumerate() {
        let _ = writeln!(text, "{}warning: {warning}", if k == 0 { "\n" } else { "" });
    }
    text
}
