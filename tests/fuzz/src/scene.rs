//! Scenes, and the tables that they name.

use halfstep_scene::geometry::{domain, estimate, layout};
use halfstep_scene::{Scene, parse};
use std::path::Path;

/// Particles that are placed; counting them is enough beyond.
const PLACED: u64 = 20_000;

/// A scene's text, and overrides: lines after a line of `---`. A valid scene places its particles, and is the same
/// after it was written as JSON and read.
///
/// # Panics
/// A valid scene is not what it says, or what is said about a wrong one is empty or longer than a reader's patience.
pub fn scene(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let (text, overrides) = text.split_once("\n---\n").unwrap_or((&text, ""));
    let overrides: Vec<String> = overrides.lines().map(str::to_owned).collect();
    judge(text, Path::new("scene.toml"), &overrides);
}

/// A table that a scene refers to, as CSV: of a curve, and of a wall's motion.
///
/// # Panics
/// As [`scene`], or there is no folder for temporary files.
pub fn curve(bytes: &[u8]) {
    const SCENE: &str = r#"
resolution = 0.1
end_time = 1.0
[fluid]
density = 1000.0
[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [1.0, 1.0] }
[[probe]]
name = "front"
kind = "front"
[[reference]]
probe = "front.x"
label = "measured"
file = "curve.csv"
columns = ["t", "x"]
"#;
    const MOTION: &str = r#"
[[shape]]
name = "paddle"
phase = "wall"
box = { min = [-0.5, 0.0], max = [0.0, 1.0] }
motion = { file = "curve.csv", columns = { time = "t", x = "x", angle = "x" }, pivot = [0.0, 0.0], scale = 0.5 }
"#;
    beside("curve.csv", bytes, &[SCENE.to_owned(), SCENE.to_owned() + MOTION]);
}

/// An outline of walls, of water and of a solid, as CSV.
///
/// # Panics
/// As [`curve`].
pub fn outline(bytes: &[u8]) {
    shapes("outline.csv", bytes);
}

/// The same as a drawing, an SVG file.
///
/// # Panics
/// As [`curve`].
pub fn drawing(bytes: &[u8]) {
    shapes("outline.svg", bytes);
}

fn shapes(file: &str, bytes: &[u8]) {
    const SCENE: &str = r#"
resolution = 0.05
end_time = 1.0
[fluid]
density = 1000.0
[[shape]]
name = "around"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.5, 0.5] }
[[shape]]
name = "own"
phase = "PHASE"
outline = { file = "FILE", scale = 0.5 }
rotate = { angle = 30 }
"#;
    const SOLID: &str = "[solid]\nmodel = \"rigid\"\ndensity = 500.0\n";
    let of = |phase: &str| SCENE.replace("PHASE", phase).replace("FILE", file);
    beside(file, bytes, &[of("wall"), of("fluid"), of("void"), of("solid") + SOLID]);
}

/// Judges scenes that stand beside a file of this name.
fn beside(name: &str, bytes: &[u8], scenes: &[String]) {
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    std::fs::write(folder.path().join(name), bytes).expect("the folder takes a file");
    let path = folder.path().join("scene.toml");
    scenes.iter().for_each(|scene| judge(scene, &path, &[]));
}

fn judge(text: &str, path: &Path, overrides: &[String]) {
    match parse(text, path, overrides) {
        Ok(scene) => {
            let counts = estimate(&scene);
            let domain = domain(&scene);
            assert!((0..scene.dimension).all(|d| domain.min[d] <= domain.max[d]), "{domain:?}");
            if counts.total() <= PLACED {
                let placed = layout::<2>(&scene).counts().total();
                assert!(
                    placed <= counts.total(),
                    "{placed} particles, at most {} were expected",
                    counts.total()
                );
            }
            let json = scene.to_json().expect("a scene is JSON");
            assert_eq!(Scene::from_json(&json).expect("the JSON of a scene is one"), scene);
        }
        Err(errors) => {
            assert!(!errors.problems.is_empty());
            let length: usize = errors.problems.iter().map(|problem| problem.to_string().len()).sum();
            let report = format!("{:?}", miette::Report::new(errors));
            assert!(!report.is_empty() && length + report.len() < 1_000_000, "{length} + {}", report.len());
        }
    }
}
