//! The keys of a scene: one table for each of its tables. The reader takes kinds and ranges from here and reads no key
//! that stands in none; the schema is printed from here.

mod material;
mod measure;
mod motion;
mod shape;
mod top;

pub(crate) use top::SCENE;

use super::section::{COMPONENT, Range};

/// A table of a scene.
pub(crate) struct Table {
    /// What the schema calls it.
    pub(crate) name: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) keys: &'static [Key],
    /// Keys that are listed elsewhere.
    pub(crate) further: &'static [&'static [Key]],
    /// The key whose word says which of the others mean something, see [`Key::only`].
    pub(crate) tag: Option<&'static str>,
    /// Keys of which exactly one is there.
    pub(crate) one_of: &'static [&'static str],
    /// A key that makes it another table.
    pub(crate) instead: Option<(&'static str, &'static Table)>,
}

/// A key: what its value may be and what it means.
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) doc: &'static str,
    pub(crate) unit: &'static str,
    /// JSON where it is always the same, else words.
    pub(crate) default: &'static str,
    pub(crate) required: bool,
    /// Words of the table's tag with which it means something; empty: all.
    pub(crate) only: &'static [&'static str],
}

/// What a value may be. Numbers can be formulas, too.
pub(crate) enum Kind {
    Number(Range),
    NumberOrAuto(Range),
    Integer(u32, u32),
    /// `"auto"` or a whole number.
    IntegerOrAuto(u32, u32),
    Boolean,
    Text,
    /// A text of this form, a regular expression.
    Form(&'static str),
    Words(fn() -> Vec<&'static str>),
    /// As many components as the scene has dimensions.
    Vector,
    /// So many values of one kind.
    Array(&'static Kind, usize, usize),
    /// Values of these kinds, one after the other.
    Row(&'static [Kind]),
    Either(&'static [Kind]),
    Table(&'static Table),
    Tables(&'static Table),
    TableOrTables(&'static Table),
    /// Names of effects with the words of a switch.
    Switches,
    /// Names of the scene's own with numbers.
    Parameters,
}

/// The form of a shape's or a probe's name.
const NAME: Kind = Kind::Form("^[A-Za-z0-9_-]*[A-Za-z_-][A-Za-z0-9_-]*$");

/// The names of a reader's list of choices.
pub(crate) fn words<T>(names: &[(&'static str, T)]) -> Vec<&'static str> {
    names.iter().map(|(name, _)| *name).collect()
}

impl Table {
    pub(crate) const fn new(name: &'static str, doc: &'static str, keys: &'static [Key]) -> Self {
        Self { name, doc, keys, further: &[], tag: None, one_of: &[], instead: None }
    }
    pub(crate) const fn tag(self, tag: &'static str) -> Self {
        Self { tag: Some(tag), ..self }
    }

    /// All keys.
    pub(crate) fn all(&self) -> impl Iterator<Item = &'static Key> {
        let own: &'static [Key] = self.keys;
        own.iter().chain(self.further.iter().copied().flatten())
    }

    pub(crate) fn key(&self, name: &str) -> Option<&'static Key> {
        self.all().find(|key| key.name == name)
    }
}

impl Key {
    pub(crate) const fn new(name: &'static str, kind: Kind, doc: &'static str) -> Self {
        Self { name, kind, doc, unit: "", default: "", required: false, only: &[] }
    }
    pub(crate) const fn number(name: &'static str, range: Range, doc: &'static str) -> Self {
        Self::new(name, Kind::Number(range), doc)
    }
    pub(crate) const fn words(
        name: &'static str,
        words: fn() -> Vec<&'static str>,
        doc: &'static str,
    ) -> Self {
        Self::new(name, Kind::Words(words), doc)
    }
    pub(crate) const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }
    pub(crate) const fn default(self, default: &'static str) -> Self {
        Self { default, ..self }
    }
    pub(crate) const fn required(self) -> Self {
        Self { required: true, ..self }
    }
    pub(crate) const fn only(self, only: &'static [&'static str]) -> Self {
        Self { only, ..self }
    }
}

impl Kind {
    /// Of vectors.
    pub(crate) const COMPONENT: Self = Self::Number(COMPONENT);

    /// The numbers that it allows.
    pub(crate) fn range(&self) -> Range {
        match self {
            Self::Number(range) | Self::NumberOrAuto(range) => *range,
            Self::Array(kind, ..) => kind.range(),
            Self::Either(kinds) => kinds.iter().map(Self::range).find(|r| !r.is_any()).unwrap_or(Range::ANY),
            _ => Range::ANY,
        }
    }

    /// The whole numbers that it allows.
    pub(crate) fn whole(&self) -> (u32, u32) {
        match self {
            Self::Integer(low, high) | Self::IntegerOrAuto(low, high) => (*low, *high),
            _ => (0, u32::MAX),
        }
    }

    /// It is a section, or several.
    pub(crate) fn is_section(&self) -> bool {
        self.table().is_some() || matches!(self, Self::Switches | Self::Parameters)
    }

    /// The table or tables that it is.
    pub(crate) fn table(&self) -> Option<&'static Table> {
        match self {
            Self::Table(table) | Self::Tables(table) | Self::TableOrTables(table) => Some(table),
            _ => None,
        }
    }
}
