//! The conformance suite of solid models over every model.

use halfstep_scene::Scene;
use halfstep_solid::SolidModel;
use halfstep_solid::finite_element::FiniteElement;
use halfstep_solid::hypoelastic::Hypoelastic;
use halfstep_solid::rigid::Rigid;
use halfstep_solid::total_lagrangian::TotalLagrangian;
use halfstep_sph::lane::Isa;
use halfstep_tests::conformance::solid::{self, Make};

/// The same scene with the solids' spacing as their own and all else twice as coarse.
fn finer_than_the_rest(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for shape in scene.shapes.iter_mut().filter(|shape| shape.solid.is_some()) {
        shape.spacing = Some(scene.resolution);
    }
    scene.resolution *= 2.0;
    scene
}

/// One test for each case of the suite.
macro_rules! conformance {
    ($name:ident $D:literal: $model:ident, $keys:literal, $scene:expr; $($case:ident)*) => {
        mod $name {
            use super::*;

            const MODEL: Make<$D> = Make { build, keys: $keys };

            fn build(scene_of_suite: &Scene, isa: Isa) -> Option<Box<dyn SolidModel<$D>>> {
                let scene: fn(&Scene) -> Scene = $scene;
                Some(Box::new($model::<$D>::new(&scene(scene_of_suite), 0, isa)?))
            }

            $(
                #[test]
                fn $case() {
                    solid::$case(MODEL);
                }
            )*
        }
    };
    (whole $name:ident $D:literal: $model:ident, $keys:literal) => {
        conformance!($name $D: $model, $keys, Scene::clone; identity interface_set rest uniform_force
            stage_0_is_forgotten sub_steps clamps conservation bodies_collide wall_contact bounds threads
            interruption);
    };
    ($($name:ident: $model:ident, $keys:literal;)*) => {
        $(mod $name {
            use super::*;

            conformance!(whole plane 2: $model, $keys);
            conformance!(whole space 3: $model, $keys);
            // All but `interface_set`, which counts particles within reach of the fluid's kernel, and `wall_contact`,
            // whose wall has the body's spacing: `tests/tests/in_process/moving_stop.rs` has a finer body.
            conformance!(finer_than_the_fluid 2: $model, $keys, finer_than_the_rest; identity rest uniform_force
                stage_0_is_forgotten sub_steps clamps conservation bodies_collide bounds threads interruption);
        })*
    };
}

conformance! {
    hypoelastic: Hypoelastic, "model = \"hypoelastic\"";
    total_lagrangian: TotalLagrangian, "model = \"total-lagrangian\"";
    finite_element: FiniteElement, "model = \"finite-element\"";
}
// By the midpoint rule: without `bounds`, which asks for a step that diverges. In the plane alone: the matrix of the
// suite's block in space takes minutes.
conformance!(implicit_finite_element 2: FiniteElement,
    "model = \"finite-element\"\ntime_integration = \"implicit\"", Scene::clone; identity interface_set rest
    uniform_force stage_0_is_forgotten sub_steps clamps conservation bodies_collide wall_contact threads interruption);
// With a memory.
conformance!(whole relaxing_total_lagrangian 2: TotalLagrangian,
    "model = \"total-lagrangian\"\nprony = [[0.5, 0.01]]");
// With the neighbours of the other model.
conformance!(whole wide_total_lagrangian 2: TotalLagrangian,
    "model = \"total-lagrangian\"\nsmoothing_ratio = 1.33");
// Without the cases of what strains: sub-steps of a swing, clamps, and a time step that a stiffness limits. In space
// without `uniform_force`, over whose long steps rounding of the moments turns the block by more than 1e-12.
conformance!(rigid_plane 2: Rigid, "model = \"rigid\"\ncontact = { restitution = 0.5 }", Scene::clone; identity
    interface_set rest uniform_force stage_0_is_forgotten conservation bodies_collide wall_contact threads
    interruption);
conformance!(rigid_space 3: Rigid, "model = \"rigid\"\ncontact = { restitution = 0.5 }", Scene::clone; identity
    interface_set rest stage_0_is_forgotten conservation bodies_collide wall_contact threads interruption);
conformance!(finer_rigid 2: Rigid, "model = \"rigid\"\ncontact = { restitution = 0.5 }", finer_than_the_rest; identity
    rest uniform_force stage_0_is_forgotten conservation bodies_collide threads interruption);
