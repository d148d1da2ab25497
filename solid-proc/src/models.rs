//! The solid models that come with the program: [`halfstep_scene::solid_models`] is the list.

use crate::model::SolidModel;
use crate::{finite_element, hypoelastic, rigid, total_lagrangian};
use halfstep_scene::{Derived, EffectName, Scene, SolidModelName};
use halfstep_sph::lane::Isa;

/// Effects that only one model has.
pub(crate) struct OwnEffects {
    /// Which, each with the reason why other models do not have it.
    pub(crate) list: &'static [(EffectName, &'static str)],
    /// What the scene's solid of that index says about one of them.
    pub(crate) derive: fn(&Scene, usize, EffectName) -> Derived,
}

macro_rules! registry {
    ($($(#[$doc:meta])* $model:ident $name:literal $module:ident $keys:ident,)*) => {
        /// The model of the scene's solid of that index.
        pub(crate) fn build<const D: usize>(
            scene: &Scene,
            solid: usize,
            isa: Isa,
        ) -> Option<Box<dyn SolidModel<D>>> {
            Some(match scene.solids.get(solid)?.model.name() {
                $(SolidModelName::$model => Box::new($module::$model::<D>::new(scene, solid, isa)?),)*
            })
        }

        /// The effects of one model.
        pub(crate) fn own_effects(model: SolidModelName) -> &'static OwnEffects {
            match model {
                $(SolidModelName::$model => &$module::EFFECTS,)*
            }
        }
    };
}

halfstep_scene::solid_models!(registry);
