//! A solid's half-steps: what is due, what was told.

use crate::{Error, Particles};
use halfstep_link::{Expect, LinkConfig, Port, ProcessLink, Processes};
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

/// Who holds the solid against walls and other solids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Contact {
    /// The coupler, where the scene has such contacts.
    #[default]
    Coupler,
    /// The solid itself.
    Own,
}

/// What the launcher says of the run and this solid.
#[derive(Debug)]
pub struct Run {
    config: LinkConfig,
    name: Name,
    place: u32,
    capacity: u32,
}

impl Run {
    /// The run that started this program.
    ///
    /// # Errors
    /// [`Error::Run`]: there is none, or it speaks another version.
    pub fn of_environment() -> Result<Self, Error> {
        let config = LinkConfig::from_env().map_err(|error| {
            Error::Run(format!("{error}: start this program with `halfstep run SCENE --solid COMMAND`"))
        })?;
        let told = std::env::var("HALFSTEP_NAME").unwrap_or_default();
        let place = config.participants.iter().position(|p| p.name.as_str() == told);
        let place = place.ok_or_else(|| Error::Run(format!("HALFSTEP_NAME: no participant `{told}`")))?;
        let own = config.participants[place];
        Ok(Self { config, name: own.name, place: place as u32, capacity: own.capacity })
    }

    /// Whether there is room for so many particles.
    ///
    /// # Errors
    /// [`Error::Count`]: there is not, or there are none.
    pub fn room_for(&self, count: usize) -> Result<(), Error> {
        let room = self.capacity as usize;
        match (1..=room).contains(&count) {
            true => Ok(()),
            false => Err(Error::Count(format!("{count} particles, where the run has room for 1 to {room}"))),
        }
    }

    /// Joins it with these particles and publishes their first state.
    ///
    /// # Errors
    /// [`Error::Count`], [`Error::Value`]: of the particles. [`Error::Run`]: the run has ended.
    pub fn join(self, particles: &Particles, contact: Contact) -> Result<Solid, Error> {
        self.room_for(particles.count())?;
        let records = records(particles)?;
        let mut solid = Solid {
            link: ProcessLink::open(&self.config, self.name, None)?,
            place: self.place,
            told: vec![[0.0; 3]; records.len()],
            records,
            half_step: HalfStep::begin(0, 0.0),
            next: Next::Publish,
            dt_limit: UNLIMITED,
            abilities: if contact == Contact::Own { ability::WALLS_AND_CONTACTS } else { 0 },
            fluid: Vec::new(),
            forces: Vec::new(),
        };
        solid.send()?;
        Ok(solid)
    }
}

/// A time step that is none: the solid allows any, s.
const UNLIMITED: f64 = 1e30;

/// The records of a first state.
fn records(particles: &Particles) -> Result<Vec<StateRecord>, Error> {
    let Particles { position, velocity, mass, density, clamped } = particles;
    same_count(density.len(), mass.len())?;
    same_count(clamped.len(), mass.len())?;
    for (name, values) in [("mass", mass), ("density", density)] {
        if let Some(k) = values.iter().position(|&x| !(x > 0.0 && x.is_finite())) {
            let text = format!("{name} of particle {k} is {}: it must be positive", values[k]);
            return Err(Error::Value(text));
        }
    }
    let record = |k: usize| StateRecord {
        id: k as u32,
        flags: u32::from(clamped[k]),
        mass: mass[k],
        density: density[k],
        ..StateRecord::default()
    };
    let mut all: Vec<StateRecord> = (0..mass.len()).map(record).collect();
    place(&mut all, position, velocity)?;
    Ok(all)
}

/// The caller means as many particles as there are.
fn same_count(found: usize, expected: usize) -> Result<(), Error> {
    match found == expected {
        true => Ok(()),
        false => Err(Error::Count(format!("{found} particles, but the solid has {expected}"))),
    }
}

/// Puts particles where they are now.
fn place(records: &mut [StateRecord], position: &[[f64; 3]], velocity: &[[f64; 3]]) -> Result<(), Error> {
    for (name, values) in [("position", position), ("velocity", velocity)] {
        same_count(values.len(), records.len())?;
        finite(name, values)?;
    }
    for (record, (x, v)) in records.iter_mut().zip(position.iter().zip(velocity)) {
        (record.position, record.velocity) = (*x, *v);
    }
    Ok(())
}

fn finite<const N: usize>(name: &str, values: &[[f64; N]]) -> Result<(), Error> {
    let wrong =
        values.iter().enumerate().find_map(|(k, value)| Some((k, value.iter().find(|x| !x.is_finite())?)));
    match wrong {
        None => Ok(()),
        Some((k, value)) => Err(Error::Value(format!("{name} of particle {k} is {value}"))),
    }
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
    place: u32,
    records: Vec<StateRecord>,
    half_step: HalfStep,
    next: Next,
    dt_limit: f64,
    abilities: u32,
    fluid: Vec<StateRecord>,
    forces: Vec<ForceRecord>,
    told: Vec<[f64; 3]>,
}

impl Solid {
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

    fn send(&mut self) -> Result<(), Error> {
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
    /// [`Error::State`]: a state is due. [`Error::Run`]: another process has ended; the solid has left the run then.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn particles_that_nothing_has() {
        let one = Particles {
            position: vec![[0.0; 3]],
            velocity: vec![[0.0; 3]],
            mass: vec![2.0],
            density: vec![1000.0],
            clamped: vec![true],
        };
        let found = records(&one).unwrap();
        assert_eq!((found.len(), found[0].mass, found[0].flags), (1, 2.0, 1));
        let light = records(&Particles { mass: vec![0.0], ..one.clone() });
        assert_eq!(light, Err(Error::Value("mass of particle 0 is 0: it must be positive".into())));
        let far = records(&Particles { position: vec![[0.0, f64::NAN, 0.0]], ..one.clone() });
        assert_eq!(far, Err(Error::Value("position of particle 0 is NaN".into())));
        let short = records(&Particles { clamped: Vec::new(), ..one });
        assert_eq!(short, Err(Error::Count("0 particles, but the solid has 1".into())));
    }
}
