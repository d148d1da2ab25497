//! A solid's half-steps: what is due, what was told.

use crate::checkpoint::{Kept, Saved};
use crate::run::{Contact, Run, finite, keep, place, same_count};
use crate::{Error, Particles};
use halfstep_link::{Expect, Port, ProcessLink, Processes};
use halfstep_wire::Name;
use halfstep_wire::failure::Quantity;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{
    Audit, Failure, ForceRecord, LAST_STAGE, StateHeader, StateRecord, ability, order, status,
};

/// A half step. Both stages go from the state at n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// n.
    pub number: u64,
    /// 0: the forces are those at n, and the state at n + 1/2 is published next. 1: the forces are those at n + 1/2,
    /// and the state at n + 1 is published.
    pub stage: u32,
    /// At n, s.
    pub time: f64,
    /// Length of the whole step, s.
    pub dt: f64,
    /// At n + 1, s.
    pub next_time: f64,
    /// How far this stage goes from n, s: dt / 2, then dt.
    pub span: f64,
}

/// What the solid does next.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Next {
    Wait,
    Publish,
    Over,
}

/// The solid of a run. Where it is dropped before the run is over, the run ends with it: the solid has failed.
#[derive(Debug)]
pub struct Solid {
    link: ProcessLink<Processes>,
    name: Name,
    place: u32,
    records: Vec<StateRecord>,
    half_step: HalfStep,
    next: Next,
    dt_limit: f64,
    sub_steps: u32,
    stored_energy: f64,
    abilities: u32,
    kept: Kept,
    /// What a checkpoint of the state has that was published last, where that is one at n, beside what is kept: that
    /// stays as it is until the forces on the state are told.
    published: Saved,
    /// Number of the last checkpoint that is on disk.
    safe: u32,
    fluid: Vec<StateRecord>,
    forces: Vec<ForceRecord>,
    told: Vec<[f64; 3]>,
}

/// What a solid begins with.
pub(crate) struct Start {
    pub(crate) link: ProcessLink<Processes>,
    pub(crate) name: Name,
    /// Among the participants.
    pub(crate) place: u32,
    pub(crate) records: Vec<StateRecord>,
    pub(crate) saved: Saved,
    pub(crate) abilities: u32,
    pub(crate) kept: Kept,
}

impl Solid {
    /// Publishes the first state.
    pub(crate) fn begin(start: Start) -> Result<Self, Error> {
        let Start { link, name, place, records, saved, abilities, kept } = start;
        let mut solid = Self {
            link,
            name,
            place,
            told: vec![[0.0; 3]; records.len()],
            records,
            half_step: HalfStep::begin(saved.step, saved.time),
            next: Next::Publish,
            dt_limit: saved.dt_limit,
            sub_steps: saved.sub_steps,
            stored_energy: saved.stored_energy,
            abilities,
            kept,
            published: Saved::default(),
            safe: 0,
            fluid: Vec::new(),
            forces: Vec::new(),
        };
        solid.send()?;
        Ok(solid)
    }

    /// Joins the run that started this program, and publishes the first state.
    ///
    /// # Errors
    /// As [`Run::of_environment`] and [`Run::join`].
    pub fn join(particles: &Particles, contact: Contact) -> Result<Self, Error> {
        Run::of_environment()?.join(particles, contact)
    }

    /// Number of its particles.
    pub fn count(&self) -> usize {
        self.records.len()
    }

    /// Forces on its particles in the state that was published last, N (2D: N/m), as [`Self::wait`] told them.
    pub fn forces(&self) -> &[[f64; 3]] {
        &self.told
    }

    fn header(&self) -> StateHeader {
        StateHeader {
            dt_limit: self.dt_limit,
            sub_steps: self.sub_steps,
            abilities: self.abilities,
            checkpoint_safe: self.safe,
            particles: self.records.len() as u64,
            audit: Audit {
                mass: self.records.iter().map(|r| r.mass).sum(),
                gap: f64::INFINITY,
                stored_energy: self.stored_energy,
                ..Audit::default()
            },
            ..self.half_step.state_header()
        }
    }

    fn send(&mut self) -> Result<(), Error> {
        let mut header = self.header();
        for r in &self.records {
            header.audit.kinetic_energy += 0.5 * r.mass * r.velocity.iter().map(|v| v * v).sum::<f64>();
            for (sum, v) in header.audit.momentum.iter_mut().zip(r.velocity) {
                *sum += r.mass * v;
            }
        }
        if self.abilities & ability::CHECKPOINTS != 0 && header.stage == 0 {
            self.published = self.saved(header.step, header.time);
        }
        self.link.send_state(0, &header, &self.records)?;
        self.next = Next::Wait;
        Ok(())
    }

    fn due(&self, next: Next) -> Result<(), Error> {
        match self.next {
            now if now == next => Ok(()),
            Next::Wait => Err(Error::State("the state is published: the forces on it are waited for next")),
            Next::Publish => Err(Error::State("the forces are told: the state after them is published next")),
            Next::Over => Err(Error::State("the solid has left the run")),
        }
    }

    /// Waits for the forces on the state that was published last; `None` where the run has ended as it should.
    ///
    /// # Errors
    /// [`Error::State`]: a state is due. [`Error::Run`]: another process has ended, or a checkpoint could not be
    /// written; the solid has left the run then.
    pub fn wait(&mut self) -> Result<Option<Step>, Error> {
        self.due(Next::Wait)?;
        let found = self.receive();
        if found.is_err() {
            self.next = Next::Over;
        }
        found
    }

    fn receive(&mut self) -> Result<Option<Step>, Error> {
        let expect = Expect::of(&self.half_step);
        let told = expect.dt(self.half_step.state_header().dt);
        // The fluid waits for room: whoever subscribes takes every message.
        let fluid = self.link.receive_peer(0, 0, &told, &mut self.fluid)?;
        if fluid.status != status::OK {
            return Err(Error::Run("the fluid has ended".into()));
        }
        let answer = self.link.receive_forces(0, &expect, &mut self.forces)?;
        if answer.order & order::WRITE_CHECKPOINT != 0 && self.abilities & ability::CHECKPOINTS != 0 {
            self.published.kept.clone_from(&self.kept);
            if let Err(error) = self.published.write(self.name.as_str(), answer.checkpoint) {
                // The run shall not wait for somebody who cannot go on.
                let _ = self.last(status::FAILED, Failure::default());
                return Err(error);
            }
            self.safe = answer.checkpoint as u32;
        }
        if answer.order & order::STOP != 0 {
            self.last(status::FINISHED, Failure::default())?;
            return Ok(None);
        }
        for ((told, force), record) in self.told.iter_mut().zip(&self.forces).zip(&self.records) {
            *told = force.force(record.mass);
        }
        let now = self.half_step.with_step(answer.dt, answer.next_time);
        let step = Step {
            number: answer.step,
            stage: answer.stage,
            time: answer.time,
            dt: answer.dt,
            next_time: answer.next_time,
            span: now.span(),
        };
        self.half_step = now.next();
        self.next = Next::Publish;
        Ok(Some(step))
    }

    /// Publishes the state after the half step that [`Self::wait`] told: positions, m, and velocities, m/s.
    ///
    /// # Errors
    /// [`Error::State`]: forces are due. [`Error::Count`], [`Error::Value`]: of the state; nothing is published then.
    pub fn publish(&mut self, position: &[[f64; 3]], velocity: &[[f64; 3]]) -> Result<(), Error> {
        self.due(Next::Publish)?;
        place(&mut self.records, position, velocity)?;
        self.send()
    }

    /// Gives the states from now on a stress, Pa, xx, yy, zz, xy, yz, xz, positive in tension: for pictures and probes.
    ///
    /// # Errors
    /// [`Error::Count`], [`Error::Value`].
    pub fn stress(&mut self, stress: &[[f64; 6]]) -> Result<(), Error> {
        finite("stress", stress)?;
        same_count(stress.len(), self.count())?;
        for (record, stress) in self.records.iter_mut().zip(stress) {
            record.deviatoric_stress = *stress;
        }
        Ok(())
    }

    /// Keeps numbers that a checkpoint of the state that is published next has: as [`Run::keep`] for the first state.
    ///
    /// # Errors
    /// [`Error::Value`]: one is not finite. [`Error::State`]: nothing was kept of the first state, so the run knows
    /// that the solid writes no checkpoints; or the state is published.
    pub fn keep(&mut self, name: &str, values: &[f64]) -> Result<(), Error> {
        if self.abilities & ability::CHECKPOINTS == 0 {
            return Err(Error::State(
                "what a checkpoint has is kept of the first state, before the solid joins",
            ));
        }
        self.due(Next::Publish)?;
        keep(&mut self.kept, name, values)
    }

    fn saved(&self, step: u64, time: f64) -> Saved {
        let of = |value: fn(&StateRecord) -> f64| self.records.iter().map(value).collect();
        Saved {
            step,
            time,
            dt_limit: self.dt_limit,
            sub_steps: self.sub_steps,
            stored_energy: self.stored_energy,
            stress: self.records.iter().map(|r| r.deviatoric_stress).collect(),
            pressure: of(|r| r.pressure),
            density: of(|r| r.density),
            kept: Kept::new(),
        }
    }

    /// Gives the states from now on a pressure, Pa: for pictures and probes.
    ///
    /// # Errors
    /// [`Error::Count`], [`Error::Value`].
    pub fn pressure(&mut self, pressure: &[f64]) -> Result<(), Error> {
        self.column("pressure", pressure, f64::is_finite, |record, pressure| record.pressure = pressure)
    }

    /// Gives the states from now on a density, kg/m³.
    ///
    /// # Errors
    /// [`Error::Count`], [`Error::Value`].
    pub fn density(&mut self, density: &[f64]) -> Result<(), Error> {
        let is_density = |x: f64| x > 0.0 && x.is_finite();
        self.column("density", density, is_density, |record, density| record.density = density)
    }

    fn column(
        &mut self,
        name: &str,
        values: &[f64],
        is_good: fn(f64) -> bool,
        set: fn(&mut StateRecord, f64),
    ) -> Result<(), Error> {
        same_count(values.len(), self.count())?;
        if let Some(k) = values.iter().position(|&x| !is_good(x)) {
            return Err(Error::Value(format!("{name} of particle {k} is {}", values[k])));
        }
        self.records.iter_mut().zip(values).for_each(|(record, &value)| set(record, value));
        Ok(())
    }

    /// Says in how many steps of its own the solid advances, for run.json.
    ///
    /// # Errors
    /// [`Error::Value`]: none.
    pub fn sub_steps(&mut self, count: u32) -> Result<(), Error> {
        if count == 0 {
            return Err(Error::Value("no sub-steps: at least one".into()));
        }
        self.sub_steps = count;
        Ok(())
    }

    /// Says what energy the solid stores from the next state on, J (2D: J/m), for the ledger.
    ///
    /// # Errors
    /// [`Error::Value`]: it is not finite.
    pub fn stored_energy(&mut self, joules: f64) -> Result<(), Error> {
        if !joules.is_finite() {
            return Err(Error::Value(format!("a stored energy of {joules}")));
        }
        self.stored_energy = joules;
        Ok(())
    }

    /// Says the largest time step that the solid allows from the next state on, s.
    ///
    /// # Errors
    /// [`Error::Value`]: it is not positive.
    pub fn dt_limit(&mut self, seconds: f64) -> Result<(), Error> {
        if !(seconds > 0.0 && seconds.is_finite()) {
            return Err(Error::Value(format!("a time step of {seconds} s: it must be positive")));
        }
        self.dt_limit = seconds;
        Ok(())
    }

    /// Ends the run: a quantity of a particle left its bounds.
    ///
    /// # Errors
    /// [`Error::State`]: forces are due. [`Error::Count`]: there is no such particle.
    pub fn diverged(&mut self, quantity: Quantity, particle: u32, value: f64) -> Result<(), Error> {
        self.due(Next::Publish)?;
        let Some(record) = self.records.get(particle as usize) else {
            return Err(Error::Count(format!("particle {particle}, where there are {}", self.records.len())));
        };
        let failure = Failure {
            participant: self.place,
            quantity: quantity as u32,
            particle,
            value,
            position: record.position,
            ..Failure::default()
        };
        self.last(status::DIVERGED, failure)
    }

    /// Publishes the last message.
    fn last(&mut self, status: u32, failure: Failure) -> Result<(), Error> {
        self.next = Next::Over;
        let mut header = StateHeader { status, failure, ..self.header() };
        if status == status::FINISHED {
            header.stage = LAST_STAGE;
        }
        Ok(self.link.send_state(0, &header, &[])?)
    }

    /// Leaves the run. Where it is not over it ends with it: the solid has failed.
    ///
    /// # Errors
    /// [`Error::Run`]: nobody could be told.
    pub fn close(mut self) -> Result<(), Error> {
        self.leave()
    }

    fn leave(&mut self) -> Result<(), Error> {
        match self.next {
            Next::Over => Ok(()),
            _ => self.last(status::FAILED, Failure::default()),
        }
    }
}

impl Drop for Solid {
    fn drop(&mut self) {
        // Nobody is there to be told that nobody could be told.
        let _ = self.leave();
    }
}
