//! The participants of a scene as owners of particles.

use halfstep_output::FrameWriter;
use halfstep_role::lockstep::{Member, RoleError};
use halfstep_role::role::Role;
use halfstep_scene::{Probe, Scene};
use halfstep_sph::Phase;
use halfstep_sph::lane::Isa;
use halfstep_wire::frame::FrameSink;
use std::path::Path;

/// The participant at this place of [`Scene::participants`], computing with an instruction set that the processor has.
pub fn build(place: usize, scene: &Scene, isa: Isa) -> Option<Box<dyn Role>> {
    let participants = scene.participants();
    match participants.get(place)?.phase {
        Phase::Fluid => halfstep_fluid::role(scene, isa),
        Phase::Solid => halfstep_solid::role(scene, place - usize::from(scene.fluid.is_some()), isa),
        Phase::Wall => None,
    }
}

/// The participants at these places, ready for the half-step loop; frames go to the run's folder.
///
/// # Errors
/// The scene lacks one of them, or a writer cannot start.
pub fn members(
    scene: &Scene,
    places: &[usize],
    isa: Isa,
    folder: Option<&Path>,
) -> Result<Vec<Member>, RoleError> {
    let participants = scene.participants();
    let member = |&place: &usize| {
        let missing = || RoleError::Start(format!("the scene has no participant number {place}"));
        let name = &participants.get(place).ok_or_else(missing)?.name;
        let role = build(place, scene, isa).ok_or_else(missing)?;
        let writer = folder.map(|folder| FrameWriter::start(folder, name)).transpose();
        let writer = writer.map_err(|error| RoleError::Output(error.into()))?;
        Ok(Member { role, frames: writer.map(|writer| Box::new(writer) as Box<dyn FrameSink>) })
    };
    places.iter().map(member).collect()
}

/// Places of the probes' participants, in the order of the probes: who measures each.
pub fn measured_by(scene: &Scene) -> Vec<usize> {
    let first_solid = usize::from(scene.fluid.is_some());
    let place = |probe: &Probe| match probe.kind.phase() {
        Phase::Solid => first_solid + probe.solid.unwrap_or_default(),
        _ => 0,
    };
    scene.probes.iter().map(place).collect()
}

/// The probes that the participant at this place measures, in the scene's order.
pub fn probes_of(scene: &Scene, place: usize) -> impl Iterator<Item = &Probe> {
    let all = measured_by(scene).into_iter().zip(&scene.probes);
    all.filter(move |(owner, _)| *owner == place).map(|(_, probe)| probe)
}
