//! From a file and its overrides to a scene.

use super::check::Check;
use super::document::{self, SourceText};
use super::error::{Report, SceneErrors};
use super::{EffectName, Scene, Switch, check_lattice, file, overrides, parameters, read, resources};
use std::path::Path;

/// Reads a scene's file, applies the overrides (`key=value`, as after `--set`) and checks everything.
///
/// # Errors
/// Everything that is wrong with the scene at once, each with its place.
pub fn load(path: &Path, overrides: &[String]) -> Result<Scene, SceneErrors> {
    load_with(path, overrides, &[])
}

/// As [`load`], for a program with effects of its own: their names are further keys of `[effects]`.
///
/// # Errors
/// Everything that is wrong with the scene at once, each with its place.
pub fn load_with(path: &Path, overrides: &[String], own_effects: &[&str]) -> Result<Scene, SceneErrors> {
    match file::read(path) {
        Ok(text) => parse_with(&text, path, overrides, own_effects),
        Err(reason) => Err(SceneErrors::whole(path, reason)),
    }
}

/// As [`load`], with the file's text at hand; `path` gives the scene its name and the folder of its reference files.
///
/// # Errors
/// Everything that is wrong with the scene at once, each with its place.
pub fn parse(text: &str, path: &Path, overrides: &[String]) -> Result<Scene, SceneErrors> {
    parse_with(text, path, overrides, &[])
}

/// As [`load_with`], with the file's text at hand.
///
/// # Errors
/// Everything that is wrong with the scene at once, each with its place.
pub fn parse_with(
    text: &str,
    path: &Path,
    overrides: &[String],
    own_effects: &[&str],
) -> Result<Scene, SceneErrors> {
    let file = SourceText { name: path.display().to_string(), text: text.into(), is_override: false };
    let sources = std::iter::once(file).chain(overrides.iter().map(|o| overrides::source(o)));
    let report = Report::new(sources.collect());
    let mut root = match document::parse(text, 0) {
        Ok(root) => root,
        Err(errors) => {
            for (origin, message) in errors {
                let note = report.place("", origin, message);
                if text.get(origin.start..origin.end) == Some("solid") {
                    note.help("a scene has either one [solid] or several [[solid]]");
                }
            }
            return Err(report.into_errors(path));
        }
    };
    for (index, text) in overrides.iter().enumerate() {
        overrides::apply(&mut root, text, index + 1, &report);
    }
    let doubtful = parameters::resolve(&mut root, &report);
    let mut draft = read::scene(&root, path, &report, own_effects);
    draft.scene.doubtful = doubtful;
    draft.scene.name_joined_bodies();
    Check { scene: &draft.scene, root: &root, report: &report }.all();
    if report.is_empty() && draft.sound_speed_auto {
        let found = resources::sound_speed(&draft.scene, &root, &report);
        if let (Some(fluid), Some(speed)) = (&mut draft.scene.fluid, found) {
            fluid.sound_speed = speed;
        }
    }
    if draft.linear_auto {
        take_off_own_viscosity(&mut draft.scene);
    }
    if report.is_empty() {
        resources::check_memory(&draft.scene, &root, &report, resources::memory_available());
    }
    if report.is_empty() {
        resources::check_reach(&draft.scene, &root, &report);
    }
    if report.is_empty() {
        draft.scene.touch_free_bodies(&draft.contact_said);
    }
    if report.is_empty() {
        resources::check_clamps(&draft.scene, &root, &report);
        resources::check_loads(&draft.scene, &root, &report);
    }
    if report.is_empty() {
        resources::check_particles(&draft.scene, &root, &report);
    }
    if report.is_empty() {
        check_lattice::check_lattice(&draft.scene, &root, &report);
    }
    if report.is_empty() { Ok(draft.scene) } else { Err(report.into_errors(path)) }
}

/// What the fluid's own viscosity does need not be done by the artificial one: A h c0 / 16 less mu / rho0, at least 0.
fn take_off_own_viscosity(scene: &mut Scene) {
    let h = scene.smoothing_ratio * scene.resolution;
    if scene.effects.get(&EffectName::Viscosity) == Some(&Switch::Off) {
        return;
    }
    let Some(fluid) = scene.fluid.as_mut().filter(|fluid| fluid.viscosity > 0.0) else { return };
    let artificial = fluid.artificial_viscosity.kinematic(h, fluid.sound_speed);
    let left = (1.0 - fluid.viscosity / fluid.density / artificial).max(0.0);
    fluid.artificial_viscosity.linear *= left;
}

impl Scene {
    /// The scene as JSON, every number exact.
    ///
    /// # Errors
    /// Where its path is no Unicode; that of a scene from [`load`] is.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string(self)
    }

    /// A scene from the JSON that [`Scene::to_json`] wrote.
    ///
    /// # Errors
    /// Where the text is no such JSON.
    pub fn from_json(text: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(text)
    }
}
