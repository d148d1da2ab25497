//! The table of keys as a JSON schema, for editors.

use super::EffectName;
use super::keys::words as names;
use super::keys::{Key, Kind, SCENE, Table};
use super::read;
use serde_json::{Map, Value, json};

/// JSON schema (draft 2020-12) of a scene's TOML: every key with its kind, range, words, default, unit and meaning.
///
/// It is made from the table of keys that the reader takes ranges from. What concerns several keys at once, such as
/// names that have to be those of a shape, it does not say; [`crate::load`] does.
pub fn schema() -> Value {
    let mut tables = Map::new();
    let mut scene = table(&SCENE, &mut tables);
    tables.insert(
        "formula".into(),
        json!({
            "type": "string",
            "pattern": "^=",
            "description": "A formula, such as \"=L / 2\", of the names in [parameters].",
        }),
    );
    scene.extend([
        ("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema")),
        ("title".to_owned(), json!("halfstep scene")),
        ("$defs".to_owned(), Value::Object(tables)),
    ]);
    Value::Object(scene)
}

/// A table as a schema; those within it go to `tables`.
fn table(of: &Table, tables: &mut Map<String, Value>) -> Map<String, Value> {
    let properties: Map<_, _> = of.all().map(|key| (key.name.to_owned(), property(key, tables))).collect();
    let mut schema = Map::from_iter([
        ("type".to_owned(), json!("object")),
        ("description".to_owned(), json!(of.doc)),
        ("properties".to_owned(), Value::Object(properties)),
        ("additionalProperties".to_owned(), json!(false)),
    ]);
    let required: Vec<&str> = of.all().filter(|key| key.required).map(|key| key.name).collect();
    if !required.is_empty() {
        schema.insert("required".into(), json!(required));
    }
    if !of.one_of.is_empty() {
        let one: Vec<Value> = of.one_of.iter().map(|key| json!({ "required": [key] })).collect();
        schema.insert("oneOf".into(), json!(one));
    }
    let conditions = conditions(of);
    if !conditions.is_empty() {
        schema.insert("allOf".into(), json!(conditions));
    }
    schema
}

/// For each word of the tag the keys that mean nothing beside it.
fn conditions(of: &Table) -> Vec<Value> {
    let Some(Key { name: tag, kind: Kind::Words(words), .. }) = of.tag.and_then(|tag| of.key(tag)) else {
        return Vec::new();
    };
    let condition = |word: &str| {
        let foreign = of.all().filter(|key| !key.only.is_empty() && !key.only.contains(&word));
        let none: Map<_, _> = foreign.map(|key| (key.name.to_owned(), json!(false))).collect();
        let told = json!({ "properties": { *tag: { "const": word } }, "required": [tag] });
        (!none.is_empty()).then(|| json!({ "if": told, "then": { "properties": none } }))
    };
    words().into_iter().filter_map(condition).collect()
}

fn property(key: &Key, tables: &mut Map<String, Value>) -> Value {
    let mut schema = kind(&key.kind, tables);
    let mut text = key.doc.to_owned();
    if !key.unit.is_empty() {
        text += &format!(" Unit: {}.", key.unit);
    }
    if !key.only.is_empty() {
        text += &format!(" Only for {}.", key.only.join(", "));
    }
    if key.required {
        text += " Required.";
    } else if let Ok(default) = serde_json::from_str::<Value>(key.default) {
        schema.insert("default".into(), default);
    } else if !key.default.is_empty() {
        text += &format!(" Default: {}.", key.default);
    }
    schema.insert("description".into(), json!(text));
    Value::Object(schema)
}

fn kind(of: &Kind, tables: &mut Map<String, Value>) -> Map<String, Value> {
    let schema = match of {
        Kind::Number(_) => json!({ "anyOf": numbers(of) }),
        Kind::NumberOrAuto(_) => {
            let mut any = numbers(of);
            any.push(json!({ "const": "auto" }));
            json!({ "anyOf": any })
        }
        Kind::Integer(..) => json!({ "anyOf": integers(of) }),
        Kind::IntegerOrAuto(..) => {
            let mut any = integers(of);
            any.push(json!({ "const": "auto" }));
            json!({ "anyOf": any })
        }
        Kind::Boolean => json!({ "type": "boolean" }),
        Kind::Text => json!({ "type": "string" }),
        Kind::Form(form) => json!({ "type": "string", "pattern": form }),
        Kind::Words(words) => json!({ "enum": words() }),
        Kind::Vector => array(Value::Object(kind(&Kind::COMPONENT, tables)), 2, 2),
        Kind::Array(item, least, most) => array(Value::Object(kind(item, tables)), *least, *most),
        Kind::Row(kinds) => {
            let items: Vec<Value> = kinds.iter().map(|k| Value::Object(kind(k, tables))).collect();
            json!({ "type": "array", "prefixItems": items, "minItems": items.len(), "items": false })
        }
        Kind::Either(kinds) => {
            let any: Vec<Value> = kinds.iter().map(|k| Value::Object(kind(k, tables))).collect();
            json!({ "anyOf": any })
        }
        Kind::Table(table) => reference(table, tables),
        Kind::Tables(table) => json!({ "type": "array", "items": reference(table, tables) }),
        Kind::TableOrTables(table) => {
            let one = reference(table, tables);
            // Where the wrong one of the two is told apart by its type, an editor's message names the key.
            json!({ "if": { "type": "array" }, "then": { "type": "array", "items": one }, "else": one })
        }
        Kind::Switches => {
            let switch = json!({ "enum": names(&read::SWITCHES), "default": "auto" });
            let effects: Map<_, _> =
                EffectName::ALL.iter().map(|effect| (effect.name().to_owned(), switch.clone())).collect();
            json!({ "type": "object", "properties": effects, "additionalProperties": false })
        }
        Kind::Parameters => json!({
            "type": "object",
            "propertyNames": { "pattern": "^[A-Za-z][A-Za-z0-9_]*$" },
            "additionalProperties": { "anyOf": [{ "type": "number" }, formula()] },
        }),
    };
    match schema {
        Value::Object(schema) => schema,
        _ => Map::new(),
    }
}

fn formula() -> Value {
    json!({ "$ref": "#/$defs/formula" })
}

fn numbers(of: &Kind) -> Vec<Value> {
    let mut number = Map::from_iter([("type".to_owned(), json!("number"))]);
    number.extend(of.range().ends().map(|(word, end)| (word.to_owned(), json!(end))));
    vec![Value::Object(number), formula()]
}

fn integers(of: &Kind) -> Vec<Value> {
    let (low, high) = of.whole();
    vec![json!({ "type": "integer", "minimum": low, "maximum": high }), formula()]
}

fn array(item: Value, least: usize, most: usize) -> Value {
    let mut schema = json!({ "type": "array", "items": item, "minItems": least });
    if most < usize::MAX {
        schema["maxItems"] = json!(most);
    }
    schema
}

/// A reference to a table, which is written once.
fn reference(of: &'static Table, tables: &mut Map<String, Value>) -> Value {
    let to = |of: &Table| json!({ "$ref": format!("#/$defs/{}", of.name) });
    if !tables.contains_key(of.name) {
        let schema = table(of, tables);
        tables.insert(of.name.to_owned(), Value::Object(schema));
    }
    match of.instead {
        None => to(of),
        Some((sign, other)) => {
            let other = reference(other, tables);
            json!({ "if": { "required": [sign] }, "then": other, "else": to(of) })
        }
    }
}

#[cfg(test)]
mod tests;
