//! What a run will take of the machine besides time, and whether it is there.

use crate::participants::participants;
use halfstep_coupling::error::RunError;
use halfstep_link::{self as link, LinkConfig};
use halfstep_scene::Scene;
use halfstep_scene::geometry::Layout;
use halfstep_wire::Name;
use std::path::Path;

/// Bytes of a particle in a frame: the columns of docs/output.md.
const FRAME: u64 = 78;
/// The same of a solid's, which has more columns.
const SOLID_FRAME: u64 = 98;
/// Bytes of a frame's file without particles.
const FRAME_FILE: u64 = 16 << 10;
/// Bytes of a particle in a checkpoint: 56 to 60 of a fluid's, 134 of a solid's, measured.
const SAVED: [u64; 2] = [60, 134];
/// Checkpoints that are on disk at once: two generations, and files that take the place of others.
const GENERATIONS: u64 = 3;
/// Bytes of a number in a row.
const NUMBER: u64 = 24;

/// What a run needs, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Forecast {
    /// In `/dev/shm`; 0: nothing is exchanged.
    pub(crate) shared: u64,
    /// In the run's folder, at its end.
    pub(crate) disk: u64,
    /// Frames of each participant.
    pub(crate) frames: u64,
}

impl Forecast {
    /// Of a scene's run.
    pub(crate) fn of<const D: usize>(scene: &Scene, layout: &Layout<D>, external: &[Name]) -> Self {
        let counts = layout.counts();
        let instants = |interval: f64| (scene.end_time / interval).min(1e15) as u64 + 2;
        let frames = instants(scene.output.frame_interval);
        let files = scene.participants().len() as u64 * FRAME_FILE;
        let of_fluid = (counts.fluid + counts.wall).saturating_mul(FRAME);
        let a_frame = of_fluid.saturating_add(counts.solid.saturating_mul(SOLID_FRAME)).saturating_add(files);
        let of_frames = frames.saturating_mul(a_frame);
        let saved = (counts.fluid + counts.wall).saturating_mul(SAVED[0]);
        let saved = saved.saturating_add(counts.solid.saturating_mul(SAVED[1])).saturating_mul(GENERATIONS);
        let columns: u64 =
            scene.probes.iter().map(|probe| probe.columns(scene.dimension).len() as u64 + 1).sum();
        let rows = instants(scene.output.probe_interval).saturating_mul(NUMBER * (columns + 1));
        let shared = Self::link(scene, layout, external).map_or(0, |link| link.shared_memory_bytes());
        Self { shared, disk: of_frames.saturating_add(saved).saturating_add(rows), frames }
    }

    fn link<const D: usize>(scene: &Scene, layout: &Layout<D>, external: &[Name]) -> Option<LinkConfig> {
        let coupled = scene.fluid.is_some() && !scene.solids.is_empty();
        coupled.then(|| participants(scene, layout, external).ok().map(LinkConfig::new)).flatten()
    }
}

/// Bytes that are free where a run's folder is, or will be; `None` where the system does not say.
pub(crate) fn free_disk(out: &Path) -> Option<u64> {
    let here = [Path::new(".")];
    let mut folders = out.ancestors().filter(|folder| !folder.as_os_str().is_empty()).chain(here);
    link::free_space(folders.find(|folder| folder.is_dir())?).ok()
}

/// Refuses a run that the disk, shared memory or the limit of open files cannot hold.
pub(crate) fn check<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    external: &[Name],
    out: &Path,
    as_processes: bool,
) -> Result<(), RunError> {
    let Forecast { disk, frames, .. } = Forecast::of(scene, layout, external);
    if let Some(free) = free_disk(out).filter(|free| *free < disk) {
        return Err(RunError::System(format!(
            "the run will write about {}, {frames} frames among it, and {} are free in {}: raise output.frame_interval, \
             or give another folder with --out",
            megabytes(disk),
            megabytes(free),
            out.display()
        )));
    }
    if let (true, Some(config)) = (as_processes, Forecast::link(scene, layout, external)) {
        link::raise_descriptor_limit();
        link::check_descriptors(&config)?;
        link::check_all_room(&config)?;
    }
    Ok(())
}

/// For people.
pub(crate) fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}
