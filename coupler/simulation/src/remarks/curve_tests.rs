//! Output, curves and metrics that are valid and say nothing: what is remarked on each, and on what is near it not.

use super::remarks;
use super::tests::{TANK, WATER};
use super::trap_tests::{has, on, with};
use halfstep_scene::parse;

/// Remarks on water with a gauge at 0.05 m and the front.
fn of(lines: &str, motion: &str, rest: &str) -> Vec<String> {
    let tank = with(TANK, motion);
    on(&format!(
        "resolution = 0.005\nend_time = 1.0\n{lines}\n[fluid]\ndensity = 1000.0\n{tank}{WATER}\
         [[probe]]\nname = \"g\"\nkind = \"water-level\"\nx = [0.05, 0.3]\n[[probe]]\nname = \"f\"\nkind = \
                             \"front\"\n{rest}"
    ))
}

#[test]
fn intervals_that_leave_no_curve() {
    let frames = |interval: f64| of(&format!("[output]\nframe_interval = {interval}"), "", "");
    let said =
        "output.frame_interval is 2 s and the run ends at 1 s: it has frames of its start and its end alone";
    assert_eq!(frames(2.0), [said]);
    assert_eq!(frames(1.0), [""; 0]);
    // The beginning of a run that is long enough.
    let text = format!("resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n{TANK}{WATER}");
    let text = text + "[output]\nframe_interval = 0.5\n";
    let mut scene = parse(&text, std::path::Path::new("t.toml"), &["end_time=0.1".into()]).unwrap();
    assert_eq!(remarks(&scene).len(), 1);
    scene.whole = Some(1.0);
    assert_eq!(remarks(&scene), [""; 0]);
    let rows =
        |interval: f64, motion: &str| of(&format!("[output]\nprobe_interval = {interval}"), motion, "");
    let said =
        "output.probe_interval is 0.2 s and the run ends at 1 s: the curves of the probes have 6 points";
    assert_eq!(rows(0.2, ""), [said]);
    assert_eq!(rows(0.1, ""), [""; 0]);
    let motion = "motion = { amplitude = [0.001, 0.0], period = 0.2 }\n";
    let said = "output.probe_interval is 0.05 s and `tank` swings with a period of 0.2 s: the curves of the probes \
                have 4.0 points a period";
    assert!(has(&rows(0.05, motion), said), "{:?}", rows(0.05, motion));
    assert!(!has(&rows(0.02, motion), "points a period"));
}

#[test]
fn levels_that_nothing_comes_to() {
    let metric = |probe: &str, kind: &str, level: f64| {
        let rest =
            format!("[[metric]]\nname = \"m\"\nprobe = \"{probe}\"\nkind = \"{kind}\"\nlevel = {level}\n");
        of("", "", &rest)
    };
    let said = "the metric `m` has level = 40 m, and f.x stays in the domain, from";
    assert!(has(&metric("f.x", "first-above", 40.0), said));
    assert_eq!(metric("f.x", "first-above", 0.3), [""; 0]);
    let said = "the metric `m` has level = 0 m, and g.level-1 begins at 0.1 m over a floor at 0 m: it does not swing \
                about it";
    assert_eq!(metric("g.level-1", "period", 0.0), [said]);
    assert_eq!(metric("g.level-1", "period", 0.1), [""; 0]);
    let said = "the metric `m` has level = 0.05 m, and g.level-1 begins at 0.1 m: it is above from the start";
    assert_eq!(metric("g.level-1", "first-above", 0.05), [said]);
    assert_eq!(metric("g.level-2", "first-above", 0.0), [""; 0], "when it is wet for the first time");
}

#[test]
fn curves_beside_the_run() {
    let curve = |points: &str| {
        of("", "", &format!("[[reference]]\nprobe = \"f.x\"\nlabel = \"late\"\npoints = {points}\n"))
    };
    let said =
        "the curve `late` of f.x lasts from 5 to 7.5 s, and the run from 0 to 1 s: nothing of it is compared";
    assert_eq!(curve("[[5.0, 0.1], [7.5, 0.2]]"), [said]);
    assert_eq!(curve("[[0.9, 0.1], [7.5, 0.2]]"), [""; 0]);
}

#[test]
fn curves_in_other_units() {
    let curve = |time: &str, title: &str, scale: f64| {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("c.csv"), format!("{time},{title}\n0,1\n0.5,2\n")).expect("a file");
        let text = format!(
            "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n{TANK}{WATER}\
             [[probe]]\nname = \"p\"\nkind = \"pressure\"\nat = [0.05, 0.01]\n[[reference]]\nprobe = \"p.pressure\"\n\
             label = \"exp\"\nfile = \"c.csv\"\ncolumns = [\"{time}\", \"{title}\"]\nscale = {scale}\n"
        );
        remarks(&parse(&text, &folder.path().join("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
    };
    let said = "the curve `exp` of p.pressure has the column `p [kPa]`, whose title says kPa, times scale = 1, in Pa \
                (scale = 1000 makes Pa of it)";
    assert_eq!(curve("t [s]", "p [kPa]", 1.0), [said]);
    assert_eq!(curve("t [s]", "p [kPa]", 1000.0), [""; 0]);
    assert_eq!(curve("t [s]", "p [Pa]", 1.0), [""; 0]);
    let found = curve("t [ms]", "p [Pa]", 1.0);
    assert!(has(&found, "the curve `exp` of p.pressure takes the times of the column `t [ms]`"), "{found:?}");
}

#[test]
fn sines_of_degrees() {
    let water = |height: &str| {
        let text = "[parameters]\nslope = 15\n";
        let water = WATER.replace("max = [0.1, 0.1]", &format!("max = [0.1, \"={height}\"]"));
        on(&format!("resolution = 0.005\nend_time = 1.0\n{text}[fluid]\ndensity = 1000.0\n{TANK}{water}"))
    };
    let found = water("0.1 * abs(tan(slope))");
    let said = "`tan(slope)` in shape.water.box.max.1 takes 15 radians, 859 degrees: that of 15 degrees is \
                `tan((slope) * pi / 180)`";
    assert!(has(&found, said), "{found:?}");
    assert!(!has(&water("0.4 * tan(slope * pi / 180)"), "radians"));
}
