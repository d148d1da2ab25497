//! A scene with one phase: the same half-step loop, clock and recorder in one process, nothing exchanged.

use crate::clock::{Clock, Limit, Tick};
use crate::energy::Account;
use crate::error::RunError;
use crate::recorder::{Measured, Recorder};
use halfstep_link::{Expect, LinkError, Port};
use halfstep_role::lockstep::{Member, drive};
use halfstep_role::report::Report;
use halfstep_sph::Phase;
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateHeader, StateRecord};
use std::sync::atomic::{AtomicBool, Ordering};

/// How a run without partner went.
#[derive(Clone, Debug)]
pub struct SoloOutcome {
    /// It was told to stop before its end.
    pub stopped: bool,
    /// Last messages of the participants.
    pub last: Vec<StateHeader>,
    /// What they say about themselves.
    pub reports: Vec<Report>,
}

/// Drives participants that nobody couples to the clock's end or until `stop`.
///
/// # Errors
/// Divergence or output; the last state before a divergence is written as a frame first.
pub fn run_solo(
    members: Vec<Member>,
    clock: &mut Clock,
    recorder: &mut Recorder,
    stop: &AtomicBool,
) -> Result<SoloOutcome, RunError> {
    let names: Vec<Name> = members.iter().map(|member| member.role.name()).collect();
    let phases = members.iter().map(|member| member.role.phase()).collect();
    let count = names.len();
    let mut port = Alone {
        names,
        phases,
        clock,
        recorder,
        stop,
        headers: vec![StateHeader::default(); count],
        probes: vec![Vec::new(); count],
        missing_probes: 0,
        tick: None,
        frame: 0,
        stopped: false,
        grown: None,
        error: None,
    };
    let mut reports = Vec::new();
    let result = drive(members, &mut port, &mut |report| {
        reports.push(report.clone());
        Ok(())
    });
    if let Some(error) = port.error {
        return Err(error);
    }
    match (result, port.grown) {
        (Ok(()), None) => Ok(SoloOutcome { stopped: port.stopped, last: port.headers, reports }),
        (Ok(()), Some(diverged)) => Err(diverged.into()),
        (Err(error), _) => Err(error.into()),
    }
}

/// The coupler's part where there is nothing to couple: time line, recorder and orders.
struct Alone<'a> {
    names: Vec<Name>,
    phases: Vec<Phase>,
    clock: &'a mut Clock,
    recorder: &'a mut Recorder,
    stop: &'a AtomicBool,
    headers: Vec<StateHeader>,
    probes: Vec<Vec<f64>>,
    /// Participants whose probe values of the present row have not come.
    missing_probes: usize,
    tick: Option<Tick>,
    frame: u64,
    stopped: bool,
    /// Energy from nowhere, and whose.
    grown: Option<Diverged>,
    error: Option<RunError>,
}

impl Alone<'_> {
    /// What happens with the state at n, decided once for all participants.
    fn decide(&mut self) -> Result<Tick, RunError> {
        self.stopped = self.stop.load(Ordering::Relaxed);
        let of = self.names.iter().zip(&self.phases).zip(&self.headers);
        let accounts: Vec<Account<'_>> = of
            .clone()
            .map(|((name, phase), header)| Account {
                name: *name,
                phase: *phase,
                audit: Some(&header.audit),
                work: 0.0,
            })
            .collect();
        self.grown = self.recorder.judge(self.clock.step(), self.clock.time(), &accounts);
        let limits: Vec<Limit> =
            of.map(|((name, _), header)| Limit { participant: *name, dt: header.dt_limit }).collect();
        // Energy from nowhere ends the run in order, with its last state on disk.
        let tick = self.clock.tick(&limits, self.stopped || self.grown.is_some())?;
        self.missing_probes = if tick.row { self.names.len() } else { 0 };
        if !tick.row {
            self.note(&tick)?;
        }
        Ok(tick)
    }

    fn note(&mut self, tick: &Tick) -> Result<(), RunError> {
        let of = self.phases.iter().zip(&self.headers).zip(&self.probes);
        let measured: Vec<Measured<'_>> =
            of.map(|((phase, header), probes)| Measured::of(*phase, header, probes)).collect();
        Ok(self.recorder.note(tick, &measured)?)
    }

    fn keep<T>(&mut self, result: Result<T, RunError>) -> Result<T, LinkError> {
        result.map_err(|error| {
            self.error = Some(error);
            LinkError::Aborted
        })
    }
}

impl Port for Alone<'_> {
    fn send_state(
        &mut self,
        member: usize,
        header: &StateHeader,
        _records: &[StateRecord],
    ) -> Result<(), LinkError> {
        self.headers[member] = *header;
        Ok(())
    }

    fn receive_forces(
        &mut self,
        member: usize,
        _expect: &Expect,
        records: &mut Vec<ForceRecord>,
    ) -> Result<ForceHeader, LinkError> {
        records.clear();
        let first = self.headers[member].stage == Stage::First.number();
        let stage = if first { Stage::First } else { Stage::Second };
        if first && member == 0 {
            let decided = self.decide();
            self.tick = Some(self.keep(decided)?);
            self.frame += u64::from(self.tick.is_some_and(|tick| tick.frame));
        }
        let Some(tick) = self.tick else { return Err(LinkError::Aborted) };
        if !first && member + 1 == self.names.len() {
            self.clock.advance(&tick);
        }
        Ok(ForceHeader {
            order: tick.orders(stage),
            frame: self.frame.saturating_sub(1),
            ..HalfStep { stage, ..tick.half_step() }.force_header()
        })
    }

    fn send_probes(
        &mut self,
        member: usize,
        _step: u64,
        _time: f64,
        values: &[f64],
    ) -> Result<(), LinkError> {
        self.probes[member].clear();
        self.probes[member].extend_from_slice(values);
        self.missing_probes = self.missing_probes.saturating_sub(1);
        match self.tick {
            Some(tick) if self.missing_probes == 0 => {
                let noted = self.note(&tick);
                self.keep(noted)
            }
            _ => Ok(()),
        }
    }

    fn participants(&self) -> &[Name] {
        &self.names
    }
}
