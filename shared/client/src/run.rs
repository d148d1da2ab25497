//! A solid before it joins its run: what the launcher says, its first records.

use crate::checkpoint::{Kept, Saved};
use crate::solid::{Solid, Start};
use crate::{Error, Particles};
use halfstep_link::{LinkConfig, ProcessLink};
use halfstep_wire::Name;
use halfstep_wire::frame::flags_of;
use halfstep_wire::protocol::{StateRecord, ability};

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
    saved: Option<Saved>,
    kept: Option<Kept>,
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
        let saved = Saved::of_environment(&told)?;
        let (name, capacity) = (own.name, own.capacity);
        Ok(Self { config, name, place: place as u32, capacity, saved, kept: None })
    }

    /// What [`Self::keep`] and [`Solid::keep`] kept by that name at the checkpoint that the run goes on from; `None`
    /// where it begins, or where nothing was kept by it.
    pub fn saved(&self, name: &str) -> Option<&[f64]> {
        self.saved.as_ref()?.kept.get(name).map(Vec::as_slice)
    }

    /// Keeps numbers of the first state, whatever the solver needs to go on from it to the same bits: with them the
    /// solid writes checkpoints, and a run with it can be resumed.
    ///
    /// # Errors
    /// [`Error::Value`]: one is not finite.
    pub fn keep(&mut self, name: &str, values: &[f64]) -> Result<(), Error> {
        keep(self.kept.get_or_insert_default(), name, values)
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

    /// Joins it with these particles and publishes their first state: where the run goes on, that of the checkpoint,
    /// bit for bit.
    ///
    /// # Errors
    /// [`Error::Count`], [`Error::Value`]: of the particles. [`Error::Run`]: the run has ended.
    pub fn join(self, particles: &Particles, contact: Contact) -> Result<Solid, Error> {
        self.room_for(particles.count())?;
        let mut records = records(particles)?;
        let saved =
            self.saved.unwrap_or_else(|| Saved { dt_limit: UNLIMITED, sub_steps: 1, ..Saved::default() });
        if !saved.stress.is_empty() {
            saved.restore(&mut records)?;
        }
        let walls = if contact == Contact::Own { ability::WALLS_AND_CONTACTS } else { 0 };
        let checkpoints = if self.kept.is_some() { ability::CHECKPOINTS } else { 0 };
        let link = ProcessLink::open(&self.config, self.name, None)?;
        Solid::begin(Start {
            link,
            name: self.name,
            place: self.place,
            records,
            saved,
            abilities: walls | checkpoints,
            kept: self.kept.unwrap_or_default(),
        })
    }
}

/// A time step that is none: the solid allows any, s.
const UNLIMITED: f64 = 1e30;

/// Keeps numbers by a name.
pub(crate) fn keep(kept: &mut Kept, name: &str, values: &[f64]) -> Result<(), Error> {
    if let Some(k) = values.iter().position(|x| !x.is_finite()) {
        return Err(Error::Value(format!("`{name}`, number {k}, is {}", values[k])));
    }
    kept.insert(name.to_owned(), values.to_vec());
    Ok(())
}

/// Most bodies that a record can tell apart.
const BODIES: u32 = (1 << 24) - 1;

/// The records of a first state.
fn records(particles: &Particles) -> Result<Vec<StateRecord>, Error> {
    let Particles { position, velocity, mass, density, clamped, body } = particles;
    same_count(density.len(), mass.len())?;
    same_count(clamped.len(), mass.len())?;
    if !body.is_empty() {
        same_count(body.len(), mass.len())?;
    }
    if let Some(k) = body.iter().position(|&body| body >= BODIES) {
        return Err(Error::Value(format!("body of particle {k} is {}: at most {}", body[k], BODIES - 1)));
    }
    for (name, values) in [("mass", mass), ("density", density)] {
        if let Some(k) = values.iter().position(|&x| !(x > 0.0 && x.is_finite())) {
            let text = format!("{name} of particle {k} is {}: it must be positive", values[k]);
            return Err(Error::Value(text));
        }
    }
    let record = |k: usize| StateRecord {
        id: k as u32,
        flags: flags_of(clamped[k], body.get(k).copied()),
        mass: mass[k],
        density: density[k],
        ..StateRecord::default()
    };
    let mut all: Vec<StateRecord> = (0..mass.len()).map(record).collect();
    place(&mut all, position, velocity)?;
    Ok(all)
}

/// The caller means as many particles as there are.
pub(crate) fn same_count(found: usize, expected: usize) -> Result<(), Error> {
    match found == expected {
        true => Ok(()),
        false => Err(Error::Count(format!("{found} particles, but the solid has {expected}"))),
    }
}

/// Puts particles where they are now.
pub(crate) fn place(
    records: &mut [StateRecord],
    position: &[[f64; 3]],
    velocity: &[[f64; 3]],
) -> Result<(), Error> {
    for (name, values) in [("position", position), ("velocity", velocity)] {
        same_count(values.len(), records.len())?;
        finite(name, values)?;
    }
    for (record, (x, v)) in records.iter_mut().zip(position.iter().zip(velocity)) {
        (record.position, record.velocity) = (*x, *v);
    }
    Ok(())
}

pub(crate) fn finite<const N: usize>(name: &str, values: &[[f64; N]]) -> Result<(), Error> {
    let wrong =
        values.iter().enumerate().find_map(|(k, value)| Some((k, value.iter().find(|x| !x.is_finite())?)));
    match wrong {
        None => Ok(()),
        Some((k, value)) => Err(Error::Value(format!("{name} of particle {k} is {value}"))),
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
            body: vec![2],
        };
        let found = records(&one).unwrap();
        assert_eq!((found.len(), found[0].mass, found[0].flags), (1, 2.0, 1 | 3 << 8));
        let unsaid = records(&Particles { body: Vec::new(), ..one.clone() }).unwrap();
        assert_eq!(unsaid[0].flags, 1);
        let many = records(&Particles { body: vec![1 << 24], ..one.clone() });
        assert_eq!(many, Err(Error::Value("body of particle 0 is 16777216: at most 16777214".into())));
        let mut kept = Kept::new();
        keep(&mut kept, "x", &[1.0]).unwrap();
        assert_eq!(keep(&mut kept, "v", &[0.0, f64::NAN]), Err(Error::Value("`v`, number 1, is NaN".into())));
        assert_eq!(kept.len(), 1);
        let light = records(&Particles { mass: vec![0.0], ..one.clone() });
        assert_eq!(light, Err(Error::Value("mass of particle 0 is 0: it must be positive".into())));
        let far = records(&Particles { position: vec![[0.0, f64::NAN, 0.0]], ..one.clone() });
        assert_eq!(far, Err(Error::Value("position of particle 0 is NaN".into())));
        let short = records(&Particles { clamped: Vec::new(), ..one });
        assert_eq!(short, Err(Error::Count("0 particles, but the solid has 1".into())));
    }
}
