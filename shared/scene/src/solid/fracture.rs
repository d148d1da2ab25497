//! `solid.fracture`: when a total-Lagrangian solid breaks, and what that takes.

use super::{ModelKeys, Plane, Solid};
use crate::keys::{Key, Table};
use crate::section::{Range, Section};
use crate::{EffectName, Scene, Switch};
use serde::{Deserialize, Serialize};

/// Tensile strength, fracture energy, and friction of what is left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fracture {
    /// Tensile strength f_t, Pa.
    pub strength: f64,
    /// Fracture energy G_f, J/m².
    pub energy: f64,
    /// Coulomb's coefficient of friction between fragments, crack faces and walls.
    #[serde(default)]
    pub friction: f64,
}

pub(super) static TABLE: Table = Table::new(
    "fracture",
    "When a solid breaks, and what that takes.",
    &[
        Key::number(
            "strength",
            Range::positive().up_to(1e15).why("it is the tensile strength f_t, Pa"),
            "Tensile strength.",
        )
        .unit("Pa")
        .required(),
        Key::number(
            "energy",
            Range::positive().up_to(1e15).why("it is the fracture energy G_f, J/m2"),
            "Fracture energy.",
        )
        .unit("J/m2")
        .required(),
        Key::number(
            "friction",
            super::FRICTION,
            "Coulomb's coefficient between fragments, crack faces and walls.",
        )
        .default("0.0"),
    ],
);

impl Fracture {
    /// Width of the band that a crack smears over, in particle spacings: a crack along a row opens between two rows,
    /// and with the eight (in space eighteen) nearest neighbours each of the two takes half of the opening for its
    /// own strain.
    pub const BAND: f64 = 2.0;
    /// Largest h / dx of a solid that breaks.
    pub const SMOOTHING: f64 = 0.95;
    /// Largest `numerics.solid_cfl`: corners and pieces with random cuts are stable to 0.72 where nu = 0.49, in the
    /// plane.
    pub(crate) const LARGEST_CFL: f64 = 0.7;
    /// Largest opening G_f / f_t of a crack over its band.
    pub const WIDEST: f64 = 0.1;

    pub(super) fn read(section: &Section<'_>) -> Option<Self> {
        let table = section.section("fracture");
        if !table.is_present() {
            return None;
        }
        let fracture = Self {
            strength: table.number("strength", None),
            energy: table.number("energy", None),
            friction: table.number("friction", Some(0.0)),
        };
        table.finish();
        Some(fracture)
    }

    /// Widest band that softens without snapping back, m: 2 E' G_f / f_t², E' the modulus of plane strain, Pa.
    pub fn widest_band(&self, modulus: f64) -> f64 {
        2.0 * modulus * self.energy / (self.strength * self.strength)
    }

    /// Stretch of two nearest particles at a spacing, m, beyond which a crack is between them for certain. A pair is
    /// cut with 0.5 % of the strength left: at an opening of 5.3 G_f / f_t, all of it in one pair. At least 1.25: a
    /// slide of 0.75 spacings along the crack.
    pub fn torn(&self, spacing: f64) -> f64 {
        (1.0 + 5.3 * self.energy / (self.strength * spacing)).max(1.25)
    }

    /// Narrowest band that is not torn far apart before it breaks, m.
    pub fn narrowest_band(&self) -> f64 {
        self.energy / (self.strength * Self::WIDEST)
    }
}

impl Scene {
    /// What fracture of the solid of that index takes, where it can break and the scene does not turn that off.
    pub fn fracture(&self, solid: usize) -> Option<Fracture> {
        let on = self.switch(EffectName::Fracture) != Switch::Off;
        self.solids[solid].fracture().filter(|_| on)
    }
}

impl Solid {
    /// What its fracture takes, where it can break.
    pub fn fracture(&self) -> Option<Fracture> {
        match &self.model {
            ModelKeys::TotalLagrangian(keys) => keys.fracture,
            _ => None,
        }
    }

    /// Modulus E' of a strip that is pulled, Pa: E / (1 - nu²) where it cannot contract across the plane, else E.
    pub fn strip_modulus(&self, dimension: usize) -> f64 {
        let held = dimension == 2
            && matches!(&self.model, ModelKeys::TotalLagrangian(k) if k.plane == Plane::Strain);
        let nu = if held { self.poissons_ratio } else { 0.0 };
        self.youngs_modulus / (1.0 - nu * nu)
    }
}
