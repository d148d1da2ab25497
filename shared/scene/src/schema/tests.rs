//! The reader and the table of keys know the same keys, of the same kinds and with the same defaults.

use super::*;
use crate::parse;
use std::path::Path;

type Fields = Map<String, Value>;

/// A value that a key of this kind may have.
fn sample(kind: &Kind) -> Value {
    match kind {
        Kind::Number(range) | Kind::NumberOrAuto(range) => {
            let fits = [0.4, 1.0, 2.0].into_iter().find(|x| range.holds(*x));
            json!(fits.expect("a number in the range"))
        }
        Kind::Integer(low, high) | Kind::IntegerOrAuto(low, high) => json!(2.clamp(*low, *high)),
        Kind::Boolean => json!(true),
        Kind::Text | Kind::Form(_) => json!("a"),
        Kind::Words(words) => json!(words()[0]),
        Kind::Vector => json!([0.5, 0.5]),
        Kind::Array(item, least, _) => json!(vec![sample(item); (*least).max(1)]),
        Kind::Row(kinds) => kinds.iter().map(sample).collect(),
        Kind::Either(kinds) => sample(&kinds[0]),
        Kind::Table(table) | Kind::TableOrTables(table) => Value::Object(least(table, None)),
        Kind::Tables(table) => json!([least(table, None)]),
        Kind::Switches => json!({ "viscosity": "on" }),
        Kind::Parameters => json!({ "L": 1.0 }),
    }
}

fn means(key: &Key, word: Option<&str>) -> bool {
    key.only.is_empty() || word.is_none_or(|word| key.only.contains(&word))
}

/// What a table must have, for a word of its tag.
fn least(table: &Table, word: Option<&str>) -> Fields {
    let one = table.one_of.first();
    let needed = table.all().filter(|key| key.required || Some(&key.name) == one);
    let mut fields: Fields = needed.map(|key| (key.name.to_owned(), sample(&key.kind))).collect();
    if let (Some(tag), Some(word)) = (table.tag, word) {
        fields.insert(tag.to_owned(), json!(word));
    }
    fields
}

/// With a further key; of those of which a table has one it replaces the other.
fn added(table: &Table, fields: &Fields, key: &str, value: Value) -> Fields {
    let mut fields = fields.clone();
    if table.one_of.contains(&key) {
        fields.retain(|other, _| !table.one_of.contains(&other.as_str()));
    }
    fields.insert(key.to_owned(), value);
    fields
}

/// All that is said about a scene.
fn said(scene: &Fields) -> Vec<String> {
    let text = toml::to_string(scene).expect("a scene as TOML");
    let errors = parse(&text, Path::new("s.toml"), &[]).err();
    errors.map_or(Vec::new(), |e| e.problems.iter().map(ToString::to_string).collect())
}

/// Compares the reader with a table, which `around` puts into a scene, and with the tables in it. Returns how many keys
/// were tried.
fn compare(table: &'static Table, around: &dyn Fn(Fields) -> Fields) -> usize {
    let words: Vec<Option<&str>> = match table.tag.and_then(|tag| table.key(tag)) {
        Some(Key { kind: Kind::Words(words), .. }) => words().into_iter().map(Some).collect(),
        _ => vec![None],
    };
    let mut tried = 0;
    for word in words {
        let with = |fields: &Fields, key: &str, value: Value| said(&around(added(table, fields, key, value)));
        let unknown =
            |said: &[String], key: &str| said.iter().any(|s| s.ends_with(&format!("{key}: unknown key")));
        // Where a key is missing the others may not be looked at: then all that belong to the word are there.
        let own = table.all().filter(|key| word.is_some_and(|word| key.only.contains(&word)));
        let mut all = least(table, word);
        all.extend(own.map(|key| (key.name.to_owned(), sample(&key.kind))));
        let mut bases = [least(table, word), all].into_iter();
        let base = bases.find(|base| unknown(&with(base, "zzz", json!(1)), "zzz"));
        let base = base.unwrap_or_else(|| panic!("{} {word:?}: unknown keys pass", table.name));
        for key in table.all() {
            let said = with(&base, key.name, sample(&key.kind));
            let place = format!("{} {word:?} {}", table.name, key.name);
            if means(key, word) {
                assert!(!unknown(&said, key.name), "{place}: {said:#?}");
                let kinds = [", not a", ", not true", "is read, but stands in no table"];
                assert!(!said.iter().any(|s| kinds.iter().any(|k| s.contains(k))), "{place}: {said:#?}");
            } else {
                let refused = said.iter().any(|s| {
                    s.contains(&format!("{}: ", key.name)) || s.contains(&format!("{} = ", key.name))
                });
                assert!(refused, "{place} is not refused: {said:#?}");
            }
            tried += 1;
            if let (Some(inner), true) = (key.kind.table(), means(key, word)) {
                let several = matches!(key.kind, Kind::Tables(_));
                let within = |fields: Fields| {
                    let fields = Value::Object(fields);
                    let value = if several { json!([fields]) } else { fields };
                    let mut outer = added(table, &base, key.name, value);
                    if key.name == "columns" {
                        outer.insert("file".to_owned(), json!("a.csv"));
                    }
                    around(outer)
                };
                tried += compare(inner, &within);
                tried += inner.instead.map_or(0, |(_, other)| compare(other, &within));
            }
        }
    }
    tried
}

#[test]
fn the_reader_and_the_table_know_the_same_keys() {
    let tried = compare(&SCENE, &|scene| scene);
    assert!(tried > 500, "{tried} keys");
}

/// Tries the default of every key that a table of a document could have and has not.
fn try_defaults(table: &'static Table, value: &Value, path: &str, same: &dyn Fn(&str) -> bool) -> usize {
    let join = |part: &str| if path.is_empty() { part.to_owned() } else { format!("{path}.{part}") };
    if let Value::Array(items) = value {
        let part = |(index, item): (usize, &Value)| match item.get("name") {
            Some(Value::String(name)) => join(name),
            _ => join(&index.to_string()),
        };
        return items.iter().enumerate().map(|i| try_defaults(table, i.1, &part(i), same)).sum();
    }
    let table = match table.instead {
        Some((sign, other)) if value.get(sign).is_some() => other,
        _ => table,
    };
    let word = table.tag.and_then(|tag| value.get(tag)?.as_str());
    let mut tried = 0;
    let sure = |key: &&Key| means(key, word) && (key.only.is_empty() || word.is_some());
    for key in table.all().filter(sure) {
        match (value.get(key.name), serde_json::from_str::<Value>(key.default)) {
            (Some(value), _) => {
                tried += key.kind.table().map_or(0, |t| try_defaults(t, value, &join(key.name), same))
            }
            // Those that only some motions and curves have.
            (None, Ok(_)) if ["motion", "reference"].contains(&table.name) => {}
            (None, Ok(default)) => {
                let set = format!("{}={default}", join(key.name));
                assert!(same(&set), "{set} changes the scene");
                tried += 1;
            }
            (None, Err(_)) => {}
        }
    }
    tried
}

#[test]
fn a_default_that_is_said_changes_nothing() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut tried = 0;
    for name in ["elastic-gate-rubber", "floating-box", "wave-paddle", "two-plates", "taylor-green"] {
        let path = folder.join(name).with_extension("toml");
        let text = std::fs::read_to_string(&path).unwrap();
        let document: Value = toml::from_str(&text).unwrap();
        let plain = parse(&text, &path, &[]).unwrap();
        let same = |set: &str| match parse(&text, &path, &[set.to_owned()]) {
            Ok(scene) => scene == plain,
            Err(errors) => panic!("{name} {set}: {:?}", miette::Report::new(errors)),
        };
        tried += try_defaults(&SCENE, &document, "", &same);
    }
    assert!(tried > 50, "{tried} defaults");
}
