//! A scene may have as many probes as its author wants.

use halfstep_tests::run::{repository, scene_at};
use std::fmt::Write;

#[test]
fn a_hundred_probes_have_a_hundred_columns() {
    let mut text = std::fs::read_to_string(repository().join("scenes/elastic-gate.toml")).unwrap();
    for k in 0..100 {
        // Up through the water beside the gate, 1 mm apart.
        let y = 0.02 + 1e-3 * f64::from(k);
        write!(text, "\n[[probe]]\nname = \"p{k}\"\nkind = \"pressure\"\nat = [0.05, {y}]\n").unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("probes.toml");
    // Curves of the literature lie beside the shipped scene.
    let text = text.replace("../validation/", &format!("{}/validation/", repository().display()));
    std::fs::write(&path, text).unwrap();
    let run = scene_at(&path).set("resolution", 0.0025).until(2e-4).run();
    let first = |k: u32| run.curve(&format!("p{k}.pressure")).values[0];
    // Hydrostatic: the pressure falls by rho g dy on the way up.
    let fall = (first(0) - first(80)) / (1000.0 * 9.81 * 0.08);
    assert!((fall - 1.0).abs() < 0.05, "{fall}");
    assert_eq!(run.probes.columns.iter().filter(|column| column.starts_with('p')).count(), 100);
}
