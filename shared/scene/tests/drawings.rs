//! Outlines from drawings, as a scene names them.

use halfstep_scene::{Geometry, load};
use std::path::Path;

const SCENE: &str = r#"
resolution = 0.01
end_time = 1.0

[fluid]
density = 1000.0

[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.5, 0.1] }

[[shape]]
name = "hull"
phase = "wall"
outline = { file = "hull.svg", scale = 10 }
"#;

/// 100 by 50 mm: a square of 30 mm with a hole of 10 mm, and a triangle.
const DRAWING: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="50mm" viewBox="0 0 100 50">
<path id="frame" fill-rule="evenodd" d="M 10 10 h 30 v 30 h -30 z M 20 20 h 10 v 10 h -10 z"/>
<path id="keel" d="M 60 50 h 30 v -20 z"/>
<path id="apart" d="M 0 0 h 1 v 1 z M 5 5 h 2 v 2 z"/>
</svg>"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("hull.svg"), DRAWING).unwrap();
    std::fs::write(folder.path().join("hull.csv"), "x,y\n0,0\n1,0\n0,1\n").unwrap();
    folder
}

/// What the scene's errors say, with the last line of the scene replaced.
fn errors(folder: &Path, outline: &str) -> String {
    let path = folder.join("scene.toml");
    let with = SCENE.replace(r#"outline = { file = "hull.svg", scale = 10 }"#, outline);
    std::fs::write(&path, with).unwrap();
    let errors = load(&path, &[]).unwrap_err();
    errors.problems.iter().map(|problem| format!("{problem}\n")).collect()
}

#[test]
fn a_path_is_a_polygon_with_holes_ten_times_as_large() {
    let folder = folder();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, SCENE.replace("scale = 10", "scale = 10, id = \"frame\"")).unwrap();
    let scene = load(&path, &[]).unwrap();
    let Geometry::Polygon(polygon) = &scene.shapes[1].geometry else { panic!("no polygon") };
    // 0.3 x 0.3 m without 0.1 x 0.1 m; y = 50 mm - 40 mm below.
    assert!((polygon.area() - 0.08).abs() < 1e-6, "{}", polygon.area());
    let low = polygon.outline.iter().map(|corner| corner[1]).fold(f64::INFINITY, f64::min);
    assert!((low - 0.1).abs() < 1e-6, "{low}");
    assert_eq!((polygon.outline.len(), polygon.holes.len()), (4, 1));
}

#[test]
fn what_a_drawing_does_not_say_is_asked_for() {
    let folder = folder();
    let says = |outline: &str, expected: &str| {
        let text = errors(folder.path(), outline);
        assert!(text.contains(expected), "{text}\n{expected}");
    };
    says(
        r#"outline = { file = "hull.svg" }"#,
        "shows 3 paths: say which by `id`; its ids are `frame`, `keel` and `apart`",
    );
    says(r#"outline = { file = "hull.svg", id = "stem" }"#, "shows no path with the id `stem`");
    says(r#"outline = { file = "hull.svg", id = "apart" }"#, "a path is one region with its holes");
    says(
        r#"outline = { file = "hull.csv", id = "keel" }"#,
        "only a drawing, a file that ends in .svg, has paths",
    );
    says(r#"outline = { file = "none.svg" }"#, "cannot be read");
}
