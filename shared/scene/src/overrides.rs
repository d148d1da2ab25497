//! `--set dotted.key=value`: changes to a document before it is read; `--set dotted.key=` takes a key out.

use super::document::{Entry, Node, Origin, SourceText, Value, item_index, parse_value};
use super::error::{Report, listed, nearest};
use std::collections::BTreeMap;

/// Parts of a key: tables within tables within which no scene has anything.
const MAX_PARTS: usize = 16;

/// The source of an override.
pub(super) fn source(text: &str) -> SourceText {
    let name = format!("--set {text}");
    SourceText { text: name.as_str().into(), name, is_override: true }
}

/// Applies the override `text`, the source of that number. Items of an array of tables are addressed by their name or
/// by their index from 0; tables on the way that do not exist are made.
pub(super) fn apply(root: &mut Node, text: &str, source: usize, report: &Report) {
    let before = "--set ".len();
    let whole = Origin { source, start: before, end: before + text.len() };
    let Some((key, value)) = text.split_once('=') else {
        report.place("", whole, "is no override: it needs the form key=value");
        return;
    };
    let value_start = before + key.len() + 1 + (value.len() - value.trim_start().len());
    let value = value.trim();
    let key_origin = Origin { source, start: before, end: before + key.len() };
    let value_origin = Origin { source, start: value_start, end: value_start + value.len() };
    let parts: Vec<&str> = key.split('.').map(str::trim).collect();
    if parts.len() > MAX_PARTS {
        let reason =
            format!("is no override: its key has {} parts, at most {MAX_PARTS} mean anything", parts.len());
        report.place("", key_origin, reason);
        return;
    }
    if parts.iter().any(|part| part.is_empty()) {
        report.place("", key_origin, "is no override: a part of its key is empty");
        return;
    }
    if value.is_empty() {
        return take_out(root, &parts, key_origin, report);
    }
    // A text that is no TOML value is a string: `--set preset=kayaki` needs no quotes.
    let node = parse_value(value, source, value_start)
        .unwrap_or_else(|_| Node { value: Value::String(value.to_owned()), origin: value_origin });
    let node = Node { origin: value_origin, ..node };
    if let Some(slot) = find(root, &parts, key_origin, report) {
        *slot = node;
    }
}

/// Takes a key, or an item of an array, out of the document.
fn take_out(root: &mut Node, parts: &[&str], key: Origin, report: &Report) {
    let Some((last, before)) = parts.split_last() else { return };
    let missing = || _ = report.place("", key, "takes out what is not there");
    // What is missing is not made.
    if root.child_at(&parts.join(".")).is_none() {
        return missing();
    }
    match find(root, before, key, report).map(|node| &mut node.value) {
        Some(Value::Table(table)) => _ = table.remove(*last),
        Some(Value::Array(items)) => match item_index(items, last) {
            Some(index) => _ = items.remove(index),
            None => missing(),
        },
        _ => missing(),
    }
}

/// The place that a dotted key names, made where it is missing.
fn find<'n>(root: &'n mut Node, parts: &[&str], key: Origin, report: &Report) -> Option<&'n mut Node> {
    let mut at = root;
    for (depth, part) in parts.iter().enumerate() {
        let path = parts[..depth].join(".");
        let kind = at.value.kind();
        at = match &mut at.value {
            Value::Table(table) => {
                let last = depth + 1 == parts.len();
                let empty =
                    || Entry { key, node: Node { value: Value::Table(BTreeMap::new()), origin: key } };
                let entry = table.entry((*part).to_owned()).or_insert_with(empty);
                if last {
                    // An error about the key is the override's, not the file's.
                    entry.key = key;
                }
                &mut entry.node
            }
            Value::Array(items) => match item_index(items, part) {
                Some(index) => &mut items[index],
                None => {
                    let names: Vec<&str> = items.iter().filter_map(Node::name).collect();
                    let note = report.place("", key, format!("there is no `{part}` in `{path}`"));
                    match nearest(part, names.iter().copied()) {
                        Some(near) => note.help(format!("did you mean `{path}.{near}`?")),
                        None if names.is_empty() => note.help("items without a name have a number from 0"),
                        None => note.help(format!("`{path}` has {}", listed(names, "and"))),
                    }
                    return None;
                }
            },
            _ => {
                report.place("", key, format!("`{path}` is {kind} and has no `{part}`"));
                return None;
            }
        };
    }
    Some(at)
}
