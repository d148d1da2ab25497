//! Hard cases stay numerically stable: the cases of `tests/stability`, see docs/stability.md.
//!
//! The short form runs every case at its coarsest resolution. The long form runs all resolutions and the long rests and
//! prints the table: `make stability` puts it into docs/stability.md.

use halfstep_tests::run::repository;
use halfstep_tests::stability::{
    Family, check, courant_table, families, replace_between_markers, room, table,
};

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

#[test]
#[ignore = "minutes: all cases in mixed precision"]
fn the_hard_cases_in_mixed_precision() {
    hold_with("numerics.precision=mixed", families().into_iter().map(|(_, family)| family));
}

#[test]
#[ignore = "many minutes: all resolutions and long rests; writes the table into docs/stability.md if HALFSTEP_PAGE is set"]
fn the_long_form() {
    let (mut page, mut wrong, mut total) = (String::new(), Vec::new(), 0.0);
    for (name, family) in families() {
        let (text, seconds, not_right) = run(&family, true);
        println!("{text}\n{name}: {seconds:.0} s\n");
        page += &format!("{text}\n");
        wrong.extend(not_right);
        total += seconds;
    }
    println!("{total:.0} s");
    renew("table", &page);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
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
#[ignore = "minutes: every case with larger and larger Courant numbers; a table of docs/stability.md if HALFSTEP_PAGE is set"]
fn room_of_the_courant_number() {
    let only = std::env::var("HALFSTEP_CASE").unwrap_or_default();
    let mut rooms = Vec::new();
    for (_, family) in families() {
        for case in family.case.iter().filter(|case| case.name.contains(&only)) {
            let own = room(&family.title, case);
            own.iter().for_each(|room| println!("{room:?}"));
            rooms.extend(own);
        }
    }
    let none: Vec<_> = rooms.iter().filter(|room| room.largest.is_none()).collect();
    assert!(none.is_empty(), "{none:?}");
    if only.is_empty() {
        renew("courant", &courant_table(rooms));
    }
}
