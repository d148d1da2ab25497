//! What a solid of another program showed in its first message, beside what the scene has for it.

use serde::{Deserialize, Serialize};

/// Part of the solid's mass by which what it publishes may differ from the scene's.
const MASS: f64 = 0.02;
/// Part of its number of particles: its own lattice may be another one, and fill a curved outline with some more.
const NUMBER: f64 = 0.1;
/// Part of the scene's places that may have no particle near: corners that a mesh cuts.
const EMPTY: f64 = 0.02;
/// Part of the fluid's speed of sound by which a particle may begin faster or slower: a solver's own start is noisy.
const VELOCITY: f64 = 1e-3;
/// Spacings that the centre of its mass may be off.
const CENTRE: f64 = 0.5;
/// Part of the mean density by which the records' may differ: a solid that begins strained.
const DENSITY: f64 = 0.02;
/// Distance in spacings below which a particle of the fluid is in the solid: the scene's own are half a spacing apart
/// at least.
pub const IN_FLUID: f64 = 0.45;

/// The first message of a solid of another program and the scene's particles of that solid.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FirstMessage {
    /// Name of the solid.
    pub name: String,
    /// Particles that it published.
    pub particles: u64,
    /// Their mass, kg (2D: kg/m).
    pub mass: f64,
    /// Particles that the scene has for it.
    pub scene_particles: u64,
    /// Their mass, kg (2D: kg/m).
    pub scene_mass: f64,
    /// Those of the scene's particles that the fluid can reach: a solid need not publish the others.
    pub outer_particles: u64,
    /// Least and largest mass that is right: of the outer particles alone, and of all, kg (2D: kg/m).
    pub right_mass: [f64; 2],
    /// Outer places of the scene's with no particle of the solid near.
    pub empty: u64,
    /// The first of them, m.
    pub first_empty: Option<[f64; 3]>,
    /// Particles of the solid with no place of the scene's near.
    pub misplaced: u64,
    /// How far the one that is farthest is from the nearest place, m.
    pub farthest: f64,
    /// Where that one is, m.
    pub farthest_at: Option<[f64; 3]>,
    /// Largest difference of a particle's velocity from that with which the scene's begin near it, m/s.
    pub off_velocity: f64,
    /// Of the fluid, m/s.
    pub sound_speed: f64,
    /// Distance of the centre of its mass from that of the scene's particles, in spacings: from that of all or of the
    /// outer ones.
    pub off_centre: f64,
    /// Mean density of its records, kg/m³.
    pub density: f64,
    /// That of the scene's particles, kg/m³.
    pub scene_density: f64,
    /// Particles of the fluid that begin closer than [`IN_FLUID`] spacings to a particle of the solid.
    pub in_fluid: u64,
}

impl FirstMessage {
    /// What in it is not as the scene has it, most telling first; nothing where the differences are those of meshes.
    pub fn remarks(&self, dimension: usize) -> Vec<String> {
        let Self { name, particles, mass, scene_particles, .. } = self;
        let unit = if dimension == 2 { "kg/m" } else { "kg" };
        let at = |x: &Option<[f64; 3]>| {
            let x = x.unwrap_or_default();
            let place: Vec<String> = x[..dimension].iter().map(|x| (*x as f32).to_string()).collect();
            format!("[{}]", place.join(", "))
        };
        let mut all = Vec::new();
        let least = self.outer_particles as f64 * (1.0 - NUMBER);
        let most = *scene_particles as f64 * (1.0 + NUMBER);
        if !(least..=most).contains(&(*particles as f64)) {
            all.push(format!(
                "the {name} publishes {particles} particles, and its shapes have {scene_particles} at the scene's \
                 spacing: water passes between such as are farther apart, closer ones only cost"
            ));
        }
        let [low, high] = self.right_mass;
        if !(low * (1.0 - MASS)..=high * (1.0 + MASS)).contains(mass) {
            all.push(format!(
                "the particles of the {name} have a mass of {mass:.4} {unit}, and the table of its particles {high:.4} \
                 {unit}: each displaces as much fluid as its mass over the scene's density"
            ));
        }
        if self.empty as f64 > EMPTY * self.outer_particles as f64 {
            all.push(format!(
                "{} of {} places near the surface of the {name} have none of its particles near, the first at {}: \
                 fluid goes there (clamped particles are published, too)",
                self.empty,
                self.outer_particles,
                at(&self.first_empty)
            ));
        }
        if self.misplaced > 0 {
            all.push(format!(
                "{} particles of the {name} are not where its shapes are, by up to {:.3e} m: the one at {}",
                self.misplaced,
                self.farthest,
                at(&self.farthest_at)
            ));
        }
        // Of particles that are elsewhere, or have another mass, nothing else is a surprise.
        if all.is_empty() && self.off_centre > CENTRE {
            all.push(format!(
                "the centre of the {name}'s mass is {:.1} spacings from that of the scene's particles: a particle \
                 displaces as much fluid as its own mass over the scene's density",
                self.off_centre
            ));
        }
        if self.off_velocity > VELOCITY * self.sound_speed {
            all.push(format!(
                "the {name} begins with velocities up to {:.3e} m/s away from those of the scene",
                self.off_velocity
            ));
        }
        if (self.density - self.scene_density).abs() > DENSITY * self.scene_density {
            all.push(format!(
                "the records of the {name} have a density of {:.1} kg/m³, and its shapes {:.1} kg/m³",
                self.density, self.scene_density
            ));
        }
        if self.in_fluid > 0 {
            all.push(format!(
                "{} particles of the fluid begin in the {name}, closer than {IN_FLUID} of the spacing to its particles",
                self.in_fluid
            ));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block of 8 by 28 particles of 0.2 kg/m, of which 180 are near the surface.
    fn block() -> FirstMessage {
        FirstMessage {
            name: "solid".into(),
            particles: 224,
            mass: 44.8,
            scene_particles: 224,
            scene_mass: 44.8,
            outer_particles: 180,
            right_mass: [36.0, 44.8],
            ..FirstMessage::default()
        }
    }

    #[test]
    fn differences_of_meshes_are_silent() {
        let as_told = block();
        let shell = FirstMessage { particles: 180, mass: 36.0, ..block() };
        let other_lattice = FirstMessage { particles: 240, mass: 45.5, empty: 3, ..block() };
        for message in [as_told, shell, other_lattice] {
            assert_eq!(message.remarks(2), [""; 0]);
        }
    }

    #[test]
    fn each_limit_says_its_own() {
        let one = |message: FirstMessage, said: &str| {
            let remarks = message.remarks(2);
            assert!(remarks.len() == 1 && remarks[0].contains(said), "{remarks:?}");
        };
        // 1.1 times 224 are 246.4; 0.9 times 180 are 162.
        one(FirstMessage { particles: 247, ..block() }, "publishes 247 particles, and its shapes have 224");
        one(FirstMessage { particles: 161, ..block() }, "publishes 161 particles");
        // 1.02 times 44.8 are 45.7; 0.98 times 36 are 35.28.
        one(
            FirstMessage { mass: 45.8, ..block() },
            "a mass of 45.8000 kg/m, and the table of its particles 44.8000 kg/m",
        );
        one(FirstMessage { mass: 35.2, ..block() }, "a mass of 35.2000 kg/m");
        // 2 % of 180 are 3.6.
        let empty = FirstMessage { empty: 4, first_empty: Some([0.5, 0.25, 0.0]), ..block() };
        one(
            empty,
            "4 of 180 places near the surface of the solid have none of its particles near, the first at [0.5, 0.25]",
        );
        let away = FirstMessage { misplaced: 1, farthest: 5e-3, farthest_at: Some([0.5; 3]), ..block() };
        one(
            away,
            "1 particles of the solid are not where its shapes are, by up to 5.000e-3 m: the one at [0.5, 0.5]",
        );
        let moving = |off_velocity| FirstMessage { off_velocity, sound_speed: 30.0, ..block() };
        one(moving(0.031), "begins with velocities up to 3.100e-2 m/s away from those of the scene");
        assert_eq!(moving(0.029).remarks(2), [""; 0]);
        let off = |off_centre| FirstMessage { off_centre, ..block() };
        one(off(0.51), "the centre of the solid's mass is 0.5 spacings from that of the scene's particles");
        assert_eq!(off(0.49).remarks(2), [""; 0]);
        let dense = |density| FirstMessage { density, scene_density: 8000.0, ..block() };
        one(dense(8200.0), "have a density of 8200.0 kg/m³, and its shapes 8000.0 kg/m³");
        assert_eq!(dense(7900.0).remarks(2), [""; 0]);
        one(FirstMessage { in_fluid: 20, ..block() }, "20 particles of the fluid begin in the solid");
    }
}
