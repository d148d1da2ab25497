//! The page's tables of the scene's JSON have every key of it.

use super::table;
use halfstep_tests::run::repository;
use serde_json::Value;
use std::collections::BTreeSet;

/// Objects that have a table of their own, wherever they stand.
const OWN_TABLES: [&str; 3] = ["geometry", "motion", "course"];
/// Keys of the scene whose values the page leaves to docs/scenes.md.
const UNSAID: [&str; 7] = ["interface", "output", "probes", "references", "metrics", "effects", "numerics"];

/// Keys with those that they stand in; below an object with a table of its own they begin with its name. A box, which
/// many keys have, is a value.
fn keys(value: &Value, place: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Array(items) => items.iter().for_each(|item| keys(item, place, found)),
        Value::Object(object) => {
            if object.keys().all(|key| key == "min" || key == "max") {
                return;
            }
            for (key, value) in object {
                let path = under(place, key);
                if !UNSAID.contains(&path.as_str()) {
                    keys(value, if OWN_TABLES.contains(&key.as_str()) { key } else { &path }, found);
                }
                found.insert(path);
            }
        }
        _ => {}
    }
}

fn under(place: &str, key: &str) -> String {
    if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") }
}

/// Keys that a cell names: "`a`, `b`", or "`a`: `b`, `c`" of an object and its keys.
fn named(cell: &str) -> Vec<String> {
    let names = |text: &str| -> Vec<String> {
        text.split(['`', ',', ' ']).filter(|name| !name.is_empty()).map(str::to_owned).collect()
    };
    let Some((object, inner)) = cell.split_once(':') else { return names(cell) };
    let mut all = names(object);
    assert_eq!(all.len(), 1, "{cell}");
    let inner = names(inner).into_iter().map(|key| under(&all[0], &key)).collect::<Vec<_>>();
    all.extend(inner);
    all
}

/// The tables of the scene's JSON have every key of it at its place, and no other.
#[test]
fn the_scenes_keys() {
    let path = repository().join("tests/tests/protocol_page/every_key.toml");
    let scene = halfstep_scene::load(&path, &[]).unwrap();
    let mut actual = BTreeSet::new();
    keys(&serde_json::to_value(&scene).unwrap(), "", &mut actual);
    let mut documented = BTreeSet::new();
    for (heading, place) in [
        ("**Keys of the scene**", ""),
        ("**Keys of the fluid**", "fluid"),
        ("**Keys of a solid**", "solid"),
        ("**Keys of a shape**", "shapes"),
        ("**Keys of a geometry**", "geometry"),
        ("**Keys of a motion**", "motion"),
        ("**Keys of a course**", "course"),
    ] {
        for row in table(heading) {
            for key in named(&row[0]) {
                assert!(documented.insert(under(place, &key)), "{heading} has {key} twice");
            }
        }
    }
    let missing: Vec<_> = actual.difference(&documented).collect();
    let unknown: Vec<_> = documented.difference(&actual).collect();
    assert!(
        missing.is_empty() && unknown.is_empty(),
        "not on the page: {missing:?}; not in the JSON: {unknown:?}"
    );
}
