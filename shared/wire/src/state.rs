//! Saved states: what the owners of a run's state write down and read back, as named columns in named groups.
//!
//! An owner names each of its fields once, in [`State::fields`]; the same visit saves and loads. Files have the groups
//! and columns under the same names. A float is kept bit by bit.

use crate::frame::SinkError;
use std::collections::BTreeMap;

/// The values of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Floating-point numbers, SI units.
    Reals(Vec<f64>),
    /// Particle, slot and record numbers.
    Numbers(Vec<u32>),
    /// Counts, and flags as 0 or 1.
    Counts(Vec<u64>),
    /// Text in UTF-8.
    Text(String),
}

/// Named columns and groups.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// By name.
    pub columns: BTreeMap<String, Column>,
    /// By name.
    pub groups: BTreeMap<String, Group>,
}

/// Why a saved state cannot be taken over.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// A field or a group is missing.
    #[error("the saved state has no `{field}`")]
    Missing {
        /// Groups and name, `/` between them.
        field: String,
    },
    /// A field holds another kind of values.
    #[error("`{field}` of the saved state is not made of {expected}")]
    Kind {
        /// Groups and name.
        field: String,
        /// Which kind is right.
        expected: &'static str,
    },
    /// A field has another length than the run's particles give it.
    #[error("`{field}` of the saved state has {found} values and not {expected}")]
    Length {
        /// Groups and name.
        field: String,
        /// Right number of values.
        expected: usize,
        /// Number of values found.
        found: usize,
    },
    /// The fields contradict each other or the scene.
    #[error("the saved state is no state of this scene: {reason}")]
    Contradiction {
        /// What is wrong.
        reason: String,
    },
}

impl StateError {
    /// The fields contradict each other or the scene.
    pub fn contradiction(reason: impl Into<String>) -> Self {
        Self::Contradiction { reason: reason.into() }
    }
}

/// Owner of a state that a run needs to go on as if it had never been interrupted.
pub trait State {
    /// Visits every field that cannot be computed from the scene and from the other fields.
    ///
    /// # Errors
    /// A saved field is missing or is not what it should be.
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError>;

    /// Computes anew what follows from the fields, after they were loaded.
    ///
    /// # Errors
    /// The fields contradict each other or the scene.
    fn restored(&mut self) -> Result<(), StateError> {
        Ok(())
    }

    /// The fields of the present state.
    fn save(&mut self) -> Group {
        let mut group = Group::default();
        let visited = self.fields(&mut Fields { way: Way::Save(&mut group), path: String::new() });
        debug_assert!(visited.is_ok(), "saving reads no saved field");
        group
    }

    /// Takes over a state that was saved.
    ///
    /// # Errors
    /// The saved state is not one of this owner in this scene. The owner must not be used then.
    fn load(&mut self, group: &Group) -> Result<(), StateError> {
        self.fields(&mut Fields { way: Way::Load(group), path: String::new() })?;
        self.restored()
    }
}

/// Where the checkpoints of a participant go.
pub trait StateSink: Send {
    /// Hands the state of checkpoint `number` over, 1 or more and ascending.
    ///
    /// # Errors
    /// An earlier one could not be written.
    fn submit(&mut self, number: u64, state: Group) -> Result<(), SinkError>;
    /// Number of the last checkpoint that is on disk; 0: none is.
    fn safe(&self) -> u64;
    /// Waits until everything submitted is on disk; returns what [`Self::safe`] then is.
    ///
    /// # Errors
    /// A checkpoint could not be written.
    fn finish(self: Box<Self>) -> Result<u64, SinkError>;
}

/// Visits the fields of an owner, to save or to load them.
pub struct Fields<'a> {
    way: Way<'a>,
    path: String,
}

enum Way<'a> {
    Save(&'a mut Group),
    Load(&'a Group),
}

impl Fields<'_> {
    /// Fields are read from a saved state.
    pub fn loading(&self) -> bool {
        matches!(self.way, Way::Load(_))
    }

    fn name(&self, field: &str) -> String {
        format!("{}{field}", self.path)
    }

    fn visit<T>(
        &mut self,
        field: &str,
        value: &mut T,
        save: impl FnOnce(&T) -> Column,
        load: impl FnOnce(&Column) -> Option<T>,
        expected: &'static str,
    ) -> Result<(), StateError> {
        match &mut self.way {
            Way::Save(group) => {
                group.columns.insert(field.to_owned(), save(value));
                Ok(())
            }
            Way::Load(group) => {
                let column = group.columns.get(field);
                let column = column.ok_or_else(|| StateError::Missing { field: self.name(field) })?;
                *value =
                    load(column).ok_or_else(|| StateError::Kind { field: self.name(field), expected })?;
                Ok(())
            }
        }
    }

    /// A column of floating-point numbers.
    pub fn reals(&mut self, field: &str, values: &mut Vec<f64>) -> Result<(), StateError> {
        self.visit(field, values, |v| Column::Reals(v.clone()), reals, "floating-point numbers")
    }

    /// A column of particle, slot or record numbers.
    pub fn numbers(&mut self, field: &str, values: &mut Vec<u32>) -> Result<(), StateError> {
        let load = |column: &Column| match column {
            Column::Numbers(values) => Some(values.clone()),
            _ => None,
        };
        self.visit(field, values, |v| Column::Numbers(v.clone()), load, "numbers")
    }

    /// Text.
    pub fn text(&mut self, field: &str, value: &mut String) -> Result<(), StateError> {
        let load = |column: &Column| match column {
            Column::Text(text) => Some(text.clone()),
            _ => None,
        };
        self.visit(field, value, |v| Column::Text(v.clone()), load, "text")
    }

    /// One column for each component of a vector: `NAME_x`, `NAME_y`, `NAME_z`.
    pub fn vectors<const D: usize>(
        &mut self,
        field: &str,
        values: &mut [Vec<f64>; D],
    ) -> Result<(), StateError> {
        values.iter_mut().enumerate().try_for_each(|(d, column)| self.reals(&component(field, d), column))
    }

    /// Points, saved as [`Self::vectors`] are.
    pub fn points<const D: usize>(
        &mut self,
        field: &str,
        points: &mut Vec<[f64; D]>,
    ) -> Result<(), StateError> {
        let mut columns: [Vec<f64>; D] = std::array::from_fn(|d| points.iter().map(|x| x[d]).collect());
        self.vectors(field, &mut columns)?;
        if self.loading() {
            let n = columns.first().map_or(0, Vec::len);
            for (d, column) in columns.iter().enumerate() {
                self.length(&component(field, d), n, column.len())?;
            }
            *points = (0..n).map(|i| std::array::from_fn(|d| columns[d][i])).collect();
        }
        Ok(())
    }

    /// A floating-point number.
    pub fn real(&mut self, field: &str, value: &mut f64) -> Result<(), StateError> {
        let load = |column: &Column| at_most_one(&reals(column)?)?;
        self.visit(field, value, |&v| Column::Reals(vec![v]), load, "one floating-point number")
    }

    /// A floating-point number or none.
    pub fn optional_real(&mut self, field: &str, value: &mut Option<f64>) -> Result<(), StateError> {
        let load = |column: &Column| at_most_one(&reals(column)?);
        self.visit(field, value, |v| Column::Reals(v.iter().copied().collect()), load, "at most one number")
    }

    /// Three components.
    pub fn vector<const D: usize>(&mut self, field: &str, value: &mut [f64; D]) -> Result<(), StateError> {
        let load = |column: &Column| reals(column)?.try_into().ok();
        self.visit(field, value, |v| Column::Reals(v.to_vec()), load, "the components of a vector")
    }

    /// A count.
    pub fn count(&mut self, field: &str, value: &mut u64) -> Result<(), StateError> {
        let load = |column: &Column| at_most_one(counts(column)?)?;
        self.visit(field, value, |&v| Column::Counts(vec![v]), load, "one count")
    }

    /// A count or none.
    pub fn optional_count(&mut self, field: &str, value: &mut Option<u64>) -> Result<(), StateError> {
        let load = |column: &Column| at_most_one(counts(column)?);
        self.visit(field, value, |v| Column::Counts(v.iter().copied().collect()), load, "at most one count")
    }

    /// A count of four bytes.
    pub fn small_count(&mut self, field: &str, value: &mut u32) -> Result<(), StateError> {
        let mut wide = u64::from(*value);
        self.count(field, &mut wide)?;
        let name = self.name(field);
        *value =
            u32::try_from(wide).map_err(|_| StateError::Kind { field: name, expected: "a small count" })?;
        Ok(())
    }

    /// Yes or no.
    pub fn flag(&mut self, field: &str, value: &mut bool) -> Result<(), StateError> {
        let mut count = u64::from(*value);
        self.count(field, &mut count)?;
        *value = count != 0;
        Ok(())
    }

    /// The fields of a part, in a group of their own. A part has its [`State::restored`] called by the whole's.
    pub fn part<S: State + ?Sized>(&mut self, name: &str, part: &mut S) -> Result<(), StateError> {
        self.group(name, |fields| part.fields(fields))
    }

    /// A group of its own for some fields.
    pub fn group(
        &mut self,
        name: &str,
        visit: impl FnOnce(&mut Fields<'_>) -> Result<(), StateError>,
    ) -> Result<(), StateError> {
        let path = format!("{}/", self.name(name));
        match &mut self.way {
            Way::Save(group) => {
                let group = group.groups.entry(name.to_owned()).or_default();
                visit(&mut Fields { way: Way::Save(group), path })
            }
            Way::Load(group) => {
                let missing = || StateError::Missing { field: path.trim_end_matches('/').to_owned() };
                let group = group.groups.get(name).ok_or_else(missing)?;
                visit(&mut Fields { way: Way::Load(group), path })
            }
        }
    }

    /// Checks the length of a loaded field.
    ///
    /// # Errors
    /// It is another one.
    pub fn length(&self, field: &str, expected: usize, found: usize) -> Result<(), StateError> {
        if self.loading() && found != expected {
            return Err(StateError::Length { field: self.name(field), expected, found });
        }
        Ok(())
    }
}

fn component(field: &str, d: usize) -> String {
    format!("{field}_{}", ["x", "y", "z"].get(d).copied().unwrap_or("w"))
}

fn reals(column: &Column) -> Option<Vec<f64>> {
    match column {
        Column::Reals(values) => Some(values.clone()),
        _ => None,
    }
}

fn counts(column: &Column) -> Option<&[u64]> {
    match column {
        Column::Counts(values) => Some(values),
        _ => None,
    }
}

/// The value or none; `None` where there are several.
fn at_most_one<T: Copy>(values: &[T]) -> Option<Option<T>> {
    match values {
        [] => Some(None),
        [value] => Some(Some(*value)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Debug, Default, PartialEq)]
    struct Body {
        time: f64,
        first: Option<f64>,
        steps: u64,
        asleep: bool,
        position: [Vec<f64>; 2],
        points: Vec<[f64; 2]>,
        id: Vec<u32>,
        name: String,
        sum: f64,
    }

    impl State for Body {
        fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
            fields.real("time", &mut self.time)?;
            fields.optional_real("first", &mut self.first)?;
            fields.flag("asleep", &mut self.asleep)?;
            fields.text("name", &mut self.name)?;
            fields.group("particles", |fields| {
                fields.vectors("position", &mut self.position)?;
                fields.points("points", &mut self.points)?;
                fields.numbers("id", &mut self.id)?;
                fields.length("id", self.position[0].len(), self.id.len())?;
                fields.count("steps", &mut self.steps)
            })
        }
        fn restored(&mut self) -> Result<(), StateError> {
            self.sum = self.position[0].iter().sum();
            Ok(())
        }
    }

    fn body() -> Body {
        Body {
            time: 0.1 + 0.2,
            first: None,
            steps: u64::MAX,
            asleep: true,
            position: [vec![1.0, f64::NAN, -0.0], vec![2.0, 5e-324, f64::INFINITY]],
            points: vec![[1.0, 2.0], [3.0, 4.0]],
            id: vec![7, 9, u32::MAX],
            name: "gate".into(),
            sum: 0.0,
        }
    }

    #[test]
    fn what_was_saved_is_loaded_bit_by_bit() {
        let saved = body().save();
        let mut loaded = Body::default();
        loaded.load(&saved).unwrap();
        assert!(loaded.sum.is_nan(), "restored after loading");
        let bits =
            |body: &Body| body.position.clone().map(|c| c.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        assert_eq!(bits(&loaded), bits(&body()));
        assert_eq!(
            (loaded.time, loaded.first, loaded.steps, loaded.asleep),
            (0.1 + 0.2, None, u64::MAX, true)
        );
        assert_eq!((loaded.points, loaded.id, loaded.name), (body().points, body().id, body().name));
    }

    #[test]
    fn a_wrong_state_is_refused_with_the_field() {
        let message = |change: &dyn Fn(&mut Group)| {
            let mut saved = body().save();
            change(&mut saved);
            Body::default().load(&saved).unwrap_err().to_string()
        };
        assert_eq!(message(&|g| drop(g.columns.remove("time"))), "the saved state has no `time`");
        assert_eq!(message(&|g| drop(g.groups.remove("particles"))), "the saved state has no `particles`");
        let id = |values: Vec<u32>| {
            move |g: &mut Group| {
                let particles = g.groups.get_mut("particles").unwrap();
                particles.columns.insert("id".into(), Column::Numbers(values.clone()));
            }
        };
        assert_eq!(message(&id(vec![1, 2])), "`particles/id` of the saved state has 2 values and not 3");
        let text = |g: &mut Group| drop(g.columns.insert("time".into(), Column::Text("0".into())));
        assert_eq!(message(&text), "`time` of the saved state is not made of one floating-point number");
    }
}
