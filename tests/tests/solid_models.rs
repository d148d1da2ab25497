//! The conformance suite of solid models over every model.

use halfstep_scene::Scene;
use halfstep_solid::SolidModel;
use halfstep_solid::hypoelastic::Hypoelastic;
use halfstep_solid::total_lagrangian::TotalLagrangian;
use halfstep_sph::lane::Isa;
use halfstep_tests::conformance::solid::{self, Make};

/// One test for each case of the suite.
macro_rules! conformance {
    ($name:ident, $model:ident, $keys:literal, [$($case:ident),*]) => {
        mod $name {
            use super::*;

            const MODEL: Make = Make { build, keys: $keys };

            fn build(scene: &Scene, isa: Isa) -> Option<Box<dyn SolidModel<2>>> {
                Some(Box::new($model::<2>::new(scene, 0, isa)?))
            }

            $(
                #[test]
                fn $case() {
                    solid::$case(MODEL);
                }
            )*
        }
    };
    ($($name:ident: $model:ident, $keys:literal;)*) => {
        $(conformance!($name, $model, $keys, [
            identity, interface_set, rest, uniform_force, stage_0_is_forgotten, sub_steps, clamps, conservation,
            bodies_collide, wall_contact, bounds, threads, interruption
        ]);)*
    };
}

conformance! {
    hypoelastic: Hypoelastic, "model = \"hypoelastic\"";
    total_lagrangian: TotalLagrangian, "model = \"total-lagrangian\"";
    // With the neighbours of the other model.
    wide_total_lagrangian: TotalLagrangian, "model = \"total-lagrangian\"\nsmoothing_ratio = 1.33";
}
