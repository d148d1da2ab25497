//! `[[contact]]`.

use super::document::Value;
use super::error::{listed, nearest};
use super::section::Section;
use super::*;

/// Contact of two solids; `None` where it is not clear of which.
pub(super) fn contact(section: Section<'_>, names: &[&str]) -> Option<PairContact> {
    let solids = solids(&section, names);
    let contact = PairContact {
        solids: solids.unwrap_or_default(),
        touch: section.boolean("touch", true),
        friction: section.number("friction", Some(0.0)),
        restitution: section.number("restitution", Some(0.0)),
        stiffness: section.number_or_auto("stiffness", None),
    };
    section.finish();
    solids.map(|_| contact)
}

fn solids(section: &Section<'_>, names: &[&str]) -> Option<[usize; 2]> {
    let Some(node) = section.node("solids") else {
        section.missing("solids");
        return None;
    };
    let Value::Array(items) = &node.value else {
        section.wrong("solids", node, "must be an array of the names of two solids");
        return None;
    };
    let mut pair = Vec::new();
    for item in items {
        let Value::String(name) = &item.value else {
            section.wrong("solids", item, "must be an array of the names of two solids");
            return None;
        };
        let Some(place) = names.iter().position(|known| known == name) else {
            let note =
                section.report.value(&section.path_of("solids"), item.origin, "no solid has this name");
            match nearest(name, names.iter().copied()) {
                Some(near) => note.help(format!("did you mean `{near}`?")),
                None => note.help(format!("the solids are {}", listed(names.iter().copied(), "and"))),
            }
            return None;
        };
        pair.push(place);
    }
    pair.sort_unstable();
    match pair[..] {
        [a, b] if a != b => Some([a, b]),
        [_, _] => {
            let how = "bodies of one solid touch in its model, whose own keys say how";
            section.wrong("solids", node, format!("names one solid twice: {how}"));
            None
        }
        _ => {
            section.wrong("solids", node, "must name two solids");
            None
        }
    }
}
