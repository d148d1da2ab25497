//! Water on both faces of plates so thin that the kernel reaches through them.
//!
//! Water beside a plate that is held cannot know how thick the plate is: each of its particles must do what it does
//! beside a plate of six rows, through which no solid particle sees both faces. What remains is round-off.

use halfstep_output::Frame;
use halfstep_tests::run::program;
use halfstep_tests::{Finished, RunBuilder, run::scene_at};
use halfstep_wire::frame::FLUID;
use std::path::{Path, PathBuf};

const GRAVITY: f64 = 9.81;
/// Left face of the plate, m; the water is as wide on either side.
const FACE: f64 = 0.1;
/// Depths left and right, m.
const LEVELS: [f64; 2] = [0.2, 0.1];
const DX: f64 = 0.01;

/// A tank that a plate of some rows parts from floor to above the water; `held` up to there.
fn tank(folder: &Path, dx: f64, rows: usize, held: f64, solid: &str) -> PathBuf {
    let [deep, shallow] = LEVELS;
    let back = FACE + rows as f64 * dx;
    let (end, foot) = (back + FACE, -4.0 * dx);
    let text = format!(
        "resolution = {dx}\nend_time = 0.3\n[fluid]\ndensity = 1000.0\n[solid]\ndensity = 1200.0\n\
         poissons_ratio = 0.3\n{solid}\n[output]\nframe_interval = 0.1\n[[shape]]\nname = \"deep\"\nphase = \"fluid\"\n\
         box = {{ min = [0.0, 0.0], max = [{FACE}, {deep}] }}\npressure = \"hydrostatic\"\n[[shape]]\n\
         name = \"shallow\"\nphase = \"fluid\"\nbox = {{ min = [{back}, 0.0], max = [{end}, {shallow}] }}\n\
         pressure = \"hydrostatic\"\n[[shape]]\nname = \"plate\"\nphase = \"solid\"\n\
         box = {{ min = [{FACE}, {foot}], max = [{back}, 0.25] }}\n\
         clamp = {{ min = [{FACE}, {foot}], max = [{back}, {held}] }}\n[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
         tank = {{ min = [0.0, 0.0], max = [{end}, 0.3], open = [\"top\"] }}\n[[probe]]\nname = \"top\"\n\
         kind = \"displacement\"\nat = [{}, 0.25]\n[[probe]]\nname = \"push\"\nkind = \"force\"\n\
         shape = \"plate\"\n",
        0.5 * (FACE + back)
    );
    let path = folder.join("tank.toml");
    std::fs::write(&path, text).unwrap();
    path
}

fn held(folder: &Path, rows: usize, model: &str) -> RunBuilder {
    let solid = format!("model = \"{model}\"\nyoungs_modulus = 1e7");
    scene_at(&tank(folder, DX, rows, 0.3, &solid)).in_process()
}

/// The last frame's fluid by number: place beside its own face, and pressure.
fn beside_faces(run: &Finished, rows: usize) -> Vec<(i32, [f64; 2], f64)> {
    let frame: Frame = run.outcome.frames("fluid").pop().expect("a last frame");
    let middle = FACE + 0.5 * rows as f64 * DX;
    let mut fluid: Vec<_> = (0..frame.len())
        .filter(|&k| frame.phase[k] == FLUID)
        .map(|k| {
            let [x, y, _] = frame.points[k].map(f64::from);
            let x = if x > middle { x - rows as f64 * DX } else { x };
            (frame.id[k], [x, y], f64::from(frame.pressure[k]))
        })
        .collect();
    fluid.sort_by_key(|f| f.0);
    fluid
}

/// Largest shift of a particle, in spacings, and largest change of a pressure over that between the two levels.
fn difference(what: &str, run: &Finished, rows: usize, thick: &Finished) -> (f64, f64) {
    assert!(run.report.audit.action_reaction.unwrap() <= 1e-12);
    let (ours, theirs) = (beside_faces(run, rows), beside_faces(thick, 6));
    assert_eq!(ours.len(), theirs.len(), "nothing is lost");
    let between = 1000.0 * GRAVITY * (LEVELS[0] - LEVELS[1]);
    let (mut shift, mut pressure) = (0.0_f64, 0.0_f64);
    for ((id, x, p), (other, y, q)) in ours.into_iter().zip(theirs) {
        assert_eq!(id, other);
        shift = shift.max((x[0] - y[0]).hypot(x[1] - y[1]) / DX);
        pressure = pressure.max((p - q).abs() / between);
    }
    let gap = run.report.audit.min_gap.unwrap();
    println!("{what}: shift {shift:.1e} dx, pressure {pressure:.1e}, closest {gap:.2} dx");
    (shift, pressure)
}

#[test]
fn water_does_not_feel_how_thick_a_held_plate_is() {
    let folder = tempfile::tempdir().unwrap();
    let thick = held(folder.path(), 6, "total-lagrangian").run();
    let row = |run: &Finished| {
        run.report.effects.iter().find(|e| e.name == "thin-plate-screen").expect("a row").clone()
    };
    assert!(!row(&thick).on, "{}", row(&thick).why);
    for (rows, model) in [(2, "total-lagrangian"), (3, "total-lagrangian"), (2, "hypoelastic")] {
        let what = format!("{rows} across, {model}");
        let screened = held(folder.path(), rows, model).run();
        let effect = row(&screened);
        assert!(effect.on && effect.why.contains("plate"), "{}", effect.why);
        // Round-off, and frames are in single precision. Over 0.3 s nothing makes it grow to more than this.
        let (shift, pressure) = difference(&what, &screened, rows, &thick);
        assert!(shift < 1e-3 && pressure < 1e-3, "{what}: {shift} {pressure}");
        // Without, the band is missed a hundred times over: the test can tell.
        let mixed = held(folder.path(), rows, model).set("effects.thin-plate-screen", "off").run();
        let (shift, pressure) = difference(&format!("{what}, off"), &mixed, rows, &thick);
        assert!(shift > 0.1 && pressure > 5e-3, "{what}: {shift} {pressure}");
    }
}

/// Two of the water's spacings thick and four of its own across: the screen weights each row by its volume. Bands:
/// 0.2 % about the thrust that is measured, 1.003, and 0.02 dx about the closest approach, 1.006 dx, 0.890 dx without.
#[test]
fn a_plate_finer_than_the_water_is_screened_too() {
    let folder = tempfile::tempdir().unwrap();
    let theory = 0.5 * 1000.0 * GRAVITY * (LEVELS[0].powi(2) - LEVELS[1].powi(2));
    for (screen, closest) in [("auto", 1.006), ("off", 0.890)] {
        let run = held(folder.path(), 2, "total-lagrangian").set("shape.plate.across", 4);
        let run = run.set("effects.thin-plate-screen", screen).run();
        let thrust = run.curve("push.x").between(0.1, 0.3).mean() / theory;
        let gap = run.report.audit.min_gap.unwrap();
        println!("4 across in water at 2 across, screen {screen}: thrust {thrust:.4}, closest {gap:.3} dx");
        assert!((gap - closest).abs() < 0.02, "screen {screen}: {gap}");
        assert!(screen == "off" || (thrust - 1.003).abs() < 0.002, "{thrust}");
    }
}

#[test]
fn pressure_is_hydrostatic_at_both_faces_of_two_rows() {
    let folder = tempfile::tempdir().unwrap();
    let run = held(folder.path(), 2, "total-lagrangian").run();
    for (side, level) in LEVELS.into_iter().enumerate() {
        // Two columns beside the face, from 3 dx below the surface to 2 dx above the floor.
        let near = |x: f64| {
            if side == 0 { x < FACE && x > FACE - 2.0 * DX } else { x > FACE && x < FACE + 2.0 * DX }
        };
        let column: Vec<f64> = beside_faces(&run, 2)
            .into_iter()
            .filter(|(_, [x, y], _)| near(*x) && *y > 2.0 * DX && *y < level - 3.0 * DX)
            .map(|(_, [_, y], p)| p - 1000.0 * GRAVITY * (level - y))
            .collect();
        let worst = column.iter().fold(0.0_f64, |worst, p| worst.max(p.abs()));
        println!("side {side}: {} particles, worst {worst:.0} Pa", column.len());
        assert!(column.len() >= 6);
        // As in the tank at rest: 2 % of the pressure at the bottom.
        assert!(worst < 0.02 * 1000.0 * GRAVITY * LEVELS[0], "side {side}: {worst}");
    }
}

#[test]
fn two_rows_bend_under_the_difference_of_both_levels() {
    const E: f64 = 3e9;
    let folder = tempfile::tempdir().unwrap();
    let solid = format!("model = \"total-lagrangian\"\nyoungs_modulus = {E}");
    let run = scene_at(&tank(folder.path(), 0.005, 2, 0.0, &solid)).in_process().until(0.4).run();
    // A cantilever of length L under rho g (level - y): integral of q y² (3 L - y) / (6 D).
    let (length, d) = (0.25, E * 0.01_f64.powi(3) / (12.0 * (1.0 - 0.3 * 0.3)));
    let bend = |level: f64| {
        let integral = length * level.powi(4) / 4.0 - level.powi(5) / 20.0;
        1000.0 * GRAVITY * integral / (6.0 * d)
    };
    let theory = bend(LEVELS[0]) - bend(LEVELS[1]);
    let ratio = run.curve("top.x").between(0.1, 0.4).mean() / theory;
    println!("deflection over beam theory: {ratio:.3}");
    // Two rows of this solid, dry, bend by 0.92 of the thin plate's; the thrust of water at rest is good for 2 %, and
    // the mean of a few swings for as much.
    assert!((ratio / 0.92 - 1.0).abs() < 0.05, "{ratio}");
    assert!(run.report.audit.action_reaction.unwrap() <= 1e-12);
}

#[test]
fn one_row_is_refused_because_it_leaks() {
    let folder = tempfile::tempdir().unwrap();
    let one = || held(folder.path(), 1, "hypoelastic");
    let refused = one().outcome();
    assert_eq!(refused.code(), Some(1), "{}", refused.stderr);
    // The text is wrapped to the terminal, at hyphens, too.
    let said: String = refused.stderr.chars().filter(|c| !c.is_whitespace() && *c != '│').collect();
    for word in
        ["tank.toml:", "shape.plate.box", "has1ofatleast2particlesacross", "thin-plate-screen=\"off\""]
    {
        assert!(said.contains(word), "{word}: {said}");
    }
    let check = std::process::Command::new(program())
        .arg("check")
        .arg(folder.path().join("tank.toml"))
        .output()
        .unwrap();
    assert_eq!(check.status.code(), Some(1));
    // What it is refused for.
    let leaks = one().set("effects.thin-plate-screen", "off").set("end_time", 1).run();
    let through =
        beside_faces(&leaks, 1).into_iter().filter(|(id, [x, _], _)| *id < 200 && *x > FACE).count();
    println!("{through} of 200 particles of the deep side are beyond the plate after 1 s");
    assert!(through > 0);
}

/// Two rows that turn under water: the screen goes along, and no particle gets between the rows.
#[test]
fn water_stays_out_of_a_blade_that_turns() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("blade.toml");
    let (long, thick) = (0.2, 2.0 * DX);
    std::fs::write(
        &path,
        format!(
            "resolution = {DX}\nend_time = 0.8\n[fluid]\ndensity = 1000.0\n[solid]\nmodel = \"rigid\"\n\
             density = 1000.0\n[output]\nframe_interval = 0.1\n[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
             tank = {{ min = [0.0, 0.0], max = [0.4, 0.4], open = [\"top\"] }}\n[[shape]]\nname = \"blade\"\n\
             phase = \"solid\"\nbox = {{ min = [0.1, 0.14], max = [0.3, 0.16] }}\nrotate = {{ angle = 30 }}\n\
             motion = {{ angular_velocity = 3.14, ramp = 0.3, pivot = [0.2, 0.15] }}\n[[shape]]\nname = \"water\"\n\
             phase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.4, 0.3] }}\npressure = \"hydrostatic\"\n"
        ),
    )
    .unwrap();
    let run = scene_at(&path).in_process().run();
    let gap = run.report.audit.min_gap.expect("water beside the blade");
    assert!(gap > 0.3, "{gap}");
    let frame = run.outcome.frames("fluid").pop().expect("a last frame");
    let solid = run.outcome.frames("solid").pop().expect("a last frame");
    let centre = [0.2, 0.15];
    // Along the blade: toward its farthest particle, which is half a thickness beside its middle line.
    let arms = solid.points.iter().map(|p| [f64::from(p[0]) - centre[0], f64::from(p[1]) - centre[1]]);
    let far = arms.max_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1]))).expect("a blade");
    let (end, side) = (0.5 * (long - DX), 0.5 * (thick - DX));
    let angle = far[1].atan2(far[0]);
    let turned = |sign: f64| angle - sign * side.atan2(end);
    // Of the two angles that this may be, the one at which all of the blade lies in its box.
    let inside = |angle: f64, p: &[f32; 3], margin: f64| {
        let arm = [f64::from(p[0]) - centre[0], f64::from(p[1]) - centre[1]];
        let (sin, cos) = angle.sin_cos();
        let (along, across) = (cos * arm[0] + sin * arm[1], cos * arm[1] - sin * arm[0]);
        along.abs() < 0.5 * long + margin && across.abs() < 0.5 * thick + margin
    };
    let angle = [turned(1.0), turned(-1.0)]
        .into_iter()
        .find(|&angle| solid.points.iter().all(|p| inside(angle, p, 0.1 * DX)))
        .expect("the blade keeps its shape");
    let within = (0..frame.len())
        .filter(|&k| frame.phase[k] == FLUID && inside(angle, &frame.points[k], -0.3 * DX))
        .count();
    assert_eq!(within, 0, "particles in the blade");
    // It has turned, and the water went along and around it.
    let turned = angle - 30_f64.to_radians();
    assert!(turned.rem_euclid(std::f64::consts::PI) > 0.3, "{turned}");
}
