//! The numbers that a key allows.

use std::fmt;

/// The numbers that a key allows, and why no others.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    low: Option<(f64, Bound)>,
    high: Option<(f64, Bound)>,
    why: &'static str,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Bound {
    Included,
    Excluded,
}

impl Range {
    pub(super) const ANY: Self = Self { low: None, high: None, why: "" };

    pub(crate) const fn positive() -> Self {
        Self { low: Some((0.0, Bound::Excluded)), high: None, why: "" }
    }
    pub(crate) const fn at_least(low: f64) -> Self {
        Self { low: Some((low, Bound::Included)), high: None, why: "" }
    }
    /// Adds an upper end, itself allowed.
    pub(crate) const fn up_to(self, high: f64) -> Self {
        Self { high: Some((high, Bound::Included)), ..self }
    }
    /// Adds an upper end, itself not allowed.
    pub(super) const fn below(self, high: f64) -> Self {
        Self { high: Some((high, Bound::Excluded)), ..self }
    }
    /// Adds the reason.
    pub(crate) const fn why(self, why: &'static str) -> Self {
        Self { why, ..self }
    }

    pub(crate) fn is_any(&self) -> bool {
        self.low.is_none() && self.high.is_none()
    }
    /// Lower and upper end with the word that JSON schemas have for each.
    pub(crate) fn ends(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let word = |included: &'static str, excluded| {
            move |(x, bound)| match bound {
                Bound::Included => (included, x),
                Bound::Excluded => (excluded, x),
            }
        };
        let low = self.low.map(word("minimum", "exclusiveMinimum"));
        low.into_iter().chain(self.high.map(word("maximum", "exclusiveMaximum")))
    }

    pub(crate) fn holds(&self, x: f64) -> bool {
        let low = self.low.is_none_or(|(low, b)| x > low || (b == Bound::Included && x == low));
        let high = self.high.is_none_or(|(high, b)| x < high || (b == Bound::Included && x == high));
        x.is_finite() && low && high
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.low {
            Some((low, Bound::Included)) => write!(f, "must be at least {}", short(low))?,
            Some((low, Bound::Excluded)) => write!(f, "must be greater than {}", short(low))?,
            None => f.write_str("must be a finite number")?,
        }
        match self.high {
            Some((high, Bound::Included)) => write!(f, " and at most {}", short(high))?,
            Some((high, Bound::Excluded)) => write!(f, " and less than {}", short(high))?,
            None => (),
        }
        if self.why.is_empty() { Ok(()) } else { write!(f, ": {}", self.why) }
    }
}

/// A number without a row of zeros.
fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}
