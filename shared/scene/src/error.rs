//! What is wrong with a scene: all of it at once, each with its place, key, value and reason.

use super::document::{Entry, Node, Origin, SourceText, Value};
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Everything that is wrong with a scene.
#[derive(Clone, Debug, thiserror::Error)]
#[error(
    "{} has {}{} error{}",
    path.display(),
    if problems.len() < MAX_PROBLEMS { "" } else { "at least " },
    problems.len(),
    if problems.len() == 1 { "" } else { "s" }
)]
pub struct SceneErrors {
    /// The scene's file.
    pub path: PathBuf,
    /// The errors, by their place; never empty, and no more than the first hundred.
    pub problems: Vec<SceneError>,
}

impl Diagnostic for SceneErrors {
    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        Some(Box::new(self.problems.iter().map(|p| p as &dyn Diagnostic)))
    }
}

/// One error of a scene.
#[derive(Clone, Debug)]
pub struct SceneError {
    /// Where the value was given.
    pub place: Place,
    /// The dotted key, as `--set` takes it; empty for a syntax error.
    pub key: String,
    /// The value as written, where there is one.
    pub value: Option<String>,
    /// What is wrong, with the allowed range or names and why.
    pub reason: String,
    /// What to do about it, where that can be told.
    pub help: Option<String>,
    source: Option<Arc<NamedSource<Arc<str>>>>,
    origin: Option<Origin>,
}

/// Where a wrong value was given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In a file; line and column count from 1, columns in characters.
    File {
        /// The file.
        path: PathBuf,
        /// The line.
        line: usize,
        /// The column.
        column: usize,
    },
    /// In an override: its text, `--set key=value`.
    Override(String),
    /// The file as a whole.
    Whole(PathBuf),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { path, line, column } => write!(f, "{}:{line}:{column}", path.display()),
            Self::Override(text) => f.write_str(text),
            Self::Whole(path) => write!(f, "{}", path.display()),
        }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.place)?;
        // An override's text shows key and value already.
        let shown = matches!(&self.place, Place::Override(text) if text.contains(&self.key));
        if !self.key.is_empty() && !shown {
            match &self.value {
                Some(value) => write!(f, "{} = {value}: ", self.key)?,
                None => write!(f, "{}: ", self.key)?,
            }
        }
        f.write_str(&self.reason)
    }
}

impl std::error::Error for SceneError {}

impl Diagnostic for SceneError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_deref().map(|source| source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let origin = self.origin.filter(|_| self.source.is_some())?;
        let label = LabeledSpan::new(None, origin.start, origin.end - origin.start);
        Some(Box::new(std::iter::once(label)))
    }
}

impl SceneErrors {
    /// The scene's file cannot be read at all.
    pub(super) fn whole(path: &Path, reason: String) -> Self {
        let problem = SceneError {
            place: Place::Whole(path.to_path_buf()),
            key: String::new(),
            value: None,
            reason,
            help: None,
            source: None,
            origin: None,
        };
        Self { path: path.to_path_buf(), problems: vec![problem] }
    }
}

/// Errors that are told; the first ones, in the order in which a scene is read.
const MAX_PROBLEMS: usize = 100;
/// Bytes of a line of a source that are shown, and of a key or an override that are named.
const MAX_SHOWN: usize = 1000;

/// The beginning of a long text.
fn beginning(text: &str) -> String {
    match text.char_indices().nth(MAX_SHOWN) {
        None => text.to_owned(),
        Some((end, _)) => format!("{} ...", &text[..end]),
    }
}

/// The beginning of a value.
fn short(line: &str) -> String {
    let short: String = line.chars().take(60).collect();
    if short.len() < line.len() { short + " ..." } else { short }
}

/// What is shown of a source for an error: its lines, the one before and the one after.
fn around(text: &str, origin: Origin) -> Option<&str> {
    let (before, after) = (text.get(..origin.start)?, text.get(origin.end..)?);
    let start = before.rmatch_indices('\n').nth(1).map_or(0, |(end, _)| end + 1);
    let end = after.match_indices('\n').nth(1).map_or(after.len(), |(end, _)| end);
    text.get(start..origin.end + end)
}

/// Collects errors while a scene is read.
pub(super) struct Report {
    sources: Vec<(SourceText, Arc<NamedSource<Arc<str>>>)>,
    problems: RefCell<Vec<SceneError>>,
    /// Where formulas stand, with their numbers.
    computed: RefCell<BTreeMap<Origin, f64>>,
}

impl Report {
    pub(super) fn new(sources: Vec<SourceText>) -> Self {
        let named = |s: SourceText| {
            let title = if s.is_override { "--set" } else { &s.name };
            let named = NamedSource::new(title, s.text.clone());
            (s, Arc::new(named))
        };
        let sources = sources.into_iter().map(named).collect();
        Self { sources, problems: RefCell::default(), computed: RefCell::default() }
    }

    /// Notes the number of a formula: what is wrong with it is said with both.
    pub(super) fn computed(&self, origin: Origin, value: f64) {
        self.computed.borrow_mut().insert(origin, value);
    }

    /// Notes that the value written at `origin` is wrong.
    pub(super) fn value(&self, key: &str, origin: Origin, reason: impl Into<String>) -> Note<'_> {
        let mut reason = reason.into();
        if let Some(number) = self.computed.borrow().get(&origin) {
            reason.push_str(&format!(" (the formula gives {number})"));
        }
        self.note(key, origin, self.snippet(origin), reason)
    }

    /// Notes that the value of a key is wrong because of other keys: at the one of them that an override changed last,
    /// or else at the key itself. The keys in it, such as a box's corners, may be among the others.
    pub(super) fn among(&self, root: &Node, key: &str, others: &[&str], reason: impl Into<String>) {
        let written = |key: &str| root.child_at(key).map(|node| node.origin);
        let changed = others.iter().filter_map(|other| Some((written(other)?, *other)));
        let last =
            changed.filter(|(o, _)| self.sources[o.source].0.is_override).max_by_key(|(o, _)| o.source);
        let own = root.origin_of(key);
        let reason = reason.into();
        let (key, origin) = match last {
            Some((origin, other)) if origin.source > own.source => {
                let inside = other.strip_prefix(key).is_some_and(|rest| rest.starts_with('.'));
                (if inside { other } else { key }, origin)
            }
            _ => (key, own),
        };
        self.note(key, origin, root.child_at(key).and_then(|node| self.in_force(node)), reason);
    }

    /// A value in force: as it was written; where overrides changed a part of it, and below a [header], each part as
    /// that was written.
    fn in_force(&self, node: &Node) -> Option<String> {
        let written = self.snippet(node.origin);
        let is_header = node.table().is_some() && written.as_ref().is_some_and(|text| text.starts_with('['));
        if node.is_of_one_source() && !is_header {
            return written;
        }
        let whole = match &node.value {
            Value::Table(table) => {
                let part = |(key, entry): (&String, &Entry)| {
                    self.in_force(&entry.node).map(|value| format!("{key} = {value}"))
                };
                format!("{{ {} }}", table.iter().filter_map(part).collect::<Vec<_>>().join(", "))
            }
            Value::Array(items) => {
                let items: Vec<_> = items.iter().filter_map(|item| self.in_force(item)).collect();
                format!("[{}]", items.join(", "))
            }
            _ => return written,
        };
        Some(short(&whole))
    }

    /// Notes an error at `origin` that is not about the value there.
    pub(super) fn place(&self, key: &str, origin: Origin, reason: impl Into<String>) -> Note<'_> {
        self.note(key, origin, None, reason.into())
    }

    fn note(&self, key: &str, origin: Origin, value: Option<String>, reason: String) -> Note<'_> {
        let (source, named) = &self.sources[origin.source];
        let (text, mut problems) = (&source.text, self.problems.borrow_mut());
        // Of more errors than anybody reads the first ones are told. Each costs the way to its line.
        if problems.len() >= MAX_PROBLEMS {
            return Note { report: self, noted: false };
        }
        let before = text.get(..origin.start).unwrap_or_default();
        let place = if source.is_override {
            Place::Override(beginning(&source.name))
        } else {
            Place::File {
                path: PathBuf::from(&source.name),
                line: before.matches('\n').count() + 1,
                column: before.chars().rev().take_while(|c| *c != '\n').count() + 1,
            }
        };
        let is_short = around(text, origin).is_some_and(|shown| shown.len() <= 3 * MAX_SHOWN);
        problems.push(SceneError {
            place,
            key: beginning(key),
            value,
            reason: beginning(&reason),
            help: None,
            source: is_short.then(|| named.clone()),
            origin: Some(origin),
        });
        Note { report: self, noted: true }
    }

    /// Whether something was written in an override.
    pub(super) fn is_override(&self, origin: Origin) -> bool {
        self.sources[origin.source].0.is_override
    }

    /// The text of a short value.
    fn snippet(&self, origin: Origin) -> Option<String> {
        let text = self.sources[origin.source].0.text.get(origin.start..origin.end)?;
        let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
        (!line.is_empty()).then(|| short(&line))
    }

    /// Whether a key, a key under it or one around it has an error already: what follows from it says nothing new.
    pub(super) fn has(&self, key: &str) -> bool {
        let covers = |outer: &str, inner: &str| {
            inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        self.problems.borrow().iter().any(|p| covers(&p.key, key) || covers(key, &p.key))
    }

    pub(super) fn has_any(&self, keys: &[&str]) -> bool {
        keys.iter().any(|key| self.has(key))
    }

    pub(super) fn is_empty(&self) -> bool {
        self.problems.borrow().is_empty()
    }

    /// Whether more errors would not be told.
    pub(super) fn is_full(&self) -> bool {
        self.problems.borrow().len() >= MAX_PROBLEMS
    }

    /// The errors, the file's first and in its order.
    pub(super) fn into_errors(self, path: &Path) -> SceneErrors {
        let mut problems = self.problems.into_inner();
        problems.sort_by_key(|p| p.origin);
        SceneErrors { path: path.to_path_buf(), problems }
    }
}

/// The error just noted.
pub(super) struct Note<'r> {
    report: &'r Report,
    /// It is among those that are told.
    noted: bool,
}

impl Note<'_> {
    /// Adds advice.
    pub(super) fn help(self, help: impl Into<String>) {
        if !self.noted {
            return;
        }
        if let Some(last) = self.report.problems.borrow_mut().last_mut() {
            last.help = Some(help.into());
        }
    }
}

/// The known name nearest to a wrong one, if any is near.
pub(super) fn nearest<'n>(wrong: &str, known: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let scored = known.into_iter().map(|name| (strsim::jaro_winkler(wrong, name), name));
    scored.filter(|(score, _)| *score > 0.75).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}

/// `a`, `b` and `c`, or with another last word.
pub(super) fn listed<'n>(names: impl IntoIterator<Item = &'n str>, last_word: &str) -> String {
    let names: Vec<String> = names.into_iter().map(|n| format!("`{n}`")).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} {last_word} {last}", rest.join(", ")),
        _ => names.concat(),
    }
}
