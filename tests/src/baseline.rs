//! Baselines: coarse, short runs of the shipped scenes whose results are stored and compared bit for bit.
//!
//! `validation/CASE/baseline.toml` lists the runs of the scene CASE. Their results lie beside it: `baseline.json` has
//! state hash and number of steps of each run and instruction set level, `baseline/RUN-LEVEL.csv` the probes. The
//! levels are those of [`Isa::bits_name`].

use crate::run::{Finished, RunBuilder, repository, scene};
use halfstep::isa::{self, ISA_VARIABLE};
use halfstep_output::{Table, read_probes};
use halfstep_sph::lane::Isa;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What to do about a difference that is meant.
const REMEDY: &str = "If the change is meant: make baselines, and say why in CHANGELOG.md.";

/// `baseline.toml`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Runs {
    run: Vec<Baseline>,
}

/// One run of a case.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    /// The case's folder and scene; the folder says it, not the file.
    #[serde(skip)]
    pub case: String,
    /// Name of the run, unique in the case.
    pub name: String,
    /// Overrides, `KEY=VALUE`.
    #[serde(default)]
    pub set: Vec<String>,
    /// Simulated time, s.
    pub until: f64,
}

/// What is compared of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Hash of the final state.
    pub state_hash: String,
    /// Number of steps.
    pub steps: u64,
    /// Every row of `probes.csv`.
    pub probes: Table,
}

/// A run and a level in `baseline.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Summary {
    state_hash: String,
    steps: u64,
}

/// `baseline.json`: by run, then by level.
type Summaries = BTreeMap<String, BTreeMap<String, Summary>>;

/// The folder of the cases.
pub fn folder() -> PathBuf {
    repository().join("validation")
}

/// All runs of all cases, by case and then as the case's file lists them.
///
/// # Panics
/// A case has no readable list of runs, or two of its runs have one name.
pub fn baselines() -> Vec<Baseline> {
    let entries = std::fs::read_dir(folder()).expect("the folder of the cases");
    let mut paths: Vec<PathBuf> =
        entries.flatten().map(|entry| entry.path().join("baseline.toml")).filter(|p| p.exists()).collect();
    paths.sort();
    let read = |path: &PathBuf| -> Vec<Baseline> {
        let text = std::fs::read_to_string(path).expect("a case's runs");
        let runs: Runs = toml::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let case = path.parent().and_then(Path::file_name).expect("a case's folder").to_string_lossy();
        let mut names: Vec<&str> = runs.run.iter().map(|run| run.name.as_str()).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{}: {names:?}", path.display());
        runs.run.into_iter().map(|run| Baseline { case: case.clone().into_owned(), ..run }).collect()
    };
    paths.iter().flat_map(read).collect()
}

/// The best level of this processor, and the lowest one where its bits are others.
pub fn levels() -> Vec<Isa> {
    let best = Isa::detect();
    let lowest = (best.bits_name() != Isa::Baseline.bits_name()).then_some(Isa::Baseline);
    std::iter::once(best).chain(lowest).collect()
}

impl Baseline {
    /// The run at a level that this processor has, to be configured further.
    pub fn builder(&self, level: Isa) -> RunBuilder {
        self.builder_until(level, self.until)
    }

    /// The same until another time, s.
    pub fn builder_until(&self, level: Isa, until: f64) -> RunBuilder {
        let run = scene(&self.case).until(until).variable(ISA_VARIABLE, isa::name(level));
        self.set.iter().fold(run, |run, over| run.argument("--set").argument(over))
    }

    /// What a run of this baseline at a level has come to.
    ///
    /// # Panics
    /// The run was computed at another level.
    pub fn record(&self, level: Isa, run: &Finished) -> Record {
        let (state_hash, isa) = run.state_hash();
        assert_eq!(isa.as_deref(), Some(level.bits_name()), "{}/{}", self.case, self.name);
        Record { state_hash, steps: run.report.steps, probes: run.probes.clone() }
    }

    /// What is stored for a level; `None` where nothing is.
    ///
    /// # Panics
    /// A stored file cannot be read.
    pub fn stored(&self, level: Isa) -> Option<Record> {
        let Summary { state_hash, steps } = self.summaries().get(&self.name)?.get(level.bits_name())?.clone();
        let curves = self.curves(level);
        let probes = curves.exists().then(|| read_probes(&curves).unwrap_or_else(|e| panic!("{e}")))?;
        Some(Record { state_hash, steps, probes })
    }

    /// Stores a run at a level.
    ///
    /// # Panics
    /// A file cannot be written.
    pub fn store(&self, level: Isa, run: &Finished) {
        let Record { state_hash, steps, .. } = self.record(level, run);
        let mut all = self.summaries();
        let levels = all.entry(self.name.clone()).or_default();
        levels.insert(level.bits_name().into(), Summary { state_hash, steps });
        let text = serde_json::to_string_pretty(&all).expect("strings and numbers") + "\n";
        std::fs::write(self.summary_file(), text).expect("baseline.json");
        let curves = self.curves(level);
        std::fs::create_dir_all(curves.parent().expect("a folder")).expect("the folder of the curves");
        std::fs::copy(run.dir().join("probes.csv"), curves).expect("the run's probes");
    }

    /// How a record differs from what is stored, with what to do about it; `None` where it does not.
    pub fn difference(&self, level: Isa, found: &Record) -> Option<String> {
        let what = format!("{}/{}, {}", self.case, self.name, level.bits_name());
        let Some(stored) = self.stored(level) else {
            return Some(format!("{what}: no baseline is stored for this level. Store one: make baselines"));
        };
        let lines = stored.differences(found);
        (!lines.is_empty()).then(|| format!("{what}:\n  {}\n  {REMEDY}", lines.join("\n  ")))
    }

    /// The stored probes of a level.
    pub fn curves(&self, level: Isa) -> PathBuf {
        let file = format!("{}-{}.csv", self.name, level.bits_name());
        folder().join(&self.case).join("baseline").join(file)
    }

    fn summary_file(&self) -> PathBuf {
        folder().join(&self.case).join("baseline.json")
    }

    fn summaries(&self) -> Summaries {
        let path = self.summary_file();
        let Ok(text) = std::fs::read_to_string(&path) else { return Summaries::new() };
        serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    }
}

/// What is stored of a case without being one of its runs' results: names of runs and of files with curves.
///
/// # Panics
/// A stored file cannot be read.
pub fn leftovers(all: &[Baseline]) -> Vec<String> {
    let mut found = Vec::new();
    for one in all {
        let of_case = || all.iter().filter(|other| other.case == one.case);
        let unknown = |name: &String| of_case().all(|other| other.name != *name);
        found.extend(one.summaries().into_keys().filter(unknown).map(|name| format!("{}: {name}", one.case)));
        let files = std::fs::read_dir(folder().join(&one.case).join("baseline")).into_iter().flatten();
        let expected = |path: &PathBuf| {
            of_case()
                .any(|other| [Isa::Baseline, Isa::Avx2].iter().any(|level| other.curves(*level) == *path))
        };
        let strays = files.flatten().map(|entry| entry.path()).filter(|path| !expected(path));
        found.extend(strays.map(|path| path.display().to_string()));
    }
    found.sort();
    found.dedup();
    found
}

impl Record {
    /// How another record differs from this one, a line for each of hash, steps and probes.
    pub fn differences(&self, found: &Self) -> Vec<String> {
        let mut lines = Vec::new();
        if self.state_hash != found.state_hash {
            lines.push(format!("state hash: expected {}, found {}", self.state_hash, found.state_hash));
        }
        if self.steps != found.steps {
            lines.push(format!("steps: expected {}, found {}", self.steps, found.steps));
        }
        lines.extend(first_difference(&self.probes, &found.probes));
        lines
    }
}

/// The first place at which two tables differ in a bit.
fn first_difference(expected: &Table, found: &Table) -> Option<String> {
    if expected.columns != found.columns {
        return Some(format!("columns: expected {:?}, found {:?}", expected.columns, found.columns));
    }
    for (k, (a, b)) in expected.rows.iter().zip(&found.rows).enumerate() {
        if let Some(c) = (0..a.len()).find(|&c| a[c].to_bits() != b[c].to_bits()) {
            let (row, column) = (k + 1, &expected.columns[c]);
            return Some(format!("probes: row {row}, {column}: expected {:e}, found {:e}", a[c], b[c]));
        }
    }
    let rows = (expected.rows.len(), found.rows.len());
    (rows.0 != rows.1).then(|| format!("probes: expected {} rows, found {}", rows.0, rows.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bit_that_differs_is_named() {
        let probes = Table {
            columns: vec!["time [s]".into(), "tip.x [m]".into()],
            rows: vec![vec![0.0, f64::NAN], vec![0.5, 0.25]],
        };
        let stored = Record { state_hash: "a".into(), steps: 7, probes };
        assert_eq!(stored.differences(&stored.clone()), [""; 0]);
        let mut other = Record { state_hash: "b".into(), steps: 8, ..stored.clone() };
        other.probes.rows[1][1] = 0.25_f64.next_up();
        assert_eq!(
            stored.differences(&other),
            [
                "state hash: expected a, found b",
                "steps: expected 7, found 8",
                "probes: row 2, tip.x [m]: expected 2.5e-1, found 2.5000000000000006e-1"
            ]
        );
        let mut signed = stored.clone();
        signed.probes.rows[0][0] = -0.0;
        assert_eq!(stored.differences(&signed), ["probes: row 1, time [s]: expected 0e0, found -0e0"]);
        let mut short = stored.clone();
        short.probes.rows.pop();
        assert_eq!(stored.differences(&short), ["probes: expected 2 rows, found 1"]);
        let mut renamed = stored.clone();
        renamed.probes.columns.pop();
        assert_eq!(stored.differences(&renamed).len(), 1);
    }
}
