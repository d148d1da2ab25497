//! The half-step loop of a process (or thread) that owns particles.

use crate::farewell;
use crate::latency::Latency;
use crate::role::{CoverageError, Role};
use halfstep_link::{Expect, LinkConfig, LinkError, PhaseLink, Processes, Transport};
use halfstep_scene::Scene;
use halfstep_wire::failure::{Diverged, Quantity, RoleName};
use halfstep_wire::frame::{FrameSink, SinkError};
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{LAST_STAGE, MAX_PROBE_VALUES, StateHeader, StateRecord, order, status};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Why a role ended before it was told to.
#[derive(Debug, thiserror::Error)]
pub enum RoleError {
    /// The exchange failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A particle left its bounds, or moves so fast that the interface set may lack one.
    #[error(transparent)]
    Diverged(#[from] Diverged),
    /// A frame cannot be written.
    #[error("{0}")]
    Frames(SinkError),
    /// The other phase said that it ends.
    #[error("the {peer} ended the run at step {step}, stage {stage}")]
    PeerEnded {
        /// Who.
        peer: RoleName,
        /// Step n.
        step: u64,
        /// Stage of its message, as the number on the wire.
        stage: u32,
    },
    /// The process was not started as a role.
    #[error("{0}")]
    Start(String),
}

/// Runs a role until the coupler says stop.
///
/// # Errors
/// Whatever ended it; the other roles were told where that was still possible.
pub fn serve<S: Transport>(
    role: &mut dyn Role,
    config: &LinkConfig,
    mut writer: Option<Box<dyn FrameSink>>,
    abort: Arc<AtomicBool>,
) -> Result<(), RoleError> {
    let link = PhaseLink::<S>::open(config, role.name(), Some(abort))?;
    let mut server = Server {
        link,
        own: Vec::new(),
        peer: Vec::new(),
        peer_epoch: 0,
        half_step: HalfStep::begin(0, 0.0),
        header: StateHeader::default(),
        frames: 0,
        at: 0.0,
        compute: Duration::ZERO,
        sums: Duration::ZERO,
        cross: Duration::ZERO,
        output: Duration::ZERO,
        latency: Latency::default(),
    };
    let result = server.run(role, &mut writer);
    if let Err(error) = &result {
        server.report_failure(error);
        if let (RoleError::Diverged(_) | RoleError::PeerEnded { .. }, Some(writer)) = (error, &mut writer) {
            // It shows where the trouble is; that it failed is not the reason why the run ended.
            let written = writer.submit(server.frames, &mut |frame| role.fill_frame(server.at, frame));
            written.unwrap_or_else(|e| tracing::warn!("the last frame is missing: {e}"));
        }
    }
    let written = match writer {
        Some(writer) => writer.finish(),
        None => Ok(0),
    };
    match result {
        Ok(last) => {
            // The last message says what is on disk, so it goes out after the writer has ended.
            let frames_safe = written.map_err(RoleError::Frames)?;
            let header = server.farewell(role, &last, frames_safe);
            server.link.send_state(&header, &[])?;
            Ok(())
        }
        Err(error) => Err(error),
    }
}

struct Server<S: Transport> {
    link: PhaseLink<S>,
    own: Vec<StateRecord>,
    peer: Vec<StateRecord>,
    peer_epoch: u64,
    half_step: HalfStep,
    header: StateHeader,
    /// Number of the next frame.
    frames: u32,
    /// Time of the role's own state, s.
    at: f64,
    compute: Duration,
    /// Parts of `compute`.
    sums: Duration,
    cross: Duration,
    output: Duration,
    latency: Latency,
}

impl<S: Transport> Server<S> {
    /// All half-steps; returns the header of the state at which the run stopped.
    fn run(
        &mut self,
        role: &mut dyn Role,
        writer: &mut Option<Box<dyn FrameSink>>,
    ) -> Result<StateHeader, RoleError> {
        // The fluid needs the solid's first state to choose what it publishes.
        let mut have_peer = false;
        if role.name() == RoleName::Fluid {
            self.receive_peer(&Expect::of(&self.half_step))?;
            have_peer = true;
        }
        loop {
            let half_step = self.half_step;
            let expect = Expect::of(&half_step);
            let start = Instant::now();
            role.set_time(half_step.before());
            let epoch = role.publish(&self.peer, &mut self.own);
            self.describe(role, writer.as_deref(), epoch);
            self.compute += start.elapsed();
            let sent = Instant::now();
            self.link.send_state(&self.header, &self.own)?;
            let start = Instant::now();
            role.own_sums();
            self.sums += start.elapsed();
            self.compute += start.elapsed();
            if !std::mem::take(&mut have_peer) {
                self.receive_peer(&expect)?;
            }
            let fluid_epoch = if role.name() == RoleName::Fluid { epoch } else { self.peer_epoch };
            let start = Instant::now();
            role.cross_sums(&self.own, &self.peer, fluid_epoch)
                .map_err(|lost| self.fastest(role.name(), &lost))?;
            self.cross += start.elapsed();
            self.compute += start.elapsed();

            // At the first stage the answer brings the time step.
            let forces = self.link.receive_forces(&expect)?;
            self.latency.add(sent.elapsed());
            let answer = *forces.header();
            let half_step = half_step.told(answer.dt, answer.next_time);
            self.at = half_step.after();
            if answer.order & order::WRITE_FRAME != 0
                && let Some(writer) = writer
            {
                let start = Instant::now();
                let submitted =
                    writer.submit(answer.frame as u32, &mut |frame| role.fill_frame(half_step.time, frame));
                submitted.map_err(RoleError::Frames)?;
                self.frames = answer.frame as u32 + 1;
                self.output += start.elapsed();
            }
            if answer.order & order::STOP != 0 {
                return Ok(self.header);
            }
            let start = Instant::now();
            role.advance(&half_step, forces.records())?;
            self.compute += start.elapsed();
            self.half_step = half_step.next();
        }
    }

    fn receive_peer(&mut self, expect: &Expect) -> Result<(), RoleError> {
        let sample = self.link.receive_peer(expect)?;
        let header = sample.header();
        if header.status != status::OK {
            let (step, stage) = (header.step, header.stage);
            return Err(RoleError::PeerEnded { peer: self.link.role().peer(), step, stage });
        }
        self.peer_epoch = header.epoch;
        self.peer.clear();
        self.peer.extend_from_slice(sample.records());
        Ok(())
    }

    fn describe(&mut self, role: &dyn Role, writer: Option<&dyn FrameSink>, epoch: u64) {
        let mut header = StateHeader {
            status: status::OK,
            epoch,
            displacement: role.displacement(),
            sub_steps: role.sub_steps(),
            frames_safe: writer.map_or(0, |w| w.safe()),
            particles: role.particles(),
            ..self.half_step.state_header()
        };
        if self.half_step.stage == Stage::First {
            header.dt_limit = role.dt_limit();
            let mut probes = [0.0; MAX_PROBE_VALUES];
            header.probe_count = role.probes(&mut probes) as u64;
            header.probes = probes;
            header.audit = role.audit();
        }
        self.header = header;
    }

    /// Coverage is lost when a particle moves half a smoothing length in one half-step: it is the one to name.
    fn fastest(&self, own: RoleName, lost: &CoverageError) -> Diverged {
        tracing::error!("{lost}");
        let role = if lost.fluid > lost.solid { RoleName::Fluid } else { RoleName::Solid };
        let records = if role == own { &self.own } else { &self.peer };
        let speed = |r: &StateRecord| r.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        let fastest = records.iter().max_by(|a, b| speed(a).total_cmp(&speed(b)));
        let record = fastest.copied().unwrap_or_default();
        Diverged {
            role,
            particle: record.id,
            quantity: Quantity::Speed,
            value: speed(&record),
            step: self.half_step.step,
            stage: self.half_step.stage,
            position: record.position,
        }
    }

    fn farewell(&self, role: &mut dyn Role, last: &StateHeader, frames_safe: u32) -> StateHeader {
        let times = self.link.times();
        let mut header = StateHeader {
            status: status::FINISHED,
            stage: LAST_STAGE,
            frames_safe,
            state_hash: role.state_hash(),
            seconds: [self.compute, times.wait, times.exchange, self.output].map(|d| d.as_secs_f64()),
            probe_count: farewell::COUNT as u64,
            ..*last
        };
        header.probes = [0.0; MAX_PROBE_VALUES];
        header.probes[farewell::ROUND_TRIP_P50] = self.latency.percentile(0.5);
        header.probes[farewell::ROUND_TRIP_P99] = self.latency.percentile(0.99);
        header.probes[farewell::PAIR_EVALUATIONS] = role.pair_evaluations() as f64;
        let costs = role.costs().of(self.sums.as_secs_f64(), self.compute.as_secs_f64());
        header.probes[farewell::WALLS] = costs.walls;
        header.probes[farewell::INTERFACE] = self.cross.as_secs_f64();
        header.probes[farewell::EFFECTS..farewell::COUNT].copy_from_slice(&costs.effects);
        header
    }

    fn report_failure(&mut self, error: &RoleError) {
        // It takes the place of the next state.
        let (step, stage) = self.half_step.stage.following(self.half_step.step);
        let mut header = StateHeader { status: status::FAILED, step, stage: stage.number(), ..self.header };
        match error {
            RoleError::Diverged(diverged) => diverged.tell(self.link.role(), &mut header),
            // The exchange itself is broken, or the other side knows already.
            RoleError::Link(_) | RoleError::PeerEnded { .. } | RoleError::Start(_) => return,
            RoleError::Frames(_) => {}
        }
        if let Err(error) = self.link.send_state(&header, &[]) {
            tracing::warn!("the failure could not be reported: {error}");
        }
    }
}

/// Environment variable with the path of the resolved scene.
pub const SCENE_VARIABLE: &str = "HALFSTEP_SCENE";
/// Environment variable with the run's folder; without it no frames are written.
pub const FOLDER_VARIABLE: &str = "HALFSTEP_OUT";
/// Environment variable with the number of worker threads.
pub const THREADS_VARIABLE: &str = "HALFSTEP_THREADS";

/// Serves a role in this process, as its environment says: what a role's `main` calls.
///
/// # Errors
/// The environment is not that of a role, or the role failed.
pub fn serve_process(
    stem: &str,
    abort: Arc<AtomicBool>,
    build: impl FnOnce(&Scene) -> Option<Box<dyn Role>> + Send,
    frames: impl FnOnce(&Path) -> Result<Box<dyn FrameSink>, SinkError>,
) -> Result<(), RoleError> {
    let start = |reason: String| RoleError::Start(reason);
    let config = LinkConfig::from_env()?;
    let variable = |key: &str| std::env::var_os(key);
    let scene = variable(SCENE_VARIABLE).ok_or_else(|| start(format!("{SCENE_VARIABLE} is not set")))?;
    let text = std::fs::read_to_string(&scene)
        .map_err(|e| start(format!("cannot read {}: {e}", Path::new(&scene).display())))?;
    let scene = Scene::from_json(&text).map_err(|e| start(format!("not a resolved scene: {e}")))?;
    let threads = variable(THREADS_VARIABLE).and_then(|v| v.to_str()?.parse().ok()).unwrap_or(1);
    let writer = variable(FOLDER_VARIABLE)
        .map(|dir| frames(Path::new(&dir)))
        .transpose()
        .map_err(RoleError::Frames)?;
    on_threads(threads, move || {
        let mut role = build(&scene).ok_or_else(|| RoleError::Start(format!("the scene has no {stem}")))?;
        serve::<Processes>(role.as_mut(), &config, writer, abort)
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
