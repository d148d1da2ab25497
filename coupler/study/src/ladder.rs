//! Which settings a study runs.

use super::error::StudyError;
use halfstep_scene::{self as scene, Geometry, Lattice, Phase, Scene};
use std::path::Path;
use std::str::FromStr;
use xxhash_rust::xxh3::xxh3_64;

/// Steps of the default ladder, the scene's own resolution included.
const RUNGS: u32 = 4;
/// Frames of each run: enough for its picture.
const FRAMES: f64 = 5.0;
/// Characters of a folder's name before its hash.
const LONGEST_NAME: usize = 60;

/// A key and the values that it is to take: `KEY=A,B,C`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vary {
    /// Dotted.
    pub key: String,
    /// As after `--set KEY=`.
    pub values: Vec<String>,
}

impl FromStr for Vary {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (key, values) = text.split_once('=').ok_or("it needs the form KEY=A,B,C")?;
        let values = split(values);
        if key.trim().is_empty() || values.iter().any(String::is_empty) {
            return Err("it needs the form KEY=A,B,C".into());
        }
        Ok(Self { key: key.trim().into(), values })
    }
}

/// Parts between commas that are in no bracket.
fn split(text: &str) -> Vec<String> {
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for c in text.chars() {
        match c {
            '[' | '{' => depth += 1,
            ']' | '}' => depth -= 1,
            _ => (),
        }
        match parts.last_mut() {
            Some(last) if c != ',' || depth > 0 => last.push(c),
            _ => parts.push(String::new()),
        }
    }
    parts.iter().map(|part| part.trim().to_owned()).collect()
}

/// The combinations of a ladder as overrides: the scene's own first, then one change at a time, or all combinations.
pub fn combinations(vary: &[Vary], full: bool) -> Vec<Vec<String>> {
    let set = |key: &str, value: &String| format!("{key}={value}");
    if !full {
        let singles = vary.iter().flat_map(|v| v.values.iter().map(|value| vec![set(&v.key, value)]));
        return std::iter::once(Vec::new()).chain(singles).collect();
    }
    vary.iter().fold(vec![Vec::new()], |made, v| {
        let with = |before: &Vec<String>, value| [&before[..], &[set(&v.key, value)]].concat();
        made.iter().flat_map(|before| v.values.iter().map(|value| with(before, value))).collect()
    })
}

/// A scene with what a study changed in it.
#[derive(Clone, Debug)]
pub struct Setting {
    /// What the ladder changes, `key=value`.
    pub changes: Vec<String>,
    /// Everything that is set: the command line's overrides, the ladder's changes, and what goes for every run.
    pub overrides: Vec<String>,
    /// The scene that results.
    pub scene: Scene,
}

impl Setting {
    /// Loads the scene with these changes.
    ///
    /// # Errors
    /// What is wrong with the scene.
    pub fn load(path: &Path, base: &[String], changes: &[String]) -> Result<Self, StudyError> {
        let mut overrides = [base, changes].concat();
        let scene = scene::load(path, &overrides)?;
        let chosen = overrides.iter().any(|o| o.starts_with("output."));
        let scene = if chosen {
            scene
        } else {
            overrides.push(format!("output.frame_interval={}", scene.end_time / FRAMES));
            scene::load(path, &overrides)?
        };
        Ok(Self { changes: changes.to_vec(), overrides, scene })
    }

    /// What changed, for tables; of the scene as it is, its resolution.
    pub fn label(&self) -> String {
        let own = || format!("resolution={}", self.scene.resolution);
        if self.changes.is_empty() { own() } else { self.changes.join(" ") }
    }

    /// What changed beside the resolution.
    pub fn choices(&self) -> Vec<String> {
        self.changes.iter().filter(|c| !c.starts_with("resolution=")).cloned().collect()
    }

    /// Name of the run's folder: readable, and different for different overrides.
    pub fn slug(&self) -> String {
        let keep = |c: char| if c.is_ascii_alphanumeric() || "=.-".contains(c) { c } else { '_' };
        let name = if self.changes.is_empty() { "own".into() } else { self.changes.join("+") };
        let name: String = name.chars().map(keep).take(LONGEST_NAME).collect();
        format!("{name}-{:08x}", xxh3_64(self.overrides.join("\n").as_bytes()) as u32)
    }

    /// Whether a run of the other is a run of this.
    pub fn same_run(&self, other: &Self) -> bool {
        content(&self.scene) == content(&other.scene)
    }
}

/// The scene as JSON, without what no run depends on.
pub fn content(scene: &Scene) -> Option<serde_json::Value> {
    let mut value = serde_json::to_value(scene).ok()?;
    strip(&mut value);
    Some(value)
}

/// Takes out what no run depends on: where the file lies, and what results are compared with.
pub fn strip(scene: &mut serde_json::Value) {
    if let Some(keys) = scene.as_object_mut() {
        ["path", "metrics", "references"].iter().for_each(|key| drop(keys.remove(*key)));
    }
}

/// The settings of a ladder.
#[derive(Debug)]
pub struct Settings {
    /// Each once.
    pub runs: Vec<Setting>,
    /// Changes that make the scene of another setting: both labels.
    pub repeated: Vec<[String; 2]>,
}

/// The settings of a ladder, each once.
///
/// # Errors
/// A combination is no valid scene.
pub fn settings(path: &Path, base: &[String], vary: &[Vary], full: bool) -> Result<Settings, StudyError> {
    let (mut runs, mut repeated): (Vec<Setting>, _) = (Vec::new(), Vec::new());
    for changes in combinations(vary, full) {
        let setting = Setting::load(path, base, &changes)?;
        match runs.iter().find(|s| s.same_run(&setting)) {
            Some(other) => repeated.push([setting.label(), other.label()]),
            None => runs.push(setting),
        }
    }
    Ok(Settings { runs, repeated })
}

/// The thinnest extent of a shape that moves, m: of those whose spacing is the scene's, where there are any.
pub fn thinnest(scene: &Scene) -> f64 {
    let moving = || scene.shapes.iter().filter(|s| s.phase != Phase::Wall);
    let spaced = moving().any(|s| s.spacing.is_none());
    let moving = moving().filter(|s| !spaced || s.spacing.is_none());
    let extents = moving.flat_map(|s| match s.geometry.unmoved() {
        Geometry::Box(b) | Geometry::Tank { cavity: b, .. } => {
            (0..scene.dimension).map(|a| b.max[a] - b.min[a]).collect()
        }
        Geometry::Disc { radius, .. } => vec![2.0 * radius],
        Geometry::Ring { inner, outer, .. } => vec![outer - inner],
        Geometry::Polygon(polygon) => vec![polygon.thickness().0],
        Geometry::Moved(_) => Vec::new(),
    });
    extents.fold(f64::INFINITY, f64::min)
}

/// Spacings that divide the thinnest shape into these numbers of particles.
pub fn dividing(scene: &Scene, particles: impl IntoIterator<Item = u32>) -> Vec<f64> {
    let (thickness, own) = (thinnest(scene), scene.resolution);
    let least = if scene.numerics.lattice == Lattice::Nodal { 3 } else { 2 };
    let counts = particles.into_iter().filter(|n| *n >= least).map(f64::from);
    // The scene's own spacing is kept as it is written.
    let snapped = counts.map(|n| if (thickness / n / own - 1.0).abs() < 1e-6 { own } else { thickness / n });
    snapped.collect()
}

/// The default ladder: the scene's own resolution and three coarser ones, each about sqrt(2) times the one before, and
/// such that the thinnest moving shape holds a whole number of particles. Coarser ones that the scene does not allow
/// are left out.
///
/// # Errors
/// The scene itself is not valid.
pub fn default_ladder(path: &Path, base: &[String]) -> Result<Vary, StudyError> {
    let own = Setting::load(path, base, &[])?.scene;
    let across = thinnest(&own) / own.resolution;
    let mut counts: Vec<u32> =
        (0..RUNGS).map(|k| (across / 2_f64.powf(0.5 * f64::from(k))).round() as u32).collect();
    counts.dedup();
    let mut spacings = dividing(&own, counts.into_iter().skip(1));
    spacings.retain(|dx| *dx > own.resolution);
    let values = spacings.iter().map(f64::to_string);
    let allowed = |dx: &String| Setting::load(path, base, &[format!("resolution={dx}")]).is_ok();
    Ok(Vary { key: "resolution".into(), values: values.filter(allowed).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vary(text: &str) -> Vary {
        text.parse().unwrap()
    }

    #[test]
    fn values_are_split_at_commas_outside_brackets() {
        assert_eq!(vary("resolution=0.01, 0.02").values, ["0.01", "0.02"]);
        assert_eq!(vary("shape.plate.box.max=[0.1,0.2],[0.1,0.3]").values, ["[0.1,0.2]", "[0.1,0.3]"]);
        for wrong in ["resolution", "=1,2", "resolution=", "resolution=1,,2"] {
            assert!(wrong.parse::<Vary>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn ladders_are_one_at_a_time_or_products() {
        let ladder = [vary("a=1,2"), vary("b=x,y,z")];
        let single = combinations(&ladder, false);
        assert_eq!(single.len(), 6);
        assert_eq!(
            (&single[0][..], &single[2][..], &single[5][..]),
            (&[][..], &["a=2".into()][..], &["b=z".into()][..])
        );
        let full = combinations(&ladder, true);
        assert_eq!(full.len(), 6);
        assert_eq!(full[1], ["a=1", "b=y"]);
        assert_eq!(full[5], ["a=2", "b=z"]);
        assert_eq!(combinations(&[], true), [Vec::<String>::new()]);
    }

    const SCENE: &str = "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
        phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [2.0, 1.0] }\n";

    fn scene_file() -> (tempfile::TempDir, std::path::PathBuf) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("pool.toml");
        std::fs::write(&path, SCENE).unwrap();
        (dir, path)
    }

    #[test]
    fn the_default_ladder_divides_the_thinnest_shape() {
        let (_dir, path) = scene_file();
        let ladder = default_ladder(&path, &[]).unwrap();
        // 10 particles over sqrt(2), 2 and 2 sqrt(2): 7, 5, 4.
        let spacings: Vec<f64> = ladder.values.iter().map(|v| v.parse().unwrap()).collect();
        assert_eq!(spacings, [1.0 / 7.0, 0.2, 0.25]);
        let settings = settings(&path, &[], &[ladder], false).unwrap().runs;
        assert_eq!(settings.len(), 4);
        assert_eq!(settings[0].label(), "resolution=0.1");
    }

    #[test]
    fn a_value_that_is_the_scenes_own_makes_no_further_run() {
        let (_dir, path) = scene_file();
        let ladder = [vary("resolution=0.1,0.2"), vary("numerics.cfl=0.25,0.6")];
        let Settings { runs: settings, repeated } = settings(&path, &[], &ladder, false).unwrap();
        assert_eq!(repeated.len(), 2);
        assert_eq!(repeated[1], ["numerics.cfl=0.6", "resolution=0.1"]);
        let labels: Vec<String> = settings.iter().map(Setting::label).collect();
        assert_eq!(labels, ["resolution=0.1", "resolution=0.2", "numerics.cfl=0.25"]);
        assert_eq!(settings[2].choices(), ["numerics.cfl=0.25"]);
        let slugs: Vec<String> = settings.iter().map(Setting::slug).collect();
        assert!(slugs[1].starts_with("resolution=0.2-") && slugs[1].len() == 23, "{slugs:?}");
        assert!(slugs[0] != slugs[1] && slugs[0].starts_with("own-"));
        assert!(super::settings(&path, &[], &[vary("numerics.cfl=7")], false).is_err());
    }
}
