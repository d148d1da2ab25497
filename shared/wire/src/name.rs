//! Names of participants and of the processes that they run in.

use std::fmt;
use std::str::FromStr;

/// Name of a participant or a process. It travels by value: 24 letters at most.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name {
    bytes: [u8; Name::LONGEST],
    length: u8,
}

/// Why a text is no name of a participant.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no name: a letter, then letters, digits and hyphens, all small, at most {max}", max = Name::LONGEST)]
pub struct BadName(pub String);

impl Name {
    /// Letters of the longest name.
    pub const LONGEST: usize = 24;
    /// The participant that owns the fluid and the walls around it, and its process.
    pub const FLUID: Self = Self::known("fluid");
    /// The only solid of a scene, and the process of all solids that have none of their own.
    pub const SOLID: Self = Self::known("solid");
    /// The process that owns the clock and the cross-phase force.
    pub const COUPLER: Self = Self::known("coupler");

    const fn known(text: &str) -> Self {
        let mut bytes = [0; Self::LONGEST];
        let mut k = 0;
        while k < text.len() {
            bytes[k] = text.as_bytes()[k];
            k += 1;
        }
        Self { bytes, length: text.len() as u8 }
    }

    /// The name as text.
    pub fn as_str(&self) -> &str {
        std::str::from_utf8(&self.bytes[..self.length as usize]).unwrap_or_default()
    }
}

impl FromStr for Name {
    type Err = BadName;

    fn from_str(text: &str) -> Result<Self, BadName> {
        let legal = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-';
        let good = text.len() <= Self::LONGEST
            && text.starts_with(|c: char| c.is_ascii_lowercase())
            && text.bytes().all(legal);
        if good { Ok(Self::known(text)) } else { Err(BadName(text.into())) }
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl fmt::Debug for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_short_and_plain() {
        for good in ["fluid", "g", "gate-2", "abcdefghijklmnopqrstuvwx"] {
            assert_eq!(good.parse::<Name>().unwrap().to_string(), good);
        }
        for bad in ["", "2nd", "-a", "Gate", "a_b", "a b", "ä", "abcdefghijklmnopqrstuvwxy"] {
            assert_eq!(bad.parse::<Name>(), Err(BadName(bad.into())));
        }
        assert_eq!("fluid".parse(), Ok(Name::FLUID));
        assert!(Name::FLUID != Name::SOLID);
    }
}
