//! Which effects a scene calls for, and why.

use halfstep_shared::geometry::Counts;
use halfstep_shared::output::run_json::EffectReport;
use halfstep_shared::scene::{DensityDiffusion, EffectName, Scene, SolidModelName, Switch, Treatment};

/// The ledger of effects of a scene. Shares of the run time are not measured yet and stay empty.
pub fn ledger(scene: &Scene, counts: &Counts) -> Vec<EffectReport> {
    let mut list = Vec::new();
    let mut add = |name: &str, on: bool, why: String| {
        list.push(EffectReport { name: name.into(), on, why, ..EffectReport::default() });
    };
    let forced = |effect| match scene.switch(effect) {
        Switch::Auto => None,
        Switch::On => Some((true, "the scene says on".to_owned())),
        Switch::Off => Some((false, "the scene says off".to_owned())),
    };
    let moving = scene.gravity.iter().any(|&g| g != 0.0);
    add("gravity", moving, if moving { "gravity is not zero" } else { "gravity is zero" }.into());
    if let Some(fluid) = &scene.fluid {
        let on = halfstep_fluid::viscosity_acts(scene);
        let why = match (forced(EffectName::Viscosity), halfstep_fluid::viscosity_share(scene)) {
            (_, None) => "fluid.viscosity is zero".into(),
            (Some((_, why)), _) => why,
            (None, Some(share)) => format!(
                "{:.2} % of the artificial viscosity; computed from {} % on",
                100.0 * share,
                100.0 * halfstep_fluid::SMALLEST_VISCOSITY_SHARE
            ),
        };
        add("viscosity", on, why);
        let a = fluid.artificial_viscosity;
        add("artificial-viscosity", true, format!("A = {}, B = {}", a.linear, a.quadratic));
        let diffusion = match fluid.density_diffusion {
            DensityDiffusion::None => "none",
            DensityDiffusion::Simple => "simple",
            DensityDiffusion::Hydrostatic => "hydrostatic",
            DensityDiffusion::DeltaSph => "delta-sph",
        };
        let on = fluid.density_diffusion != DensityDiffusion::None;
        add("density-diffusion", on, format!("fluid.density_diffusion is {diffusion}"));
        let walls = counts.wall > 0;
        add("walls", walls, format!("{} wall particles", counts.wall));
        let (on, why) =
            forced(EffectName::WallGuard).unwrap_or((walls, "keeps single particles out of walls".into()));
        add("wall-guard", on && walls, why);
        let (on, why) = forced(EffectName::NonNegativeWallPressure)
            .unwrap_or((walls || scene.solid.is_some(), "walls and solids push and do not pull".into()));
        add("non-negative-wall-pressure", on, why);
    }
    if let Some(solid) = &scene.solid {
        match solid.model {
            SolidModelName::Hypoelastic => {
                let strength = solid.artificial_stress.strength;
                let (on, why) = forced(EffectName::ArtificialStress).unwrap_or((
                    strength > 0.0,
                    format!("the hypoelastic solid is unstable in tension; strength {strength}"),
                ));
                add("artificial-stress", on && strength > 0.0, why);
                let (on, why) = forced(EffectName::RenormalisedGradient)
                    .unwrap_or((false, "the plain gradient is the method's default".into()));
                add("renormalised-gradient", on, why);
            }
            SolidModelName::TotalLagrangian => {
                let why = match solid.hourglass {
                    None => "alpha from the bending stiffness of the particles' cells".into(),
                    Some(alpha) => format!("alpha = {alpha}"),
                };
                add("hourglass", solid.hourglass != Some(0.0), why);
                let clamps = scene.shapes.iter().any(|s| !s.clamp.is_empty());
                let (on, why) = forced(EffectName::ClampFace)
                    .unwrap_or((clamps, "clamps hold at the faces of their boxes".into()));
                add("clamp-face", on && clamps, why);
            }
        }
        let touching = scene.shapes.iter().any(|s| s.contact);
        let (on, why) = forced(EffectName::WallContact)
            .unwrap_or((touching, format!("contact is {touching} for the scene's walls")));
        add("wall-contact", on && touching, why);
    }
    let coupled = scene.fluid.is_some() && scene.solid.is_some();
    let treatment = match scene.interface.treatment {
        Treatment::MovingWall => "moving-wall",
        Treatment::PhaseBlind => "phase-blind",
    };
    let why = if coupled { format!("treatment {treatment}") } else { "the scene has one phase only".into() };
    add("interface", coupled, why);
    let c = scene.interface.cross_viscosity;
    add("cross-viscosity", coupled && c > 0.0, format!("C = {c}"));
    list
}
