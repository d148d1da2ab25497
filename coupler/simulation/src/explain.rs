//! What takes part in a scene, why, and what it costs.

use crate::options::RunOptions;
use crate::run::run;
use halfstep_coupling::error::RunError;
use halfstep_coupling::roles;
use halfstep_output::run_json::EffectReport;
use halfstep_scene::{FluidIntegration, Scene, TimeStep};
use halfstep_sph::lane::Isa;
use serde::Serialize;
use std::fmt;

/// Steps that are run to measure the shares.
const STEPS: f64 = 20.0;

/// The effects of a scene, their shares measured over the scene's first steps.
#[derive(Clone, Debug, Serialize)]
pub struct Explanation {
    /// The scene's name.
    pub scene: String,
    /// The effects, with what they cost.
    pub effects: Vec<EffectReport>,
    /// Which compiled composition of pair effects the fluid's pass runs.
    pub composition: Option<String>,
    /// Memory of the fluid, bytes a particle.
    pub fluid_bytes_per_particle: Option<f64>,
    /// How the fluid goes from n to n + 1.
    pub time_integration: Option<FluidIntegration>,
    /// Courant number of the fluid where it sets the step.
    pub cfl: Option<f64>,
}

/// Runs a scene for a moment, as threads, and tells what its effects took of the time.
///
/// # Errors
/// The moment could not be run.
pub fn explain(scene: &Scene, isa: Isa) -> Result<Explanation, RunError> {
    let mut limit = f64::INFINITY;
    let (mut bytes, mut composition) = (None, None);
    for place in 0..scene.participants().len() {
        let Some(mut role) = roles::build(place, scene, isa) else { continue };
        limit = limit.min(role.dt_limit());
        role.own_sums();
        bytes = bytes.or(role.bytes().map(|b| b as f64 / role.particles().max(1) as f64));
        composition = composition.or(role.composition().map(str::to_owned));
    }
    let dt = match scene.time_step {
        TimeStep::Auto => limit,
        TimeStep::Fixed(dt) => dt,
    };
    let mut moment = scene.clone();
    moment.end_time = scene.end_time.min(STEPS * dt);
    moment.output.frame_interval = moment.end_time;
    moment.output.probe_interval = moment.end_time;
    let folder = tempfile::tempdir().map_err(|e| RunError::System(format!("no temporary folder: {e}")))?;
    let options = RunOptions { isa, ..RunOptions::new(folder.path().join("run")) };
    let (report, error) = run(&moment, &options)?;
    if let Some(error) = error {
        return Err(error);
    }
    Ok(Explanation {
        scene: scene.name.clone(),
        effects: report.effects,
        composition,
        fluid_bytes_per_particle: bytes,
        time_integration: scene.fluid.as_ref().map(|fluid| fluid.time_integration),
        cfl: (scene.fluid.is_some() && scene.time_step == TimeStep::Auto).then_some(scene.numerics.cfl),
    })
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:<28}{:<5}{:>7}{:>9}   why", "effect", "", "share", "memory")?;
        for effect in &self.effects {
            let share = effect.share.map_or(String::new(), percent);
            let memory = effect.bytes_per_particle.map_or(String::new(), |b| format!("{b:.0} B"));
            let on = if effect.on { "on" } else { "off" };
            writeln!(f, "{:<28}{on:<5}{share:>7}{memory:>9}   {}", effect.name, effect.why)?;
        }
        writeln!(f, "\nshares are of the computing time of all roles; memory is per particle of the phase")?;
        if let Some(composition) = &self.composition {
            writeln!(f, "fluid pass compiled for: {composition}")?;
        }
        if let Some(bytes) = self.fluid_bytes_per_particle {
            writeln!(f, "fluid: {bytes:.0} bytes a particle, walls and neighbour lists included")?;
        }
        if let Some(rule) = self.time_integration {
            let cfl = self.cfl.map_or(String::new(), |cfl| format!(", Courant number {cfl}"));
            writeln!(f, "fluid goes by {}{cfl}", rule.in_words())?;
        }
        Ok(())
    }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
