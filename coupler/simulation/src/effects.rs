//! The ledger of effects: which take part in a scene, why, and what they cost.

use halfstep_coupling::couple::CoupledOutcome;
use halfstep_coupling::solo::SoloOutcome;
use halfstep_output::RunReport;
use halfstep_output::run_json::EffectReport;
use halfstep_role::farewell;
use halfstep_role::role::Costs;
use halfstep_scene::geometry::Counts;
use halfstep_scene::{Decision, EffectName, Scene, Treatment};
use halfstep_wire::protocol::StateHeader;

/// What the fluid does in any case: pressure, continuity, neighbour lists, time step.
const FLUID: &str = "fluid";
/// What the solid does in any case.
const SOLID: &str = "solid";
/// Walls toward the fluid.
const WALLS: &str = "walls";
/// Sums across the interface.
const INTERFACE: &str = "interface";
/// The force f_i.
const CROSS_VISCOSITY: &str = "cross-viscosity";

/// The ledger of effects of a scene, without shares.
pub(crate) fn ledger(scene: &Scene, counts: &Counts) -> Vec<EffectReport> {
    let row = |name: &str, on: bool, why: String| EffectReport {
        name: name.into(),
        on,
        why,
        ..EffectReport::default()
    };
    let decided = |d: Decision| row(d.name, d.on, d.why);
    let (fluid, solid) = (scene.fluid.is_some(), scene.solid.is_some());
    let moving = scene.gravity.iter().any(|&g| g != 0.0);
    let mut list = vec![
        row("gravity", moving, if moving { "gravity is not zero" } else { "gravity is zero" }.into()),
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
        list.extend(halfstep_fluid::effects::decide::<2>(scene).into_iter().map(|(decision, bytes)| {
            let bytes_per_particle = (bytes > 0).then_some(bytes as f64);
            EffectReport { bytes_per_particle, ..decided(decision) }
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
        if solid { "[solid]: stress, neighbours, time step" } else { "no [solid]: no solid process" }.into(),
    ));
    if solid {
        list.extend(halfstep_solid::effects::decide(scene).into_iter().map(decided));
    }
    let coupled = fluid && solid;
    let treatment = match scene.interface.treatment {
        Treatment::MovingWall => "moving-wall",
        Treatment::PhaseBlind => "phase-blind",
    };
    let why = if coupled {
        format!("interface.treatment is \"{treatment}\"")
    } else {
        "one phase only: no coupler, nothing exchanged".into()
    };
    list.push(row(INTERFACE, coupled, why));
    let c = scene.interface.cross_viscosity;
    let why = if coupled { format!("interface.cross_viscosity is {c}") } else { "one phase only".into() };
    list.push(row(CROSS_VISCOSITY, coupled && c > 0.0, why));
    list
}

/// Shares of a coupled run: parts of the computing time of all three roles.
pub(crate) fn share_coupled(report: &mut RunReport, outcome: &CoupledOutcome) {
    let total = outcome.fluid.seconds[0] + outcome.solid.seconds[0] + outcome.seconds.compute;
    let both = [&outcome.fluid, &outcome.solid];
    let sum = |place: usize| both.iter().map(|h| told(h, place)).sum::<f64>();
    let mut costs = Costs { walls: sum(farewell::WALLS), ..Costs::default() };
    for (k, seconds) in costs.effects.iter_mut().enumerate() {
        *seconds = sum(farewell::EFFECTS + k);
    }
    share(report, &costs, total);
    let shown = |place: usize| {
        let effect = place.checked_sub(farewell::EFFECTS).map(|k| EffectName::ALL[k]);
        effect.is_none_or(|effect| is_on(report, effect))
    };
    let own = [&outcome.fluid, &outcome.solid].map(|header| {
        let places = (farewell::WALLS..farewell::COUNT).filter(|&place| shown(place));
        (header.seconds[0] - places.map(|place| told(header, place)).sum::<f64>()).max(0.0) / total
    });
    share_row(report, INTERFACE, sum(farewell::INTERFACE) / total);
    share_row(report, CROSS_VISCOSITY, outcome.seconds.compute / total);
    for (name, share) in [FLUID, SOLID].into_iter().zip(own) {
        share_row(report, name, share);
    }
}

/// Shares of a run of one phase.
pub(crate) fn share_solo(report: &mut RunReport, outcome: &SoloOutcome) {
    let total = outcome.seconds.compute;
    share(report, &outcome.costs, total);
    let shown =
        EffectName::ALL.iter().zip(outcome.costs.effects).filter(|(effect, _)| is_on(report, **effect));
    let effects = outcome.costs.walls + shown.map(|(_, seconds)| seconds).sum::<f64>();
    for name in [FLUID, SOLID] {
        share_row(report, name, (total - effects).max(0.0) / total);
    }
}

fn share(report: &mut RunReport, costs: &Costs, total: f64) {
    for (effect, seconds) in EffectName::ALL.iter().zip(costs.effects) {
        if seconds > 0.0 {
            share_row(report, effect.name(), seconds / total);
        }
    }
    if costs.walls > 0.0 {
        share_row(report, WALLS, costs.walls / total);
    }
}

/// The ledger has a row that can show what the effect costs. (A solid's artificial viscosity has none without a fluid's:
/// then it is part of the solid.)
fn is_on(report: &RunReport, effect: EffectName) -> bool {
    report.effects.iter().any(|row| row.on && row.name == effect.name())
}

fn share_row(report: &mut RunReport, name: &str, share: f64) {
    if !share.is_finite() {
        return;
    }
    for row in report.effects.iter_mut().filter(|row| row.on && row.name == name) {
        row.share = Some(share);
    }
}

/// What a last message says; a foreign phase may say nothing.
fn told(last: &StateHeader, place: usize) -> f64 {
    if (place as u64) < last.probe_count { last.probes[place] } else { 0.0 }
}
