//! The participants of a scene as owners of particles.

use halfstep_interface::contact::{Contact, WallContact};
use halfstep_output::checkpoint::{StateWriter, file, file_name};
use halfstep_output::{FrameWriter, OutputError};
use halfstep_role::Member;
use halfstep_role::lockstep::RoleError;
use halfstep_role::role::Role;
use halfstep_scene::{Probe, Scene};
use halfstep_sph::Phase;
use halfstep_sph::lane::Isa;
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

/// What contact between the solids asks of a run, from the first records of all participants in their order.
#[derive(Clone, Debug, Default)]
pub struct ContactAsks {
    /// Largest time step that all contacts are stable with, s; `None` where nothing can touch.
    pub limit: Option<f64>,
    /// Of each pair that may touch its solids' places in the scene and its stiffness, Pa/m.
    pub stiffness: Vec<([usize; 2], f64)>,
}

/// What contact asks before anything is run.
pub fn contact_asks(scene: &Scene, roles: &mut [Box<dyn Role>]) -> ContactAsks {
    let held = |solid: &usize| scene.leaves_walls_to_coupler(*solid);
    let walls = |solid| Some((solid, WallContact::new(scene, solid)?));
    let mut walls: Vec<_> = (0..scene.solids.len()).filter(held).filter_map(walls).collect();
    let mut contact = Contact::new(scene);
    if contact.is_none() && walls.is_empty() {
        return ContactAsks::default();
    }
    let first = |role: &mut Box<dyn Role>| {
        let mut records = Vec::new();
        role.publish(&[], &mut records);
        records
    };
    let solids = roles.iter_mut().filter(|role| role.phase() == Phase::Solid);
    let states: Vec<_> = solids.map(first).collect();
    contact.iter_mut().for_each(|contact| contact.begin(states.iter().map(Vec::as_slice)));
    walls.iter_mut().for_each(|(solid, walls)| walls.begin(&states[*solid]));
    let limits = contact.iter().map(Contact::limit).chain(walls.iter().map(|(_, walls)| walls.limit()));
    ContactAsks {
        limit: Some(limits.fold(f64::INFINITY, f64::min)).filter(|limit| limit.is_finite()),
        stiffness: contact.iter().flat_map(Contact::booked).map(|(k, law, _)| (k, law.stiffness)).collect(),
    }
}

/// The participants at these places, ready for the half-step loop; frames and checkpoints go to the run's folder. With
/// the folder of a checkpoint they go on from there.
///
/// # Errors
/// The scene lacks one of them, a writer cannot start, or the checkpoint is not one of this scene.
pub fn members(
    scene: &Scene,
    places: &[usize],
    isa: Isa,
    folder: Option<&Path>,
    checkpoint: Option<&Path>,
) -> Result<Vec<Member>, RoleError> {
    let member = |&place: &usize| {
        let missing = || RoleError::Start(format!("the scene has no participant number {place}"));
        equip(build(place, scene, isa).ok_or_else(missing)?, folder, checkpoint)
    };
    places.iter().map(member).collect()
}

/// A participant with writers for a run's folder. With the folder of a checkpoint it goes on from there.
///
/// # Errors
/// A writer cannot start, or the checkpoint is not one of this participant.
pub fn equip(
    role: Box<dyn Role>,
    folder: Option<&Path>,
    checkpoint: Option<&Path>,
) -> Result<Member, RoleError> {
    let own = role.name().to_string();
    let mut member = Member::new(role);
    let output = |error: OutputError| RoleError::Output(error.into());
    if let Some(folder) = folder {
        member.frames = Some(Box::new(FrameWriter::start(folder, &own).map_err(output)?));
        member.checkpoints = Some(Box::new(StateWriter::start(folder, &own).map_err(output)?));
    }
    if let Some(checkpoint) = checkpoint {
        resume(&mut member, checkpoint, &own)?;
    }
    Ok(member)
}

/// Lets a participant go on from a checkpoint in a folder.
fn resume(member: &mut Member, checkpoint: &Path, name: &str) -> Result<(), RoleError> {
    let path = checkpoint.join(file_name(name));
    let state = file::read(&path).map_err(|error| RoleError::Start(error.to_string()))?;
    member.resume(&state).map_err(|error| RoleError::Start(format!("{}: {error}", path.display())))
}

/// Places of the probes' participants, in the order of the probes: who measures each.
pub fn measured_by(scene: &Scene) -> Vec<usize> {
    let first_solid = usize::from(scene.fluid.is_some());
    let place = |probe: &Probe| match probe.phase() {
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
