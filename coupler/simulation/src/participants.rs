//! The participants of a run: their messages' sizes before it, what they said at their ends after it.

use crate::effects;
use crate::options::{SolidSource, source};
use halfstep_coupling::couple::{ContactSummary, Done, Outcome, combined_hash};
use halfstep_coupling::error::RunError;
use halfstep_coupling::roles;
use halfstep_link::{FLUID, LinkConfig, Participant};
use halfstep_output::RunReport;
use halfstep_output::run_json::{
    ContactReport, EnergyReport, ForceKind, ForceReport, ParticipantEnergy, ParticipantReport, RoleSeconds,
    WALLS,
};
use halfstep_role::report::Report;
use halfstep_scene::geometry::Layout;
use halfstep_scene::{Phase, ProbeKind, Scene};
use halfstep_wire::Name;

/// The participants of a coupled scene with the sizes of their messages: each in the process that the scene names,
/// those in `external` in one of their own.
///
/// # Errors
/// A name of the scene is none.
pub(crate) fn participants<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    external: &[Name],
) -> Result<Vec<Participant>, RunError> {
    let solids = layout.solid_counts(scene);
    let name = |text: &str| text.parse::<Name>().map_err(|e| RunError::System(e.to_string()));
    let mut participants = Vec::new();
    // Particles of all solids, counted in cells of the fluid's.
    let mut all_solids = 0.0;
    for (place, participant) in scene.participants().into_iter().enumerate() {
        let own = name(&participant.name)?;
        let is_external = external.contains(&own);
        let capacity = match place {
            FLUID => 0,
            _ if is_external => solids[place - 1].max(4096),
            _ => solids[place - 1],
        };
        if place != FLUID {
            let cells = (scene.solid_spacing(place - 1) / scene.resolution).powi(D as i32);
            all_solids += capacity as f64 * if is_external { 1.0 } else { cells };
        }
        participants.push(Participant {
            name: own,
            process: if is_external { own } else { name(&participant.process)? },
            capacity: capacity.max(1) as u32,
            probes: values(scene, place) as u32,
        });
    }
    let shared = |k: &usize| {
        let own = &participants[*k];
        external.contains(&own.name)
            && participants.iter().any(|other| other.name != own.name && other.process == own.process)
    };
    if let Some(k) = (0..participants.len()).find(shared) {
        let name = participants[k].name;
        return Err(RunError::System(format!(
            "the solid `{name}` of another program needs the process `{name}` for itself, but other solids run in it: \
             give them another `process`"
        )));
    }
    // A ribbon of about four layers on each side of the solids' surfaces, and room for compression.
    let ribbon = ((24.0 * all_solids) as u64).max(4096).min(layout.counts().fluid);
    let capacity = scene.numerics.interface_capacity.map_or(ribbon, u64::from);
    participants[FLUID].capacity = capacity.max(1) as u32;
    Ok(participants)
}

/// Number of probe values of the participant at this place.
fn values(scene: &Scene, place: usize) -> usize {
    let of = |kind: &ProbeKind| kind.count(scene.dimension) + kind.companions(scene.dimension);
    roles::probes_of(scene, place).map(|probe| of(&probe.kind)).sum()
}

/// Puts what the coupler found into the report of a run.
pub(crate) fn report_outcome(scene: &Scene, outcome: &Outcome, report: &mut RunReport) {
    report.audit.state_hash = Some(format!("{:016x}", combined_hash(&outcome.last)));
    let contact = |ContactSummary { solids, stiffness, booked }: &ContactSummary| ContactReport {
        solids: solids
            .iter()
            .map(|solid| solid.map_or(WALLS, |k| &scene.solids[k].name).to_owned())
            .collect(),
        stiffness: *stiffness,
        normal: booked.normal,
        friction: booked.friction,
        largest_force: booked.largest_force,
        largest_penetration: booked.largest_penetration,
    };
    report.contacts = outcome.contacts.iter().map(contact).collect();
    let acted = outcome.forces.iter().filter(|(_, _, done)| done.largest > 0.0);
    let force = |(solid, kind, done): &(usize, ForceKind, Done)| ForceReport {
        solid: scene.solids[*solid].name.clone(),
        kind: *kind,
        impulse: done.impulse,
        work: done.work,
        largest: done.largest,
    };
    report.forces = acted.map(force).collect();
    if scene.fluid.is_some() && !scene.solids.is_empty() {
        report.audit.action_reaction = Some(outcome.action_reaction);
        report.audit.checks = outcome.checks;
        report.roles.coupler = Some(outcome.seconds);
        report.work.pair_evaluations.coupler = Some(outcome.pair_evaluations);
    }
}

/// Puts what the participants said at their ends into the report: sums by phase, and a row for each of them.
pub(crate) fn report_participants(
    scene: &Scene,
    external: &[(Name, SolidSource)],
    outcome: &Outcome,
    reports: &[Option<Report>],
    config: Option<&LinkConfig>,
    report: &mut RunReport,
) {
    for (place, participant) in scene.participants().into_iter().enumerate() {
        let process = config.map_or(participant.process, |c| c.participants[place].process.to_string());
        let times = reports[place].as_ref().map(|own| RoleSeconds {
            compute: own.compute,
            wait: own.wait,
            exchange: own.exchange,
            output: own.output,
        });
        let pairs = reports[place].as_ref().map(|own| own.pair_evaluations);
        let (seconds, evaluations, phase) = match participant.phase {
            Phase::Fluid => (&mut report.roles.fluid, &mut report.work.pair_evaluations.fluid, "fluid"),
            _ => (&mut report.roles.solid, &mut report.work.pair_evaluations.solid, "solid"),
        };
        if let Some(own) = times {
            let sum = seconds.get_or_insert_default();
            sum.compute += own.compute;
            // Members of one process wait and exchange together.
            if !report.participants.iter().any(|other| other.process == process && other.times.is_some()) {
                sum.wait += own.wait;
                sum.exchange += own.exchange;
            }
            sum.output += own.output;
        }
        if let Some(own) = pairs {
            *evaluations.get_or_insert(0) += own;
        }
        let source = participant.name.parse().ok().and_then(|name| source(external, name));
        let model = match participant.phase {
            Phase::Fluid => Some("weakly-compressible".to_owned()),
            _ => scene
                .solids
                .iter()
                .find(|s| s.name == participant.name)
                .map(|s| s.model.name().name().to_owned()),
        };
        report.participants.push(ParticipantReport {
            phase: phase.into(),
            model: model.filter(|_| source.is_none()),
            command: source.map(|source| match source {
                SolidSource::Command(line) => line.clone(),
                SolidSource::ByHand => String::new(),
            }),
            process,
            name: participant.name,
            particles: outcome.last[place].particles,
            mass: outcome.last[place].audit.mass,
            outside: 0,
            capacity: config.map(|c| c.participants[place].capacity),
            // The recorder has counted and judged.
            sub_steps: None,
            energy_growth: None,
            open_joints: reports[place].as_ref().map_or_else(Vec::new, |own| own.open_joints.clone()),
            jerked_joints: reports[place].as_ref().map_or_else(Vec::new, |own| own.jerked_joints.clone()),
            times,
        });
    }
    report.audit.impulse = reports.iter().flatten().find_map(|own| own.impulse).and_then(|mut both| {
        both.add_all(&outcome.impulse, 1.0);
        both.mismatch()
    });
    report.energy = energy(reports, &report.contacts);
    let phases = scene.participants().into_iter().map(|participant| participant.phase);
    let known: Vec<(Phase, Report)> =
        phases.zip(reports).filter_map(|(phase, own)| Some((phase, own.clone()?))).collect();
    effects::share(report, &known, report.roles.coupler.map_or(0.0, |coupler| coupler.compute));
}

/// The energy ledgers that participants kept.
fn energy(reports: &[Option<Report>], contacts: &[ContactReport]) -> Option<EnergyReport> {
    let kept = reports.iter().flatten().filter(|own| !own.energy.is_empty());
    let ledger = |own: &Report| ParticipantEnergy { name: own.name.clone(), parts: own.energy.clone() };
    let ledgers: Vec<ParticipantEnergy> = kept.map(ledger).collect();
    let complete = ledgers.len() == reports.len();
    EnergyReport::of(ledgers, complete, contacts)
}
