//! Hard cases stay numerically stable: the cases of `tests/stability`, see docs/stability.md.
//!
//! The short form runs cases at their coarsest resolution. The long form runs all resolutions and the long rests and
//! prints the table: `make stability` puts it into docs/stability.md.

use halfstep_tests::run::{Outcome, repository, scene_at};
use halfstep_tests::stability::{
    Case, Family, check, courant_table, families, replace_between_markers, room, table,
};
use halfstep_wire::frame::FLUID;
use std::f64::consts::FRAC_1_SQRT_2;

fn family(name: &str) -> Family {
    let found = families().into_iter().find(|(stem, _)| stem == name);
    found.unwrap_or_else(|| panic!("no file {name}.toml")).1
}

/// Runs a family; the text of its table, its time, and what is wrong.
fn run(family: &Family, long: bool) -> (String, f64, Vec<String>) {
    let only = std::env::var("HALFSTEP_CASE").unwrap_or_default();
    let (mut rows, mut wrong) = (Vec::new(), Vec::new());
    for case in family.case.iter().filter(|c| c.name.contains(&only)) {
        let (own, not_right) = check(case, long);
        rows.extend(own);
        wrong.extend(not_right);
    }
    let seconds = rows.iter().map(|r| r.seconds).sum();
    (table(&family.title, &rows), seconds, wrong)
}

fn short(name: &str) {
    let (text, seconds, wrong) = run(&family(name), false);
    println!("{text}\n{seconds:.1} s\n");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

macro_rules! families {
    ($($function:ident $name:literal,)*) => {
        $(
            #[test]
            fn $function() {
                short($name);
            }
        )*

        #[test]
        fn every_file_of_cases_has_a_test() {
            let names: Vec<String> = families().into_iter().map(|(name, _)| name).collect();
            assert_eq!(names, [$($name),*]);
        }
    };
}

families! {
    contact "contact",
    corners "corners",
    droplets "droplets",
    fracture "fracture",
    impact "impact",
    rest "rest",
    rigid "rigid",
    solids "solids",
    tension "tension",
    thin_plates "thin-plates",
    time_steps "time-steps",
}

/// All cases of some families hold at their coarsest resolution with one more setting.
fn hold_with(setting: &str, families: impl IntoIterator<Item = Family>) {
    let mut wrong = Vec::new();
    for mut family in families {
        for case in &mut family.case {
            case.set.push(setting.into());
            case.without.clear();
        }
        let (text, _, not_right) = run(&family, false);
        println!("{text}");
        wrong.extend(not_right);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// With the wide kernel, whose guards are strong and near.
#[test]
fn drops_impacts_and_corners_hold_with_the_preset_for_waves() {
    hold_with("preset=waves", ["droplets", "impact"].map(family));
}

/// Cases with fluid: by either rule of time integration, whichever is the default of a case.
fn with_fluid(mut family: Family) -> Family {
    family.case.retain(|case| case.has_fluid());
    family
}

#[test]
fn drops_and_impacts_hold_by_either_rule() {
    for rule in ["midpoint", "verlet"] {
        let families = ["droplets", "impact"].map(|name| with_fluid(family(name)));
        hold_with(&format!("fluid.time_integration={rule}"), families);
    }
}

#[test]
#[ignore = "minutes: all cases with fluid by either rule of time integration"]
fn the_hard_cases_by_either_rule() {
    for rule in ["midpoint", "verlet"] {
        let families = families().into_iter().map(|(_, family)| with_fluid(family));
        hold_with(&format!("fluid.time_integration={rule}"), families);
    }
}

#[test]
#[ignore = "minutes: all cases in mixed precision"]
fn the_hard_cases_in_mixed_precision() {
    hold_with("numerics.precision=mixed", families().into_iter().map(|(_, family)| family));
}

#[test]
#[ignore = "many minutes: all resolutions and long rests; writes the table into docs/stability.md if HALFSTEP_PAGE is set"]
fn the_long_form() {
    let only = std::env::var("HALFSTEP_FAMILY").unwrap_or_default();
    let (mut page, mut wrong, mut total) = (String::new(), Vec::new(), 0.0);
    for (name, family) in families() {
        let (text, seconds, not_right) = if only.is_empty() || only == name {
            run(&family, true)
        } else {
            (part_of_page(&family.title), 0.0, Vec::new())
        };
        println!("{text}\n{name}: {seconds:.0} s\n");
        page += &format!("{text}\n");
        wrong.extend(not_right);
        total += seconds;
    }
    println!("{total:.0} s");
    renew("table", &page);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What docs/stability.md has of a family.
fn part_of_page(title: &str) -> String {
    let page = std::fs::read_to_string(repository().join("docs/stability.md")).expect("the page");
    let heading = format!("### {title}\n");
    let part = page.split_once(&heading).expect("the family's heading").1;
    let end = part.find("\n### ").or_else(|| part.find("\n<!-- ")).expect("an end");
    format!("{heading}{}\n", part[..end].trim_end())
}

/// Puts a table into docs/stability.md if HALFSTEP_PAGE is set.
fn renew(name: &str, text: &str) {
    if std::env::var_os("HALFSTEP_PAGE").is_some() {
        let path = repository().join("docs/stability.md");
        let old = std::fs::read_to_string(&path).expect("the page");
        std::fs::write(&path, replace_between_markers(&old, name, text).expect("markers")).expect("the page");
    }
}

#[test]
#[ignore = "minutes: all cases by the midpoint rule with larger and larger Courant numbers; a table of docs/stability.md if HALFSTEP_PAGE is set"]
fn room_of_the_courant_number() {
    let only = std::env::var("HALFSTEP_CASE").unwrap_or_default();
    let more = std::env::var("HALFSTEP_SET").ok();
    let mut rooms = Vec::new();
    let of_fluid = more.as_ref().is_some_and(|set| set.starts_with("fluid."));
    for (_, mut family) in families() {
        let wanted = |case: &&mut Case| case.name.contains(&only) && (case.has_fluid() || !of_fluid);
        for case in family.case.iter_mut().filter(wanted) {
            case.set.extend(more.clone());
            if more.is_none() && case.has_fluid() {
                case.set.push("fluid.time_integration=midpoint".into());
            }
            let own = room(&family.title, case);
            own.iter().for_each(|room| println!("{room:?}"));
            rooms.extend(own);
        }
    }
    let none: Vec<_> = rooms.iter().filter(|room| room.largest.is_none()).collect();
    assert!(none.is_empty(), "{none:?}");
    if only.is_empty() && more.is_none() {
        renew("courant", &courant_table(rooms));
    }
}

/// Largest energy that the water gains, over what it may have, with plates of many stiffnesses between two waters.
fn growth_beside_plates(rule: &str, cfl: f64) -> f64 {
    let file = repository().join("tests/stability/scenes/two-waters.toml");
    let growths = (0..24).map(|k| {
        let run = scene_at(&file).set("solid.youngs_modulus", 5e7 * 200_f64.powf(f64::from(k) / 23.0));
        let run = run.set("fluid.time_integration", rule).set("numerics.cfl", cfl).until(0.12);
        let growth = run.threads(1).in_process().run().report.audit.energy_growth;
        growth.fluid.expect("a growth")
    });
    growths.fold(0.0, f64::max)
}

/// Of what grows beside thin plates the stiffness decides, in narrow bands: one case says little.
#[test]
#[ignore = "a minute: 72 runs"]
fn plates_of_many_stiffnesses_between_two_waters() {
    let [midpoint, verlet, longer] = [("midpoint", 0.4), ("verlet", 0.4), ("verlet", 0.6)]
        .map(|(rule, cfl)| growth_beside_plates(rule, cfl));
    println!("midpoint {midpoint:.1e}, position Verlet {verlet:.1e}, with longer steps {longer:.1e}");
    assert!(midpoint < 1e-5 && verlet < 1e-4, "{midpoint:e} {verlet:e}");
    // Why position Verlet's longer steps are not the default beside such a solid.
    assert!(longer > 1e-3, "{longer:e}");
}

/// What is thrown at walls in each run of an ensemble.
struct Ensemble {
    name: &'static str,
    scene: &'static str,
    set: &'static [&'static str],
    /// Overrides for a velocity, m/s.
    thrown: fn(f64) -> Vec<String>,
    velocities: [f64; 2],
    runs: usize,
    resolution: f64,
    /// How deep a place is in a wall, m.
    depth: fn([f64; 2]) -> f64,
}

const HIGH: &str = "shape.tank.tank.max=[0.4,12.0]";
const ENSEMBLES: [Ensemble; 7] = [
    film("film, 1 particle", &["output.frame_interval=0.004"]),
    film("film, 2 particles", &["output.frame_interval=0.004", "shape.film.box.max=[0.3,0.01]"]),
    film("film, 3 particles", &["output.frame_interval=0.004", "shape.film.box.max=[0.3,0.015]"]),
    Ensemble {
        name: "lone particles, a pair, a row, a jet",
        scene: "spray",
        set: &["output.frame_interval=0.004", HIGH, "numerics.domain={min=[-1,-1],max=[2,20]}"],
        thrown: |v| vec![format!("shape.jet.velocity=[{v},{}]", -v)],
        velocities: [3.4, 4.6],
        runs: 41,
        resolution: 0.01,
        depth: |at| beyond_cavity(at, 0.4),
    },
    Ensemble {
        name: "into a corner",
        scene: "slam",
        set: &["output.frame_interval=2e-4", "shape.tank.tank.max=[0.15,1.5]"],
        thrown: |v| vec![format!("shape.water.velocity=[{v},{}]", -v)],
        velocities: [8.0, 12.0],
        runs: 41,
        resolution: 0.005,
        depth: |at| beyond_cavity(at, 0.15),
    },
    over("a drop over a block", "over-a-block", |[x, y]| (0.05 - x.abs()).min(0.1 - y).min(y)),
    over("a drop over a ridge", "over-a-ridge", |[x, y]| ((0.1 - y - x.abs()) * FRAC_1_SQRT_2).min(y)),
];

const fn film(name: &'static str, set: &'static [&'static str]) -> Ensemble {
    Ensemble {
        name,
        scene: "film",
        set,
        thrown: |v| vec![format!("shape.film.velocity=[{v},0.0]")],
        velocities: [0.7, 1.3],
        runs: 61,
        resolution: 0.005,
        depth: |at| beyond_cavity(at, 0.4),
    }
}

/// A drop falls on what stands on a floor, and runs down beside it; how deep it gets in that, not in the floor.
const fn over(name: &'static str, scene: &'static str, depth: fn([f64; 2]) -> f64) -> Ensemble {
    Ensemble {
        name,
        scene,
        set: &[],
        thrown: |v| vec![format!("parameters.speed={v}")],
        velocities: [0.5, 4.0],
        runs: 61,
        resolution: 0.01,
        depth,
    }
}

/// How far a place is beyond the floor and the walls at either side, which are so far apart, m.
fn beyond_cavity([x, y]: [f64; 2], width: f64) -> f64 {
    (-x).max(x - width).max(-y)
}

/// How deep, dx, the fluid of a run got into walls.
fn beyond_walls(run: &Outcome, ensemble: &Ensemble) -> f64 {
    let frames = run.frames("fluid");
    let own = frames.iter().flat_map(|frame| {
        let fluid = frame.points.iter().zip(&frame.phase).filter(|(_, phase)| **phase == FLUID);
        fluid.map(|(x, _)| (ensemble.depth)([f64::from(x[0]), f64::from(x[1])]))
    });
    own.fold(f64::NEG_INFINITY, f64::max) / ensemble.resolution
}

/// How far, dx, the fluid got into walls in so many runs of an ensemble with more settings, the least first; and how
/// many particles were lost in all of them.
fn beyond_in_runs(ensemble: &Ensemble, runs: usize, more: &[(&str, &str)]) -> (Vec<f64>, u64) {
    let file = repository().join("tests/stability/scenes").join(ensemble.scene);
    let [from, to] = ensemble.velocities;
    let (mut depths, mut lost) = (Vec::new(), 0);
    for k in 0..runs {
        let v = from + (to - from) * k as f64 / (runs - 1) as f64;
        let mut run = scene_at(&file.with_extension("toml")).set("resolution", ensemble.resolution);
        for set in ensemble.set.iter().map(|set| (*set).to_owned()).chain((ensemble.thrown)(v)) {
            run = run.argument("--set").argument(set);
        }
        let run = more.iter().fold(run, |run, (key, value)| run.set(key, value));
        let run = run.threads(1).in_process().outcome();
        depths.push(beyond_walls(&run, ensemble));
        lost += run.report().particles.removed;
    }
    depths.sort_by(f64::total_cmp);
    (depths, lost)
}

/// Part of the runs in which a particle is deeper in a wall than 0.3 dx.
fn deep(depths: &[f64]) -> f64 {
    depths.iter().filter(|depth| **depth > 0.3).count() as f64 / depths.len() as f64
}

/// The second row of a wall lies 1.5 dx deep: beyond it a particle is through.
const THROUGH: f64 = 1.5;

/// One run of a film or of spray says little: it ends in single particles, whose ways the last bit decides.
#[test]
fn films_keep_out_of_walls_at_nearly_all_velocities() {
    for ensemble in ENSEMBLES.iter().filter(|ensemble| ensemble.scene == "film") {
        for rule in ["midpoint", "verlet"] {
            let (guarded, lost) = beyond_in_runs(ensemble, 11, &[("fluid.time_integration", rule)]);
            println!("{}, {rule}: {guarded:.2?}", ensemble.name);
            assert!(
                guarded[10] < THROUGH && lost == 0,
                "{}, {rule}: {guarded:?}, {lost} lost",
                ensemble.name
            );
            assert!(deep(&guarded) < 0.3 && guarded[5] < 0.1, "{}, {rule}: {guarded:?}", ensemble.name);
        }
        let (free, _) = beyond_in_runs(ensemble, 11, &[("effects.wall-guard", "off")]);
        println!("{}, without guard: {free:.2?}", ensemble.name);
        // Without the remedy half of the runs fail, and the median with them.
        assert!(deep(&free) > 0.5 && free[5] > 0.3, "{}: {free:?}", ensemble.name);
    }
}

/// Over an edge water is a stretched sheet: its tension must not draw it into the wall behind the edge.
#[test]
fn drops_run_over_edges_at_all_velocities() {
    for ensemble in ENSEMBLES.iter().filter(|ensemble| ensemble.scene.starts_with("over")) {
        for rule in ["midpoint", "verlet"] {
            let (depths, lost) = beyond_in_runs(ensemble, 16, &[("fluid.time_integration", rule)]);
            println!("{}, {rule}: {depths:.2?}", ensemble.name);
            assert!(
                depths[15] < 0.6 && deep(&depths) < 0.2 && lost == 0,
                "{}, {rule}: {depths:?}",
                ensemble.name
            );
        }
        let (held, _) = beyond_in_runs(ensemble, 16, &[("effects.wall-separation", "off")]);
        println!("{}, not let go: {held:.2?}", ensemble.name);
        assert!(deep(&held) > 0.25 && held[15] > 0.9, "{}: {held:?}", ensemble.name);
    }
}

#[test]
#[ignore = "minutes: 387 runs with each variant; a table of docs/stability.md if HALFSTEP_PAGE is set"]
fn films_and_spray_at_many_velocities() {
    let mut page =
        "| case | | runs | in a wall by more than 0.3 dx | farthest, dx | median, dx | particles lost |\n\
                    |---|---|---|---|---|---|---|\n"
            .to_owned();
    let mut wrong = Vec::new();
    let variants = [
        ("hydrostatic", ("fluid.density_diffusion", "hydrostatic")),
        ("delta-sph", ("fluid.density_diffusion", "delta-sph")),
        ("simple", ("fluid.density_diffusion", "simple")),
        ("midpoint rule", ("fluid.time_integration", "midpoint")),
        ("no guard", ("effects.wall-guard", "off")),
        ("not let go", ("effects.wall-separation", "off")),
    ];
    for ensemble in &ENSEMBLES {
        for (name, setting) in variants {
            let (depths, lost) = beyond_in_runs(ensemble, ensemble.runs, &[setting]);
            let runs = depths.len();
            let (farthest, median) = (depths[runs - 1], depths[runs / 2]);
            let part = deep(&depths);
            let row = format!(
                "| {} | {name} | {runs} | {:.0} | {farthest:.2} | {median:.2} | {lost} |\n",
                ensemble.name,
                part * runs as f64
            );
            print!("{row}");
            page += &row;
            if !["no guard", "not let go"].contains(&name)
                && (farthest > THROUGH || part > 0.2 || median > 0.1 || lost > 0)
            {
                wrong.push(row);
            }
        }
    }
    renew("ensembles", &page);
    assert!(wrong.is_empty(), "{}", wrong.concat());
}
