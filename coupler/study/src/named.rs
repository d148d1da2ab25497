//! The files that a command for the shell names.

use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::Xxh3;

/// What separates commands, or a command from the files that it reads and writes.
const OPERATORS: &str = ";&|()<>\n";

/// The files that a command names, and the words that look like files and are none.
#[derive(Clone, Debug, Default)]
pub(super) struct Named {
    pub(super) files: Vec<PathBuf>,
    pub(super) unknown: Vec<String>,
    /// Where the command may look: where it starts, and where it goes by `cd`.
    folders: Vec<PathBuf>,
}

impl Named {
    /// By a command that starts here.
    pub(super) fn by(command: &str) -> Self {
        Self::from(command, Path::new(""))
    }

    fn from(command: &str, folder: &Path) -> Self {
        let mut named = Self { folders: vec![folder.into()], ..Self::default() };
        for (is_written, text) in commands(command) {
            let Ok(words) = shell_words::split(&text) else {
                named.unknown.push(text.trim().to_owned());
                continue;
            };
            // A file that is written says nothing of the program.
            let words = &words[usize::from(is_written).min(words.len())..];
            match words {
                [first, rest @ ..] if first == "cd" || first.ends_with("=cd") => named.enter(rest),
                _ => {
                    let before = std::iter::once("").chain(words.iter().map(String::as_str));
                    before.zip(words).for_each(|(before, word)| named.add(before, word));
                }
            }
        }
        named
    }

    /// Hash of the content of all files.
    pub(super) fn hash(&self) -> std::io::Result<u64> {
        let mut hash = Xxh3::new();
        for file in &self.files {
            let content = std::fs::read(file)?;
            hash.update(&(content.len() as u64).to_le_bytes());
            hash.update(&content);
        }
        Ok(hash.digest())
    }

    /// `cd`: the later commands may also stay where they are, in a subshell's parent.
    fn enter(&mut self, words: &[String]) {
        let home = "~".to_owned();
        let word = words.iter().find(|word| *word != "--").unwrap_or(&home);
        let found: Vec<PathBuf> = self.places(word).filter(|place| place.is_dir()).collect();
        if found.is_empty() {
            self.unknown.push(word.clone());
        }
        self.folders.extend(found);
    }

    /// A word after another: a file, an option or a variable with one, or with several. What a module has, or a folder
    /// that is an argument, is not known.
    fn add(&mut self, before: &str, word: &str) {
        let places: Vec<PathBuf> = self.places(word).collect();
        let is_folder =
            places.iter().any(|place| place.is_dir()) && !places.iter().any(|place| place.is_file());
        if before == "-m" || is_folder {
            self.unknown.push(word.to_owned());
            return;
        }
        if self.find(word) {
            return;
        }
        let value = word.split_once('=').map_or(word, |(_, value)| value);
        if self.find(value) {
            return;
        }
        for part in value.split(['=', ':', ',']) {
            // `-t0.5`, `-I/usr/include`.
            let short = if part.starts_with("--") { None } else { part.strip_prefix('-') };
            let rest = short.map_or(part, |rest| rest.get(1..).unwrap_or_default());
            if !self.find(rest) && looks_like_file(rest) {
                self.unknown.push(word.to_owned());
                return;
            }
        }
    }

    /// Takes the file of that name; returns whether something has it.
    fn find(&mut self, name: &str) -> bool {
        if name.is_empty() {
            return true;
        }
        let mut places: Vec<PathBuf> = self.places(name).collect();
        if !name.contains('/') {
            let path = std::env::var_os("PATH").unwrap_or_default();
            places.extend(std::env::split_paths(&path).map(|folder| folder.join(name)).find(|p| p.is_file()));
        }
        places.retain(|place| place.exists());
        let found = !places.is_empty();
        // Devices and folders have no content of the program's.
        self.files.extend(places.into_iter().filter(|place| place.is_file()));
        found
    }

    /// What a word may stand for.
    fn places(&self, name: &str) -> impl Iterator<Item = PathBuf> {
        let below_home = name.strip_prefix('~').filter(|rest| rest.is_empty() || rest.starts_with('/'));
        let home = below_home.and_then(|rest| Some(std::env::home_dir()?.join(rest.trim_start_matches('/'))));
        self.folders.iter().map(move |folder| folder.join(name)).chain(home)
    }
}

/// A line's simple commands, the text before and after each operator, with whether it begins with a file that is
/// written.
fn commands(line: &str) -> Vec<(bool, String)> {
    let mut found = vec![(false, String::new())];
    let (mut quote, mut escaped, mut after_operator) = (None, false, false);
    for c in line.chars() {
        let is_operator = quote.is_none() && !escaped && OPERATORS.contains(c);
        if is_operator && !after_operator {
            found.push(Default::default());
        }
        if let Some((is_written, text)) = found.last_mut() {
            *is_written |= is_operator && c == '>';
            text.extend(Some(c).filter(|_| !is_operator));
        }
        after_operator = is_operator;
        match (c, quote) {
            _ if escaped => escaped = false,
            ('\\', None | Some('"')) => escaped = true,
            ('\'' | '"', None) => quote = Some(c),
            _ if quote == Some(c) => quote = None,
            _ => {}
        }
    }
    found
}

/// Whether a word that names no file was meant to, or to stand for one: a path, a name with an extension, what the
/// shell would replace.
fn looks_like_file(word: &str) -> bool {
    let extension = Path::new(word).extension().and_then(|extension| extension.to_str());
    let is_name = extension.is_some_and(|e| e.starts_with(|c: char| c.is_ascii_alphabetic()));
    word.parse::<f64>().is_err() && (is_name || word.contains(['/', '$', '`', '*', '?']))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(folder: &Path, command: &str) -> (Vec<String>, Vec<String>) {
        let named = Named::from(command, folder);
        let own = |file: &PathBuf| Some(file.strip_prefix(folder).ok()?.to_str()?.to_owned());
        (named.files.iter().filter_map(own).collect(), named.unknown)
    }

    #[test]
    fn files_are_found_as_the_shell_finds_them() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("a solver")).unwrap();
        for file in ["gate.py", "mesh.msh", "a solver/gate.py", "a solver/fast", "old.log"] {
            std::fs::write(folder.path().join(file), file).unwrap();
        }
        for (command, files) in [
            ("plate=OMP_NUM_THREADS=1 sh gate.py 0.5 2e4 -t0.5 --k=1.5,2", &["gate.py"][..]),
            ("plate='a solver/fast' --mesh=mesh.msh", &["a solver/fast", "mesh.msh"]),
            ("sh a\\ solver/gate.py", &["a solver/gate.py"]),
            ("plate=cd 'a solver' && ./fast 4", &["a solver/./fast"]),
            ("(cd \"a solver\"; sh gate.py)", &["gate.py", "a solver/gate.py"]),
            ("sh gate.py<mesh.msh >old.log 2>&1", &["gate.py", "mesh.msh"]),
            ("sh gate.py >> new.log 2> /dev/null", &["gate.py"]),
            ("PYTHONPATH='a solver':/tmp sh gate.py ~ ';x.py y'", &["gate.py"]),
        ] {
            let (found, unknown) = named(folder.path(), command);
            assert_eq!(found, files, "{command}");
            assert_eq!(unknown.is_empty(), !command.contains(".py y"), "{command}: {unknown:?}");
        }
        for (command, word) in [
            ("sh gate.py other.msh", "other.msh"),
            ("cd elsewhere && sh gate.py", "elsewhere"),
            ("sh $SOLVER", "$SOLVER"),
            ("sh -m my.gate", "my.gate"),
            ("sh -m gate", "gate"),
            ("sh gate.py 'a solver'", "a solver"),
            ("./solve", "./solve"),
            ("sh --mesh=*.msh", "--mesh=*.msh"),
            ("sh 'gate.py", "sh 'gate.py"),
        ] {
            assert_eq!(named(folder.path(), command).1, [word], "{command}");
        }
    }

    #[test]
    fn programs_on_the_path_count() {
        let shell = Named::by("plate=sh -c true").files;
        assert!(shell.iter().any(|file| file.ends_with("sh")), "{shell:?}");
    }

    #[test]
    fn the_hash_is_of_the_content() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a.py", "b.py"].map(|name| folder.path().join(name));
        let hash = |texts: [&str; 2]| {
            std::fs::write(&a, texts[0]).unwrap();
            std::fs::write(&b, texts[1]).unwrap();
            Named::from("./a.py b.py", folder.path()).hash().unwrap()
        };
        assert_eq!(hash(["x", "y"]), hash(["x", "y"]));
        assert!(hash(["x", "y"]) != hash(["y", "x"]) && hash(["xy", ""]) != hash(["x", "y"]));
    }
}
