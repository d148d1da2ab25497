//! A document that names a file of the repository names one that exists, and its links lead somewhere.

use halfstep_tests::run::repository;
use std::path::{Path, PathBuf};

/// What a run leaves or cargo builds: named in documents, but not in the repository.
const MADE: [&str; 4] = ["target/", "out/", "frames/", "/"];

/// The top folders of the repository, by which paths are told from other words with a slash.
fn top_folders() -> Vec<String> {
    let entries = std::fs::read_dir(repository()).unwrap().flatten();
    entries
        .filter(|e| e.file_type().is_ok_and(|t| t.is_dir()))
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .collect()
}

fn documents() -> Vec<PathBuf> {
    fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
        let mut entries: Vec<PathBuf> =
            std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
        entries.sort();
        for path in entries {
            if path.is_dir() {
                collect(&path, found);
            } else if path.extension().is_some_and(|e| e == "md") {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    for folder in ["docs", "validation", "examples", "shared/output"] {
        collect(&repository().join(folder), &mut found);
    }
    found.extend(["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| repository().join(name)));
    found
}

/// Targets of links and pictures, `[TEXT](TARGET)`, outside of code; a text may go over several lines.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let outside = text.split("```").step_by(2);
    let prose = outside.flat_map(|part| part.split('`').step_by(2));
    prose.flat_map(|part| part.split("](").skip(1)).filter_map(|rest| rest.split(')').next())
}

/// A heading as the target of a link: lower case, spaces to hyphens, without other signs.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).flat_map(char::to_lowercase).collect()
}

/// Anchors of the headings of a page.
fn anchors(text: &str) -> Vec<String> {
    let outside = text.split("```").step_by(2);
    let headings = outside.flat_map(str::lines).filter(|line| line.starts_with('#'));
    headings.map(|line| anchor(line.trim_start_matches('#'))).collect()
}

/// Whether a link of a document leads to a file of the repository and, where it names one, to a heading of that file.
fn leads_somewhere(target: &str, document: &Path) -> bool {
    let (file, heading) = target.split_once('#').map_or((target, None), |(file, at)| (file, Some(at)));
    let own = document.parent().expect("a document lies in a folder");
    let path = if file.is_empty() { document.to_path_buf() } else { own.join(file) };
    let has = |heading: &str| {
        std::fs::read_to_string(&path).is_ok_and(|text| anchors(&text).iter().any(|a| a == heading))
    };
    path.exists() && heading.is_none_or(has)
}

/// What stands between single backticks outside of fenced blocks.
fn in_backticks(text: &str) -> impl Iterator<Item = &str> {
    let outside = text.split("```").step_by(2);
    outside.flat_map(str::lines).flat_map(|line| line.split('`').skip(1).step_by(2))
}

/// Whether a word means a file or folder of the repository.
fn is_repository_path(word: &str) -> bool {
    let placeholder = word.chars().any(|c| " <>{}*$=|\"'[]()…".contains(c))
        || ["NNNN", "my_", "DIR", "SCENE", "CASE", "..", "://", "::"].iter().any(|part| word.contains(part));
    let path = word.contains('/') || [".rs", ".toml", ".md"].iter().any(|end| word.ends_with(end));
    path && !placeholder && !MADE.iter().any(|start| word.starts_with(start))
}

/// Where a document may mean a path from: the top, its own folder, or a crate's.
fn exists(word: &str, document: &Path, folders: &[String]) -> bool {
    let word = word.trim_end_matches('/');
    // A place within a file: src/run.rs:12 or docs/protocol.md#channels.
    let word = word.split(['#', ':']).next().unwrap_or(word);
    let top = repository();
    let own = document.parent().expect("a document lies in a folder");
    let crates = folders.iter().flat_map(|folder| [top.join(folder), top.join(folder).join("src")]);
    [top.clone(), own.into()].into_iter().chain(crates).any(|place| place.join(word).exists())
}

#[test]
fn paths_in_documents_exist() {
    let folders = top_folders();
    let mut missing = Vec::new();
    for document in documents() {
        let text = std::fs::read_to_string(&document).unwrap();
        for word in in_backticks(&text).filter(|word| is_repository_path(word)) {
            let first = word.split('/').next().unwrap_or(word);
            // Rates like kg/m and choices like on/off begin with no folder of ours and have no ending of ours.
            let ours = folders.iter().any(|f| f == first)
                || ["rs", "toml", "md"].iter().any(|e| Path::new(word).extension().is_some_and(|x| x == *e));
            if ours && !exists(word, &document, &folders) {
                let name = document.strip_prefix(repository()).unwrap_or(&document);
                missing.push(format!("{}: {word}", name.display()));
            }
        }
    }
    assert!(missing.is_empty(), "named but not there:\n{}", missing.join("\n"));
}

#[test]
fn links_in_documents_lead_somewhere() {
    let mut lost = Vec::new();
    for document in documents() {
        let text = std::fs::read_to_string(&document).unwrap();
        let name = document.strip_prefix(repository()).unwrap_or(&document);
        let inside = links(&text).filter(|target| !target.contains("://"));
        lost.extend(
            inside.filter(|t| !leads_somewhere(t, &document)).map(|t| format!("{}: {t}", name.display())),
        );
    }
    assert!(lost.is_empty(), "links that lead nowhere:\n{}", lost.join("\n"));
}

#[test]
fn every_scene_has_a_page_that_the_index_links_to() {
    let index = std::fs::read_to_string(repository().join("docs/validation.md")).unwrap();
    let scenes = std::fs::read_dir(repository().join("scenes")).unwrap().flatten();
    let cases: Vec<String> =
        scenes.filter_map(|e| Some(e.path().file_stem()?.to_string_lossy().into_owned())).collect();
    assert!(cases.len() >= 12, "{cases:?}");
    for case in cases {
        let page = format!("validation/{case}/README.md");
        assert!(repository().join(&page).is_file(), "{page} is missing");
        assert!(
            links(&index).any(|target| target == format!("../{page}")),
            "docs/validation.md has no {page}"
        );
    }
}

#[test]
fn headings_become_anchors() {
    let text = "# A (b), c d\n```sh\n# no heading\n```\n## f_i and `g`\n[x](y.md#z) `[no](link)`";
    assert_eq!(anchors(text), ["a-b-c-d", "f_i-and-g"]);
    assert_eq!(links(text).collect::<Vec<_>>(), ["y.md#z"]);
}

#[test]
fn words_are_told_from_paths() {
    for path in ["shared/link/src", "scenes/elastic-gate.toml", "coupler/simulation/src/run.rs", "run.rs"] {
        assert!(is_repository_path(path), "{path}");
    }
    for word in [
        "frames/fluid_NNNNNN.hdf",
        "docs/decisions/NNNN-title.md",
        "target/release/halfstep",
        "/dev/shm",
        "halfstep run SCENE",
        "run.json",
        "halfstep_link",
        "<DIR>/run.json",
    ] {
        assert!(!is_repository_path(word), "{word}");
    }
    let text = "see `a/b.rs` and\n```\n`c/d.rs`\n```\nor `e`.";
    assert_eq!(in_backticks(text).collect::<Vec<_>>(), ["a/b.rs", "e"]);
}
