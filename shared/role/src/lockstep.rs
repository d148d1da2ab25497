//! The one half-step loop: drives the participants of a process through whatever carries their messages.

use crate::latency::Latency;
use crate::published::Published;
use crate::report::Report;
use crate::role::{CoverageError, Peer, Role};
use halfstep_link::{Expect, LinkError, Port};
use halfstep_scene::EffectName;
use halfstep_sph::Phase;
use halfstep_wire::Name;
use halfstep_wire::failure::{Diverged, Quantity};
use halfstep_wire::frame::{FrameSink, SinkError};
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{ForceRecord, LAST_STAGE, StateHeader, StateRecord, ability, order, status};
use halfstep_wire::state::{Group, State, StateError, StateSink};
use std::time::{Duration, Instant};

/// Why a process of participants ended before it was told to.
#[derive(Debug, thiserror::Error)]
pub enum RoleError {
    /// The exchange failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A particle left its bounds, or moves so fast that the interface set may lack one.
    #[error(transparent)]
    Diverged(#[from] Diverged),
    /// A frame or a report cannot be written.
    #[error("{0}")]
    Output(SinkError),
    /// A participant of another process said that it ends.
    #[error("the {peer} ended the run at step {step}, stage {stage}")]
    PeerEnded {
        /// Who.
        peer: Name,
        /// Step n.
        step: u64,
        /// Stage of its message, as the number on the wire.
        stage: u32,
    },
    /// The process was not started as one of participants.
    #[error("{0}")]
    Start(String),
}

/// A participant, where its frames and checkpoints go, and where it begins.
pub struct Member {
    /// Owner of the particles.
    pub role: Box<dyn Role>,
    /// Without one no frames are written.
    pub frames: Option<Box<dyn FrameSink>>,
    /// Without one no checkpoints are written.
    pub checkpoints: Option<Box<dyn StateSink>>,
    /// The state that it goes on from; `None`: the scene's first.
    pub resumed: Option<Published>,
}

impl Member {
    /// At the scene's first state, with nothing written.
    pub fn new(role: Box<dyn Role>) -> Self {
        Self { role, frames: None, checkpoints: None, resumed: None }
    }

    /// Goes on from a checkpoint.
    ///
    /// # Errors
    /// The checkpoint is not one of this participant in this scene.
    pub fn resume(&mut self, checkpoint: &Group) -> Result<(), StateError> {
        let mut published = Published::default();
        published.load(checkpoint)?;
        let own = || StateError::contradiction("this participant cannot be saved");
        let role = checkpoint.groups.get("role").ok_or(StateError::Missing { field: "role".into() })?;
        self.role.state().ok_or_else(own)?.load(role)?;
        self.resumed = Some(published);
        Ok(())
    }
}

/// Takes the report of a participant that has ended, before its last message goes out.
pub type Deliver<'a> = &'a mut dyn FnMut(&Report) -> Result<(), SinkError>;

/// Drives participants until they are ordered to stop. Their frames are on disk and their reports delivered before
/// their last messages go out.
///
/// # Errors
/// Whatever ended it; the others were told where that was still possible, and the state that diverged was written as
/// the last frame.
pub fn drive(members: Vec<Member>, port: &mut dyn Port, deliver: Deliver<'_>) -> Result<(), RoleError> {
    let peers: Vec<usize> = (0..members.len()).map(|k| port.peers(k).len()).collect();
    let mut run = Lockstep::new(members, &peers)?;
    while run.half_step(port)? {}
    run.end(port, deliver)
}

/// What a participant has on disk at its end.
struct Written {
    frames_safe: u32,
    checkpoint_safe: u32,
}

/// A participant on its way.
struct Track {
    role: Box<dyn Role>,
    frames: Option<Box<dyn FrameSink>>,
    checkpoints: Option<Box<dyn StateSink>>,
    resumed: Option<Published>,
    own: Vec<StateRecord>,
    peers: Vec<Peer>,
    /// The peers' states of this half-step are there.
    have_peers: bool,
    forces: Vec<ForceRecord>,
    probes: Vec<f64>,
    header: StateHeader,
    /// Number of the next frame.
    frame: u32,
    sent: Instant,
    compute: Duration,
    /// Parts of `compute`.
    sums: Duration,
    cross: Duration,
    output: Duration,
    latency: Latency,
}

impl Track {
    fn new(member: Member, peers: Vec<Peer>) -> Self {
        Self {
            role: member.role,
            frames: member.frames,
            checkpoints: member.checkpoints,
            resumed: member.resumed,
            own: Vec::new(),
            peers,
            have_peers: false,
            forces: Vec::new(),
            probes: Vec::new(),
            header: StateHeader::default(),
            frame: 0,
            sent: Instant::now(),
            compute: Duration::ZERO,
            sums: Duration::ZERO,
            cross: Duration::ZERO,
            output: Duration::ZERO,
            latency: Latency::default(),
        }
    }

    fn publish(&mut self, half_step: &HalfStep) {
        let start = Instant::now();
        self.role.set_time(half_step.before());
        let epoch = self.role.publish(&self.peers, &mut self.own);
        let mut header = StateHeader {
            status: status::OK,
            epoch,
            displacement: self.role.displacement(),
            sub_steps: self.role.sub_steps(),
            frames_safe: self.frames.as_ref().map_or(0, |frames| frames.safe()),
            checkpoint_safe: self.checkpoints.as_ref().map_or(0, |checkpoints| checkpoints.safe() as u32),
            particles: self.role.particles(),
            abilities: self.abilities(),
            ..half_step.state_header()
        };
        if half_step.stage == Stage::First {
            header.dt_limit = self.role.dt_limit();
            header.audit = self.role.audit();
        }
        if let Some(published) = self.resumed.take() {
            // What the sums of the interrupted half-step changed afterwards does not belong to it.
            header = published.header(header);
        }
        self.header = header;
        self.compute += start.elapsed();
        self.sent = Instant::now();
    }

    fn publish_to(&mut self, port: &mut dyn Port, k: usize, half_step: &HalfStep) -> Result<(), RoleError> {
        self.publish(half_step);
        Ok(port.send_state(k, &self.header, &self.own)?)
    }

    fn abilities(&mut self) -> u32 {
        let saves = self.checkpoints.is_some() && self.role.state().is_some();
        ability::PROBES | ability::WALLS_AND_CONTACTS | if saves { ability::CHECKPOINTS } else { 0 }
    }

    fn own_sums(&mut self) {
        let start = Instant::now();
        self.role.own_sums();
        self.sums += start.elapsed();
        self.compute += start.elapsed();
    }

    fn receive_peers(&mut self, port: &mut dyn Port, k: usize, expect: &Expect) -> Result<(), RoleError> {
        for (place, peer) in self.peers.iter_mut().enumerate() {
            let header = port.receive_peer(k, place, expect, &mut peer.records)?;
            if header.status != status::OK {
                let (step, stage) = (header.step, header.stage);
                return Err(RoleError::PeerEnded { peer: port.peers(k)[place], step, stage });
            }
            peer.epoch = header.epoch;
        }
        Ok(())
    }

    fn cross_sums(&mut self, port: &dyn Port, k: usize, half_step: &HalfStep) -> Result<(), RoleError> {
        let start = Instant::now();
        let result = self.role.cross_sums(&self.own, &self.peers);
        self.cross += start.elapsed();
        self.compute += start.elapsed();
        result.map_err(|lost| self.fastest(port.peers(k), &lost, half_step).into())
    }

    /// Coverage is lost when a particle moves half a smoothing length in one half-step: it is the one to name.
    fn fastest(&self, peers: &[Name], lost: &CoverageError, half_step: &HalfStep) -> Diverged {
        tracing::error!("{lost}");
        let of_fluid = lost.fluid > lost.solid;
        let (participant, records) = if of_fluid == (self.role.phase() == Phase::Fluid) {
            (self.role.name(), &self.own)
        } else {
            (peers[lost.peer], &self.peers[lost.peer].records)
        };
        let speed = |r: &StateRecord| r.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        let fastest = records.iter().max_by(|a, b| speed(a).total_cmp(&speed(b)));
        let record = fastest.copied().unwrap_or_default();
        Diverged {
            participant,
            particle: record.id,
            quantity: Quantity::Speed,
            value: speed(&record),
            step: half_step.step,
            stage: half_step.stage,
            position: record.position,
        }
    }

    fn advance(&mut self, half_step: &HalfStep) -> Result<(), RoleError> {
        let start = Instant::now();
        self.role.advance(half_step, &self.forces)?;
        self.compute += start.elapsed();
        Ok(())
    }

    fn write_frame(&mut self, number: u32, time: f64) -> Result<(), SinkError> {
        let Some(frames) = &mut self.frames else { return Ok(()) };
        let start = Instant::now();
        frames.submit(number, &mut |frame| self.role.fill_frame(time, frame))?;
        self.frame = number + 1;
        self.output += start.elapsed();
        Ok(())
    }

    /// Hands over the state last published.
    fn write_checkpoint(&mut self, number: u64) -> Result<(), SinkError> {
        let (Some(checkpoints), Some(state)) = (&mut self.checkpoints, self.role.state()) else {
            return Ok(());
        };
        let start = Instant::now();
        let mut group = Published::of(&self.header).save();
        group.groups.insert("role".into(), state.save());
        checkpoints.submit(number, group)?;
        self.output += start.elapsed();
        Ok(())
    }

    fn finish(&mut self) -> Result<Written, SinkError> {
        let frames_safe = self.frames.take().map_or(Ok(0), |frames| frames.finish());
        let checkpoint_safe = self.checkpoints.take().map_or(Ok(0), |checkpoints| checkpoints.finish());
        Ok(Written { frames_safe: frames_safe?, checkpoint_safe: checkpoint_safe? as u32 })
    }

    fn report(&mut self, port: &dyn Port) -> Report {
        let times = port.times();
        let compute = self.compute.as_secs_f64();
        let costs = self.role.costs().of(self.sums.as_secs_f64(), compute);
        let effects = EffectName::ALL.iter().copied().zip(costs.effects);
        Report {
            name: self.role.name().to_string(),
            compute,
            wait: times.wait.as_secs_f64(),
            exchange: times.exchange.as_secs_f64(),
            output: self.output.as_secs_f64(),
            round_trip_us: [0.5, 0.99].map(|share| self.latency.percentile(share)),
            pair_evaluations: self.role.pair_evaluations(),
            walls: costs.walls,
            interface: self.cross.as_secs_f64(),
            effects: effects.filter(|(_, seconds)| *seconds > 0.0).collect(),
        }
    }
}

/// Place of the participant that failed, and why.
type Failed = (usize, RoleError);

/// Participants in lock-step, driven half-step by half-step.
pub struct Lockstep {
    tracks: Vec<Track>,
    half_step: HalfStep,
    /// Time of the participants' own states, s.
    at: f64,
    begun: bool,
}

impl Lockstep {
    /// At the state that the participants begin with; `peers` are the numbers of their peers.
    ///
    /// # Errors
    /// They begin at different steps.
    pub fn new(members: Vec<Member>, peers: &[usize]) -> Result<Self, RoleError> {
        let peers = |k: usize| vec![Peer::default(); peers.get(k).copied().unwrap_or(0)];
        let tracks = members.into_iter().enumerate().map(|(k, member)| Track::new(member, peers(k)));
        let tracks: Vec<Track> = tracks.collect();
        let begins = |track: &Track| track.resumed.as_ref().map_or((0, 0.0), |from| (from.step, from.time));
        let (step, time) = tracks.first().map_or((0, 0.0), begins);
        if tracks.iter().any(|track| begins(track) != (step, time)) {
            return Err(RoleError::Start("the participants' checkpoints are of different steps".into()));
        }
        Ok(Self { tracks, half_step: HalfStep::begin(step, time), at: time, begun: false })
    }

    /// The owners of particles, in the order of the members.
    pub fn roles(&self) -> impl Iterator<Item = &dyn Role> {
        self.tracks.iter().map(|track| &*track.role)
    }

    /// Time of the participants' own states, s.
    pub fn time(&self) -> f64 {
        self.at
    }

    /// One half-step; returns whether the run goes on.
    ///
    /// # Errors
    /// As for [`drive`]; nothing can be done with the participants then.
    pub fn half_step(&mut self, port: &mut dyn Port) -> Result<bool, RoleError> {
        let result = self.exchange_and_advance(port);
        result.map_err(|(k, error)| {
            self.report_failure(port, k, &error);
            if let RoleError::Diverged(_) | RoleError::PeerEnded { .. } = error {
                self.last_frames();
            }
            let written = self.tracks.iter_mut().map(Track::finish).find_map(Result::err);
            if let Some(error) = written {
                tracing::warn!("what was written last is not safe: {error}");
            }
            error
        })
    }

    /// Ends a run that was told to stop: everything is on disk, then reports and last messages go out.
    ///
    /// # Errors
    /// Something could not be written, or a message not be sent.
    pub fn end(&mut self, port: &mut dyn Port, deliver: Deliver<'_>) -> Result<(), RoleError> {
        let written: Vec<Result<Written, SinkError>> = self.tracks.iter_mut().map(Track::finish).collect();
        for (k, written) in written.into_iter().enumerate() {
            // The last message says what is on disk.
            let track = &mut self.tracks[k];
            let Written { frames_safe, checkpoint_safe } = written.map_err(RoleError::Output)?;
            deliver(&track.report(port)).map_err(RoleError::Output)?;
            let header = StateHeader {
                status: status::FINISHED,
                stage: LAST_STAGE,
                frames_safe,
                checkpoint_safe,
                state_hash: track.role.state_hash(),
                ..track.header
            };
            port.send_state(k, &header, &[])?;
        }
        Ok(())
    }

    /// The fluid needs the solids' first states to choose what it publishes.
    fn begin(&mut self, port: &mut dyn Port) -> Result<(), Failed> {
        let half_step = self.half_step;
        let fluid = |track: &Track| track.role.phase() == Phase::Fluid;
        self.each(|k, track| if fluid(track) { Ok(()) } else { track.publish_to(port, k, &half_step) })?;
        let expect = Expect::of(&half_step);
        self.each(|k, track| {
            if fluid(track) {
                track.receive_peers(port, k, &expect)?;
                track.have_peers = true;
                track.publish_to(port, k, &half_step)?;
            }
            Ok(())
        })
    }

    /// Does a part of the half-step for one participant after the other.
    fn each(
        &mut self,
        mut part: impl FnMut(usize, &mut Track) -> Result<(), RoleError>,
    ) -> Result<(), Failed> {
        let mut all = self.tracks.iter_mut().enumerate();
        all.try_for_each(|(k, track)| part(k, track).map_err(|error| (k, error)))
    }

    fn exchange_and_advance(&mut self, port: &mut dyn Port) -> Result<bool, Failed> {
        let half_step = self.half_step;
        let expect = Expect::of(&half_step);
        match std::mem::replace(&mut self.begun, true) {
            true => self.each(|k, track| track.publish_to(port, k, &half_step))?,
            false => self.begin(port)?,
        }
        self.tracks.iter_mut().for_each(Track::own_sums);
        self.each(|k, track| {
            if !std::mem::take(&mut track.have_peers) {
                track.receive_peers(port, k, &expect)?;
            }
            track.cross_sums(port, k, &half_step)
        })?;
        let (mut told, mut stopped, mut at) = (half_step, false, self.at);
        let answered = self.each(|k, track| {
            // At the first stage the answer brings the time step.
            let answer = port.receive_forces(k, &expect, &mut track.forces)?;
            track.latency.add(track.sent.elapsed());
            told = half_step.told(answer.dt, answer.next_time);
            at = told.after();
            if answer.order & order::WRITE_FRAME != 0 {
                track.write_frame(answer.frame as u32, told.time).map_err(RoleError::Output)?;
            }
            if answer.order & order::SEND_PROBES != 0 {
                track.probes.clear();
                track.role.probes(&mut track.probes);
                port.send_probes(k, told.step, told.time, &track.probes)?;
            }
            if answer.order & order::WRITE_CHECKPOINT != 0 {
                track.write_checkpoint(answer.checkpoint).map_err(RoleError::Output)?;
            }
            // All participants are stopped at the same state.
            stopped = answer.order & order::STOP != 0;
            if stopped { Ok(()) } else { track.advance(&told) }
        });
        self.at = at;
        answered?;
        self.half_step = told.next();
        Ok(!stopped)
    }

    /// Tells the others that participant `k` failed.
    fn report_failure(&mut self, port: &mut dyn Port, k: usize, error: &RoleError) {
        // It takes the place of the next state.
        let (step, stage) = self.half_step.stage.following(self.half_step.step);
        let last = self.tracks[k].header;
        let mut header = StateHeader { status: status::FAILED, step, stage: stage.number(), ..last };
        match error {
            RoleError::Diverged(diverged) => diverged.tell(port.participants(), &mut header),
            // The exchange itself is broken, or the others know already.
            RoleError::Link(_) | RoleError::PeerEnded { .. } | RoleError::Start(_) => return,
            RoleError::Output(_) => {}
        }
        if let Err(error) = port.send_state(k, &header, &[]) {
            tracing::warn!("the failure could not be reported: {error}");
        }
    }

    /// The last states show where the trouble is; that they could not be written is not the reason why the run ended.
    fn last_frames(&mut self) {
        for track in &mut self.tracks {
            let written = track.write_frame(track.frame, self.at);
            written.unwrap_or_else(|error| tracing::warn!("the last frame is missing: {error}"));
        }
    }
}
