//! Files that somebody made to be read for ever, or to use up the memory: an error comes, soon and short.

use halfstep_scene::{load, parse};
use std::ffi::CString;
use std::path::Path;

/// Everything that the command line would print about a text, and its number of errors.
fn said(text: &str, overrides: &[String]) -> (String, usize) {
    let errors = parse(text, Path::new("s.toml"), overrides).unwrap_err();
    let count = errors.problems.len();
    let lines: String = errors.problems.iter().map(|problem| format!("{problem}\n")).collect();
    (format!("{lines}{:?}", miette::Report::new(errors)), count)
}

#[test]
fn of_a_hundred_thousand_unknown_keys_the_first_hundred_are_told() {
    let keys: String = (0..100_000).map(|k| format!("key_{k} = {k}\n")).collect();
    for text in [keys.clone(), format!("[fluid]\n{keys}")] {
        let (message, count) = said(&text, &[]);
        assert_eq!(count, 100);
        assert!(message.contains("s.toml has at least 100 errors"), "{message}");
        assert!(message.len() < 200_000, "{} bytes", message.len());
    }
}

#[test]
fn a_long_line_is_not_repeated() {
    let long = "x".repeat(2_000_000);
    let texts = [
        format!("{long} = 1\n"),
        format!("resolution = \"{long}\"\n"),
        format!("resolution = 0.1 # {long}\nresolution = 0.2\n"),
        format!("resolution = [{}]\n", "0, ".repeat(500_000)),
        format!("resolution = {long}\n"),
    ];
    for text in texts {
        let (message, _) = said(&text, &[]);
        assert!(message.len() < 100_000, "{} bytes", message.len());
    }
    let (message, _) = said("", &[format!("resolution={long}"), format!("{long}=1")]);
    assert!(message.len() < 100_000, "{} bytes", message.len());
}

#[test]
fn deep_tables_do_not_overflow_the_stack() {
    let deep = "a.".repeat(60_000) + "a";
    let (message, _) = said("", &[format!("{deep}=1")]);
    assert!(message.contains("its key has 60001 parts, at most 16 mean anything"), "{message}");
    let brackets = "[".repeat(60_000);
    for text in [format!("{deep} = 1\n"), format!("[{deep}]\nb = 1\n"), format!("a = {brackets}\n")] {
        assert!(said(&text, &[]).1 > 0);
    }
    assert!(said("", &[format!("a={brackets}")]).1 > 0);
}

#[test]
fn what_is_no_file_is_not_read() {
    let folder = std::env::temp_dir().join(format!("halfstep-hostile-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let pipe = folder.join("pipe.toml");
    let path = CString::new(pipe.to_str().unwrap()).unwrap();
    // SAFETY: the path ends with NUL.
    assert_eq!(unsafe { libc::mkfifo(path.as_ptr(), 0o600) }, 0);
    let large = folder.join("large.toml");
    std::fs::File::create(&large).unwrap().set_len(1 << 40).unwrap();
    for (path, why) in [
        (Path::new("/dev/zero"), "a device, and no file"),
        (&pipe, "a pipe or a device, and no file"),
        (&folder, "a folder"),
        (&large, "more than 64 MiB"),
    ] {
        let errors = load(path, &[]).unwrap_err();
        assert!(errors.problems[0].reason.contains(why), "{path:?}: {}", errors.problems[0]);
    }
    let curve = "resolution = 0.1\n[[reference]]\nlabel = \"x\"\nprobe = \"p\"\ncolumns = [\"t\", \"x\"]\n";
    for path in ["/dev/zero", pipe.to_str().unwrap()] {
        let (message, _) = said(&format!("{curve}file = \"{path}\"\n"), &[]);
        assert!(message.contains("and no file"), "{message}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}
