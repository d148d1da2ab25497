//! The coupler's half-steps: checks the states, evaluates the cross-phase forces, decides dt and orders.

mod checkpoint;

use crate::clock::{Limit, Tick};
use crate::course::{Course, Progress};
use crate::energy::Account;
use crate::error::RunError;
use crate::external::ExternalSolid;
use crate::recorder::Measured;
pub use crate::solids::{ContactSummary, Done};
use crate::solids::{External, Solids, Work};
use halfstep_link::{CouplerPort, Expect, StateMessage};
use halfstep_output::run_json::{ForceKind, RoleSeconds};
use halfstep_role::balance::Balance;
use halfstep_role::timeline::{self, Kind, Watch};
use halfstep_scene::Scene;
use halfstep_sph::Phase;
use halfstep_sph::lane::Isa;
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{ForceHeader, StateHeader, ability, order, status};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Half-steps between two checks that action equals reaction.
const AUDIT_INTERVAL: u64 = 50;

/// How a run ended.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// It was told to stop before its end.
    pub stopped: bool,
    /// Last messages of the participants.
    pub last: Vec<StateHeader>,
    /// Where the coupler's time went.
    pub seconds: RoleSeconds,
    /// Largest relative mismatch of the forces on both sides.
    pub action_reaction: f64,
    /// Of the fluid's forces on all solids, as they were sent.
    pub impulse: Balance,
    /// Consistency checks passed.
    pub checks: u64,
    /// Pairs listed in the coupler's sums.
    pub pair_evaluations: u64,
    /// What contact did to each pair of solids.
    pub contacts: Vec<ContactSummary>,
    /// What each kind of force did to each solid, by its index in the scene.
    pub forces: Vec<(usize, ForceKind, Done)>,
}

/// The coupler of a run, whatever carries its messages. A step is [`Self::first`], [`Self::note`], [`Self::second`].
pub struct Coupler<P: CouplerPort, const D: usize> {
    /// The exchange.
    pub port: P,
    phases: Vec<Phase>,
    solids: Solids<D>,
    /// Probe values of each participant at the present row.
    probes: Vec<Vec<f64>>,
    /// What each participant said in its first message that it does; empty before.
    abilities: Vec<u32>,
    /// States of the present half-step.
    states: Vec<P::State>,
    half_step: HalfStep,
    /// What happens with the state at n.
    tick: Option<Tick>,
    /// Energy from nowhere, and whose: the run ends with this state.
    grown: Option<Diverged>,
    stopped: bool,
    /// The run goes on from a checkpoint: the first states must be those that it was made of.
    resumed: bool,
    half_steps: u64,
    action_reaction: f64,
    checks: u64,
    pair_evaluations: u64,
    compute: Duration,
    frame: u64,
}

impl<P: CouplerPort, const D: usize> Coupler<P, D> {
    /// For a scene, on a port whose participants are connected, computing with an instruction set that the processor
    /// has. `external` has an entry for each solid: what stands in for what an external solid does not do itself.
    pub fn new(port: P, scene: &Scene, external: Vec<Option<ExternalSolid>>, isa: Isa) -> Self {
        let participants = port.participants();
        let phases = scene.participants().into_iter().map(|participant| participant.phase).collect();
        Self {
            port,
            phases,
            solids: Solids::new(scene, external, isa),
            probes: vec![Vec::new(); participants],
            abilities: Vec::new(),
            states: Vec::with_capacity(participants),
            half_step: HalfStep::begin(0, 0.0),
            tick: None,
            grown: None,
            stopped: false,
            resumed: false,
            half_steps: 0,
            action_reaction: 0.0,
            checks: 0,
            pair_evaluations: 0,
            compute: Duration::ZERO,
            frame: 0,
        }
    }

    /// Runs to the clock's end or until it is told to stop.
    ///
    /// # Errors
    /// A participant failed, died or disagrees; the log cannot be written.
    pub fn run(&mut self, course: &mut Course) -> Result<Outcome, RunError> {
        while self.first(course)? {
            self.note(course)?;
            self.second(course)?;
        }
        self.note(course)?;
        self.end(course)
    }

    /// The first half of a step: takes the states at n and answers them. Returns whether the run goes on.
    ///
    /// # Errors
    /// As for [`Self::run`].
    pub fn first(&mut self, course: &mut Course) -> Result<bool, RunError> {
        let began = timeline::begin(&self.half_step, 1);
        let _turn = timeline::turn(Name::COUPLER);
        self.receive(course, &Expect::of(&self.half_step))?;
        if self.abilities.is_empty() {
            self.abilities = self.states.iter().map(|state| state.header().abilities).collect();
            let unable = self.abilities.iter().position(|abilities| abilities & ability::CHECKPOINTS == 0);
            if let Some(place) = unable.filter(|_| course.must_save) {
                return Err(RunError::NoCheckpoints { participant: self.port.name(place) });
            }
            let changed = self.solids.leave_walls(&self.states, self.resumed);
            match self.resumed {
                true => {
                    self.check_resumed(changed)?;
                    course.go_on()?;
                }
                false => self.solids.begin(&self.states),
            }
            let first = self.solids.first_messages(&self.states);
            course.recorder.compare_first(first, self.resumed);
            for (place, walls) in self.solids.walls() {
                walls.say(self.port.name(place), &course.recorder);
            }
        }
        self.complete_checkpoint(course)?;
        self.stopped = course.stop.load(Ordering::Relaxed);
        let checks = timeline::phase("balance and time step");
        let limit = |(k, state): (usize, &P::State)| Limit {
            participant: self.port.name(k),
            dt: state.header().dt_limit,
        };
        let contact = self.solids.contact_limit().map(|dt| Limit { participant: Name::COUPLER, dt });
        let limits: Vec<Limit> = self.states.iter().enumerate().map(limit).chain(contact).collect();
        // Before anything of this step is noted: a run that goes on from here notes it.
        let saved = self.save_if_due(course, &limits)?;
        let work = self.solids.work(&self.states);
        let accounts: Vec<Account<'_>> = self.accounts(&work);
        let HalfStep { step, time, .. } = self.half_step;
        self.grown = course.recorder.judge(step, time, &accounts);
        // Energy from nowhere ends the run in order, with its last state on disk.
        let tick = course.clock.tick(&limits, self.stopped || self.grown.is_some())?;
        let checkpoint = match (saved, &mut course.checkpoints, &self.grown) {
            (Some(saved), Some(checkpoints), None) => {
                Some(checkpoints.begin(&saved, &course.clock, self.frame)?)
            }
            _ => None,
        };
        drop(checks);
        self.half_step = tick.half_step();
        self.tick = Some(tick);
        self.answer(&tick, checkpoint)?;
        timeline::end(Name::COUPLER, began);
        Ok(tick.dt.is_some())
    }

    /// Takes what the participants measured on the state at n where a row is due, and notes it. The frames of external
    /// solids are written.
    ///
    /// # Errors
    /// As for [`Self::run`].
    pub fn note(&mut self, course: &mut Course) -> Result<(), RunError> {
        let Some(tick) = self.tick else { return Ok(()) };
        let _turn = timeline::turn(Name::COUPLER);
        self.measure(&course.progress, &tick)?;
        let _phase = timeline::phase_of(Kind::Output, "recorder");
        let of = self.phases.iter().zip(&self.states).zip(&self.probes);
        let measured: Vec<Measured<'_>> =
            of.map(|((phase, state), probes)| Measured::of(*phase, state.header(), probes)).collect();
        course.recorder.note(&tick, &measured)?;
        self.states.clear();
        Ok(())
    }

    /// The second half of a step: takes the states at n + 1/2 and answers them.
    ///
    /// # Errors
    /// As for [`Self::run`].
    pub fn second(&mut self, course: &mut Course) -> Result<(), RunError> {
        let Some(tick) = self.tick else { return Ok(()) };
        self.half_step = self.half_step.next();
        let began = timeline::begin(&self.half_step, 1);
        let _turn = timeline::turn(Name::COUPLER);
        self.receive(course, &Expect::of(&self.half_step))?;
        self.complete_checkpoint(course)?;
        self.answer(&tick, None)?;
        self.solids.book(self.half_step.dt);
        self.states.clear();
        course.clock.advance(&tick);
        timeline::end(Name::COUPLER, began);
        self.half_step = self.half_step.next();
        Ok(())
    }

    /// Takes the last messages of a run that was told to stop.
    ///
    /// # Errors
    /// As for [`Self::run`].
    pub fn end(&mut self, course: &mut Course) -> Result<Outcome, RunError> {
        timeline::finish();
        self.receive(course, &Expect::last(self.half_step.step))?;
        self.solids.finish()?;
        // All frames of external solids are on disk.
        self.complete_checkpoint(course)?;
        self.checks += self.states.len() as u64;
        if let Some(diverged) = self.grown.take() {
            return Err(diverged.into());
        }
        let last = self.states.iter().map(|state| *state.header()).collect();
        self.states.clear();
        Ok(self.outcome(last))
    }

    fn accounts<'a>(&'a self, work: &[Work]) -> Vec<Account<'a>> {
        let account = |(place, state): (usize, &'a P::State)| Account {
            name: self.port.name(place),
            phase: self.phases[place],
            audit: (!self.solids.is_external(place)).then_some(&state.header().audit),
            work: work[place].fluid,
            contact: work[place].contact,
        };
        self.states.iter().enumerate().map(account).collect()
    }

    /// All states of a half-step. The solids' first: where all are there the order does not matter, and the fluid waits
    /// for the solids' first messages before it sends its own.
    fn receive(&mut self, course: &mut Course, expect: &Expect) -> Result<(), RunError> {
        let (first_solid, participants) = (self.solids.first, self.phases.len());
        self.states.clear();
        for place in (first_solid..participants).chain(0..first_solid) {
            course.progress.await_message(place);
            let (from, times) = (self.port.name(place), P::times);
            let take = |port: &mut P| port.receive_state(place, expect);
            let state = timeline::receive(&mut self.port, "wait for state", from, times, take)?;
            course.progress.note_message();
            self.reject_failure(place, state.header())?;
            self.states.push(state);
        }
        self.states.rotate_right(first_solid);
        if expect.is_last() {
            return Ok(());
        }
        let _phase = timeline::phase("checks");
        let dt = self.tick.and_then(|tick| tick.dt).unwrap_or_default();
        let remark = self.solids.check(&self.states, dt, (expect.step, self.half_step.stage.number()))?;
        remark.into_iter().for_each(|remark| course.recorder.note_warning(remark));
        Ok(())
    }

    fn reject_failure(&self, place: usize, header: &StateHeader) -> Result<(), RunError> {
        let role = self.port.name(place);
        match header.status {
            status::OK | status::FINISHED => Ok(()),
            status::DIVERGED => {
                let names: Vec<Name> = (0..self.port.participants()).map(|k| self.port.name(k)).collect();
                Err(Diverged::of_message(role, &names, header).into())
            }
            _ => Err(RunError::RoleFailed { role, step: header.step, said: None }),
        }
    }

    /// Fetches the probe values of the state at n where a row is due, and writes the frames of external solids.
    fn measure(&mut self, progress: &Progress, tick: &Tick) -> Result<(), RunError> {
        for (place, state) in self.states.iter().enumerate() {
            let values = &mut self.probes[place];
            values.clear();
            let measures = self.abilities[place] & ability::PROBES != 0;
            if let Some(external) = self.solids.external(place) {
                if tick.frame {
                    external.solid.write(self.frame - 1, tick.time, state.records())?;
                }
                if !measures {
                    if tick.row {
                        let External { solid, forces, contact } = external;
                        values.extend_from_slice(solid.measure(state.records(), forces, contact));
                    }
                    continue;
                }
            }
            if tick.row {
                let (from, times) = (self.port.name(place), P::times);
                let take = |port: &mut P| port.receive_probes(place, tick.step, values);
                progress.await_message(place);
                timeline::receive(&mut self.port, "wait for probes", from, times, take)?;
                self.solids.part_contact(place, state.records(), values);
                progress.note_message();
            }
        }
        Ok(())
    }

    fn answer(&mut self, tick: &Tick, checkpoint: Option<u64>) -> Result<(), RunError> {
        let watch = Watch::start(Kind::Compute, "cross force");
        self.checks += self.states.len() as u64;
        let mut header = self.half_step.force_header();
        header.order = tick.orders(self.half_step.stage);
        if let Some(number) = checkpoint {
            header.order |= order::WRITE_CHECKPOINT;
            header.checkpoint = number;
        }
        if header.order & order::WRITE_FRAME != 0 {
            header.frame = self.frame;
            self.frame += 1;
        }
        // The last state has no step: contacts then take that of their limit.
        let dt = tick.dt.unwrap_or(f64::INFINITY);
        self.pair_evaluations += self.solids.evaluate(&self.states, [self.half_step.before(), dt]);
        self.compute += watch.stop();
        for (place, forces) in self.solids.answers() {
            let epoch = self.states[place].header().epoch;
            let _phase = timeline::phase_of(Kind::Message, "send");
            self.port.send_forces(place, &ForceHeader { epoch, ..header }, forces)?;
        }
        let watch = Watch::start(Kind::Compute, "audit");
        if self.half_steps.is_multiple_of(AUDIT_INTERVAL)
            && let Some(mismatch) = self.solids.audit(&self.states)
        {
            self.action_reaction = self.action_reaction.max(mismatch);
            self.checks += 1;
        }
        self.half_steps += 1;
        self.compute += watch.stop();
        Ok(())
    }

    fn outcome(&self, last: Vec<StateHeader>) -> Outcome {
        let times = self.port.times();
        Outcome {
            stopped: self.stopped,
            last,
            seconds: RoleSeconds {
                compute: self.compute.as_secs_f64(),
                wait: times.wait.as_secs_f64(),
                exchange: times.exchange.as_secs_f64(),
                output: 0.0,
            },
            action_reaction: self.action_reaction,
            impulse: self.solids.impulse,
            checks: self.checks,
            pair_evaluations: self.pair_evaluations,
            contacts: self.solids.contacts(),
            forces: self.solids.forces_by_kind(),
        }
    }
}

/// Hash over all participants, in their order.
pub fn combined_hash<'a>(last: impl IntoIterator<Item = &'a StateHeader>) -> u64 {
    let hashes = last.into_iter().enumerate();
    hashes.fold(0, |hash, (place, header)| hash ^ header.state_hash.rotate_left(place as u32))
}
