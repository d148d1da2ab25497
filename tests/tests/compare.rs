//! `halfstep compare`: the table has a built-in model and a program of one's own, and the picture is drawn.

use halfstep_tests::conformance::link::eventually;
use halfstep_tests::process::{is_alive, kill, with_variable};
use halfstep_tests::python::{FAILING_SOLID, HANGING_SOLID, python, python_of};
use halfstep_tests::run::{program, repository};
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn compare(arguments: &[&str]) -> Output {
    compare_in("elastic-gate", arguments)
}

fn compare_in(scene: &str, arguments: &[&str]) -> Output {
    let scene = repository().join(format!("scenes/{scene}.toml"));
    Command::new(program()).arg("compare").arg(scene).arg("--quiet").args(arguments).output().unwrap()
}

/// The gate's plate by particles and by scikit-fem's finite elements, to where the tip has gone 8 mm: their curves are
/// as near as two solvers of one equation.
#[test]
fn finite_elements_bend_as_particles_do() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let script = repository().join("python/examples/scikit-fem/gate.py");
    let elements = format!("elements={} {}", python().display(), script.display());
    let coarse = ["--set", "resolution=0.0025", "--set", "shape.plate.across=5", "--until", "0.027"];
    let solids = ["--solid", "total-lagrangian", "--solid", &elements, "--out", out, "--json"];
    let output = compare(&[&coarse[..], &solids].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["probe"], "tip.x [m]");
    let [own, elements] = told["solids"].as_array().unwrap().as_slice() else { panic!("{told}") };
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    println!("{} m and {} m, apart by {}", own["peak"], elements["peak"], elements["distance"][0]);
    assert!((0.006..0.010).contains(&number(&own["peak"])), "{told}");
    assert_eq!(number(&own["distance"][0]), 0.0);
    assert!(number(&elements["distance"][0]) < 0.01, "{told}");
    assert_eq!(elements["status"], "finished");
    for file in ["compare.json", "compare.png"] {
        assert!(folder.path().join(file).exists(), "{file}");
    }
}

#[test]
fn what_cannot_be_compared_is_refused() {
    for (arguments, reason) in [
        (&["--solid", "hypoelastic", "--solid", "hypoelastic"][..], "two solids are called `hypoelastic`"),
        (&["--solid", "hypoelastic", "--set", "solid.model=none"], "solid.model"),
        (&["--solid", "hypoelastic", "--solid", "finite-elements"], "`finite-elements` is no model"),
        (&["--solid", "hypoelastic", "--solid", "..=sleep 1"], "`..` names no solid"),
    ] {
        let output = compare(arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains(reason), "{said}");
    }
}

/// Of two solids one is exchanged, and the other stays what it is: the curve that is compared is the first plate's.
#[test]
fn one_of_several_solids_is_exchanged() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let counts = ["--set", "solid.soft.sub_steps=2", "--set", "solid.stiff.sub_steps=20"];
    let short = [&["--until", "0.002", "--out", out, "--json"], &counts[..]].concat();
    let models = ["--solid", "total-lagrangian", "--solid", "finite-element"];
    let unsaid = compare_in("two-plates", &[&short[..], &models].concat());
    assert_eq!(unsaid.status.code(), Some(1));
    let said = String::from_utf8_lossy(&unsaid.stderr).into_owned();
    assert!(said.contains("say which with --of NAME, one of soft, stiff"), "{said}");
    let output = compare_in("two-plates", &[&short[..], &models, &["--of", "soft"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["solids"][0]["sub_steps"], 2, "{told}");
    for (k, model) in ["total-lagrangian", "finite-element"].into_iter().enumerate() {
        let path = folder.path().join("runs").join(model).join("run.json");
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
        let solids = report["scene"]["solid"].as_array().unwrap();
        let of = |name: &str| &solids.iter().find(|solid| solid["name"] == name).unwrap()["model"];
        assert_eq!((of("soft"), of("stiff")), (&model.into(), &"hypoelastic".into()), "{report}");
        // The table tells of the one that is exchanged, not of the other's sub-steps and energy.
        let [_, soft, stiff] = report["participants"].as_array().unwrap().as_slice() else {
            panic!("{report}")
        };
        assert_eq!((&stiff["sub_steps"], &report["sub_steps"]), (&20.into(), &20.into()), "{report}");
        assert_eq!(told["solids"][k]["sub_steps"], soft["sub_steps"], "{told}");
        assert_eq!(told["solids"][k]["energy_growth"][1], soft["energy_growth"], "{told}");
        assert!(soft["energy_growth"].is_number() && stiff["energy_growth"].is_number(), "{report}");
    }
}

/// A rigid plate beside an elastic one: it does not move, and the table says what was left out of the scene for it.
#[test]
fn a_rigid_plate_stands_beside_an_elastic_one() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let coarse = ["--set", "resolution=0.0025", "--until", "0.02", "--out", out];
    let models = ["--solid", "total-lagrangian", "--solid", "rigid"];
    let output = compare(&[&coarse[..], &models, &["--json"]].concat());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let [elastic, rigid] = told["solids"].as_array().unwrap().as_slice() else { panic!("{told}") };
    assert!(elastic["peak"].as_f64().unwrap() > 1e-3 && rigid["peak"].as_f64() == Some(0.0), "{told}");
    assert_eq!(elastic["note"], "");
    let note = rigid["note"].as_str().unwrap();
    for part in ["`solid.youngs_modulus`", "`shape.plate.clamp`", "`plate` fixed where it was clamped"] {
        assert!(note.contains(part) && said.contains(part), "{part}: {note}\n{said}");
    }
    // 0.6 dx / c_P, c_P = sqrt((K + 4 G / 3) / rho), of the plate; what does not strain has no such limit.
    let stable = |solid: &serde_json::Value| solid["stable_step"].as_f64().unwrap();
    println!("stable to {} s and {} s", stable(elastic), stable(rigid));
    assert!(stable(rigid) > 10.0 * stable(elastic), "{told}");
    let shown = compare(&[&coarse[..], &models].concat());
    let table = String::from_utf8_lossy(&shown.stdout).into_owned();
    assert!(table.contains("stable step [s]") && table.contains("rigid: without `"), "{table}");
}

/// Without water a stand-in for the fluid runs the program: two element codes on the plate that swings.
#[test]
fn models_and_programs_are_compared_without_water() {
    let folder = tempfile::tempdir().unwrap();
    let dry =
        ["--until", "0.01", "--set", "resolution=0.004", "--out", folder.path().to_str().unwrap(), "--json"];
    let script = repository().join("python/examples/scikit-fem/gate.py");
    let elements = format!("elements={} {}", python().display(), script.display());
    let solids = ["--solid", "total-lagrangian", "--solid", "finite-element", "--solid", &elements];
    let output = compare_in("oscillating-plate", &[&dry[..], &solids].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let [own, squares, nine] = told["solids"].as_array().unwrap().as_slice() else { panic!("{told}") };
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    for other in [squares, nine] {
        println!(
            "{}: {} of {} m, apart by {}",
            other["name"], other["peak"], own["peak"], other["distance"][0]
        );
        assert!(number(&other["distance"][0]) < 0.03, "{told}");
        assert_eq!(other["status"], "finished");
    }
    // It begins with the velocities of the scene's particles, as far as its own shape functions have them.
    assert!((number(&nine["peak"]) / number(&own["peak"]) - 1.0).abs() < 0.03, "{told}");
    assert!(number(&nine["steps"]) > 100.0 && number(&nine["wall_seconds"]) > 0.0, "{told}");
}

/// A solid that fails midway has a curve as near as any other one while it lasts: the table says how long, and a script
/// sees that the comparison is not whole. The run of somebody else in its place is kept.
#[test]
fn a_solid_that_fails_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("failing.py");
    std::fs::write(&script, FAILING_SOLID).unwrap();
    let failing = format!("failing={} {}", python().display(), script.display());
    let out = folder.path().join("out");
    let arguments = ["--set", "resolution=0.004", "--until", "0.01", "--out", out.to_str().unwrap()];
    let arguments = [&arguments[..], &["--solid", "total-lagrangian", "--solid", &failing]].concat();
    let output = compare_in("oscillating-plate", &arguments);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}\n{errors}");
    assert!(said.contains(" % until ") && said.contains("failing: the solid failed at step 3"), "{said}");
    assert!(errors.contains("failing did not run to the end"), "{errors}");
    // Where a comparison's run was is now one of somebody's own, by hand; where it left nothing, too.
    let own = out.join("runs/total-lagrangian");
    for by_hand in [true, false] {
        if by_hand {
            let scene = repository().join("scenes/oscillating-plate.toml");
            let made = ["--set", "resolution=0.004", "--until", "0.001", "--quiet", "--force", "--out"];
            let made = Command::new(program()).arg("run").arg(scene).args(made).arg(&own).output().unwrap();
            assert!(made.status.success(), "{made:?}");
            assert!(own.join("messages.txt").is_file());
        } else {
            std::fs::remove_file(own.join("messages.txt")).unwrap();
        }
        refused(&arguments, &own);
    }
}

/// A comparison keeps the run in this folder.
fn refused(arguments: &[&str], own: &Path) {
    let before = std::fs::read(own.join("run.json")).unwrap();
    let output = compare_in("oscillating-plate", arguments);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.contains("a run that was not made here"), "{errors}");
    assert_eq!(std::fs::read(own.join("run.json")).unwrap(), before);
}

/// A comparison ends with a solid that hangs: at Ctrl-C, and when it is killed itself.
#[test]
fn no_solid_outlives_its_comparison() {
    for signal in [libc::SIGINT, libc::SIGKILL] {
        let folder = tempfile::tempdir().unwrap();
        let (script, out) = (folder.path().join("hanging.py"), folder.path().join("out"));
        std::fs::write(&script, HANGING_SOLID).unwrap();
        let hanging = format!("hanging={} {}", python().display(), script.display());
        let mut comparison = Command::new(program())
            .arg("compare")
            .arg(repository().join("scenes/oscillating-plate.toml"))
            .args(["--set", "resolution=0.004", "--until", "0.01", "--quiet", "--solid", &hanging, "--out"])
            .arg(&out)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let own = out.join("runs/hanging");
        eventually(60.0, "the solid to hang", || own.join("hangs").exists());
        let told = own.canonicalize().unwrap();
        let solids = with_variable("HALFSTEP_OUT", told.to_str().unwrap());
        assert_eq!(solids.len(), 1);
        kill(comparison.id(), signal);
        let status = comparison.wait().unwrap();
        assert_eq!(status.code(), (signal == libc::SIGINT).then_some(130));
        eventually(10.0, "the solid to end", || !is_alive(solids[0]));
        let ended =
            || std::fs::read_to_string(own.join("run.json")).is_ok_and(|text| text.contains("stopped"));
        eventually(10.0, "the trial to end", ended);
    }
}

/// The stand-in knows one solid.
#[test]
fn a_program_does_not_join_others_without_water() {
    let folder = tempfile::tempdir().unwrap();
    let one = |name: &str, x: f64| {
        format!(
            "[[solid]]\nname = \"{name}\"\nmodel = \"rigid\"\ndensity = 1000.0\n[[shape]]\nname = \"{name}\"\n\
             phase = \"solid\"\nsolid = \"{name}\"\nbox = {{ min = [{x}, 0.0], max = [{}, 0.1] }}\n[[probe]]\n\
             name = \"of-{name}\"\nkind = \"body-position\"\nbody = \"{name}\"\nsolid = \"{name}\"\n",
            x + 0.1
        )
    };
    let text = format!("resolution = 0.01\nend_time = 0.1\n{}{}", one("a", 0.0), one("b", 0.3));
    let path = folder.path().join("two.toml");
    std::fs::write(&path, text).unwrap();
    let arguments = ["--of", "a", "--solid", "rigid", "--solid", "mine=true 1", "--quiet"];
    let output = Command::new(program()).arg("compare").arg(&path).args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("two has several solids and no [fluid]: mine cannot join it"), "{said}");
}

/// The gate by NGSolve, to beyond its peak, and the oscillating plate without water, each beside the built-in plate of
/// particles 5 across: 0.5 % and 1.83 % apart, which is 0.6 % of the period. NGSolve comes with its own environment.
#[test]
#[ignore = "long"]
fn ngsolve_bends_as_particles_do() {
    let script = repository().join("python/examples/ngsolve/gate.py");
    let elements =
        format!("ngsolve=OMP_NUM_THREADS=1 {} {}", python_of("ngsolve").display(), script.display());
    let beside_particles = |scene: &str, arguments: &[&str]| {
        let folder = tempfile::tempdir().unwrap();
        let solids = ["--solid", "total-lagrangian", "--solid", &elements, "--json", "--out"];
        let output = compare_in(scene, &[arguments, &solids, &[folder.path().to_str().unwrap()]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        let [own, elements] = told["solids"].as_array().unwrap().as_slice() else { panic!("{told}") };
        println!("{} m and {} m, apart by {}", own["peak"], elements["peak"], elements["distance"][0]);
        [number(&elements["peak"]) / number(&own["peak"]), number(&elements["distance"][0])]
    };
    let coarse = ["--set", "resolution=0.0025", "--set", "shape.plate.across=5", "--until", "0.15"];
    let [peak, distance] = beside_particles("elastic-gate", &coarse);
    assert!((peak - 1.0).abs() < 0.01 && distance < 0.01, "{peak} {distance}");
    let dry = ["--set", "resolution=0.004", "--until", "0.27"];
    let [peak, distance] = beside_particles("oscillating-plate", &dry);
    assert!((peak - 0.995).abs() < 0.003 && (0.015..0.022).contains(&distance), "{peak} {distance}");
}
