//! A TOML document in which every key and value knows where it was written: in the file or in an override.

use super::brackets;
use std::collections::BTreeMap;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A text that values come from.
#[derive(Clone, Debug)]
pub(super) struct SourceText {
    /// The file's path; for an override its own text, `--set key=value`.
    pub(super) name: String,
    pub(super) text: Arc<str>,
    pub(super) is_override: bool,
}

/// Bytes `start..end` of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Origin {
    pub(super) source: usize,
    pub(super) start: usize,
    pub(super) end: usize,
}

#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) value: Value,
    pub(super) origin: Origin,
}

#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) key: Origin,
    pub(super) node: Node,
}

#[derive(Clone, Debug)]
pub(super) enum Value {
    Table(BTreeMap<String, Entry>),
    Array(Vec<Node>),
    String(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Date,
}

impl Value {
    /// Kind of the value, for a message.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Table(_) => "a table",
            Self::Array(_) => "an array",
            Self::String(_) => "a string",
            Self::Integer(_) => "an integer",
            Self::Float(_) => "a number",
            Self::Boolean(_) => "true or false",
            Self::Date => "a date",
        }
    }
}

/// A syntax error: where, and what.
pub(super) type Syntax = (Origin, String);

/// Reads a whole file.
pub(super) fn parse(text: &str, source: usize) -> Result<Node, Vec<Syntax>> {
    let (table, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        // All that follows an open bracket are errors that do not name it.
        if let Some(start) = brackets::unclosed(text) {
            let origin = Origin { source, start, end: start + 1 };
            return Err(vec![(origin, "this bracket is not closed".into())]);
        }
        // What comes after the first one may follow from it.
        let first = errors.iter().map(|e| syntax(e, text, source, 0)).min_by_key(|(origin, _)| origin.start);
        return Err(first
            .map(|(origin, message)| (origin, explained(text, origin, message)))
            .into_iter()
            .collect());
    }
    let origin = Origin { source, start: 0, end: 0 };
    Ok(Node { value: table_value(table.get_ref(), source, 0), origin })
}

/// Reads one value that starts at byte `offset` of its source.
pub(super) fn parse_value(text: &str, source: usize, offset: usize) -> Result<Node, Syntax> {
    match DeValue::parse(text) {
        Ok(value) => Ok(node(&value, source, offset)),
        Err(error) => Err(syntax(&error, text, source, offset)),
    }
}

/// Lists of tables.
const LISTS: [&str; 4] = ["shape", "probe", "solid", "contact"];

/// A message of the parser that says what is meant where it can be told.
fn explained(text: &str, Origin { start, end, .. }: Origin, message: String) -> String {
    let rest = text.get(start..).unwrap_or_default();
    let is_head = text.get(..start).unwrap_or_default().ends_with('[');
    let key = text.get(start..end).unwrap_or_default();
    match rest.chars().next() {
        Some(']' | '}') => "this bracket closes none".into(),
        _ if is_head && LISTS.contains(&key) => format!("{message}: of several, each begins with [[{key}]]"),
        _ => message,
    }
}

fn syntax(error: &toml::de::Error, text: &str, source: usize, offset: usize) -> Syntax {
    let span = error.span().unwrap_or(0..0);
    let end = span.end.min(text.len());
    let origin = Origin { source, start: offset + span.start.min(end), end: offset + end };
    (origin, error.message().replace('\n', ", "))
}

fn node(spanned: &Spanned<DeValue<'_>>, source: usize, offset: usize) -> Node {
    let value = match spanned.get_ref() {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
            Ok(number) => Value::Integer(number),
            // Too large for an integer; ranges are checked later.
            Err(_) => Value::Float(digits.as_str().parse().unwrap_or(f64::NAN)),
        },
        DeValue::Float(digits) => Value::Float(digits.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(value) => Value::Boolean(*value),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(items) => Value::Array(items.iter().map(|n| node(n, source, offset)).collect()),
        DeValue::Table(table) => table_value(table, source, offset),
    };
    Node { value, origin: origin(spanned.span(), source, offset) }
}

fn table_value(table: &DeTable<'_>, source: usize, offset: usize) -> Value {
    let entries = table.iter().map(|(key, value)| {
        let entry = Entry { key: origin(key.span(), source, offset), node: node(value, source, offset) };
        (key.get_ref().to_string(), entry)
    });
    Value::Table(entries.collect())
}

fn origin(span: std::ops::Range<usize>, source: usize, offset: usize) -> Origin {
    Origin { source, start: offset + span.start, end: offset + span.end }
}

impl Node {
    pub(super) fn table(&self) -> Option<&BTreeMap<String, Entry>> {
        match &self.value {
            Value::Table(table) => Some(table),
            _ => None,
        }
    }

    /// Whether nothing in it was written in another source, such as an override.
    pub(super) fn is_of_one_source(&self) -> bool {
        let own = |node: &Node| node.origin.source == self.origin.source && node.is_of_one_source();
        match &self.value {
            Value::Table(table) => table.values().all(|entry| own(&entry.node)),
            Value::Array(items) => items.iter().all(own),
            _ => true,
        }
    }

    /// Where the value at a dotted path was written, or else the nearest table around it that was.
    pub(super) fn origin_of(&self, path: &str) -> Origin {
        let mut at = self;
        for part in path.split('.') {
            match at.child(part) {
                Some(child) => at = child,
                None => break,
            }
        }
        at.origin
    }

    /// The value at a dotted path.
    pub(super) fn child_at(&self, path: &str) -> Option<&Node> {
        path.split('.').try_fold(self, |at, part| at.child(part))
    }

    /// The value under a key; in an array the table of that name or the item of that index.
    pub(super) fn child(&self, part: &str) -> Option<&Node> {
        match &self.value {
            Value::Table(table) => table.get(part).map(|entry| &entry.node),
            Value::Array(items) => items.get(item_index(items, part)?),
            _ => None,
        }
    }

    /// The `name` of a table.
    pub(super) fn name(&self) -> Option<&str> {
        match &self.table()?.get("name")?.node.value {
            Value::String(name) => Some(name),
            _ => None,
        }
    }
}

/// The item that a part of a dotted path means: by name, else by index from 0.
pub(super) fn item_index(items: &[Node], part: &str) -> Option<usize> {
    let by_name = items.iter().position(|item| item.name() == Some(part));
    by_name.or_else(|| part.parse().ok().filter(|i| *i < items.len()))
}
