//! Serving the participants of a process, as its environment says.

use crate::lockstep::{Deliver, RoleError, drive};
use crate::member::Member;
use crate::report::Report;
use crate::timeline::{self, Part, Window};
use halfstep_link::{LinkConfig, ProcessLink, Processes, Transport};
use halfstep_scene::Scene;
use halfstep_wire::Name;
use halfstep_wire::frame::SinkError;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Environment variable with the path of the resolved scene.
pub const SCENE_VARIABLE: &str = "HALFSTEP_SCENE";
/// Environment variable with the run's folder; without it neither frames nor reports are written.
pub const FOLDER_VARIABLE: &str = "HALFSTEP_OUT";
/// Environment variable with the folder of the checkpoint that a process's participants go on from; without it they
/// begin as the scene does.
pub const CHECKPOINT_VARIABLE: &str = "HALFSTEP_CHECKPOINT";
/// Environment variable with the number of worker threads.
pub const THREADS_VARIABLE: &str = "HALFSTEP_THREADS";
/// Environment variable with the steps whose half-steps are recorded, `FROM..TO`; without it nothing is.
pub const TIMELINE_VARIABLE: &str = "HALFSTEP_TIMELINE";

/// Drives the participants of `process` until the coupler says stop.
///
/// # Errors
/// Whatever ended it; the others were told where that was still possible.
pub fn serve<S: Transport>(
    members: Vec<Member>,
    config: &LinkConfig,
    process: Name,
    abort: Arc<AtomicBool>,
    deliver: Deliver<'_>,
) -> Result<(), RoleError> {
    let mut link = ProcessLink::<S>::open(config, process, Some(abort))?;
    let own: Vec<Name> = members.iter().map(|member| member.role.name()).collect();
    if own != link.members() {
        return Err(RoleError::Start(format!("{process} shall serve {:?} and not {own:?}", link.members())));
    }
    drive(members, &mut link, deliver)
}

/// Serves the participants of this process: what the `main` of such a process calls. `build` makes them from the scene,
/// given their places among the scene's participants, the run's folder, and that of the checkpoint that they go on
/// from. `keep` takes the part of the timeline that the process recorded.
///
/// # Errors
/// The environment is not that of a run, or the run failed.
pub fn serve_process(
    process: Name,
    abort: Arc<AtomicBool>,
    build: impl FnOnce(&Scene, &[usize], Option<&Path>, Option<&Path>) -> Result<Vec<Member>, RoleError> + Send,
    deliver: impl Fn(&Path, &Report) -> Result<(), SinkError> + Send,
    keep: impl FnOnce(&Path, Part) + Send + 'static,
) -> Result<(), RoleError> {
    let start = |reason: String| RoleError::Start(reason);
    let config = LinkConfig::from_env()?;
    let variable = |key: &str| std::env::var_os(key);
    let scene = variable(SCENE_VARIABLE).ok_or_else(|| start(format!("{SCENE_VARIABLE} is not set")))?;
    let text = std::fs::read_to_string(&scene)
        .map_err(|e| start(format!("cannot read {}: {e}", Path::new(&scene).display())))?;
    let scene = Scene::from_json(&text).map_err(|e| start(format!("not a resolved scene: {e}")))?;
    let threads = variable(THREADS_VARIABLE).and_then(|v| v.to_str()?.parse().ok()).unwrap_or(1);
    let window = variable(TIMELINE_VARIABLE).map(|text| text.to_string_lossy().parse::<Window>()).transpose();
    let window = window.map_err(|error| start(format!("{TIMELINE_VARIABLE}: {error}")))?;
    let folder = variable(FOLDER_VARIABLE);
    let folder = folder.as_deref().map(Path::new);
    let checkpoint = variable(CHECKPOINT_VARIABLE);
    on_threads(threads, move || {
        let members = build(&scene, &config.members(process), folder, checkpoint.as_deref().map(Path::new))?;
        let _recording = window.zip(folder).map(|(window, folder)| {
            let folder = folder.to_owned();
            timeline::record(window, Box::new(move |part| keep(&folder, part)))
        });
        let mut deliver = |report: &Report| folder.map_or(Ok(()), |folder| deliver(folder, report));
        serve::<Processes>(members, &config, process, abort, &mut deliver)
    })?
}

/// Runs `work` with a pool of that many threads for the neighbour passes.
///
/// # Errors
/// The threads cannot be started.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> Result<T, RoleError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map(|pool| pool.install(work))
        .map_err(|e| RoleError::Start(format!("cannot start {threads} threads: {e}")))
}
