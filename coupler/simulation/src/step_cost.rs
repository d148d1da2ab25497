//! What a step of a participant costs: the half-step loop of a run for a few steps, with a coupler that only counts.

use halfstep_link::{Expect, LinkError, Port};
use halfstep_role::Member;
use halfstep_role::lockstep::drive;
use halfstep_role::role::Role;
use halfstep_wire::Name;
use halfstep_wire::half_step::Stage;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateHeader, StateRecord, order, status};
use std::time::Instant;

/// Steps that are timed.
const STEPS: u64 = 4;

/// Seconds of a participant's own step of length `dt`, s: the fastest of a few, without the other phase; `None` where
/// it leaves its bounds.
pub(crate) fn step_cost(role: Box<dyn Role>, dt: f64) -> Option<f64> {
    let mut port = Stopwatch {
        names: [role.name()],
        dt,
        last: StateHeader::default(),
        began: None,
        best: f64::INFINITY,
    };
    let member = Member::new(role);
    drive(vec![member], &mut port, &mut |_| Ok(())).ok()?;
    Some(port.best)
}

/// Lets a participant go on for some steps and takes the time from one to the next.
struct Stopwatch {
    names: [Name; 1],
    dt: f64,
    last: StateHeader,
    began: Option<Instant>,
    best: f64,
}

impl Port for Stopwatch {
    fn send_state(
        &mut self,
        _member: usize,
        header: &StateHeader,
        _records: &[StateRecord],
    ) -> Result<(), LinkError> {
        if header.status == status::OK && header.stage == Stage::First.number() {
            let now = Instant::now();
            let step = self.began.map_or(f64::INFINITY, |began| (now - began).as_secs_f64());
            self.best = self.best.min(step);
            self.began = Some(now);
        }
        self.last = *header;
        Ok(())
    }

    fn receive_forces(
        &mut self,
        _member: usize,
        _expect: &Expect,
        records: &mut Vec<ForceRecord>,
    ) -> Result<ForceHeader, LinkError> {
        records.clear();
        let StateHeader { step, stage, time, .. } = self.last;
        let order = if step < STEPS { order::GO } else { order::STOP };
        let next_time = time + self.dt;
        Ok(ForceHeader { order, step, stage, time, dt: self.dt, next_time, ..ForceHeader::default() })
    }

    fn participants(&self) -> &[Name] {
        &self.names
    }
}
