//! A state hash holds on every machine of its instruction set only if no result depends on the system's sin or exp,
//! which differ in the last bit from one C library and processor to the next.

use halfstep_tests::run::repository;
use halfstep_tests::sources::{program, sources};
use std::path::Path;

/// Functions that f64 takes from the system. Square roots are exact; `mul_add` is rounded once wherever it is used;
/// integer powers are products.
const SYSTEM: [&str; 25] = [
    "sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh",
    "acosh", "atanh", "exp", "exp2", "exp_m1", "ln", "ln_1p", "log", "log2", "log10", "powf", "cbrt",
    "hypot",
];

/// Parts of a path where no bit of a run is made: pictures and files of results, studies of finished runs, the
/// statistics of waiting times, and what is said about a scene.
const FREE: [&str; 4] = ["/output/", "/study/", "/latency.rs", "/remarks/"];

/// Numbers of the lines that call one of the system's functions, from 1. A file ends where the tests within it begin.
fn calls(text: &str) -> Vec<usize> {
    let calls_one = |line: &str| {
        let code = line.split("//").next().unwrap_or_default();
        SYSTEM.iter().any(|name| {
            let path = |(k, found): (usize, &str)| {
                !code[k + found.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_')
            };
            code.contains(&format!(".{name}(")) || code.match_indices(&format!("f64::{name}")).any(path)
        })
    };
    program(text).lines().enumerate().filter(|(_, line)| calls_one(line)).map(|(k, _)| k + 1).collect()
}

#[test]
fn what_a_run_computes_takes_no_function_from_the_system() {
    let top = repository();
    let (mut wrong, mut used) = (Vec::new(), Vec::new());
    for path in sources() {
        let text = std::fs::read_to_string(&path).expect("a source");
        let name = format!("/{}", path.strip_prefix(&top).unwrap_or(Path::new("")).display());
        let lines = calls(&text);
        match FREE.iter().find(|part| name.contains(**part)) {
            Some(part) if !lines.is_empty() => used.push(*part),
            Some(_) => {}
            None => wrong.extend(
                lines.iter().map(|k| format!("{name}:{k}: {}", text.lines().nth(k - 1).unwrap_or(""))),
            ),
        }
    }
    assert!(wrong.is_empty(), "use the crate libm's function:\n{}", wrong.join("\n"));
    // Each exception is one, so the scan reads files and finds calls.
    assert!(FREE.iter().all(|part| used.contains(part)), "{used:?}");
}

#[test]
fn the_scan_tells_the_systems_functions_from_others() {
    let text = "#[cfg(test)]\nmod tests;\na.sin()\nlibm::sin(a)\n// a.exp()\nmap(f64::tanh)\nf64::sinhole\n\
                a.sqrt().max(b)\na.powi(2)\nx.powf(0.5)\n\
                #[cfg(test)]\nmod tests { a.cos() }";
    assert_eq!(calls(text), [3, 6, 10]);
}
