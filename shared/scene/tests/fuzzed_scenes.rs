//! Whatever a scene's file and its overrides hold, the answer is a valid scene or a list of errors, never a panic.

use halfstep_scene::geometry::{domain, estimate, layout};
use halfstep_scene::{Scene, parse};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

const VALUES: [&str; 26] = [
    "0",
    "1",
    "2",
    "3",
    "-1",
    "0.5",
    "nan",
    "-inf",
    "1e308",
    "1e-308",
    "1e400",
    "99999999999999999999",
    "true",
    "\"\"",
    "\"auto\"",
    "\"tip\"",
    "[]",
    "{}",
    "[0, 0]",
    "[1e300, -1e300]",
    "[[1, 2], [3]]",
    "1979-05-27",
    "{ min = [0, 0], max = [1, 1] }",
    "[{ min = [0, 0], max = [1e-9, 1] }]",
    "\"\\u0000é\"",
    "",
];

const KEYS: [&str; 36] = [
    "shape.water.polygon",
    "shape.water.outline.file",
    "shape.water.rotate.angle",
    "shape.plate.translate",
    "shape.plate.repeat.count",
    "shape.plate.repeat.step",
    "shape.plate.body",
    "preset",
    "dimension",
    "resolution",
    "smoothing_ratio",
    "end_time",
    "time_step",
    "gravity",
    "gravity.1",
    "fluid",
    "fluid.density",
    "fluid.sound_speed",
    "solid.poissons_ratio",
    "solid.sub_steps",
    "solid.name",
    "solid.process",
    "solid",
    "shape",
    "shape.plate.box",
    "shape.plate.clamp",
    "shape.plate.solid",
    "shape.water.velocity",
    "shape.0",
    "probe.0.at",
    "reference.0.scale",
    "metric.0.reference",
    "metric.0.probe",
    "shape.water.velocity_field.half_wave",
    "output.frame_interval",
    "..",
];

/// A change to a scene's lines.
#[derive(Clone, Debug)]
enum Change {
    Drop(usize),
    Repeat(usize, usize),
    Value(usize, &'static str),
    Character(usize, usize, char),
    Cut(usize),
}

fn change() -> impl Strategy<Value = Change> {
    let line = || 0_usize..100;
    prop_oneof![
        line().prop_map(Change::Drop),
        (line(), line()).prop_map(|(from, to)| Change::Repeat(from, to)),
        (line(), prop::sample::select(&VALUES[..])).prop_map(|(line, value)| Change::Value(line, value)),
        (
            line(),
            0_usize..60,
            prop::sample::select(&['[', ']', '"', '=', '.', '-', '9', 'e', '#', '\u{e9}'][..])
        )
            .prop_map(|(line, column, c)| Change::Character(line, column, c)),
        (20_usize..100).prop_map(Change::Cut),
    ]
}

fn apply(lines: &mut Vec<String>, change: &Change) {
    let count = lines.len().max(1);
    match *change {
        Change::Drop(line) if line < lines.len() => drop(lines.remove(line)),
        Change::Repeat(from, to) if from < lines.len() => lines.insert(to % count, lines[from].clone()),
        Change::Value(line, value) if line < lines.len() => {
            let key = lines[line].split('=').next().unwrap_or_default().trim_end().to_owned();
            lines[line] = format!("{key} = {value}");
        }
        Change::Character(line, column, c) if line < lines.len() => {
            let mut characters: Vec<char> = lines[line].chars().collect();
            let at = column % (characters.len() + 1);
            if at < characters.len() {
                characters[at] = c
            } else {
                characters.push(c)
            }
            lines[line] = characters.into_iter().collect();
        }
        Change::Cut(line) => lines.truncate(line),
        _ => (),
    }
}

fn shipped() -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut files: Vec<PathBuf> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let read = |path: PathBuf| (path.clone(), std::fs::read_to_string(path).unwrap());
    files.into_iter().map(read).collect()
}

/// Everything that is done with a valid scene can be done with it.
fn use_it(scene: &Scene) {
    assert_eq!(&Scene::from_json(&scene.to_json().unwrap()).unwrap(), scene);
    let domain = domain(scene);
    assert!((0..2).all(|a| domain.min[a] < domain.max[a]), "{domain:?}");
    if estimate(scene).total() < 100_000 {
        let layout = layout::<2>(scene);
        let finite = |p: &[f64; 2]| p.iter().all(|x| x.is_finite());
        assert!(
            layout.fluid.iter().all(|p| finite(&p.position) && finite(&p.velocity) && p.pressure.is_finite())
        );
        assert!(layout.solid.iter().all(|p| finite(&p.position) && finite(&p.velocity)));
        assert!(
            layout
                .wall
                .iter()
                .all(|p| finite(&p.position) && (p.normal[0].hypot(p.normal[1]) - 1.0).abs() < 1e-9)
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_scenes_load_or_say_why_not(
        file in 0_usize..10,
        changes in prop::collection::vec(change(), 0..4),
        overrides in prop::collection::vec((prop::sample::select(&KEYS[..]), prop::sample::select(&VALUES[..])), 0..3),
    ) {
        let (path, text) = shipped().swap_remove(file);
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        changes.iter().for_each(|change| apply(&mut lines, change));
        let overrides: Vec<String> = overrides.iter().map(|(key, value)| format!("{key}={value}")).collect();
        match parse(&lines.join("\n"), &path, &overrides) {
            Ok(scene) => use_it(&scene),
            Err(errors) => {
                prop_assert!(!errors.problems.is_empty());
                // Rendering reads the spans.
                let rendered = format!("{:?}", miette::Report::new(errors));
                prop_assert!(!rendered.is_empty());
            }
        }
    }

    #[test]
    fn numbers_pass_through_json_bit_for_bit(density in prop::num::f64::POSITIVE, at in -1e3..1e3_f64) {
        let (path, text) = shipped().swap_remove(0);
        let mut scene = parse(&text, &path, &[]).unwrap();
        scene.resolution = density;
        scene.gravity[0] = at;
        let back = Scene::from_json(&scene.to_json().unwrap()).unwrap();
        prop_assert_eq!(back.resolution.to_bits(), density.to_bits());
        prop_assert_eq!(back.gravity[0].to_bits(), at.to_bits());
    }

    #[test]
    fn any_text_is_answered(text in "\\PC{0,80}", set in "\\PC{0,30}") {
        let answer = parse(&text, Path::new("any.toml"), &[set]);
        prop_assert!(answer.is_err_and(|errors| !errors.to_string().is_empty()));
    }
}
