//! Wrong scenes and what is said about them: every message in full, with line and column, and no other message.

use halfstep_scene::{Place, SceneErrors, parse};
use miette::Diagnostic;
use std::path::{Path, PathBuf};

const RIGHT: &str = r#"resolution = 0.01
end_time = 1.0
gravity = [0.0, -9.81]

[fluid]
density = 1000.0

[solid]
density = 1100.0
youngs_modulus = 12e6
poissons_ratio = 0.4

[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.2, 0.3] }

[[shape]]
name = "plate"
phase = "solid"
box = { min = [0.3, 0.0], max = [0.35, 0.3] }
clamp = { min = [0.3, 0.2], max = [0.35, 0.3] }

[[shape]]
name = "basin"
phase = "wall"
tank = { min = [0.0, 0.0], max = [1.0, 0.5], open = ["top"] }

[[probe]]
name = "tip"
kind = "displacement"
at = [0.325, 0.0]

[[reference]]
probe = "tip.x"
label = "theory"
points = [[0.0, 0.0], [1.0, 0.01]]
"#;

/// One case a paragraph: lines taken out of [`RIGHT`] (`-`), lines put in their place (`+`), overrides (`$`), and the
/// messages that follow (`>`). A paragraph headed `= two solids` starts from [`two_solids`] instead,
/// one headed `= rigid` from [`rigid`].
const CASES: &str = include_str!("wrong_scenes.txt");

fn errors(text: &str, overrides: &[&str]) -> SceneErrors {
    let overrides: Vec<String> = overrides.iter().map(|o| o.to_string()).collect();
    match parse(text, Path::new("s.toml"), &overrides) {
        Ok(_) => panic!("no error: {overrides:?} on\n{text}"),
        Err(errors) => errors,
    }
}

fn messages(errors: &SceneErrors) -> Vec<String> {
    errors.problems.iter().map(|p| p.to_string()).collect()
}

/// The right scene with another solid beside its own.
fn two_solids() -> String {
    let gate = edited("[solid]\n", "[[solid]]\nname = \"gate\"\n");
    let named = "phase = \"solid\"\nsolid = \"gate\"\n";
    let gate = replaced(&gate, "phase = \"solid\"\n", named);
    let lid = "[[solid]]\nname = \"lid\"\nmodel = \"hypoelastic\"\ndensity = 900.0\nyoungs_modulus = 1e9\n\
               poissons_ratio = 0.3\n\n[[shape]]\nname = \"cover\"\nphase = \"solid\"\nsolid = \"lid\"\n\
               box = { min = [0.5, 0.0], max = [0.6, 0.3] }\n";
    format!("{gate}\n{lid}")
}

/// The right scene with a rigid solid: the plate, and a wall that swings.
fn rigid() -> String {
    let solid = edited("youngs_modulus = 12e6\npoissons_ratio = 0.4\n", "model = \"rigid\"\n");
    let clamp = "clamp = { min = [0.3, 0.2], max = [0.35, 0.3] }\n";
    let joint = "\n[[solid.joints]]\nname = \"pin\"\nkind = \"hinge\"\nbody = \"plate\"\nat = [0.3, 0.3]\n";
    replaced(&solid, clamp, "") + joint
}

/// The right scene with whole lines replaced.
fn edited(from: &str, to: &str) -> String {
    replaced(RIGHT, from, to)
}

fn replaced(text: &str, from: &str, to: &str) -> String {
    let framed = format!("\n{text}");
    let from = format!("\n{from}");
    assert_eq!(framed.matches(&from).count(), 1, "must occur once:{from}");
    framed.replacen(&from, &format!("\n{to}"), 1)[1..].to_owned()
}

#[test]
fn the_scenes_that_they_are_made_of_are_right() {
    parse(RIGHT, Path::new("s.toml"), &[]).unwrap();
    parse(&two_solids(), Path::new("s.toml"), &[]).unwrap();
    parse(&rigid(), Path::new("s.toml"), &[]).unwrap();
}

/// A wrong scene: its paragraph, file, overrides and messages.
struct Case {
    case: &'static str,
    text: String,
    set: Vec<&'static str>,
    want: Vec<&'static str>,
}

fn cases() -> impl Iterator<Item = Case> {
    CASES.split("\n\n").map(|case| {
        let marked = |mark: &str| case.lines().filter_map(|l| l.strip_prefix(mark)).collect::<Vec<_>>();
        let [out, put, set, want] = ["- ", "+ ", "$ ", "> "].map(marked);
        let two = case.starts_with("= two solids\n");
        let rigid_one = case.starts_with("= rigid\n");
        let marks = out.len() + put.len() + set.len() + want.len() + usize::from(two || rigid_one);
        assert_eq!(marks, case.lines().count(), "{case}");
        let base = match (two, rigid_one) {
            (true, _) => two_solids(),
            (_, true) => rigid(),
            _ => RIGHT.to_owned(),
        };
        let lines = |lines: &[&str]| lines.iter().map(|l| format!("{l}\n")).collect::<String>();
        let text = if out.is_empty() { base } else { replaced(&base, &lines(&out), &lines(&put)) };
        Case { case, text, set, want }
    })
}

#[test]
fn every_wrong_scene_is_told_what_is_wrong_and_nothing_else() {
    let (mut count, mut failed) = (0, Vec::new());
    for Case { case, text, set, want } in cases() {
        let got = messages(&errors(&text, &set));
        if got != want {
            failed.push(format!("{case}\n  got: {got:#?}"));
        }
        count += 1;
    }
    assert!(failed.is_empty(), "{}", failed.join("\n\n"));
    assert!(count > 100, "{count} cases");
}

#[test]
fn what_no_memory_holds_is_refused_before_it_is_allocated() {
    for resolution in ["1e-8", "1e-60", "1e-300"] {
        let set = format!("resolution={resolution}");
        let got = messages(&errors(RIGHT, &[&set]));
        assert_eq!(got.len(), 1, "{got:?}");
        assert!(got[0].starts_with(&format!("--set {set}: makes ")), "{got:?}");
        assert!(got[0].ends_with("iB of memory are available"), "{got:?}");
    }
    let got = messages(&errors(RIGHT, &["resolution=1e-8"]));
    assert!(got[0].contains("6.0e14 fluid, 1.5e14 solid and "), "{got:?}");
}

#[test]
fn what_is_nearly_right_is_suggested() {
    for (from, to, help) in [
        ("density = 1000.0", "densty = 1000.0", "did you mean `density`?"),
        ("gravity = [0.0, -9.81]", "gravitiy = [0.0, -9.81]", "did you mean `gravity`?"),
        ("phase = \"fluid\"", "phase = \"fliud\"", "did you mean `fluid`?"),
        ("kind = \"displacement\"", "kind = \"displacements\"", "did you mean `displacement`?"),
        ("probe = \"tip.x\"", "probe = \"top.x\"", "did you mean `tip.x`?"),
        ("[fluid]", "effects.wall_contact = \"on\"\n[fluid]", "did you mean `wall-contact`?"),
        (
            "density = 1100.0",
            "density = 1100.0\ngravity = [0.0, 0.0]",
            "`gravity` belongs at the top of the scene, above the first [section]",
        ),
        (
            "label = \"theory\"",
            "label = \"theory\"\nzzz = 1",
            "known here: `columns`, `file`, `label`, `points`, `probe` and `scale`",
        ),
    ] {
        let errors = errors(&edited(&format!("{from}\n"), &format!("{to}\n")), &[]);
        let helps: Vec<&str> = errors.problems.iter().filter_map(|p| p.help.as_deref()).collect();
        assert_eq!(helps, [help], "{to}");
    }
    let both = format!("{RIGHT}\n[[solid]]\nname = \"lid\"\n");
    let help = errors(&both, &[]).problems.remove(0).help;
    assert_eq!(help.as_deref(), Some("a scene has either one [solid] or several [[solid]]"));
    let errors = errors(RIGHT, &["shape.plat.velocity=[1,0]"]);
    assert_eq!(errors.problems[0].help.as_deref(), Some("did you mean `shape.plate`?"));
}

#[test]
fn all_errors_come_at_once_the_files_before_the_overrides() {
    let text = RIGHT.replace("1000.0", "-1.0").replace("0.01\n", "0.0\n").replace("12e6", "0");
    let errors = errors(&text, &["solid.density=0", "output.frame_interval=-1"]);
    let keys: Vec<&str> = errors.problems.iter().map(|p| p.key.as_str()).collect();
    let want =
        ["resolution", "fluid.density", "solid.youngs_modulus", "solid.density", "output.frame_interval"];
    assert_eq!(keys, want);
    assert_eq!(errors.to_string(), "s.toml has 5 errors");
    assert_eq!(errors.related().unwrap().count(), 5);
}

#[test]
fn an_error_carries_its_parts_and_its_span() {
    // Characters of several bytes before it: columns count characters, spans bytes.
    let text = RIGHT.replace(
        "poissons_ratio = 0.4",
        "\"µ\" = 1\nartificial_stress = { \"é\" = 0, strength = -1 }\npoissons_ratio = 0.4",
    );
    let errors = errors(&text, &["solid.model=hypoelastic", "fluid.density=-3"]);
    let strength = errors.problems.iter().find(|p| p.key.ends_with("strength")).unwrap();
    assert_eq!(strength.value.as_deref(), Some("-1"));
    assert_eq!(strength.reason, "must be at least 0 and at most 100");
    assert_eq!(strength.place, Place::File { path: PathBuf::from("s.toml"), line: 12, column: 43 });
    let label = strength.labels().unwrap().next().unwrap();
    assert_eq!(&text[label.offset()..][..label.len()], "-1");
    let density = errors.problems.last().unwrap();
    assert_eq!(density.place, Place::Override("--set fluid.density=-3".into()));
    let label = density.labels().unwrap().next().unwrap();
    assert_eq!(&"--set fluid.density=-3"[label.offset()..][..label.len()], "-3");
}

#[test]
fn a_file_that_cannot_be_read_is_said_so() {
    let error = halfstep_scene::load(Path::new("no/such.toml"), &[]).unwrap_err();
    assert_eq!(error.problems[0].place, Place::Whole("no/such.toml".into()));
    assert!(error.problems[0].to_string().starts_with("no/such.toml: cannot be read: "));
}

/// What a schema can say: kinds, words, ranges that are always the same, keys that are unknown or must be there.
#[test]
fn a_schema_refuses_what_it_can_say() {
    let schema = jsonschema::draft202012::new(&halfstep_scene::schema()).unwrap();
    let is_right = |text: &str| match toml::from_str::<serde_json::Value>(text) {
        Ok(scene) => schema.is_valid(&scene),
        Err(_) => false,
    };
    for base in [RIGHT.to_owned(), two_solids(), rigid()] {
        assert!(is_right(&base), "{base}");
    }
    let says = ["unknown key", "must be one of", ", not a", "must be at least", "must be greater than"];
    // What depends on other keys.
    let depends = [
        "greater than `min`",
        "greater than `from`",
        "with phase-blind",
        "solid.smoothing_ratio = 0.75",
        "linear theory has no steeper waves",
        "smears a crack over a band",
        "one of `kinetic`",
        "one of `water`",
        "one of `gate`",
    ];
    let mut refused = 0;
    for Case { case, text, want, .. } in cases().filter(|case| case.set.is_empty()) {
        let any = |words: &[&str]| want.iter().any(|message| words.iter().any(|word| message.contains(word)));
        if any(&says) && !any(&depends) {
            assert!(!is_right(&text), "{case}");
            refused += 1;
        }
    }
    assert!(refused > 50, "{refused}");
}
