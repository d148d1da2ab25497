//! The JSON schema of scenes: the file that editors read is the one of today, and takes every scene of the repository.

use halfstep_scene::schema;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Where the scenes of the repository lie.
const FOLDERS: [&str; 5] =
    ["scenes", "tests/set-ups", "tests/stability/scenes", "coupler/cli/templates", "python/examples/mujoco"];
/// What a shipped scene says to an editor.
const LINE: &str = "#:schema ../docs/scene.schema.json\n";

#[test]
fn the_schema_takes_every_scene() {
    let schema = jsonschema::draft202012::new(&schema()).expect("a schema");
    for folder in FOLDERS {
        let entries = repository().join(folder).read_dir().expect(folder).map(|entry| entry.unwrap().path());
        let scenes: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
        assert!(!scenes.is_empty(), "{folder}");
        for path in scenes {
            let text = std::fs::read_to_string(&path).unwrap();
            let scene: Value = toml::from_str(&text).unwrap();
            let wrong: Vec<String> =
                schema.iter_errors(&scene).map(|e| format!("{}: {e}", e.instance_path())).collect();
            assert!(wrong.is_empty(), "{}: {wrong:#?}", path.display());
            assert!(folder != "scenes" || text.starts_with(LINE), "{} has no {LINE}", path.display());
        }
    }
}

#[test]
fn the_schema_of_the_documentation_is_that_of_the_program() {
    let path = repository().join("docs/scene.schema.json");
    let renewed = format!("{:#}\n", schema());
    assert!(
        std::fs::read_to_string(&path).is_ok_and(|text| text == renewed),
        "{}: halfstep schema > docs/scene.schema.json renews it",
        path.display()
    );
}

#[test]
fn every_key_says_what_it_means() {
    let schema = schema();
    let tables = schema["$defs"].as_object().unwrap().values().chain([&schema]);
    let keys = tables.filter_map(|table| table["properties"].as_object()).flatten();
    let mut told = 0;
    for (key, property) in keys {
        let text = property["description"].as_str().unwrap_or_default();
        assert!(text.len() > 5 && text.ends_with('.'), "{key}: {text}");
        told += 1;
    }
    assert!(told > 150, "{told} keys");
}
