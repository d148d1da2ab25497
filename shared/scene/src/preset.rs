//! The values that a scene starts from: the program's own, or a preset's. Single keys override both.

use super::*;

/// Every default that does not depend on other keys.
#[derive(Clone, Copy)]
pub(super) struct Defaults {
    pub(super) smoothing_ratio: f64,
    pub(super) time_step: TimeStep,
    pub(super) fluid_viscosity: ArtificialViscosity,
    pub(super) density_diffusion: DensityDiffusion,
    pub(super) density_diffusion_coefficient: f64,
    pub(super) model: SolidModelName,
    pub(super) solid_smoothing_ratio: f64,
    pub(super) solid_viscosity: ArtificialViscosity,
    pub(super) artificial_stress: ArtificialStress,
    pub(super) treatment: Treatment,
    pub(super) cross_viscosity: f64,
    pub(super) kernel: KernelName,
    pub(super) lattice: Lattice,
    pub(super) effects: &'static [(EffectName, Switch)],
}

impl Defaults {
    pub(super) fn of(preset: Option<Preset>) -> Self {
        let own = Self {
            smoothing_ratio: 1.33,
            time_step: TimeStep::Auto,
            fluid_viscosity: ArtificialViscosity { linear: 0.1, quadratic: 0.0 },
            density_diffusion: DensityDiffusion::DeltaSph,
            density_diffusion_coefficient: 0.1,
            model: SolidModelName::TotalLagrangian,
            solid_smoothing_ratio: 1.33,
            solid_viscosity: ArtificialViscosity { linear: 1.0, quadratic: 1.0 },
            artificial_stress: ArtificialStress { strength: 0.3, exponent: 4.0 },
            treatment: Treatment::MovingWall,
            cross_viscosity: 1.0,
            kernel: KernelName::CubicSpline,
            lattice: Lattice::Centred,
            effects: &[],
        };
        match preset {
            None => own,
            // What is the same as the program's own today is repeated: a preset stays when the defaults move.
            Some(Preset::Kayaki) => Self {
                smoothing_ratio: 1.33,
                time_step: TimeStep::Fixed(1e-5),
                fluid_viscosity: ArtificialViscosity { linear: 1.0, quadratic: 1.0 },
                density_diffusion: DensityDiffusion::DeltaSph,
                density_diffusion_coefficient: 0.1,
                model: SolidModelName::Hypoelastic,
                solid_smoothing_ratio: 1.33,
                solid_viscosity: ArtificialViscosity { linear: 1.0, quadratic: 1.0 },
                artificial_stress: ArtificialStress { strength: 0.3, exponent: 4.0 },
                treatment: Treatment::PhaseBlind,
                cross_viscosity: 1.0,
                kernel: KernelName::CubicSpline,
                lattice: Lattice::Nodal,
                // Kayaki's scheme evaluates everything at both stages.
                effects: &[(EffectName::FrozenDiffusion, Switch::Off)],
            },
        }
    }

    /// With the solid model that the interface can work with.
    pub(super) fn with_treatment(self, treatment: Treatment) -> Self {
        match treatment {
            Treatment::MovingWall => self,
            Treatment::PhaseBlind => Self { model: SolidModelName::Hypoelastic, ..self },
        }
    }

    /// With what the solid's model asks for.
    pub(super) fn with_model(self, model: SolidModelName) -> Self {
        match model {
            SolidModelName::Hypoelastic => self,
            // Fixed neighbours and corrected gradients: eight neighbours are enough. The viscosity is for a plate in water,
            // whose short waves grow with those of the water's pressure where nothing damps them.
            SolidModelName::TotalLagrangian => Self {
                solid_smoothing_ratio: 0.75,
                solid_viscosity: ArtificialViscosity { linear: 0.1, quadratic: 0.0 },
                ..self
            },
        }
    }
}
