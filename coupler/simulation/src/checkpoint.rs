//! Finding the checkpoint that an interrupted run goes on from.

use halfstep_coupling::checkpoints::scene_hash;
use halfstep_coupling::clock;
use halfstep_coupling::error::RunError;
use halfstep_coupling::say;
use halfstep_output::checkpoint::{COUPLER, FOLDERS, Manifest, file, file_name};
use halfstep_output::run_json::Resumption;
use halfstep_scene::Scene;
use halfstep_sph::lane::Isa;
use halfstep_wire::state::{Column, Group};
use std::path::{Path, PathBuf};

/// A checkpoint that is whole and belongs to its run's scene.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    /// Its folder.
    pub(crate) folder: PathBuf,
    /// Number, step and time.
    pub(crate) manifest: Manifest,
    /// Clock, recorder and coupler.
    pub(crate) coupler: Group,
}

impl Checkpoint {
    /// The newest checkpoint of the run in a folder that is whole, on a processor with this instruction set. A newer
    /// one that is torn is passed over with a warning.
    ///
    /// # Errors
    /// There is none, or it is of another scene, program or instruction set.
    pub(crate) fn newest(run: &Path, scene: &Scene, isa: Isa) -> Result<Self, RunError> {
        let (mut found, mut torn, mut begun) = (Vec::new(), Vec::new(), Vec::new());
        let participants = scene.participants().into_iter().map(|participant| file_name(&participant.name));
        let expected: Vec<String> = participants.chain([COUPLER.to_owned()]).collect();
        for name in FOLDERS {
            let folder = run.join(name);
            match Manifest::read(&folder) {
                Ok(Some(manifest)) if !manifest.files.iter().map(|file| &file.name).eq(&expected) => {
                    torn.push(format!("{name} is not of the scene's participants"));
                }
                Ok(Some(manifest)) => found.push((manifest, folder)),
                // An interruption that comes while a checkpoint is written is nothing to warn of.
                Ok(None) if folder.join(COUPLER).exists() => begun.push(format!("{name} is not complete")),
                Ok(None) => {}
                Err(error) => torn.push(error.to_string()),
            }
        }
        found.sort_by_key(|(manifest, _)| manifest.number);
        let Some((manifest, folder)) = found.pop() else {
            torn.append(&mut begun);
            let reasons = if torn.is_empty() { "it has written none".into() } else { torn.join("; ") };
            let reason = format!("{} has no whole checkpoint: {reasons}", run.display());
            return Err(RunError::Resume(reason));
        };
        for reason in torn {
            tracing::warn!("a checkpoint is passed over: {reason}");
            say::warn(format_args!(
                "warning: a checkpoint is passed over: {reason}; the one of step {} is taken",
                manifest.step
            ));
        }
        Self::agrees(&manifest, scene, isa).map_err(|why| {
            RunError::Resume(format!("the checkpoint in {} is of another {why}", folder.display()))
        })?;
        let coupler = file::read(&folder.join(COUPLER))?;
        Ok(Self { folder, manifest, coupler })
    }

    fn agrees(manifest: &Manifest, scene: &Scene, isa: Isa) -> Result<(), String> {
        let version = env!("CARGO_PKG_VERSION");
        if manifest.version != version {
            return Err(format!("version, {}; this is {version}", manifest.version));
        }
        if scene_hash(scene).is_ok_and(|hash| hash != manifest.scene) {
            return Err("scene than scene.json beside it".into());
        }
        if manifest.isa != isa.bits_name() {
            let own = isa.bits_name();
            return Err(format!(
                "instruction set level, {}; this is {own}: the bits would differ",
                manifest.isa
            ));
        }
        Ok(())
    }

    /// A part of the coupler's file.
    pub(crate) fn part(&self, name: &str) -> Result<&Group, RunError> {
        let missing = || RunError::Resume(format!("{} has no `{name}`", self.folder.join(COUPLER).display()));
        self.coupler.groups.get(name).ok_or_else(missing)
    }

    /// Part of the time step that the run took when it was written.
    pub(crate) fn factor(&self) -> f64 {
        match self.part("clock").ok().and_then(|clock| clock.columns.get("factor")) {
            Some(Column::Reals(factor)) if factor.len() == 1 => factor[0],
            _ => 1.0,
        }
    }

    /// Lets the run go on from it with this part of the time step.
    pub(crate) fn shorten(&mut self, factor: f64) {
        if let Some(clock) = self.coupler.groups.get_mut("clock") {
            clock::shorten(clock, factor);
        }
    }

    /// Whether another program computed the scene's solid of that index when it was written.
    pub(crate) fn is_external(&self, solid: usize) -> bool {
        let name = format!("solid_{solid}");
        let saved = self.part("coupler").ok().and_then(|coupler| coupler.groups.get(&name));
        saved.is_some_and(|solid| solid.groups.contains_key("external"))
    }

    /// Number of frames of each participant before the checkpoint.
    pub(crate) fn frames(&self) -> Result<u64, RunError> {
        match self.part("coupler")?.columns.get("frame") {
            Some(Column::Counts(counts)) if counts.len() == 1 => Ok(counts[0]),
            _ => Err(RunError::Resume("the coupler's checkpoint does not count frames".into())),
        }
    }

    /// How the report tells of it.
    pub(crate) fn resumption(&self) -> Resumption {
        let Manifest { number, step, time, .. } = self.manifest;
        Resumption { checkpoint: number, step, time, time_step_factor: self.factor(), because: None }
    }
}
