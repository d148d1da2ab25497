//! Reading one table: every value is checked as it is taken, every key that nobody asked for is an error.
//!
//! A wrong value is noted and replaced by a harmless one, so that the rest of the scene is read and checked as well.

use super::Block;
use super::document::{Entry, Node, Value};
use super::error::{Report, listed, nearest};
use super::keys::{Key, SCENE, Table};
pub(crate) use super::range::Range;
use std::cell::RefCell;

/// Components of vectors, whose squares are formed.
pub(crate) const COMPONENT: Range = Range::at_least(-1e12).up_to(1e12);

/// A table of the scene, or the want of one.
pub(crate) struct Section<'a> {
    node: &'a Node,
    /// Whether the scene has it; else `node` is the table around it.
    present: bool,
    /// Its keys.
    table: &'static Table,
    pub(super) path: String,
    pub(super) report: &'a Report,
    asked: RefCell<Vec<&'static str>>,
}

impl<'a> Section<'a> {
    pub(super) fn root(node: &'a Node, report: &'a Report) -> Self {
        Self { node, present: true, table: &SCENE, path: String::new(), report, asked: RefCell::default() }
    }

    pub(super) fn is_present(&self) -> bool {
        self.present
    }

    /// The dotted path of a key.
    pub(super) fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// What the table of keys says of a key.
    fn known(&self, key: &str) -> Option<&'static Key> {
        self.table.key(key)
    }

    fn range_of(&self, key: &str) -> Range {
        self.known(key).map_or(Range::ANY, |key| key.kind.range())
    }

    pub(super) fn entry(&self, key: &'static str) -> Option<&'a Entry> {
        if self.known(key).is_none() {
            let reason = format!("is read, but stands in no table of keys (`{}`)", self.table.name);
            self.report.place(&self.path_of(key), self.node.origin, reason);
        }
        self.asked.borrow_mut().push(key);
        if self.present { self.node.table()?.get(key) } else { None }
    }

    /// Whether a key is there, without asking for it.
    pub(super) fn has(&self, key: &str) -> bool {
        self.present && self.node.child(key).is_some()
    }

    pub(crate) fn node(&self, key: &'static str) -> Option<&'a Node> {
        self.entry(key).map(|entry| &entry.node)
    }

    /// Notes that the value of a key is wrong.
    pub(crate) fn wrong(&self, key: &str, node: &Node, reason: impl Into<String>) {
        self.report.value(&self.path_of(key), node.origin, reason);
    }

    fn wrong_kind(&self, key: &str, node: &Node, wanted: &str) {
        self.wrong(key, node, format!("must be {wanted}, not {}", node.value.kind()));
    }

    /// Notes that a key is missing.
    pub(crate) fn missing(&self, key: &str) {
        // The error of a value that is no table has been reported.
        if self.present || !self.report.has(&self.path) {
            self.report.place(&self.path_of(key), self.node.origin, "is missing and has no default");
        }
    }

    /// A number; without a default it must be there.
    pub(crate) fn number(&self, key: &'static str, default: Option<f64>) -> f64 {
        self.number_within(key, default, self.range_of(key))
    }

    /// A number where one is said.
    pub(crate) fn optional_number(&self, key: &'static str) -> Option<f64> {
        self.as_number(key, self.node(key)?, self.range_of(key))
    }

    /// A number whose range depends on the rest of the scene.
    pub(crate) fn number_within(&self, key: &'static str, default: Option<f64>, range: Range) -> f64 {
        match (self.node(key), default) {
            (Some(node), _) => self.as_number(key, node, range).or(default).unwrap_or(f64::NAN),
            (None, Some(default)) => default,
            (None, None) => {
                self.missing(key);
                f64::NAN
            }
        }
    }

    /// A number or `"auto"`, which is `None`.
    pub(crate) fn number_or_auto(&self, key: &'static str, default: Option<f64>) -> Option<f64> {
        let Some(node) = self.node(key) else { return default };
        match &node.value {
            Value::String(text) if text == "auto" => None,
            Value::String(_) => {
                self.wrong(key, node, "must be a number or \"auto\"");
                None
            }
            _ => self.as_number(key, node, self.range_of(key)),
        }
    }

    pub(crate) fn as_number(&self, key: &str, node: &Node, range: Range) -> Option<f64> {
        let number = match node.value {
            Value::Float(x) => x,
            Value::Integer(n) => n as f64,
            _ => {
                self.wrong_kind(key, node, "a number");
                return None;
            }
        };
        if range.holds(number) {
            return Some(number);
        }
        let reason = if number.is_finite() { range.to_string() } else { Range::ANY.to_string() };
        self.wrong(key, node, reason);
        None
    }

    /// Whether a number of a key's value is within its range; else that is noted.
    pub(crate) fn number_in(&self, key: &str, node: &Node, number: f64, range: Range) -> bool {
        if !range.holds(number) {
            self.wrong(key, node, range.to_string());
        }
        range.holds(number)
    }

    /// A whole number.
    pub(crate) fn integer(&self, key: &'static str, default: u32) -> u32 {
        self.optional_integer(key).unwrap_or(default)
    }

    /// A whole number where one is said.
    pub(super) fn optional_integer(&self, key: &'static str) -> Option<u32> {
        let node = self.node(key)?;
        let (low, high) = self.known(key)?.kind.whole();
        match node.value {
            Value::Integer(n) => match u32::try_from(n) {
                Ok(n) if (low..=high).contains(&n) => return Some(n),
                _ => self.wrong(key, node, format!("must be a whole number from {low} to {high}")),
            },
            Value::Float(_) => {
                self.wrong(key, node, format!("must be a whole number from {low} to {high}"));
            }
            _ => self.wrong_kind(key, node, &format!("a whole number from {low} to {high}")),
        }
        None
    }

    /// A string.
    pub(crate) fn string(&self, key: &'static str) -> Option<&'a str> {
        let node = self.node(key)?;
        match &node.value {
            Value::String(text) => Some(text),
            _ => {
                self.wrong_kind(key, node, "a string");
                None
            }
        }
    }

    pub(crate) fn boolean(&self, key: &'static str, default: bool) -> bool {
        let Some(node) = self.node(key) else { return default };
        match node.value {
            Value::Boolean(value) => value,
            _ => {
                self.wrong_kind(key, node, "true or false");
                default
            }
        }
    }

    /// One of a list of names; without a default it must be there.
    pub(crate) fn choice<T: Copy>(
        &self,
        key: &'static str,
        default: Option<T>,
        names: &[(&'static str, T)],
    ) -> Option<T> {
        match (self.node(key), default) {
            (Some(node), _) => self.as_choice(key, node, names).or(default),
            (None, None) => {
                self.missing(key);
                None
            }
            (None, default) => default,
        }
    }

    pub(super) fn as_choice<T: Copy>(&self, key: &str, node: &Node, names: &[(&str, T)]) -> Option<T> {
        let known = || names.iter().map(|(name, _)| *name);
        let one_of = if names.len() > 1 { "one of " } else { "" };
        let wanted = format!("{one_of}{}", listed(known(), "or"));
        let Value::String(text) = &node.value else {
            self.wrong_kind(key, node, &wanted);
            return None;
        };
        if let Some((_, value)) = names.iter().find(|(name, _)| name == text) {
            return Some(*value);
        }
        let note = self.report.value(&self.path_of(key), node.origin, format!("must be {wanted}"));
        if let Some(near) = nearest(text, known()) {
            note.help(format!("did you mean `{near}`?"));
        }
        None
    }

    /// A vector with `dimension` components; the others are zero.
    pub(crate) fn vector(&self, key: &'static str, dimension: usize, default: Option<[f64; 3]>) -> [f64; 3] {
        match (self.node(key), default) {
            (Some(node), _) => self.as_vector(key, node, dimension).or(default).unwrap_or([f64::NAN; 3]),
            (None, Some(default)) => default,
            (None, None) => {
                self.missing(key);
                [f64::NAN; 3]
            }
        }
    }

    pub(crate) fn as_vector(&self, key: &str, node: &Node, dimension: usize) -> Option<[f64; 3]> {
        let Value::Array(items) = &node.value else {
            self.wrong_kind(key, node, &format!("an array of {dimension} numbers"));
            return None;
        };
        // A wrong dimension is not repeated at every vector.
        let other = self.report.has("dimension") && (2..=3).contains(&items.len());
        if items.len() != dimension && !other {
            let reason = format!("must have {dimension} components, as the scene is {dimension}D");
            self.wrong(key, node, reason);
            return None;
        }
        let mut vector = [0.0; 3];
        for (component, item) in vector.iter_mut().zip(items).take(dimension) {
            *component = self.as_number(key, item, COMPONENT)?;
        }
        Some(vector)
    }

    /// A box `{ min, max }`.
    pub(super) fn block(&self, dimension: usize) -> Block {
        let block =
            Block { min: self.vector("min", dimension, None), max: self.vector("max", dimension, None) };
        let corners = [self.node("min"), self.node("max")];
        if let Some(axis) = (0..dimension).find(|a| block.max[*a] <= block.min[*a])
            && let [Some(min), Some(max)] = corners
        {
            // Where an override changed one corner, that one is wrong.
            let axis_name = ["x", "y", "z"][axis];
            if min.origin.source > max.origin.source {
                let reason = format!("must be less than `max` in {axis_name}, {}", block.max[axis]);
                self.wrong("min", min, reason);
            } else {
                let reason = format!("must be greater than `min` in {axis_name}, {}", block.min[axis]);
                self.wrong("max", max, reason);
            }
        }
        block
    }

    /// The table under a key.
    pub(crate) fn section(&self, key: &'static str) -> Section<'a> {
        match self.node(key) {
            Some(node) => self.sub(self.path_of(key), node, key),
            None => Section {
                node: self.node,
                present: false,
                table: self.table_of(key),
                path: self.path_of(key),
                report: self.report,
                asked: RefCell::default(),
            },
        }
    }

    fn sub(&self, path: String, node: &'a Node, key: &str) -> Section<'a> {
        let present = node.table().is_some();
        if !present {
            self.wrong_kind(key, node, "a table");
        }
        let table = match self.table_of(key) {
            Table { instead: Some((sign, other)), .. } if node.child(sign).is_some() => other,
            table => table,
        };
        Section { node, present, table, path, report: self.report, asked: RefCell::default() }
    }

    /// The keys of the table or the tables under a key.
    fn table_of(&self, key: &str) -> &'static Table {
        static NONE: Table = Table::new("", "", &[]);
        self.known(key).and_then(|key| key.kind.table()).unwrap_or(&NONE)
    }

    /// The tables of an array, each under its name or its index.
    pub(crate) fn tables(&self, key: &'static str) -> Vec<Section<'a>> {
        let Some(node) = self.node(key) else { return Vec::new() };
        let Value::Array(items) = &node.value else {
            self.wrong_kind(key, node, &format!("an array of tables, each headed [[{key}]]"));
            return Vec::new();
        };
        let sections = items.iter().enumerate().map(|(index, item)| {
            let part = item.name().map_or_else(|| index.to_string(), str::to_owned);
            self.sub(self.path_of(&format!("{key}.{part}")), item, key)
        });
        sections.collect()
    }

    /// Notes an error about the table as a whole.
    pub(crate) fn whole(&self, reason: impl Into<String>) {
        self.report.place(&self.path, self.node.origin, reason);
    }

    /// Notes every key that was not asked for.
    pub(crate) fn finish(self) {
        let Some(table) = self.node.table().filter(|_| self.present) else { return };
        let asked = self.asked.borrow();
        for (key, entry) in table.iter().filter(|(key, _)| !asked.contains(&key.as_str())) {
            if self.report.is_full() {
                return;
            }
            let note = self.report.place(&self.path_of(key), entry.key, "unknown key");
            let mut known = asked.clone();
            known.sort_unstable();
            known.dedup();
            // Keys of the top turn up in a section when they stand below its heading.
            let of_the_top = SCENE.key(key).is_some_and(|key| !key.kind.is_section());
            if !self.path.is_empty() && of_the_top {
                note.help(format!("`{key}` belongs at the top of the scene, above the first [section]"));
            } else if let Some(near) = nearest(key, known.iter().copied()) {
                note.help(format!("did you mean `{near}`?"));
            } else {
                note.help(format!("known here: {}", listed(known.iter().copied(), "and")));
            }
        }
    }
}
