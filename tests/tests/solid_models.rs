//! The conformance suite of solid models over every model.

use halfstep_scene::Scene;
use halfstep_solid::SolidModel;
use halfstep_solid::hypoelastic::Hypoelastic;
use halfstep_solid::total_lagrangian::TotalLagrangian;
use halfstep_sph::lane::Isa;
use halfstep_tests::conformance::solid::{self, Make};

/// One test for each case of the suite, in two and in three dimensions.
macro_rules! conformance {
    ($model:ident, $keys:literal, $dimension:ident $D:literal, [$($case:ident),*]) => {
        mod $dimension {
            use super::*;

            const MODEL: Make<$D> = Make { build, keys: $keys };

            fn build(scene: &Scene, isa: Isa) -> Option<Box<dyn SolidModel<$D>>> {
                Some(Box::new($model::<$D>::new(scene, 0, isa)?))
            }

            $(
                #[test]
                fn $case() {
                    solid::$case(MODEL);
                }
            )*
        }
    };
    ($model:ident, $keys:literal, $($dimension:ident $D:literal),*) => {
        $(conformance!($model, $keys, $dimension $D, [
            identity, interface_set, rest, uniform_force, stage_0_is_forgotten, sub_steps, clamps, conservation,
            bodies_collide, wall_contact, bounds, threads, interruption
        ]);)*
    };
    ($($name:ident: $model:ident, $keys:literal;)*) => {
        $(mod $name {
            use super::*;

            conformance!($model, $keys, plane 2, space 3);
        })*
    };
}

conformance! {
    hypoelastic: Hypoelastic, "model = \"hypoelastic\"";
    total_lagrangian: TotalLagrangian, "model = \"total-lagrangian\"";
    // With the neighbours of the other model.
    wide_total_lagrangian: TotalLagrangian, "model = \"total-lagrangian\"\nsmoothing_ratio = 1.33";
}
