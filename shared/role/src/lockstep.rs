//! The one half-step loop: drives the participants of a process through whatever carries their messages.

use crate::awake::Awake;
use crate::member::Member;
use crate::report::Report;
use crate::role::{Peer, Role};
use crate::timeline::{self, Kind};
use crate::track::{Track, Written};
use halfstep_link::{Expect, Port};
use halfstep_sph::Phase;
use halfstep_wire::Name;
use halfstep_wire::frame::SinkError;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{LAST_STAGE, StateHeader, order, status};

pub use crate::error::RoleError;

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

/// Place of the participant that failed, and why.
type Failed = (usize, RoleError);

/// Participants in lock-step, driven half-step by half-step.
pub struct Lockstep {
    tracks: Vec<Track>,
    half_step: HalfStep,
    /// Time of the participants' own states, s.
    at: f64,
    begun: bool,
    awake: Awake,
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
        let begins =
            |track: &Track| track.member.resumed.as_ref().map_or((0, 0.0), |from| (from.step, from.time));
        let (step, time) = tracks.first().map_or((0, 0.0), begins);
        if tracks.iter().any(|track| begins(track) != (step, time)) {
            return Err(RoleError::Start("the participants' checkpoints are of different steps".into()));
        }
        Ok(Self {
            tracks,
            half_step: HalfStep::begin(step, time),
            at: time,
            begun: false,
            awake: Awake::default(),
        })
    }

    /// The owners of particles, in the order of the members.
    pub fn roles(&self) -> impl Iterator<Item = &dyn Role> {
        self.tracks.iter().map(|track| &*track.member.role)
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
        // What costs are measured by is no half-step.
        timeline::finish();
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
                state_hash: track.member.role.state_hash(),
                ..track.header
            };
            port.send_state(k, &header, &[])?;
        }
        Ok(())
    }

    /// The fluid needs the solids' first states to choose what it publishes.
    fn begin(&mut self, port: &mut dyn Port) -> Result<(), Failed> {
        let half_step = self.half_step;
        let fluid = |track: &Track| track.member.role.phase() == Phase::Fluid;
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
        all.try_for_each(|(k, track)| {
            let _turn = timeline::turn(track.member.role.name());
            part(k, track).map_err(|error| (k, error))
        })
    }

    fn exchange_and_advance(&mut self, port: &mut dyn Port) -> Result<bool, Failed> {
        let half_step = self.half_step;
        let began = timeline::begin(&half_step, self.tracks.len());
        let expect = Expect::of(&half_step);
        self.awake.wake();
        match std::mem::replace(&mut self.begun, true) {
            true => self.each(|k, track| track.publish_to(port, k, &half_step))?,
            false => self.begin(port)?,
        }
        self.each(|_, track| {
            track.own_sums();
            Ok(())
        })?;
        self.each(|k, track| {
            if !std::mem::take(&mut track.have_peers) {
                track.receive_peers(port, k, &expect)?;
            }
            track.cross_sums(port, k, &half_step)
        })?;
        let (mut told, mut stopped, mut at) = (half_step, false, self.at);
        let awake = self.awake.clone();
        let answered = self.each(|k, track| {
            // At the first stage the answer brings the time step.
            let answer = timeline::receive(
                port,
                "wait for forces",
                Name::COUPLER,
                |port| port.times(),
                |port| port.receive_forces(k, &expect, &mut track.forces),
            )?;
            track.latency.add(track.sent.elapsed());
            told = half_step.with_step(answer.dt, answer.next_time);
            at = told.after();
            if answer.order & order::WRITE_FRAME != 0 {
                track.write_frame(answer.frame as u32, told.time).map_err(RoleError::Output)?;
            }
            if answer.order & order::SEND_PROBES != 0 {
                let _phase = timeline::phase_of(Kind::Output, "probes");
                track.probes.clear();
                track.member.role.probes(&mut track.probes);
                port.send_probes(k, told.step, told.time, &track.probes)?;
            }
            if answer.order & order::WRITE_CHECKPOINT != 0 {
                track.write_checkpoint(answer.checkpoint).map_err(RoleError::Output)?;
            }
            // All participants are stopped at the same state.
            stopped = answer.order & order::STOP != 0;
            if !stopped {
                awake.wake();
                track.advance(&told)?;
            }
            timeline::end(track.member.role.name(), began);
            Ok(())
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
            RoleError::Diverged(diverged) => diverged.write_to(port.participants(), &mut header),
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
            let _turn = timeline::turn(track.member.role.name());
            let written = track.write_frame(track.frame, self.at);
            written.unwrap_or_else(|error| tracing::warn!("the last frame is missing: {error}"));
        }
    }
}
