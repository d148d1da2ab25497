//! Solids in resolved scenes: `null` for none, an object for the one of `[solid]`, a list for `[[solid]]`.

use super::Solid;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub(crate) fn serialize<S: Serializer>(solids: &[Solid], to: S) -> Result<S::Ok, S::Error> {
    match solids {
        [] => to.serialize_none(),
        [one] if one.name == Solid::DEFAULT_NAME => one.serialize(to),
        several => several.serialize(to),
    }
}

pub(crate) fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<Vec<Solid>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Section {
        One(Box<Solid>),
        Several(Vec<Solid>),
    }
    Ok(match Option::<Section>::deserialize(from)? {
        None => Vec::new(),
        Some(Section::One(solid)) => vec![*solid],
        Some(Section::Several(solids)) => solids,
    })
}
