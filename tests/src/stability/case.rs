//! What a case is, and where the cases are read from.

use super::criteria::Criterion;
use crate::run::{RunBuilder, repository, scene_at};
use serde::Deserialize;
use std::path::PathBuf;

/// One file of `tests/stability`: cases that belong together.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Family {
    /// Its heading in the table.
    pub title: String,
    /// Its cases.
    pub case: Vec<Case>,
}

/// A hard case.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// What is hard about it.
    pub name: String,
    /// Scene file in `tests/stability/scenes`, or in `scenes` with a leading `@`; without `.toml`.
    pub scene: String,
    /// Particle spacings, m, coarsest first: the short form runs the first one only.
    pub resolution: Vec<f64>,
    /// Simulated time, s.
    pub until: f64,
    /// Simulated time of the long form, s; as `until` if it is not given.
    pub until_long: Option<f64>,
    /// Overrides, `KEY=VALUE`.
    #[serde(default)]
    pub set: Vec<String>,
    /// Solid models to run it with; none for a fluid alone.
    #[serde(default)]
    pub models: Vec<String>,
    /// Only in the long form: one that is as hard stands beside it.
    #[serde(default)]
    pub long: bool,
    /// As three processes instead of threads of one.
    #[serde(default)]
    pub processes: bool,
    /// What must hold.
    pub criteria: Vec<Criterion>,
    /// Runs without its remedies.
    #[serde(default)]
    pub without: Vec<Without>,
}

/// A case whose remedy is taken away.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Without {
    /// What is taken away, for the table.
    pub what: String,
    /// Overrides that take it away.
    pub set: Vec<String>,
    /// The criterion that fails then, by its label; `"finished"`: the run diverges.
    #[serde(default)]
    pub fails: String,
    /// Nothing fails: the case is robust without this remedy.
    #[serde(default)]
    pub holds: bool,
    /// Models for which this is true; empty: all.
    #[serde(default)]
    pub models: Vec<String>,
    /// Particle spacings for which this is true, m; empty: all.
    #[serde(default)]
    pub resolution: Vec<f64>,
    /// What the program's error must contain where the run diverges.
    #[serde(default)]
    pub says: String,
}

impl Case {
    fn file(&self) -> PathBuf {
        let folder = repository();
        let file = match self.scene.strip_prefix('@') {
            Some(name) => folder.join("scenes").join(name),
            None => folder.join("tests/stability/scenes").join(&self.scene),
        };
        file.with_extension("toml")
    }

    /// Its scene has a fluid.
    pub fn has_fluid(&self) -> bool {
        let text = std::fs::read_to_string(self.file()).expect("a scene");
        text.lines().any(|line| line.starts_with("[fluid"))
    }

    /// A run of the case at a resolution.
    pub fn run(&self, resolution: f64, model: Option<&str>, long: bool, more: &[String]) -> RunBuilder {
        let mut run = scene_at(&self.file()).set("resolution", resolution);
        if let Some(model) = model {
            run = run.set("solid.model", model);
        }
        let until = if long { self.until_long.unwrap_or(self.until) } else { self.until };
        for over in self.set.iter().chain(more) {
            run = run.argument("--set").argument(over);
        }
        run = run.until(until).threads(1);
        if self.processes { run } else { run.in_process() }
    }

    /// Whether what is measured in this place, the end of the run first and then the criteria, is known to fail.
    pub(super) fn is_known_limit(&self, place: usize) -> bool {
        place.checked_sub(1).is_some_and(|k| !self.criteria[k].limit.is_empty())
    }

    /// Models to run it with; `None` for a fluid alone.
    pub fn each_model(&self) -> Vec<Option<&str>> {
        match &self.models[..] {
            [] => vec![None],
            models => models.iter().map(|m| Some(m.as_str())).collect(),
        }
    }
}

/// All families in the order of their files' names, with these names.
///
/// # Panics
/// A file cannot be read, or says something that no case has.
pub fn families() -> Vec<(String, Family)> {
    let folder = repository().join("tests/stability");
    let files = std::fs::read_dir(&folder).expect("the folder of the cases").flatten();
    let mut paths: Vec<PathBuf> = files.map(|f| f.path()).filter(|p| p.extension().is_some()).collect();
    paths.sort();
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).expect("a file of cases");
        let family = toml::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        (path.file_stem().expect("a name").to_string_lossy().into_owned(), family)
    };
    paths.into_iter().map(read).collect()
}
