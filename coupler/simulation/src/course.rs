//! What every run has, in whatever processes its participants are: its course from the start or from a checkpoint, and
//! its report at the end.

use crate::advice::advice;
use crate::checkpoint::Checkpoint;
use crate::options::SolidSource;
use crate::participants::{report_outcome, report_participants};
use crate::through_walls::through_walls;
use crate::{last_frame, remarks, run};
use halfstep_coupling::checkpoints::Checkpoints;
use halfstep_coupling::clock::Clock;
use halfstep_coupling::couple::Outcome;
use halfstep_coupling::course::Course;
use halfstep_coupling::error::RunError;
use halfstep_coupling::recorder::Recorder;
use halfstep_output::run_json::RunStatus;
use halfstep_output::{self as output, ProbeLog, RunDirectory, RunReport};
use halfstep_role::report::Report;
use halfstep_scene::Scene;
use halfstep_sph::lane::Isa;
use halfstep_wire::Name;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The course of a run, which writes to a folder if there is one; `quiet` hides its progress. What may be refused comes
/// first: a run that cannot go on stays as it was.
pub(crate) fn begin(
    scene: &Scene,
    folder: Option<&RunDirectory>,
    from: Option<&Checkpoint>,
    stop: Arc<AtomicBool>,
    isa: Isa,
    quiet: bool,
) -> Result<Course, RunError> {
    let probes = folder.map(|folder| folder.file("probes.csv"));
    let unwritable = |e: serde_json::Error| RunError::System(format!("scene.json: {e}"));
    let mut set_aside = None;
    let recorder = match from {
        Some(from) => {
            let (frames, state) = (from.frames()?, from.part("recorder")?);
            for participant in scene.participants() {
                folder.map_or(Ok(()), |folder| folder.check_frames(&participant.name, frames))?;
            }
            set_aside = folder.map(|folder| folder.set_aside(frames)).transpose()?;
            Recorder::new(scene, None, quiet).resume(scene, probes.as_deref(), state)?
        }
        None => {
            let create = |path| ProbeLog::create(path, &Recorder::columns(scene));
            Recorder::new(scene, probes.as_deref().map(create).transpose()?, quiet)
        }
    };
    let checkpoints = match folder {
        Some(folder) => {
            let text = scene.to_json().map_err(unwritable)?;
            output::atomic::replace_bytes(&folder.file("scene.json"), text.as_bytes())?;
            let at = from.map_or((0, 0.0), |from| (from.manifest.number, from.manifest.time));
            let names = names(scene)?;
            let isa = isa.bits_name();
            Some(Checkpoints::new(scene, folder.path(), names, isa, at).map_err(unwritable)?)
        }
        None => None,
    };
    Ok(Course {
        clock: Clock::new(scene),
        recorder,
        checkpoints,
        must_save: false,
        set_aside,
        stop,
        progress: Arc::default(),
    })
}

/// Names of a scene's participants.
fn names(scene: &Scene) -> Result<Vec<Name>, RunError> {
    let name = |text: String| text.parse::<Name>().map_err(|e| RunError::System(e.to_string()));
    scene.participants().into_iter().map(|participant| name(participant.name)).collect()
}

/// Puts the end of a run in one process into its report; returns whether it was stopped.
pub(crate) fn report_local(
    scene: &Scene,
    external: &[(Name, SolidSource)],
    (outcome, reports): (Outcome, Vec<Report>),
    report: &mut RunReport,
) -> bool {
    report_outcome(scene, &outcome, report);
    let reports: Vec<Option<Report>> = reports.into_iter().map(Some).collect();
    report_participants(scene, external, &outcome, &reports, None, report);
    outcome.stopped
}

/// Completes the report of a run that was stopped or not, or failed, and writes what stands at its end.
pub(crate) fn end(
    course: &mut Course,
    result: Result<bool, RunError>,
    scene: &Scene,
    external: &[(Name, SolidSource)],
    folder: Option<&RunDirectory>,
    mut report: RunReport,
) -> (RunReport, Option<RunError>) {
    let Course { clock, recorder, .. } = course;
    // Rows that are lost make a run fail that has nothing else to complain of.
    let rows = recorder.synchronise();
    let result = result.and_then(|stopped| Ok(rows.map(|()| stopped)?));
    recorder.finish(&mut report);
    let external: Vec<Name> = external.iter().map(|(name, _)| *name).collect();
    let mut error = conclude(result, scene, clock, &external, &mut report);
    if let Some(folder) = folder
        && let Err(error) = last_frame::note(scene, folder.path(), &mut report)
    {
        tracing::warn!("how the run ended is not known from its last frames: {error}");
    }
    if let Some(folder) = folder.filter(|_| !scene.probes.is_empty()) {
        match output::probes::summarise(&folder.file("probes.csv")) {
            Ok(probes) => report.probes = probes,
            Err(error) => tracing::warn!("the probes' extremes are not known: {error}"),
        }
    }
    let mut remarked = remarks::outcome(scene, &report);
    if let Some(folder) = folder {
        match through_walls(scene, folder.path()) {
            Ok(entered) => remarked.extend(entered),
            Err(error) => tracing::warn!("whether solids went through walls is not known: {error}"),
        }
    }
    remarked.iter().for_each(|warning| tracing::warn!("{warning}"));
    report.warnings.extend(remarked.iter().cloned());
    report.warnings_at_end = remarked;
    if let Some(folder) = folder {
        // The run has been computed: that its report cannot be written is how it ended.
        if let Err(unwritten) = report.write(&folder.file("run.json")) {
            tracing::error!("{unwritten}");
            report.status = Some(RunStatus::Failed);
            error.get_or_insert(unwritten.into());
        }
        for error in run::draw(scene, folder.path()).into_iter().filter_map(Result::err) {
            tracing::warn!("a picture could not be drawn: {error}");
        }
    }
    (report, error)
}

/// Whether the run was stopped, or why it failed.
fn conclude(
    result: Result<bool, RunError>,
    scene: &Scene,
    clock: &Clock,
    external: &[Name],
    report: &mut RunReport,
) -> Option<RunError> {
    match result {
        Ok(stopped) => {
            report.status = Some(if stopped { RunStatus::Stopped } else { RunStatus::Finished });
            None
        }
        Err(mut error) => {
            report.status = Some(match &mut error {
                RunError::StoppedAtOnce { .. } => RunStatus::Stopped,
                RunError::Diverged { diverged, hint } => {
                    *hint = advice(diverged, scene, clock, external);
                    if !report.warnings.is_empty() {
                        *hint = format!("what the run warned of may be the cause; if not, {hint}");
                    }
                    RunStatus::Diverged
                }
                _ => RunStatus::Failed,
            });
            tracing::error!("{error}");
            report.error = Some(error.to_string());
            Some(error)
        }
    }
}
