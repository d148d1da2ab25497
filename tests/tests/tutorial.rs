//! The tutorial is what a newcomer types: its scene is written down, its commands are run in order, and what the page
//! shows of their answers is in them.

use halfstep_tests::python::python;
use halfstep_tests::run::{program, repository};
use std::path::Path;
use std::process::{Command, Output};

/// A fenced block: what stands behind the fence, and the lines.
struct Block {
    info: String,
    text: String,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut parts = page.split("\n```");
    let mut blocks = Vec::new();
    parts.next();
    while let (Some(inside), Some(_)) = (parts.next(), parts.next()) {
        let (info, text) = inside.split_once('\n').unwrap_or((inside, ""));
        blocks.push(Block { info: info.into(), text: text.into() });
    }
    blocks
}

/// Runs a line in a folder, with the program under its name. Programs of the examples have tests of their own: there
/// must only be one of that name.
fn typed(line: &str, folder: &Path) -> Option<Output> {
    let words: Vec<&str> = line.split_whitespace().collect();
    if let Some((before, after)) = line.split_once("'python3 my_wall.py'") {
        let mut command = Command::new(program());
        command.args(before.split_whitespace().skip(1)).arg(format!("{} my_wall.py", python().display()));
        let output = command.args(after.split_whitespace()).current_dir(folder).output();
        return Some(output.expect("the program starts"));
    }
    match words.as_slice() {
        ["halfstep", arguments @ ..] => {
            let output = Command::new(program()).args(arguments).current_dir(folder).output();
            Some(output.expect("the program starts"))
        }
        ["cargo", "run", "--release", "-p", "halfstep-examples", "--bin", name] => {
            let manifest = std::fs::read_to_string(repository().join("examples/Cargo.toml")).unwrap();
            assert!(manifest.contains(&format!("name = \"{name}\"")), "{line}");
            None
        }
        _ => panic!("`{line}` is no command that a reader can type"),
    }
}

#[test]
fn every_command_of_the_tutorial_does_what_the_page_says() {
    let page = std::fs::read_to_string(repository().join("docs/tutorial.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (mut answer, mut commands, mut shown) = (String::new(), 0, 0);
    for Block { info, text } in blocks(&page) {
        match info.as_str() {
            "toml" => std::fs::write(folder.path().join("wall.toml"), text).unwrap(),
            "python" => std::fs::write(folder.path().join("my_wall.py"), text).unwrap(),
            "sh" | "sh fails" => {
                answer.clear();
                for line in text.lines() {
                    commands += 1;
                    let Some(output) = typed(line, folder.path()) else { continue };
                    let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
                    assert_eq!(output.status.success(), info == "sh", "{line}: {said:?}");
                    answer += &said.concat();
                }
            }
            "text" => {
                let answer = words(&answer);
                for line in text.lines() {
                    assert!(answer.contains(&words(line)), "`{line}` is not in the answer: {answer}");
                    shown += 1;
                }
            }
            // Set-up of the machine.
            "" => {}
            other => panic!("a block of unknown kind `{other}`"),
        }
    }
    assert!(commands >= 9 && shown >= 5, "{commands} commands, {shown} lines of answers");
    for file in ["plot.png", "contact.png", "probes.csv", "run.json", "frames"] {
        assert!(folder.path().join("out/wall").join(file).exists(), "{file}");
    }
}

/// The words alone: a report is wrapped, and a caret may stand between.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
