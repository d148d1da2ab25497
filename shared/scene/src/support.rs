//! The width of the water's kernel, and what follows from it and from what the water meets.

use super::preset::Defaults;
use super::{Scene, Shape, Solid, Treatment};

/// h / dx from which on guards at walls and solids are strong and near. h F(r), by which they act, is weaker near by
/// where the kernel is wide: at 0.75 dx 0.54 times as strong with h / dx = 2 as with 1.5.
const WIDE: f64 = 1.75;
/// h / dx of water alone: the fewest neighbours with which waves and vortices keep their energy.
pub(super) const ALONE: f64 = 2.0;
/// h / dx beside solids, whose loads converge faster with a narrow kernel.
const BESIDE_SOLIDS: f64 = 1.5;
/// C where the kernel is wide.
const WIDE_CROSS_VISCOSITY: f64 = 4.0;
/// From where on C is the far one, over the spacing: the reach of f_i is what a swing loses.
const NEAR: f64 = 1.0;
/// The same at held solids, whose load does not hang on it: the longer reach keeps single particles out of plates.
const AT_HELD_SOLIDS: f64 = 1.25;

/// What the water meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Company {
    /// Walls at most.
    None,
    /// Solids that are all held somewhere.
    Held,
    /// A body that nothing holds: the water's waves carry it.
    Free,
}

impl Company {
    pub(super) fn of(shapes: &[Shape], solids: &[Solid], treatment: Treatment) -> Self {
        match (solids.is_empty(), treatment == Treatment::MovingWall && any_free(shapes, solids)) {
            (true, _) => Self::None,
            (false, true) => Self::Free,
            (false, false) => Self::Held,
        }
    }
}

/// Shapes of bodies of which no shape is clamped, and no joint and no prescribed motion holds it.
pub(super) fn free_shapes<'a>(shapes: &'a [Shape], solids: &'a [Solid]) -> impl Iterator<Item = &'a Shape> {
    let of_solids = || shapes.iter().filter(|shape| shape.solid.is_some());
    let holds = |shape: &Shape| !shape.clamp.is_empty() || super::bodies::is_held(solids, shapes, shape);
    let held = move |body: &Shape| {
        of_solids().any(|shape| shape.solid == body.solid && shape.body() == body.body() && holds(shape))
    };
    of_solids().filter(move |shape| !held(shape))
}

fn any_free(shapes: &[Shape], solids: &[Solid]) -> bool {
    free_shapes(shapes, solids).next().is_some()
}

/// Whether guards of a scene with this h / dx are strong and near.
fn is_wide(smoothing_ratio: f64) -> bool {
    smoothing_ratio >= WIDE
}

impl Defaults {
    /// h / dx of a scene that does not say it.
    pub(super) fn smoothing_ratio(&self, company: Company) -> f64 {
        let own = if company == Company::None { ALONE } else { BESIDE_SOLIDS };
        self.smoothing_ratio.unwrap_or(own)
    }

    /// With what suits this h / dx and what the water meets.
    pub(super) fn suited(mut self, smoothing_ratio: f64, company: Company, treatment: Treatment) -> Self {
        let wide = is_wide(smoothing_ratio);
        if wide || company == Company::Free {
            self.fluid_viscosity.linear = self.waves_linear;
            self.cross_viscosity_reach = NEAR;
        }
        // Phase-blind, f_i is the paper's, whose C is the same everywhere.
        match treatment {
            Treatment::PhaseBlind => self.cross_viscosity_far = 1.0,
            Treatment::MovingWall if wide => self.cross_viscosity = WIDE_CROSS_VISCOSITY,
            Treatment::MovingWall => (),
        }
        self
    }

    /// From where on C is the far one where nothing says otherwise, over the spacing.
    pub(super) const CROSS_VISCOSITY_REACH: f64 = AT_HELD_SOLIDS;
}

impl Scene {
    /// The water's kernel is so wide that the guards at walls are strong and near.
    pub fn has_wide_support(&self) -> bool {
        is_wide(self.smoothing_ratio)
    }

    /// What the water's defaults are chosen for, in words.
    pub fn water_meets(&self) -> &'static str {
        match Company::of(&self.shapes, &self.solids, self.interface.treatment) {
            Company::None => "no solid",
            Company::Held if self.interface.treatment == Treatment::MovingWall => "solids that are held",
            Company::Held => "solids",
            Company::Free => "a body that nothing holds",
        }
    }

    /// A body floats, drifts or falls: nothing holds it, and the water sees it as a moving wall.
    pub fn has_free_bodies(&self) -> bool {
        Company::of(&self.shapes, &self.solids, self.interface.treatment) == Company::Free
    }
}
