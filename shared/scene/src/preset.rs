//! The values that a scene starts from: the program's own, or a preset's. Single keys override both.

use super::*;

/// Every default that does not depend on other keys.
#[derive(Clone, Copy)]
pub(crate) struct Defaults {
    /// Number of space dimensions.
    pub(crate) dimension: usize,
    /// h / dx of the water; where there is none, the scene decides.
    pub(crate) smoothing_ratio: Option<f64>,
    pub(crate) time_step: TimeStep,
    pub(crate) fluid_viscosity: ArtificialViscosity,
    /// A where the water's kernel is wide, and where bodies float.
    pub(crate) waves_linear: f64,
    /// A is less by what the fluid's own viscosity is worth.
    pub(crate) own_viscosity_counts: bool,
    pub(crate) density_diffusion: DensityDiffusion,
    pub(crate) density_diffusion_coefficient: f64,
    pub(crate) model: SolidModelName,
    pub(crate) solid_smoothing_ratio: f64,
    pub(crate) solid_viscosity: ArtificialViscosity,
    pub(crate) artificial_stress: ArtificialStress,
    pub(crate) treatment: Treatment,
    pub(crate) cross_viscosity: f64,
    /// C far off over C near by.
    pub(crate) cross_viscosity_far: f64,
    /// Where C is the far one, over the spacing.
    pub(crate) cross_viscosity_reach: f64,
    pub(crate) kernel: KernelName,
    /// Of the fluid; `None`: the solids decide.
    pub(crate) integration: Option<FluidIntegration>,
    pub(crate) lattice: Lattice,
    pub(crate) effects: &'static [(EffectName, Switch)],
}

impl Defaults {
    pub(super) fn of(preset: Option<Preset>, dimension: usize) -> Self {
        let own = Self {
            dimension,
            smoothing_ratio: None,
            time_step: TimeStep::Auto,
            fluid_viscosity: ArtificialViscosity { linear: 0.05, quadratic: 0.0 },
            waves_linear: 0.02,
            own_viscosity_counts: true,
            density_diffusion: DensityDiffusion::Hydrostatic,
            density_diffusion_coefficient: 0.1,
            model: SolidModelName::TotalLagrangian,
            solid_smoothing_ratio: 1.33,
            solid_viscosity: ArtificialViscosity { linear: 1.0, quadratic: 1.0 },
            artificial_stress: ArtificialStress { strength: 0.3, exponent: 4.0 },
            treatment: Treatment::MovingWall,
            cross_viscosity: 1.0,
            cross_viscosity_far: 0.0,
            cross_viscosity_reach: Self::CROSS_VISCOSITY_REACH,
            kernel: KernelName::WendlandC2,
            integration: None,
            lattice: Lattice::Centred,
            effects: &[],
        };
        match preset {
            None => own,
            Some(Preset::Waves) => Self { smoothing_ratio: Some(support::ALONE), ..own },
            // What is the same as the program's own today is repeated: a preset stays when the defaults move.
            Some(Preset::Kayaki) => Self {
                dimension,
                smoothing_ratio: Some(1.33),
                time_step: TimeStep::Fixed(1e-5),
                fluid_viscosity: ArtificialViscosity { linear: 1.0, quadratic: 1.0 },
                waves_linear: 1.0,
                own_viscosity_counts: false,
                density_diffusion: DensityDiffusion::DeltaSph,
                density_diffusion_coefficient: 0.1,
                model: SolidModelName::Hypoelastic,
                solid_smoothing_ratio: 1.33,
                solid_viscosity: ArtificialViscosity { linear: 1.0, quadratic: 1.0 },
                artificial_stress: ArtificialStress { strength: 0.3, exponent: 4.0 },
                treatment: Treatment::PhaseBlind,
                cross_viscosity: 1.0,
                cross_viscosity_far: 1.0,
                cross_viscosity_reach: Self::CROSS_VISCOSITY_REACH,
                kernel: KernelName::CubicSpline,
                integration: Some(FluidIntegration::Midpoint),
                lattice: Lattice::Nodal,
                // Kayaki's scheme evaluates everything at both stages, the viscous stress however small, and the solid
                // from the start.
                effects: &[
                    (EffectName::FrozenDiffusion, Switch::Off),
                    (EffectName::Viscosity, Switch::On),
                    (EffectName::SleepingSolid, Switch::Off),
                    (EffectName::ParticleShifting, Switch::Off),
                    (EffectName::WallSeparation, Switch::Off),
                    (EffectName::NoSlipContinuity, Switch::Off),
                    (EffectName::WallGuard, Switch::Off),
                ],
            },
        }
    }

    /// With a solid model that the interface can work with.
    pub(super) fn with_treatment(self, treatment: Treatment) -> Self {
        let can = |model: SolidModelName| model.rules().not_phase_blind.is_none();
        if treatment == Treatment::MovingWall || can(self.model) {
            return self;
        }
        let able = SolidModelName::ALL.iter().find(|(_, model)| can(*model));
        Self { model: able.map_or(self.model, |(_, model)| *model), ..self }
    }
}
