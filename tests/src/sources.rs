//! The sources of the program, for tests that hold a rule over all of them.

use crate::run::repository;
use std::path::PathBuf;

/// Everything of the program that is compiled into it.
///
/// # Panics
/// A folder cannot be read.
pub fn sources() -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders: Vec<PathBuf> =
        ["shared", "fluid-proc", "solid-proc", "coupler"].map(|name| repository().join(name)).into();
    while let Some(folder) = folders.pop() {
        for entry in
            std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path())
        {
            let is_source =
                entry.extension().is_some_and(|e| e == "rs") && entry.to_string_lossy().contains("/src/");
            if entry.is_dir() {
                folders.push(entry);
            } else if is_source && !entry.file_stem().is_some_and(|s| s.to_string_lossy().ends_with("tests"))
            {
                found.push(entry);
            }
        }
    }
    found
}

/// A file's text without its tests: a file ends where the tests within it begin.
pub fn program(text: &str) -> &str {
    text.find("#[cfg(test)]\nmod tests {").map_or(text, |end| &text[..end])
}
