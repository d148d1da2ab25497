//! Which crate may see which: the arrows of docs/architecture.md, held against what cargo says.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Each crate with the crates of the workspace that it may see, its tests and examples aside.
const ARROWS: &[(&str, &[&str])] = &[
    ("sph", &[]),
    ("scene", &["sph"]),
    ("wire", &["sph"]),
    ("link", &["wire"]),
    ("client", &["wire", "link"]),
    ("c", &["client"]),
    ("interface", &["sph", "scene", "wire"]),
    ("role", &["sph", "scene", "wire", "link"]),
    ("output", &["scene", "wire"]),
    ("fluid", &["sph", "scene", "wire", "interface", "role"]),
    ("solid", &["sph", "scene", "wire", "interface", "role"]),
    ("coupling", &["sph", "scene", "wire", "link", "interface", "role", "output", "fluid", "solid"]),
    ("halfstep", &["sph", "scene", "wire", "link", "role", "output", "fluid", "solid", "coupling"]),
    ("study", &["scene", "output", "coupling", "halfstep"]),
    ("cli", &["sph", "scene", "wire", "role", "output", "coupling", "halfstep", "study"]),
];

/// Libraries that only one crate (of the program; the test crates aside) may name.
const ALONE: &[(&str, &[&str])] = &[
    ("iceoryx2", &["link"]),
    ("hdf5-metno", &["output"]),
    ("plotters", &["output", "study"]),
    ("png", &["output"]),
    ("toml", &["scene"]),
    ("clap", &["study", "cli"]),
];

/// All that the kernel may bring along.
const OF_SPH: &[&str] = &["libm", "nalgebra", "rayon"];

fn short(name: &str) -> &str {
    name.strip_prefix("halfstep-").unwrap_or(name)
}

/// Direct dependencies of each crate of the program, by short name.
fn dependencies() -> BTreeMap<String, BTreeSet<String>> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(halfstep_tests::run::repository())
        .output()
        .expect("cargo runs");
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("cargo speaks JSON");
    let mut found = BTreeMap::new();
    for package in metadata["packages"].as_array().expect("packages") {
        let name = short(package["name"].as_str().expect("a name")).to_owned();
        if ["tests", "fuzz"].contains(&name.as_str()) || name.starts_with("example") {
            continue;
        }
        let all = package["dependencies"].as_array().expect("dependencies");
        let needed = all.iter().filter(|d| d["kind"].is_null());
        let names = needed.map(|d| short(d["name"].as_str().expect("a name")).to_owned()).collect();
        found.insert(name, names);
    }
    found
}

#[test]
fn crates_depend_in_one_direction() {
    let found = dependencies();
    let known: BTreeSet<&str> = ARROWS.iter().map(|(name, _)| *name).collect();
    let names: BTreeSet<&str> = found.keys().map(String::as_str).collect();
    assert_eq!(names, known, "the list of crates");
    for (name, allowed) in ARROWS {
        let own: BTreeSet<&str> =
            found[*name].iter().map(String::as_str).filter(|d| known.contains(d)).collect();
        let allowed: BTreeSet<&str> = allowed.iter().copied().collect();
        assert_eq!(own, allowed, "{name} sees");
    }
    // Each crate stands below all that it may see, so there is no circle.
    for (place, (name, allowed)) in ARROWS.iter().enumerate() {
        for seen in *allowed {
            let below = ARROWS[..place].iter().any(|(other, _)| other == seen);
            assert!(below, "{name} sees {seen}, which stands above");
        }
    }
}

#[test]
fn heavy_libraries_are_used_by_one_crate_each() {
    let found = dependencies();
    for (library, rooms) in ALONE {
        let users: Vec<&str> = found
            .iter()
            .filter(|(_, needs)| needs.contains(*library))
            .map(|(name, _)| name.as_str())
            .collect();
        let mut rooms = rooms.to_vec();
        rooms.sort_unstable();
        assert_eq!(users, rooms, "{library}");
    }
    assert_eq!(found["sph"].iter().map(String::as_str).collect::<Vec<_>>(), OF_SPH);
}
