//! The script of the price lists, with a stand-in for the program: whether it runs to its end, keeps the lists that it
//! does not renew, and asks for scenes that there are.

use halfstep_tests::repository;
use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

/// Notes how it is called, and leaves what the script takes.
const STAND_IN: &str = r#"#!/bin/sh
printf '%s\n' "$*" >> calls
while [ $# -gt 0 ]; do
    [ "$1" = --out ] && { mkdir -p "$2"; : > "$2/work-precision.png"; echo "a new list"; }
    shift
done
"#;

fn run(folder: &Path, scenes: &[&str]) -> (String, String) {
    let _ = std::fs::remove_file(folder.join("calls"));
    let output = Command::new("sh")
        .args(["docs/price-lists.sh", "./stand-in"])
        .args(scenes)
        .current_dir(folder)
        .output()
        .expect("sh runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect(name);
    (read("calls"), read("docs/price-lists.md"))
}

/// The section of a scene in the page.
fn section<'p>(page: &'p str, scene: &str) -> Option<&'p str> {
    let rest = page.split(&format!("\n## {scene}\n")).nth(1)?;
    rest.split("\n## ").next().map(str::trim)
}

#[test]
fn the_script_asks_for_scenes_that_there_are_and_keeps_the_rest_of_the_page() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(folder.path().join("docs/images")).unwrap();
    for name in ["docs/price-lists.sh", "docs/price-lists.md"] {
        std::fs::copy(repository().join(name), folder.path().join(name)).unwrap();
    }
    std::fs::create_dir_all(folder.path().join("tests/python")).unwrap();
    std::fs::write(folder.path().join("tests/python/setup.sh"), "echo python3\n").unwrap();
    let stand_in = folder.path().join("stand-in");
    std::fs::write(&stand_in, STAND_IN).unwrap();
    std::fs::set_permissions(&stand_in, Permissions::from_mode(0o700)).unwrap();

    let before = std::fs::read_to_string(folder.path().join("docs/price-lists.md")).unwrap();
    let (calls, page) = run(folder.path(), &["taylor-green"]);
    assert_eq!(calls.lines().count(), 1, "{calls}");
    assert!(section(&page, "taylor-green").unwrap().contains("a new list"), "{page}");
    for scene in ["oscillating-plate", "standing-wave", "elastic-gate"] {
        assert_eq!(section(&page, scene), section(&before, scene), "{scene}");
    }

    let (calls, page) = run(folder.path(), &[]);
    assert!(calls.lines().count() >= 18, "{calls}");
    for call in calls.lines() {
        let words: Vec<&str> = call.split_whitespace().collect();
        let path = words[1];
        let name = words[words.len() - 1].trim_start_matches("out/prices/");
        assert!(section(&page, name).unwrap().contains("a new list"), "{name}");
        let after = |key: &str| words.windows(2).filter(|w| w[0] == key).map(|w| w[1]).collect::<Vec<_>>();
        let settings: Vec<String> = after("--set").into_iter().map(str::to_owned).collect();
        let mut variants = vec![settings.clone()];
        for vary in after("--vary") {
            let (key, values) = vary.split_once('=').expect("KEY=A,B");
            for value in values.split(',') {
                variants.push(settings.iter().cloned().chain([format!("{key}={value}")]).collect());
            }
        }
        assert!(variants.len() > 1, "{call}");
        for variant in variants {
            let loaded = halfstep_scene::load(&repository().join(path), &variant);
            assert!(loaded.is_ok(), "{path} {variant:?}: {:?}", loaded.err());
        }
    }
}
