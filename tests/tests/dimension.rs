//! The dimension of a scene becomes a type in one place: everything below is generic over it.

use halfstep_tests::run::repository;
use halfstep_tests::sources::{program, sources};

/// The macro that is the place.
const PLACE: &str = "shared/scene/src/dimension.rs";

/// Not generic yet: the surfaces of contact between two solids are outlines in the plane, and scenes in space are not
/// run.
const PLANE: &str = "shared/interface/src/contact/outline.rs";

/// Lines that name a dimension as a type's parameter, with their numbers from 1. Defaults of parameters name one, too,
/// and choose none for a scene.
fn named(text: &str) -> Vec<(usize, &str)> {
    let names = |line: &str| {
        let code = line.split("//").next().unwrap_or_default();
        // Plane strain has a third axis: a matrix of three by three is no choice of a dimension.
        let tensor = code.contains("SMatrix::<f64, 3, 3>");
        !tensor && ["<2>", "<3>", ", 2>", ", 3>"].iter().any(|parameter| code.contains(parameter))
    };
    program(text).lines().enumerate().map(|(k, line)| (k + 1, line)).filter(|(_, line)| names(line)).collect()
}

#[test]
fn no_dimension_is_named_outside_of_the_one_place() {
    let top = repository();
    let mut wrong = Vec::new();
    for path in sources() {
        let text = std::fs::read_to_string(&path).expect("a source");
        let name = path.strip_prefix(&top).expect("a source of the repository").display().to_string();
        if name == PLANE {
            continue;
        }
        wrong.extend(named(&text).into_iter().map(|(k, line)| format!("{name}:{k}: {}", line.trim())));
    }
    assert!(wrong.is_empty(), "use dispatch! or the parameter D:\n{}", wrong.join("\n"));
    let place = std::fs::read_to_string(top.join(PLACE)).expect("the place");
    assert!(place.contains("macro_rules! dispatch"), "{PLACE}");
}

#[test]
fn the_scan_finds_a_dimension() {
    let text = "let a = layout::<2>(s);\n// Side<2>\nfn f<const D: usize>() {}\nCoupler::<_, 3>::new()\n\
                #[cfg(test)]\nmod tests {\n    g::<2>();\n}";
    assert_eq!(named(text), [(1, "let a = layout::<2>(s);"), (4, "Coupler::<_, 3>::new()")]);
}
