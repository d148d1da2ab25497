//! The roles by scene: the one place where the dimension becomes a type.

use halfstep_fluid::Fluid;
use halfstep_role::role::Role;
use halfstep_scene::Scene;
use halfstep_solid::Solid;
use halfstep_sph::lane::Isa;
use halfstep_wire::failure::RoleName;

/// The role of a phase, where the scene has it, computing with an instruction set that the processor has.
pub fn build(role: RoleName, scene: &Scene, isa: Isa) -> Option<Box<dyn Role>> {
    match role {
        RoleName::Fluid => Fluid::<2>::new(scene, isa).map(|f| Box::new(f) as Box<dyn Role>),
        RoleName::Solid => Solid::<2>::new(scene, 0, isa).map(|s| Box::new(s) as Box<dyn Role>),
        RoleName::Coupler => None,
    }
}

/// File stem of a phase's frames.
pub fn stem(role: RoleName) -> &'static str {
    match role {
        RoleName::Fluid => "fluid",
        RoleName::Solid => "solid",
        RoleName::Coupler => "coupler",
    }
}
