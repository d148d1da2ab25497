//! What helps before and beside runs: new scenes, completions, a manual page, what the program is.

use clap::{Command, ValueEnum};
use clap_complete::Shell;
use halfstep_coupling::say;
use halfstep_sph::lane::Isa;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::LazyLock;

/// Version, commit, instruction set and features.
pub(crate) static VERSION: LazyLock<String> = LazyLock::new(|| {
    format!(
        "{}\ncommit           {}\ninstruction set  {} ({} here)\nfeatures         pictures",
        env!("CARGO_PKG_VERSION"),
        option_env!("HALFSTEP_COMMIT").unwrap_or("unknown"),
        Isa::detect().bits_name(),
        std::env::consts::ARCH
    )
});

/// What a new scene is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kind {
    /// A column of water that collapses in a tank
    Water,
    /// Water that leans on an elastic plate
    Coupled,
    /// A beam under its own weight
    Solid,
    /// A tank that rolls, with an elastic baffle
    Rolling,
    /// A rigid box that floats
    Floating,
    /// Waves of a piston, and a beach
    Waves,
    /// A brittle wall that water breaks
    Breaking,
}

impl Kind {
    fn text(self) -> &'static str {
        match self {
            Self::Water => include_str!("../templates/water.toml"),
            Self::Coupled => include_str!("../templates/coupled.toml"),
            Self::Solid => include_str!("../templates/solid.toml"),
            Self::Rolling => include_str!("../templates/rolling.toml"),
            Self::Floating => include_str!("../templates/floating.toml"),
            Self::Waves => include_str!("../templates/waves.toml"),
            Self::Breaking => include_str!("../templates/breaking.toml"),
        }
    }
}

/// Writes a commented scene that runs as it is; no file is replaced.
pub(crate) fn new(path: &Path, kind: Kind) -> ExitCode {
    let path = match path.extension() {
        Some(_) => path.to_path_buf(),
        None => PathBuf::from(format!("{}.toml", path.display())),
    };
    let text = kind.text().replace("SCENE", &path.display().to_string());
    let made = OpenOptions::new().write(true).create_new(true).open(&path);
    match made.and_then(|mut file| file.write_all(text.as_bytes())) {
        Ok(()) => {
            say::tell(format_args!(
                "{}\nhalfstep check {} says what it computes",
                path.display(),
                path.display()
            ));
            ExitCode::SUCCESS
        }
        Err(error) => {
            let reason = match error.kind() {
                ErrorKind::AlreadyExists => "is there already, and nothing is replaced".to_owned(),
                _ => error.to_string(),
            };
            say::warn(format_args!("error: {}: {reason}", path.display()));
            ExitCode::from(1)
        }
    }
}

/// Prints the JSON schema of scenes.
pub(crate) fn schema() -> ExitCode {
    say::tell(format_args!("{:#}", halfstep_scene::schema()));
    ExitCode::SUCCESS
}

/// Prints a shell's completions.
pub(crate) fn completions(mut command: Command, shell: Shell) -> ExitCode {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut command, "halfstep", &mut text);
    say::tell(format_args!("{}", String::from_utf8_lossy(&text).trim_end()));
    ExitCode::SUCCESS
}

/// Prints the manual page.
pub(crate) fn manual(command: Command) -> ExitCode {
    let mut text = Vec::new();
    // Writing to memory cannot fail.
    let _ = clap_mangen::Man::new(command).render(&mut text);
    say::tell(format_args!("{}", String::from_utf8_lossy(&text).trim_end()));
    ExitCode::SUCCESS
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_scene::parse;

    #[test]
    fn every_new_scene_is_right_and_has_no_warning() {
        for kind in Kind::value_variants() {
            let name = format!("{kind:?}.toml");
            let scene =
                parse(kind.text(), Path::new(&name), &[]).unwrap_or_else(|e| panic!("{kind:?}: {e:?}"));
            let check = halfstep::check::check(&scene, Isa::detect()).expect("two dimensions");
            assert_eq!(check.warnings, Vec::<String>::new(), "{kind:?}");
            assert!(!scene.metrics.is_empty() && kind.text().contains("halfstep run SCENE"), "{kind:?}");
        }
    }

    #[test]
    fn a_scene_that_is_there_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("own");
        assert_eq!(new(&path, Kind::Water), ExitCode::SUCCESS);
        let made = folder.path().join("own.toml");
        std::fs::write(&made, "mine").unwrap();
        assert_eq!(new(&path, Kind::Solid), ExitCode::from(1));
        assert_eq!(std::fs::read_to_string(&made).unwrap(), "mine");
    }
}
