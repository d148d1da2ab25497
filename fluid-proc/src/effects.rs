//! The fluid's effects: what takes part in the pair pass, decided once by the scene.
//!
//! [`halfstep_scene::fluid_effects`] is the list. A pass is compiled for the compositions named in
//! [`Effects::composition`]; there an absent effect does not exist. Any other composition runs the complete law, which
//! asks for each effect whether it is there.

use crate::density_diffusion::{DeltaSph, Diffusion, Hydrostatic, Simple};
use crate::density_gradient;
use crate::fluid::Fluid;
use crate::rates::PairEffect;
use crate::wall_guard;
use halfstep_interface::{non_negative_pressure, thin_plate_screen};
use halfstep_scene::{Decision, EffectName, Scene};

/// An effect of the list.
pub trait FluidEffect<const D: usize> {
    /// What it adds to a pair.
    type Pair<'a>: PairEffect<D>;
    /// Whether it takes part in a scene with fluid.
    fn decide(scene: &Scene) -> Decision;
    /// Memory of its own, bytes a particle, where it takes part in this scene.
    fn bytes(_: &Scene) -> usize {
        0
    }
    /// Its share of the pass, where it takes part.
    fn pair(fluid: &Fluid<D>) -> Self::Pair<'_>;
}

macro_rules! compose {
    ($($(#[$doc:meta])* $effect:ident $name:literal $module:ident,)*) => {
        /// The effects of a scene's pair pass; `None`: absent.
        #[derive(Clone, Copy)]
        pub struct Effects<'a, const D: usize> {
            $($(#[$doc])* pub $module: Option<<crate::$module::$effect as FluidEffect<D>>::Pair<'a>>,)*
        }

        impl<'a, const D: usize> Effects<'a, D> {
            /// None at all.
            pub fn none() -> Self {
                Self { $($module: None,)* }
            }

            /// Those that take part.
            pub(crate) fn of(fluid: &'a Fluid<D>) -> Self {
                Self {
                    $($module: fluid
                        .takes_part(EffectName::$effect)
                        .then(|| <crate::$module::$effect as FluidEffect<D>>::pair(fluid)),)*
                }
            }

            /// The same without one.
            pub fn without(mut self, effect: EffectName) -> Self {
                match effect {
                    $(EffectName::$effect => self.$module = None,)*
                    _ => {}
                }
                self
            }

            fn on(&self) -> usize {
                [$(self.$module.is_some(),)*].into_iter().filter(|&on| on).count()
            }

            /// All effects with a question whether each is there.
            #[allow(clippy::type_complexity)]
            fn complete(self) -> chain!(type D, 'a $($module::$effect)*) {
                chain!(self $($module)*)
            }
        }

        /// The effects of the list.
        pub const LIST: &[EffectName] = &[$(EffectName::$effect,)*];

        /// Memory that an effect of the list takes where it takes part, bytes a particle.
        pub fn bytes(scene: &Scene, effect: EffectName) -> usize {
            match effect {
                $(EffectName::$effect => <crate::$module::$effect as FluidEffect<2>>::bytes(scene),)*
                _ => 0,
            }
        }

        fn of_the_list(scene: &Scene) -> Vec<Decision> {
            vec![$(<crate::$module::$effect as FluidEffect<2>>::decide(scene),)*]
        }
    };
}

macro_rules! chain {
    (type $D:ident, $a:lifetime) => { () };
    (type $D:ident, $a:lifetime $module:ident::$effect:ident $($rest:tt)*) => {
        (Option<<crate::$module::$effect as FluidEffect<$D>>::Pair<$a>>, chain!(type $D, $a $($rest)*))
    };
    ($effects:ident) => { () };
    ($effects:ident $module:ident $($rest:tt)*) => { ($effects.$module, chain!($effects $($rest)*)) };
}

halfstep_scene::fluid_effects!(compose);

/// What a scene with fluid decides about each of the fluid's effects.
pub fn decide(scene: &Scene) -> Vec<Decision> {
    let mut decisions = of_the_list(scene);
    decisions.push(density_gradient::decide(scene));
    decisions.push(wall_guard::decide(scene));
    decisions.push(non_negative_pressure(scene));
    decisions.push(thin_plate_screen(scene));
    decisions
}

/// A pass over whatever composition it is given.
pub trait Pass<const D: usize> {
    /// Runs it.
    fn run<E: PairEffect<D>>(self, effects: E);
}

impl<'a, const D: usize> Effects<'a, D> {
    /// Runs a pass compiled for exactly these effects, or the complete law. Returns the composition's name.
    pub fn composition(self, pass: impl Pass<D>) -> &'static str {
        let Self { artificial_viscosity: damping, density_diffusion: diffusion, viscosity, .. } = self;
        match (self.on(), damping, diffusion, viscosity) {
            (1, Some(damping), None, None) => {
                pass.run((damping, ()));
                "artificial viscosity"
            }
            (2, Some(damping), Some(Diffusion::Simple(diffusion)), None) => {
                pass.run::<(_, (Simple, ()))>((damping, (diffusion, ())));
                "artificial viscosity, simple diffusion"
            }
            (2, Some(damping), Some(Diffusion::Hydrostatic(diffusion)), None) => {
                pass.run::<(_, (Hydrostatic<D>, ()))>((damping, (diffusion, ())));
                "artificial viscosity, hydrostatic diffusion"
            }
            (2, Some(damping), Some(Diffusion::DeltaSph(diffusion)), None) => {
                pass.run::<(_, (DeltaSph<'a, D>, ()))>((damping, (diffusion, ())));
                "artificial viscosity, delta-SPH diffusion"
            }
            (3, Some(damping), Some(Diffusion::Simple(diffusion)), Some(stress)) => {
                pass.run((damping, (diffusion, (stress, ()))));
                "artificial viscosity, simple diffusion, viscosity"
            }
            (2, None, Some(Diffusion::DeltaSph(diffusion)), Some(stress)) => {
                pass.run((diffusion, (stress, ())));
                "delta-SPH diffusion, viscosity"
            }
            (3, Some(damping), Some(Diffusion::DeltaSph(diffusion)), Some(stress)) => {
                pass.run((damping, (diffusion, (stress, ()))));
                "artificial viscosity, delta-SPH diffusion, viscosity"
            }
            _ => {
                pass.run(self.complete());
                "complete law"
            }
        }
    }
}
