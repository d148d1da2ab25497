//! A participant on its way through the half-steps: its messages, what it writes, and where its time goes.

use crate::error::RoleError;
use crate::latency::Latency;
use crate::ledger::Ledger;
use crate::member::Member;
use crate::published::Published;
use crate::report::Report;
use crate::role::{CoverageError, Peer};
use crate::timeline::{self, Kind, Watch};
use halfstep_link::{Expect, Port};
use halfstep_scene::EffectName;
use halfstep_sph::Phase;
use halfstep_wire::Name;
use halfstep_wire::failure::{Diverged, Quantity};
use halfstep_wire::frame::SinkError;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{ForceRecord, StateHeader, StateRecord, ability, status};
use halfstep_wire::state::State;
use std::time::{Duration, Instant};

/// What a participant has on disk at its end.
pub(crate) struct Written {
    pub(crate) frames_safe: u32,
    pub(crate) checkpoint_safe: u32,
}

/// A participant on its way.
pub(crate) struct Track {
    pub(crate) member: Member,
    own: Vec<StateRecord>,
    peers: Vec<Peer>,
    /// The peers' states of this half-step are there.
    pub(crate) have_peers: bool,
    pub(crate) forces: Vec<ForceRecord>,
    pub(crate) probes: Vec<f64>,
    pub(crate) header: StateHeader,
    /// Number of the next frame.
    pub(crate) frame: u32,
    pub(crate) sent: Instant,
    compute: Duration,
    /// Parts of `compute`.
    sums: Duration,
    cross: Duration,
    output: Duration,
    pub(crate) latency: Latency,
}

impl Track {
    pub(crate) fn new(member: Member, peers: Vec<Peer>) -> Self {
        // A run that goes on keeps its frames, also where it ends before the next one.
        let frames = member.resumed.as_ref().and(member.frames.as_ref());
        let frame = frames.map_or(0, |frames| frames.safe());
        Self {
            member,
            own: Vec::new(),
            peers,
            have_peers: false,
            forces: Vec::new(),
            probes: Vec::new(),
            header: StateHeader::default(),
            frame,
            sent: Instant::now(),
            compute: Duration::ZERO,
            sums: Duration::ZERO,
            cross: Duration::ZERO,
            output: Duration::ZERO,
            latency: Latency::default(),
        }
    }

    fn publish(&mut self, half_step: &HalfStep) {
        let watch = Watch::start(Kind::Compute, "publish");
        self.member.role.set_time(half_step.before());
        let epoch = self.member.role.publish(&self.peers, &mut self.own);
        let mut header = StateHeader {
            status: status::OK,
            epoch,
            displacement: self.member.role.displacement(),
            sub_steps: self.member.role.sub_steps(),
            frames_safe: self.member.frames.as_ref().map_or(0, |frames| frames.safe()),
            checkpoint_safe: self
                .member
                .checkpoints
                .as_ref()
                .map_or(0, |checkpoints| checkpoints.safe() as u32),
            particles: self.member.role.particles(),
            abilities: self.abilities(),
            ..half_step.state_header()
        };
        if half_step.stage == Stage::First {
            header.dt_limit = self.member.role.dt_limit();
            header.audit = self.member.role.audit();
        }
        if let Some(published) = self.member.resumed.take() {
            // What the sums of the interrupted half-step changed afterwards does not belong to it.
            header = published.header(header);
        }
        self.header = header;
        self.compute += watch.stop();
        self.sent = Instant::now();
    }

    pub(crate) fn publish_to(
        &mut self,
        port: &mut dyn Port,
        k: usize,
        half_step: &HalfStep,
    ) -> Result<(), RoleError> {
        self.publish(half_step);
        let _phase = timeline::phase_of(Kind::Message, "send");
        Ok(port.send_state(k, &self.header, &self.own)?)
    }

    fn abilities(&mut self) -> u32 {
        let saves = self.member.checkpoints.is_some() && self.member.role.state().is_some();
        ability::PROBES | ability::WALLS_AND_CONTACTS | if saves { ability::CHECKPOINTS } else { 0 }
    }

    pub(crate) fn own_sums(&mut self) {
        let watch = Watch::start(Kind::Compute, "sums");
        self.member.role.own_sums();
        let took = watch.stop();
        self.sums += took;
        self.compute += took;
    }

    pub(crate) fn receive_peers(
        &mut self,
        port: &mut dyn Port,
        k: usize,
        expect: &Expect,
    ) -> Result<(), RoleError> {
        for (place, peer) in self.peers.iter_mut().enumerate() {
            let header = timeline::receive(
                port,
                "wait for state",
                port.peers(k)[place],
                |port| port.times(),
                |port| port.receive_peer(k, place, expect, &mut peer.records),
            )?;
            if header.status != status::OK {
                let (step, stage) = (header.step, header.stage);
                return Err(RoleError::PeerEnded { peer: port.peers(k)[place], step, stage });
            }
            peer.epoch = header.epoch;
        }
        Ok(())
    }

    pub(crate) fn cross_sums(
        &mut self,
        port: &dyn Port,
        k: usize,
        half_step: &HalfStep,
    ) -> Result<(), RoleError> {
        let watch = Watch::start(Kind::Compute, "interface");
        let result = self.member.role.cross_sums(&self.own, &self.peers);
        let took = watch.stop();
        self.cross += took;
        self.compute += took;
        result.map_err(|lost| self.fastest(port.peers(k), &lost, half_step).into())
    }

    /// Coverage is lost when a particle moves half a smoothing length in one half-step: it is the one to name.
    fn fastest(&self, peers: &[Name], lost: &CoverageError, half_step: &HalfStep) -> Diverged {
        tracing::error!("{lost}");
        let of_fluid = lost.fluid > lost.solid;
        let (participant, records) = if of_fluid == (self.member.role.phase() == Phase::Fluid) {
            (self.member.role.name(), &self.own)
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

    pub(crate) fn advance(&mut self, half_step: &HalfStep) -> Result<(), RoleError> {
        let watch = Watch::start(Kind::Compute, "integrate");
        self.member.role.advance(half_step, &self.forces)?;
        self.compute += watch.stop();
        Ok(())
    }

    pub(crate) fn write_frame(&mut self, number: u32, time: f64) -> Result<(), SinkError> {
        let Some(frames) = &mut self.member.frames else { return Ok(()) };
        let watch = Watch::start(Kind::Output, "frame");
        frames.submit(number, &mut |frame| self.member.role.fill_frame(time, frame))?;
        self.frame = number + 1;
        self.output += watch.stop();
        Ok(())
    }

    /// Hands over the state last published.
    pub(crate) fn write_checkpoint(&mut self, number: u64) -> Result<(), SinkError> {
        let (Some(checkpoints), Some(state)) = (&mut self.member.checkpoints, self.member.role.state())
        else {
            return Ok(());
        };
        let watch = Watch::start(Kind::Output, "checkpoint");
        let mut group = Published::of(&self.header).save();
        group.groups.insert("role".into(), state.save());
        checkpoints.submit(number, group)?;
        self.output += watch.stop();
        Ok(())
    }

    pub(crate) fn finish(&mut self) -> Result<Written, SinkError> {
        let frames_safe = self.member.frames.take().map_or(Ok(0), |frames| frames.finish());
        let checkpoint_safe =
            self.member.checkpoints.take().map_or(Ok(0), |checkpoints| checkpoints.finish());
        Ok(Written { frames_safe: frames_safe?, checkpoint_safe: checkpoint_safe? as u32 })
    }

    pub(crate) fn report(&mut self, port: &dyn Port) -> Report {
        let times = port.times();
        let [compute, sums, cross] = [self.compute, self.sums, self.cross].map(|time| time.as_secs_f64());
        let costs = self.member.role.costs().of(sums, compute, cross);
        let effects = EffectName::ALL.iter().copied().zip(costs.effects);
        Report {
            name: self.member.role.name().to_string(),
            compute,
            wait: times.wait.as_secs_f64(),
            exchange: times.exchange.as_secs_f64(),
            output: self.output.as_secs_f64(),
            round_trip_us: [0.5, 0.99].map(|share| self.latency.percentile(share)),
            pair_evaluations: self.member.role.pair_evaluations(),
            walls: costs.walls,
            moving_walls: costs.moving_walls,
            interface: cross,
            effects: effects.filter(|(_, seconds)| *seconds > 0.0).collect(),
            energy: self.member.role.ledger().map_or_else(Vec::new, Ledger::entries),
            open_joints: self.member.role.open_joints(),
            jerked_joints: self.member.role.jerked_joints(),
            impulse: self.member.role.impulse(),
        }
    }
}
