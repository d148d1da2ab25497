//! The effects of a scene: which take part in a scene, why, and what they cost.

use crate::remarks::bodies_of;
use halfstep_output::RunReport;
use halfstep_output::run_json::EffectReport;
use halfstep_role::report::Report;
use halfstep_scene::geometry::Counts;
use halfstep_scene::{Decision, EffectName, PairContact, Phase, Scene, Treatment, dispatch};
use std::cell::OnceCell;

/// What the fluid does in any case: pressure, continuity, neighbour lists, time step.
const FLUID: &str = "fluid";
/// What the solid does in any case.
const SOLID: &str = "solid";
/// Walls toward the fluid.
const WALLS: &str = "walls";
/// Walls that move as prescribed, toward the fluid.
pub(crate) const MOVING_WALLS: &str = "moving-walls";
/// Sums across the interface.
const INTERFACE: &str = "interface";
/// Contact between two solids.
const SOLID_CONTACT: &str = "solid-contact";
/// The force f_i.
const CROSS_VISCOSITY: &str = "cross-viscosity";

/// The row of an effect.
pub(crate) fn row(decision: Decision) -> EffectReport {
    let Decision { name, on, why } = decision;
    EffectReport { name: name.into(), on, why, ..EffectReport::default() }
}

/// The effects of a scene, without shares.
pub(crate) fn reports(scene: &Scene, counts: &Counts) -> Vec<EffectReport> {
    let row = |name, on, why| row(Decision { name, on, why });
    let (fluid, solid) = (scene.fluid.is_some(), !scene.solids.is_empty());
    let (moving, frame) = (scene.gravity.iter().any(|&g| g != 0.0), scene.frame.is_some());
    let why = match (moving, frame) {
        (_, true) => "`frame` moves: gravity is less its acceleration, and turned back by its angle",
        (true, false) => "gravity is not zero",
        (false, false) => "gravity is zero",
    };
    let mut list = vec![
        row("gravity", moving || frame, why.into()),
        row(
            FLUID,
            fluid,
            if fluid {
                "[fluid]: pressure, continuity, neighbour lists, time step"
            } else {
                "no [fluid]: no fluid process"
            }
            .into(),
        ),
    ];
    if fluid {
        let decided_on = dispatch!(scene.dimension, D => halfstep_fluid::effects::decide::<D>(scene));
        list.extend(decided_on.unwrap_or_default().into_iter().map(|(decision, bytes)| {
            let bytes_per_particle = (bytes > 0).then_some(bytes as f64);
            EffectReport { bytes_per_particle, ..self::row(decision) }
        }));
    }
    list.push(row(
        WALLS,
        fluid && counts.wall > 0,
        format!("{} wall particles toward the fluid", counts.wall),
    ));
    list.push(row(
        SOLID,
        solid,
        match solid {
            false => "no [solid]: no solid process",
            true if scene.solids.iter().all(|solid| solid.rigid().is_some()) => {
                "[solid]: rigid bodies, joints, contact, time step"
            }
            true => "[solid]: stress, neighbours, time step",
        }
        .into(),
    ));
    if solid {
        list.extend(halfstep_solid::effects::decide(scene).into_iter().map(self::row));
    }
    list.extend(crate::prescribed::rows(scene, counts));
    let coupled = fluid && solid;
    let treatment = match scene.interface.treatment {
        Treatment::MovingWall => "moving-wall",
        Treatment::PhaseBlind => "phase-blind",
    };
    let why = if coupled {
        format!("interface.treatment is \"{treatment}\"")
    } else {
        "one phase only: nothing to exchange between fluid and solid".into()
    };
    list.push(row(INTERFACE, coupled, why));
    let (c, far) = (scene.interface.cross_viscosity, scene.interface.cross_viscosity_far);
    let why = match (coupled, c == far) {
        (false, _) => "one phase only".into(),
        (true, true) => format!("interface.cross_viscosity is {c}"),
        (true, false) => {
            let reach = scene.interface.cross_viscosity_reach;
            format!("interface.cross_viscosity is {c}, and {far} from {reach} dx on")
        }
    };
    list.push(row(CROSS_VISCOSITY, coupled && c > 0.0, why));
    // Placed once, where a scene asks for it.
    let bodies = OnceCell::new();
    let several = |contact: &PairContact| {
        bodies_of(scene, bodies.get_or_init(|| scene.bodies()), contact.solids[0]) > 1
    };
    let pairs: Vec<String> = scene
        .contacts()
        .into_iter()
        .chain(scene.contacts_of_bodies().filter(several))
        .map(|contact| {
            let [a, b] = contact.solids.map(|solid| &scene.solids[solid].name);
            let who = if a == b { format!("bodies of `{a}`") } else { format!("`{a}` and `{b}`") };
            format!("{who} (friction {}, restitution {})", contact.friction, contact.restitution)
        })
        .collect();
    if !pairs.is_empty() {
        list.push(row(SOLID_CONTACT, true, format!("touch in the coupler: {}", pairs.join(", "))));
    }
    list
}

/// Puts the shares of the computing time of all roles into the rows, as the participants reported them. `coupler`:
/// the coupler's own computing time, s.
pub(crate) fn share(report: &mut RunReport, reports: &[(Phase, Report)], coupler: f64) {
    let total = coupler + reports.iter().map(|(_, own)| own.compute).sum::<f64>();
    let sum = |part: &dyn Fn(&Report) -> f64| reports.iter().map(|(_, own)| part(own)).sum::<f64>() / total;
    for effect in EffectName::ALL {
        let seconds = |own: &Report| own.effects.iter().find(|(e, _)| e == effect).map_or(0.0, |(_, s)| *s);
        let share = sum(&seconds);
        if share > 0.0 {
            share_row(report, effect.name(), share);
        }
    }
    let walls = sum(&|own| own.walls);
    if walls > 0.0 {
        share_row(report, WALLS, walls);
    }
    share_row(report, MOVING_WALLS, sum(&|own| own.moving_walls));
    // What the coupler computes is told by the first of these that takes part.
    let computed = [CROSS_VISCOSITY, SOLID_CONTACT, INTERFACE].into_iter().find(|name| is_on(report, name));
    let interface = sum(&|own| own.interface);
    share_row(report, INTERFACE, interface);
    match computed {
        Some(INTERFACE) => share_row(report, INTERFACE, interface + coupler / total),
        Some(name) => share_row(report, name, coupler / total),
        None => {}
    }
    for (name, phase) in [(FLUID, Phase::Fluid), (SOLID, Phase::Solid)] {
        let rest = |own: &Report| {
            let shown = own.effects.iter().filter(|(effect, _)| is_on(report, effect.name()));
            let effects: f64 = shown.map(|(_, seconds)| seconds).sum();
            (own.compute - own.walls - own.moving_walls - own.interface - effects).max(0.0)
        };
        let share: f64 = reports.iter().filter(|(p, _)| *p == phase).map(|(_, own)| rest(own)).sum();
        share_row(report, name, share / total);
    }
}

/// There is a row that can show what the effect costs. (A solid's artificial viscosity has none without a
/// fluid's: then it is part of the solid.)
fn is_on(report: &RunReport, name: &str) -> bool {
    report.effects.iter().any(|row| row.on && row.name == name)
}

fn share_row(report: &mut RunReport, name: &str, share: f64) {
    if !share.is_finite() {
        return;
    }
    for row in report.effects.iter_mut().filter(|row| row.on && row.name == name) {
        row.share = Some(share);
    }
}
