//! `[solid]` or `[[solid]]`.

use super::document::Value;
use super::preset::Defaults;
use super::read::viscosity;
use super::section::Section;
use super::*;

/// Longest name of a solid or a process: it is part of the names of shared memory and of files.
const LONGEST_NAME: usize = 24;
/// Names that a solid must not have: those of other participants, and the word for a process of one's own.
const RESERVED: [&str; 4] = ["fluid", "coupler", "wall", OWN];
const OWN: &str = "own";

/// The solids of a scene: the one of `[solid]`, or those of `[[solid]]`.
pub(super) fn solids(top: &Section<'_>, defaults: Defaults, numerics: &Numerics) -> Vec<Solid> {
    match top.node("solid").map(|node| &node.value) {
        None => Vec::new(),
        Some(Value::Array(_)) => {
            let read = |section| {
                let name = name(&section);
                solid(section, name, defaults, numerics)
            };
            top.tables("solid").into_iter().map(read).collect()
        }
        Some(_) => {
            let section = top.section("solid");
            if let Some(node) = section.node("name") {
                let reason = "only a [[solid]] has a name: the one of [solid] is called `solid`";
                section.wrong("name", node, reason);
            }
            vec![solid(section, Solid::DEFAULT_NAME.to_owned(), defaults, numerics)]
        }
    }
}

fn name(section: &Section<'_>) -> String {
    if section.node("name").is_none() {
        section.missing("name");
    }
    identifier(section, "name").unwrap_or_default().to_owned()
}

/// The process that serves the solid of this name.
fn process(section: &Section<'_>, name: &str) -> String {
    match section.string("process") {
        None => Solid::DEFAULT_NAME,
        Some(OWN) => name,
        Some(_) => identifier(section, "process").unwrap_or_default(),
    }
    .to_owned()
}

/// A name that can be part of the name of a file or a service and means nothing else.
fn identifier<'a>(section: &Section<'a>, key: &'static str) -> Option<&'a str> {
    let (node, text) = (section.node(key)?, section.string(key)?);
    let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    let begins = text.starts_with(|c: char| c.is_ascii_lowercase());
    if !begins || !text.chars().all(allowed) || text.len() > LONGEST_NAME {
        let form = "must be lower-case letters, digits and `-`, begin with a letter";
        let why = "files and shared memory are named after it";
        section.wrong(key, node, format!("{form} and have at most {LONGEST_NAME} characters: {why}"));
    } else if RESERVED.contains(&text) {
        let names = super::error::listed(RESERVED, "and");
        section.wrong(key, node, format!("is reserved: {names} mean something else"));
    }
    Some(text)
}

/// Keys of solids that strain.
const ELASTIC: [&str; 5] =
    ["youngs_modulus", "poissons_ratio", "smoothing_ratio", "artificial_viscosity", "side_friction"];

fn solid(section: Section<'_>, name: String, defaults: Defaults, numerics: &Numerics) -> Solid {
    let model = section.choice("model", Some(defaults.model), SolidModelName::ALL).unwrap_or(defaults.model);
    let rules = model.rules();
    let defaults = (rules.defaults)(defaults);
    for key in ELASTIC.into_iter().filter(|_| rules.rigid) {
        if let Some(node) = section.node(key) {
            section.wrong(key, node, "a rigid body does not strain, and has no use for it");
        }
    }
    // Of a rigid solid, which has none.
    let none = rules.rigid.then_some(0.0);
    let solid = Solid {
        process: process(&section, &name),
        name,
        threads: section.integer("threads", numerics.threads.solid as u32) as usize,
        density: section.number("density", None),
        youngs_modulus: section.number("youngs_modulus", none),
        poissons_ratio: section.number("poissons_ratio", none),
        smoothing_ratio: section.number_within(
            "smoothing_ratio",
            Some(defaults.solid_smoothing_ratio),
            rules.smoothing,
        ),
        artificial_viscosity: viscosity(&section, defaults.solid_viscosity),
        model: model.read(&section, &defaults),
        side_friction: section.number("side_friction", Some(0.0)),
        sub_steps: sub_steps(&section, numerics.max_sub_steps),
    };
    let others = SolidModelName::ALL.iter().filter(|(_, other)| *other != model);
    let mut known: Vec<&str> = rules.keys.iter().map(|(key, _)| *key).collect();
    for (key, why) in others.flat_map(|(_, other)| other.rules().keys) {
        if let Some(node) = section.node(key)
            && !known.contains(key)
        {
            section.wrong(key, node, *why);
        }
        // Others may have it, too.
        known.push(key);
    }
    section.finish();
    solid
}

fn sub_steps(section: &Section<'_>, most: u32) -> SubSteps {
    let Some(node) = section.node("sub_steps") else { return SubSteps::Auto };
    match &node.value {
        Value::String(text) if text == "auto" => SubSteps::Auto,
        Value::Integer(n) => match u32::try_from(*n) {
            Ok(n) if n > most => {
                let reason = format!("must be at most numerics.max_sub_steps, which is {most}");
                section.wrong("sub_steps", node, reason);
                SubSteps::Auto
            }
            Ok(n) if n == 1 || (n >= 2 && n % 2 == 0) => SubSteps::Fixed(n),
            _ => {
                let why = "half of them lead to the middle of the step";
                section.wrong("sub_steps", node, format!("must be \"auto\", 1 or an even number: {why}"));
                SubSteps::Auto
            }
        },
        _ => {
            section.wrong("sub_steps", node, "must be \"auto\", 1 or an even number");
            SubSteps::Auto
        }
    }
}
