//! The solids that a comparison is of, as the command line names them.

use halfstep_scene::SolidModelName;
use serde::Serialize;
use std::path::Path;

/// A solid that takes part.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Candidate {
    /// A model that comes with the program, by its name in scenes.
    Model(String),
    /// A program: what it is called, and the line for the shell that starts it.
    Program {
        /// Small letters, digits, `-`, `_` and `.`, first a letter or a digit; names the folder of the run.
        name: String,
        /// The line.
        command: String,
    },
}

impl Candidate {
    /// From the command line: the name of a model, a command, or NAME=COMMAND.
    pub fn parse(text: &str) -> Self {
        if SolidModelName::ALL.iter().any(|(name, _)| *name == text) {
            return Self::Model(text.into());
        }
        if let Some((name, command)) = text.split_once('=').filter(|(name, _)| is_name(name)) {
            return Self::Program { name: name.into(), command: command.into() };
        }
        // The script, not its interpreter or its arguments.
        let stem =
            |word: &str| Some(Path::new(word.trim_matches(['\'', '"'])).file_stem()?.to_str()?.to_owned());
        let is_script = |word: &&str| Path::new(word.trim_matches(['\'', '"'])).extension().is_some();
        let words = || text.split_whitespace();
        let name = words().find(is_script).or(words().next()).and_then(stem).filter(|name| is_name(name));
        Self::Program { name: name.unwrap_or_else(|| "program".into()), command: text.into() }
    }

    /// Why it is refused: it has a name that is none, or no shell would start it, a single word that is neither a model
    /// nor a program.
    pub fn unknown(&self) -> Option<String> {
        let Self::Program { command, .. } = self else { return None };
        if let Some((name, _)) = command.split_once('=')
            && name.starts_with(['.', '-'])
            && name.chars().all(may_name)
        {
            return Some(format!("`{name}` names no solid: names begin with a small letter or a digit"));
        }
        if command.is_empty() || command.contains(|c: char| c.is_whitespace() || "/=;&|$`'\"".contains(c)) {
            return None;
        }
        let path = std::env::var_os("PATH").unwrap_or_default();
        if std::env::split_paths(&path).any(|folder| folder.join(command).is_file()) {
            return None;
        }
        let models = SolidModelName::ALL.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        Some(format!("`{command}` is no model ({models}) and no program on PATH"))
    }

    /// What the solid is called in table, picture and folder.
    pub fn name(&self) -> &str {
        match self {
            Self::Model(name) | Self::Program { name, .. } => name,
        }
    }
}

/// A variable of the command's environment is in capitals.
fn may_name(c: char) -> bool {
    c.is_ascii_lowercase() || c.is_ascii_digit() || "-_.".contains(c)
}

/// Whether a folder can be called so: dots alone are the folder above.
fn is_name(name: &str) -> bool {
    !name.starts_with(['-', '_', '.']) && !name.is_empty() && name.chars().all(may_name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solids_are_models_or_programs() {
        assert_eq!(Candidate::parse("hypoelastic"), Candidate::Model("hypoelastic".into()));
        let named = |text: &str| Candidate::parse(text).name().to_owned();
        assert_eq!(named("fem=python3 gate.py 4"), "fem");
        assert_eq!(named("OMP_NUM_THREADS=1 python3 gate.py"), "gate");
        assert_eq!(named("/usr/bin/python3 'my/gate.py' 4"), "gate");
        assert_eq!(named("./solid"), "solid");
        let command = Candidate::Program { name: "a".into(), command: "b --key=c".into() };
        assert_eq!(Candidate::parse("a=b --key=c"), command);
    }

    #[test]
    fn a_word_that_is_neither_model_nor_program_is_unknown() {
        let unknown = |text: &str| Candidate::parse(text).unknown();
        assert!(
            unknown("hypoelastc")
                .is_some_and(|why| why.contains("hypoelastic, ") || why.contains(", hypoelastic"))
        );
        assert!(unknown("mine=total-lagrange").is_some());
        for known in ["hypoelastic", "sh", "./hypoelastc", "hypoelastc --now", "A=1 hypoelastc"] {
            assert_eq!(unknown(known), None, "{known}");
        }
    }

    #[test]
    fn names_begin_with_a_letter_or_a_digit() {
        for text in ["..=./solid 4", ".=./solid 4", "-x=./solid 4", ".hidden=./solid"] {
            let candidate = Candidate::parse(text);
            assert!(!candidate.name().starts_with(['.', '-']), "{text}");
            assert!(candidate.unknown().is_some_and(|why| why.contains("names no solid")), "{text}");
        }
        let variable = Candidate::parse("_x=1 ./.solid.sh");
        assert_eq!((variable.name(), variable.unknown()), ("program", None));
        assert_eq!(Candidate::parse("2d_v1.0=./solid").name(), "2d_v1.0");
    }
}
