//! The conformance suite of solid models over every model.

use halfstep_shared::lane::Isa;
use halfstep_shared::scene::Scene;
use halfstep_solid::SolidModel;
use halfstep_tests::conformance::solid;

/// One test for each case of the suite.
macro_rules! conformance {
    ($name:ident, $model:ident, [$($case:ident),*]) => {
        mod $name {
            use super::*;

            fn make(scene: &Scene, isa: Isa) -> Option<Box<dyn SolidModel<2>>> {
                Some(Box::new(halfstep_solid::$name::$model::new(scene, isa)?))
            }

            $(
                #[test]
                fn $case() {
                    solid::$case(make);
                }
            )*
        }
    };
    ($($name:ident: $model:ident),*) => {
        $(conformance!($name, $model, [
            identity, interface_set, rest, uniform_force, stage_0_is_forgotten, sub_steps, clamps, conservation,
            bodies_collide, wall_contact, bounds, threads
        ]);)*
    };
}

conformance!(hypoelastic: Hypoelastic, total_lagrangian: TotalLagrangian);
