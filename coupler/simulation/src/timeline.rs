//! The timeline of a run: from what each process recorded, a file of its own in the run's folder, to the one that was
//! asked for.

use crate::options::Trace;
use halfstep_coupling::error::RunError;
use halfstep_coupling::say;
use halfstep_output::timeline::{Span, Timeline, Track};
use halfstep_output::{OutputError, atomic, draw_timeline, run_dir};
use halfstep_role::timeline::{self, Event, Part, Recording, Window};
use halfstep_scene::Scene;
use halfstep_wire::Name;
use std::path::{Path, PathBuf};

/// Where the part of a process lies.
fn path(folder: &Path, process: &str) -> PathBuf {
    folder.join(format!("timeline-{process}.json"))
}

/// Refuses a file that the timeline could not be written to at the end.
pub(crate) fn check(trace: &Trace, scene: &Path, out: &Path, force: bool) -> Result<(), RunError> {
    let file = trace.file.as_path();
    let refused = |reason: String| Err(RunError::System(format!("--trace {}: {reason}", file.display())));
    if file.file_name().is_none() || file.is_dir() {
        return refused("is a folder; it must be a file".into());
    }
    if file.metadata().is_ok_and(|found| !found.is_file()) {
        return refused("is no regular file".into());
    }
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let same = |a: &Path, b: &Path| match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => absolute(a) == absolute(b),
    };
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if same(file, scene) {
        return refused("is the scene".into());
    }
    if Path::new(&name).extension().is_some_and(|end| end.eq_ignore_ascii_case("png")) {
        return refused(
            "the file has trace events (JSON); their picture is trace.png in the run's folder".into(),
        );
    }
    if same(folder, out) {
        if run_dir::is_of_run(&name) && name != "trace.json" {
            return refused("is a file that the run itself leaves in its folder".into());
        }
        if !folder.exists() {
            return Ok(());
        }
    }
    if file.exists() && !force {
        return refused("the file exists; --force replaces it".into());
    }
    if !folder.is_dir() {
        return refused(format!("there is no folder {}", folder.display()));
    }
    let attempt = atomic::temporary(file);
    match std::fs::File::create(&attempt).and_then(|_| std::fs::remove_file(&attempt)) {
        Ok(()) => Ok(()),
        Err(error) => refused(format!("cannot be written: {error}")),
    }
}

/// The process of participants and coupler that are threads of one.
const ONE: &str = "halfstep";

/// Records the half-steps of this thread, which does what a process of the scene or the coupler does; what it recorded
/// goes to the run's folder. `own`: it has a process of its own.
pub(crate) fn record(window: Window, folder: &Path, process: Name, own: bool) -> Recording {
    let folder = folder.to_owned();
    let shown = if own { process.to_string() } else { ONE.to_owned() };
    timeline::record(window, Box::new(move |part| keep(&folder, process, &shown, &part)))
}

/// Writes the part of a process, `shown` under a name. A run does not end because its timeline cannot be written.
pub(crate) fn keep(folder: &Path, process: Name, shown: &str, part: &Part) {
    if part.events.is_empty() {
        return;
    }
    if let Err(error) = of_part(shown, part).write(&path(folder, process.as_str())) {
        tracing::warn!("{process}: its part of the timeline is missing: {error}");
    }
}

fn of_part(process: &str, part: &Part) -> Timeline {
    let mut tracks: Vec<Track> = Vec::new();
    let own = (process.to_string(), std::process::id());
    for event in &part.events {
        let name = event.track.to_string();
        let place = tracks.iter().position(|track| track.name == name).unwrap_or_else(|| {
            tracks.push(Track { process: own.clone(), name, spans: Vec::new() });
            tracks.len() - 1
        });
        tracks[place].spans.push(span(event));
    }
    for track in &mut tracks {
        // A span before what lies within it.
        track.spans.sort_by(|a, b| a.start.total_cmp(&b.start).then(b.duration.total_cmp(&a.duration)));
    }
    Timeline { tracks, lost: part.lost }
}

fn span(event: &Event) -> Span {
    let [start, end] = event.span;
    Span {
        name: event.what.into(),
        category: event.kind.name().into(),
        start: start as f64 * 1e-3,
        duration: (end - start) as f64 * 1e-3,
        step: event.step,
        stage: event.stage.number(),
        with: event.with.map(|with| with.to_string()),
    }
}

/// Puts together what the processes left in a run's folder, writes the file that was asked for, draws `trace.png`, and
/// says what there is of the window. A run whose timeline is missing has been computed all the same.
pub(crate) fn finish(scene: &Scene, folder: &Path, trace: &Trace, steps: u64) {
    let warn = |told: String| {
        tracing::warn!("{told}");
        say::warn(format_args!("warning: {told}"));
    };
    let Trace { file, window } = trace;
    match collect(scene, folder, file) {
        Err(error) => warn(format!("the timeline is not whole: {error}")),
        Ok(None) if steps <= window.first() => warn(format!(
            "no timeline: the run ended at step {steps}, before the window {window} began; --trace-steps FROM..TO gives \
             another one"
        )),
        Ok(None) => warn("no timeline: no process could leave its part".into()),
        Ok(Some(timeline)) => {
            let last = timeline.steps().map_or(window.first(), |(_, last)| last);
            if last < window.last() {
                let whole = window.last();
                warn(format!(
                    "the run ended within the timeline's window: step {last} is its last, not {whole}"
                ));
            }
            if timeline.lost > 0 {
                let lost = timeline.lost;
                warn(format!("{lost} phases were too many for the timeline; a shorter window has all"));
            }
            let picture = folder.join("trace.png");
            say::tell(format_args!("the timeline: {} and {}", file.display(), picture.display()));
        }
    }
}

fn collect(scene: &Scene, folder: &Path, file: &Path) -> Result<Option<Timeline>, OutputError> {
    let participants = scene.participants();
    // The process of an external solid leaves nothing; one of that name may have been there for others.
    let mut parts = vec![path(folder, Name::COUPLER.as_str())];
    parts.extend(participants.iter().map(|participant| path(folder, &participant.process)));
    parts.sort();
    parts.dedup();
    parts.retain(|part| part.is_file());
    if parts.is_empty() {
        return Ok(None);
    }
    let read = parts.iter().map(|part| Timeline::read(part)).collect::<Result<Vec<_>, _>>()?;
    let order: Vec<String> = participants.into_iter().map(|participant| participant.name).collect();
    let whole = Timeline::merged(read, &order);
    whole.write(file)?;
    for part in parts {
        let _ = std::fs::remove_file(part);
    }
    draw_timeline(scene, &whole, &folder.join("trace.png"))?;
    Ok(Some(whole))
}
