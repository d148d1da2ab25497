//! `[parameters]` and formulas: a string that begins with `=` stands for the number that it computes.
//!
//! The crate exmex reads formulas. Their functions are those of the crate libm, so that a scene has the same numbers on
//! every machine.

use super::document::{Entry, Node, Origin, Value};
use super::error::{Report, listed, nearest};
use exmex::{
    BinOp, Express, FlatEx, MakeOperators, MatchLiteral, Operator, literal_matcher_from_pattern, ops_factory,
};
use std::collections::BTreeMap;

/// Longest formula, characters.
const MAX_LENGTH: usize = 500;
/// Deepest parentheses.
const MAX_DEPTH: usize = 30;
/// Characters that formulas are made of, beside letters and digits.
const SIGNS: &str = "+-*/^()., _";
/// Keys whose values are texts that people read.
const TEXTS: [&str; 2] = ["label", "source"];
/// Keys of angles in degrees.
const DEGREES: [&str; 2] = ["rotate.angle", "lattice_angle"];
/// Names that formulas know.
const FUNCTIONS: [&str; 12] =
    ["sqrt", "abs", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "floor", "pi"];

ops_factory!(
    Operators,
    f64,
    Operator::make_bin("^", BinOp { apply: libm::pow, prio: 4, is_commutative: false }),
    Operator::make_bin("*", BinOp { apply: |a, b| a * b, prio: 2, is_commutative: true }),
    Operator::make_bin("/", BinOp { apply: |a, b| a / b, prio: 3, is_commutative: false }),
    Operator::make_bin_unary("+", BinOp { apply: |a, b| a + b, prio: 0, is_commutative: true }, |a| a),
    Operator::make_bin_unary("-", BinOp { apply: |a, b| a - b, prio: 1, is_commutative: false }, |a| -a),
    Operator::make_unary("sqrt", f64::sqrt),
    Operator::make_unary("abs", f64::abs),
    Operator::make_unary("sin", libm::sin),
    Operator::make_unary("cos", libm::cos),
    Operator::make_unary("tan", libm::tan),
    Operator::make_unary("asin", libm::asin),
    Operator::make_unary("acos", libm::acos),
    Operator::make_unary("atan", libm::atan),
    Operator::make_unary("exp", libm::exp),
    Operator::make_unary("log", libm::log),
    Operator::make_unary("floor", libm::floor),
    Operator::make_constant("pi", std::f64::consts::PI)
);

literal_matcher_from_pattern!(Numbers, r"^(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?");

/// A sine, cosine or tangent in a formula whose angle is a whole or half number beyond half a turn.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeAngle {
    /// The key of the formula.
    pub key: String,
    /// The function with its angle, as it is written.
    pub call: String,
    /// What is written as the angle.
    pub angle: String,
    /// Its value, rad.
    pub radians: f64,
}

/// What is hardly meant in `[parameters]` and formulas.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Doubtful {
    /// Parameters that no formula of a key needs.
    pub unused: Vec<String>,
    /// Angles that are hardly in radians.
    pub whole_angles: Vec<WholeAngle>,
    /// Keys of angles in degrees, with formulas that compute radians.
    pub radians: Vec<[String; 2]>,
}

/// Takes `[parameters]` out of a document and puts numbers in the place of all formulas.
pub(super) fn resolve(root: &mut Node, report: &Report) -> Doubtful {
    let nothing = Doubtful::default;
    let Value::Table(top) = &mut root.value else { return nothing() };
    let table = match top.remove("parameters") {
        None => BTreeMap::new(),
        Some(Entry { node: Node { value: Value::Table(table), .. }, .. }) => table,
        Some(entry) => {
            let kind = entry.node.value.kind();
            report.value("parameters", entry.node.origin, format!("must be a table, not {kind}"));
            return nothing();
        }
    };
    let (known, doubtful) = (BTreeMap::new(), Doubtful::default());
    let mut parameters = Parameters { table: &table, known, doubtful, report };
    parameters.replace(root, "");
    let unused: Vec<String> =
        table.keys().filter(|name| !parameters.known.contains_key(*name)).cloned().collect();
    for name in &unused {
        parameters.named(name, &mut Vec::new());
    }
    Doubtful { unused, ..parameters.doubtful }
}

struct Parameters<'a> {
    table: &'a BTreeMap<String, Entry>,
    /// Those that are computed; `None`: an error that was noted.
    known: BTreeMap<String, Option<f64>>,
    doubtful: Doubtful,
    report: &'a Report,
}

impl Parameters<'_> {
    /// A parameter's value. `within` are the parameters whose formulas are being computed.
    fn named(&mut self, name: &str, within: &mut Vec<String>) -> Option<f64> {
        if let Some(known) = self.known.get(name) {
            return *known;
        }
        let entry = self.table.get(name)?;
        let key = format!("parameters.{name}");
        let (node, wrong) = (&entry.node, |reason: String| {
            self.report.value(&key, entry.node.origin, reason);
        });
        let letters = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let begins = name.starts_with(|c: char| c.is_ascii_alphabetic());
        let value = if !begins || !name.chars().all(letters) || FUNCTIONS.contains(&name) {
            let reason = "is no name of a parameter: letters, digits and `_`, beginning with a letter, and no function";
            self.report.place(&key, entry.key, reason);
            None
        } else {
            match &node.value {
                Value::Float(x) if x.is_finite() => Some(*x),
                Value::Integer(n) => Some(*n as f64),
                Value::String(text) if text.trim_start().starts_with('=') => {
                    within.push(name.to_owned());
                    let value = self.formula(text, &key, node.origin, within);
                    within.pop();
                    value
                }
                _ => {
                    wrong("must be a finite number, or a formula such as \"=2 * L\"".into());
                    None
                }
            }
        };
        self.known.insert(name.to_owned(), value);
        value
    }

    /// The number that a formula computes.
    fn formula(&mut self, text: &str, key: &str, origin: Origin, within: &mut Vec<String>) -> Option<f64> {
        let wrong = |reason: String| self.report.value(key, origin, reason);
        let formula = text.trim().trim_start_matches('=').trim();
        if let Some(reason) = unreadable(formula) {
            wrong(reason);
            return None;
        }
        let Ok(expression) = FlatEx::<f64, Operators, Numbers>::parse(formula) else {
            wrong(
                "is no formula: an operator, a number or a name is missing, or one too many is there".into(),
            );
            return None;
        };
        let mut values = Vec::new();
        for name in expression.var_names() {
            if let Some(first) = within.iter().position(|other| other == name) {
                let circle = within[first..].iter().chain([name]).map(String::as_str);
                let way: Vec<String> = circle.map(|name| format!("`{name}`")).collect();
                wrong(format!("goes round in a circle: {}", way.join(" needs ")));
                return None;
            }
            if !self.table.contains_key(name) {
                let known = || self.table.keys().map(String::as_str);
                let note = wrong(format!("`{name}` is no parameter"));
                match nearest(name, known().chain(FUNCTIONS)) {
                    Some(near) => note.help(format!("did you mean `{near}`?")),
                    None if self.table.is_empty() => note.help("the scene has no [parameters]"),
                    None => note.help(format!("the parameters are {}", listed(known(), "and"))),
                }
                return None;
            }
            let name = name.clone();
            values.push(self.named(&name, within)?);
        }
        let value = expression.eval(&values).unwrap_or(f64::NAN);
        if !value.is_finite() {
            self.report.value(key, origin, format!("is {value}, no finite number"));
            return None;
        }
        for (call, angle) in angles(formula) {
            self.note_whole(key, call, angle);
        }
        if DEGREES.iter().any(|name| key.ends_with(name)) && computes_radians(formula) {
            self.doubtful.radians.push([key.to_owned(), formula.to_owned()]);
        }
        Some(value)
    }

    /// Notes an angle that is a whole or half number beyond half a turn. Of two parameters it may be a phase, as k x
    /// is.
    fn note_whole(&mut self, key: &str, call: &str, angle: &str) {
        let Ok(expression) = FlatEx::<f64, Operators, Numbers>::parse(angle) else { return };
        let names = expression.var_names();
        let values: Option<Vec<f64>> =
            names.iter().map(|name| self.known.get(name.as_str()).copied().flatten()).collect();
        let value = values.filter(|values| values.len() < 2).and_then(|values| expression.eval(&values).ok());
        if let Some(radians) = value.filter(|x| x.abs() > std::f64::consts::PI && (2.0 * x).fract() == 0.0) {
            let [key, call, angle] = [key, call, angle.trim()].map(str::to_owned);
            self.doubtful.whole_angles.push(WholeAngle { key, call, angle, radians });
        }
    }

    /// Puts numbers in the place of all formulas of a node.
    fn replace(&mut self, node: &mut Node, path: &str) {
        let join = |part: &str| if path.is_empty() { part.to_owned() } else { format!("{path}.{part}") };
        match &mut node.value {
            Value::Table(table) => {
                for (key, entry) in table.iter_mut().filter(|(key, _)| !TEXTS.contains(&key.as_str())) {
                    self.replace(&mut entry.node, &join(key));
                }
            }
            Value::Array(items) => {
                for (index, item) in items.iter_mut().enumerate() {
                    let part = item.name().map_or_else(|| index.to_string(), str::to_owned);
                    self.replace(item, &join(&part));
                }
            }
            Value::String(text) if text.starts_with('=') => {
                let text = text.clone();
                // What is wrong with it has been said; NaN would be an error of its own.
                let value = self.formula(&text, path, node.origin, &mut Vec::new());
                let value = value.map_or(1.0, meant);
                self.report.computed(node.origin, value);
                // A whole number can be one of particles, too.
                let whole = value.fract() == 0.0 && value.abs() < 1e15;
                node.value = if whole { Value::Integer(value as i64) } else { Value::Float(value) };
            }
            _ => {}
        }
    }
}

/// Digits of a number as people write it: one more would not tell all floats apart.
const DIGITS: usize = 15;

/// The number of few digits that a result is but for rounding: 0.3 of 3 * 0.1.
fn meant(value: f64) -> f64 {
    let rounded: f64 = format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value);
    if (rounded - value).abs() <= 2.0 * f64::EPSILON * value.abs() { rounded } else { value }
}

/// The formula ends in an arc, and nothing in it turns that into degrees.
fn computes_radians(formula: &str) -> bool {
    let has = |part: &str| formula.contains(part);
    ["asin(", "acos(", "atan("].into_iter().any(has) && !["pi", "180", "57."].into_iter().any(has)
}

/// Sines, cosines and tangents in a formula whose parentheses fit, with what is in these.
fn angles(formula: &str) -> impl Iterator<Item = (&str, &str)> {
    let letters = |c: char| c.is_ascii_alphanumeric() || c == '_';
    formula.match_indices('(').filter_map(move |(open, _)| {
        let name = formula[..open].rsplit(|c| !letters(c)).next()?;
        let mut depth = 0;
        let close = formula[open..].find(|c| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            depth == 0
        })?;
        let end = open + close;
        let call = &formula[open - name.len()..=end];
        ["sin", "cos", "tan"].contains(&name).then(|| (call, &formula[open + 1..end]))
    })
}

/// Why a text is not even looked at as a formula.
fn unreadable(formula: &str) -> Option<String> {
    if formula.is_empty() {
        return Some("has no formula after its `=`".into());
    }
    if formula.len() > MAX_LENGTH {
        return Some(format!("is longer than {MAX_LENGTH} characters"));
    }
    if let Some(sign) = formula.chars().find(|c| !c.is_ascii_alphanumeric() && !SIGNS.contains(*c)) {
        return Some(format!("is no formula: `{sign}` means nothing in it"));
    }
    let mut depth = 0_usize;
    for sign in formula.chars() {
        match sign {
            '(' => depth += 1,
            ')' if depth == 0 => {
                return Some("is no formula: a parenthesis closes that was not opened".into());
            }
            ')' => depth -= 1,
            _ => {}
        }
        if depth > MAX_DEPTH {
            return Some(format!("has parentheses deeper than {MAX_DEPTH}"));
        }
    }
    (depth > 0).then(|| "is no formula: a parenthesis is not closed".into())
}
