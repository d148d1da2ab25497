//! A solid's half-steps: what is due, what was told.

use crate::call::{Code, Fault, same_count};
use halfstep_link::{Expect, LinkConfig, Port, ProcessLink, Processes};
use halfstep_wire::Name;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{
    Audit, Failure, ForceRecord, LAST_STAGE, StateHeader, StateRecord, ability, order, status,
};

/// A half step, as the header has it.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Step {
    number: u64,
    stage: u32,
    reserved: u32,
    time: f64,
    dt: f64,
    next_time: f64,
    span: f64,
}

/// What the launcher says of the run and this solid.
pub(crate) struct Plan {
    config: LinkConfig,
    name: Name,
    place: u32,
}

impl Plan {
    /// Of the run that started this program, which has room for so many particles.
    pub(crate) fn of_run(count: usize) -> Result<Self, Fault> {
        let config = LinkConfig::from_env().map_err(|error| {
            Fault::run(format!("{error}: start this program with `halfstep run SCENE --solid COMMAND`"))
        })?;
        let told = std::env::var("HALFSTEP_NAME").unwrap_or_default();
        let place = config.participants.iter().position(|p| p.name.as_str() == told);
        let place = place.ok_or_else(|| Fault::run(format!("HALFSTEP_NAME: no participant `{told}`")))?;
        let own = config.participants[place];
        if count == 0 || count > own.capacity as usize {
            let room = own.capacity;
            return Err(Fault::new(
                Code::Count,
                format!("{count} particles, where the run has room for 1 to {room}"),
            ));
        }
        Ok(Self { config, name: own.name, place: place as u32 })
    }
}

/// The records of a first state.
pub(crate) fn records(
    position: &[f64],
    velocity: &[f64],
    mass: &[f64],
    density: &[f64],
    clamped: Option<&[u8]>,
) -> Result<Vec<StateRecord>, Fault> {
    for (name, values) in [("mass", mass), ("density", density)] {
        if let Some(k) = values.iter().position(|&x| !(x > 0.0 && x.is_finite())) {
            let text = format!("{name} of particle {k} is {}: it must be positive", values[k]);
            return Err(Fault::new(Code::Value, text));
        }
    }
    let record = |k: usize| StateRecord {
        id: k as u32,
        flags: u32::from(clamped.is_some_and(|clamped| clamped[k] != 0)),
        mass: mass[k],
        density: density[k],
        ..StateRecord::default()
    };
    let mut all: Vec<StateRecord> = (0..mass.len()).map(record).collect();
    place(&mut all, position, velocity)?;
    Ok(all)
}

/// Puts particles where they are now.
fn place(records: &mut [StateRecord], position: &[f64], velocity: &[f64]) -> Result<(), Fault> {
    for (name, values) in [("position", position), ("velocity", velocity)] {
        finite(name, values, 3)?;
    }
    let vectors = position.chunks_exact(3).zip(velocity.chunks_exact(3));
    for (record, (x, v)) in records.iter_mut().zip(vectors) {
        record.position.copy_from_slice(x);
        record.velocity.copy_from_slice(v);
    }
    Ok(())
}

fn finite(name: &str, values: &[f64], width: usize) -> Result<(), Fault> {
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(k) => Err(Fault::new(Code::Value, format!("{name} of particle {} is {}", k / width, values[k]))),
    }
}

/// What the solid does next.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Next {
    Wait,
    Publish,
    Over,
}

/// The solid of a run.
pub(crate) struct Solid {
    link: ProcessLink<Processes>,
    place: u32,
    records: Vec<StateRecord>,
    half_step: HalfStep,
    next: Next,
    dt_limit: f64,
    abilities: u32,
    fluid: Vec<StateRecord>,
    forces: Vec<ForceRecord>,
}

impl Solid {
    /// Connects and publishes the first state.
    pub(crate) fn open(plan: Plan, records: Vec<StateRecord>, own_walls: bool) -> Result<Self, Fault> {
        let mut solid = Self {
            link: ProcessLink::open(&plan.config, plan.name, None)?,
            place: plan.place,
            records,
            half_step: HalfStep::begin(0, 0.0),
            next: Next::Publish,
            dt_limit: 1e30,
            abilities: if own_walls { ability::WALLS_AND_CONTACTS } else { 0 },
            fluid: Vec::new(),
            forces: Vec::new(),
        };
        solid.send()?;
        Ok(solid)
    }

    pub(crate) fn count(&self) -> usize {
        self.records.len()
    }

    fn header(&self) -> StateHeader {
        StateHeader {
            dt_limit: self.dt_limit,
            sub_steps: 1,
            abilities: self.abilities,
            particles: self.records.len() as u64,
            audit: Audit {
                mass: self.records.iter().map(|r| r.mass).sum(),
                gap: f64::INFINITY,
                ..Audit::default()
            },
            ..self.half_step.state_header()
        }
    }

    fn send(&mut self) -> Result<(), Fault> {
        let mut header = self.header();
        for r in &self.records {
            header.audit.kinetic_energy += 0.5 * r.mass * r.velocity.iter().map(|v| v * v).sum::<f64>();
            for (sum, v) in header.audit.momentum.iter_mut().zip(r.velocity) {
                *sum += r.mass * v;
            }
        }
        self.link.send_state(0, &header, &self.records)?;
        self.next = Next::Wait;
        Ok(())
    }

    fn due(&self, next: Next) -> Result<(), Fault> {
        match self.next {
            now if now == next => Ok(()),
            Next::Wait => Err(Fault::state("the state is published: halfstep_wait comes next")),
            Next::Publish => {
                Err(Fault::state("halfstep_wait has told the forces: halfstep_publish comes next"))
            }
            Next::Over => Err(Fault::state("the solid has left the run: only halfstep_close is left")),
        }
    }

    pub(crate) fn wait(&mut self, step: &mut Step, forces: &mut [f64]) -> Result<Code, Fault> {
        self.due(Next::Wait)?;
        let found = self.receive(step, forces);
        if found.is_err() {
            self.next = Next::Over;
        }
        found
    }

    fn receive(&mut self, step: &mut Step, forces: &mut [f64]) -> Result<Code, Fault> {
        let expect = Expect::of(&self.half_step);
        let told = expect.dt(self.half_step.state_header().dt);
        // The fluid waits for room: whoever subscribes takes every message.
        let fluid = self.link.receive_peer(0, 0, &told, &mut self.fluid)?;
        if fluid.status != status::OK {
            return Err(Fault::run("the fluid has ended"));
        }
        let answer = self.link.receive_forces(0, &expect, &mut self.forces)?;
        if answer.order & order::STOP != 0 {
            self.last(status::FINISHED, Failure::default())?;
            return Ok(Code::Stopped);
        }
        for ((to, force), record) in forces.chunks_exact_mut(3).zip(&self.forces).zip(&self.records) {
            to.copy_from_slice(&force.force(record.mass));
        }
        let now = self.half_step.with_step(answer.dt, answer.next_time);
        *step = Step {
            number: answer.step,
            stage: answer.stage,
            reserved: 0,
            time: answer.time,
            dt: answer.dt,
            next_time: answer.next_time,
            span: now.span(),
        };
        self.half_step = now.next();
        self.next = Next::Publish;
        Ok(Code::Ok)
    }

    pub(crate) fn publish(&mut self, position: &[f64], velocity: &[f64]) -> Result<Code, Fault> {
        self.due(Next::Publish)?;
        place(&mut self.records, position, velocity)?;
        self.send()?;
        Ok(Code::Ok)
    }

    pub(crate) fn stress(&mut self, stress: &[f64]) -> Result<Code, Fault> {
        finite("stress", stress, 6)?;
        same_count(stress.len() / 6, self.count())?;
        for (record, stress) in self.records.iter_mut().zip(stress.chunks_exact(6)) {
            record.deviatoric_stress.copy_from_slice(stress);
        }
        Ok(Code::Ok)
    }

    pub(crate) fn limit(&mut self, seconds: f64) -> Result<Code, Fault> {
        if !(seconds > 0.0 && seconds.is_finite()) {
            return Err(Fault::new(Code::Value, format!("a time step of {seconds} s: it must be positive")));
        }
        self.dt_limit = seconds;
        Ok(Code::Ok)
    }

    pub(crate) fn diverged(&mut self, quantity: i32, particle: u32, value: f64) -> Result<Code, Fault> {
        self.due(Next::Publish)?;
        let Some(record) = self.records.get(particle as usize) else {
            let text = format!("particle {particle}, where there are {}", self.records.len());
            return Err(Fault::new(Code::Count, text));
        };
        if !(1..=6).contains(&quantity) {
            return Err(Fault::new(Code::Value, format!("no quantity has the number {quantity}")));
        }
        let failure = Failure {
            participant: self.place,
            quantity: quantity as u32,
            particle,
            value,
            position: record.position,
            ..Failure::default()
        };
        self.last(status::DIVERGED, failure)?;
        Ok(Code::Ok)
    }

    /// Publishes the last message.
    fn last(&mut self, status: u32, failure: Failure) -> Result<(), Fault> {
        self.next = Next::Over;
        let mut header = StateHeader { status, failure, ..self.header() };
        if status == status::FINISHED {
            header.stage = LAST_STAGE;
        }
        Ok(self.link.send_state(0, &header, &[])?)
    }

    pub(crate) fn close(mut self) -> Result<Code, Fault> {
        if self.next != Next::Over {
            self.last(status::FAILED, Failure::default())?;
        }
        Ok(Code::Ok)
    }
}
