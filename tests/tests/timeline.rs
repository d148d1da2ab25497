//! `halfstep run --trace`: the timeline of half-steps has everybody and everything once, and changes nothing.

use halfstep_output::timeline::{HALF_STEP, Span, Timeline, Track};
use halfstep_tests::python::python;
use halfstep_tests::run::{repository, scene_at};
use halfstep_tests::{Outcome, RunBuilder, scene};
use std::ops::Range;
use std::path::Path;

fn gate() -> RunBuilder {
    scene("elastic-gate").set("resolution", 0.0025).until(0.01)
}

fn traced(run: RunBuilder, file: &Path, steps: Range<u64>) -> RunBuilder {
    let Range { start, end } = steps;
    run.argument("--trace").argument(file).argument("--trace-steps").argument(format!("{start}..{end}"))
}

fn names(timeline: &Timeline) -> Vec<&str> {
    timeline.tracks.iter().map(|track| track.name.as_str()).collect()
}

fn of<'a>(track: &'a Track, name: &str) -> impl Iterator<Item = &'a Span> {
    track.spans.iter().filter(move |span| span.name == name)
}

/// Each track has every half-step of the steps once, spans lie within each other or apart, and none is longer than the
/// run, s.
fn holds(timeline: &Timeline, steps: Range<u64>, seconds: f64) {
    assert_eq!(timeline.lost, 0);
    let expected: Vec<(u64, u32)> = steps.flat_map(|step| [(step, 0), (step, 1)]).collect();
    for track in &timeline.tracks {
        let whole = track.spans.iter().filter(|span| span.category == HALF_STEP);
        let found: Vec<(u64, u32)> = whole.map(|span| (span.step, span.stage)).collect();
        assert_eq!(found, expected, "{}", track.name);
        let mut open: Vec<&Span> = Vec::new();
        for span in &track.spans {
            assert!(span.start >= 0.0 && span.duration >= 0.0, "{span:?}");
            while open.last().is_some_and(|outer| outer.end() <= span.start + 2e-3) {
                open.pop();
            }
            assert!(open.last().is_none_or(|outer| outer.contains(span)), "{:?} and {span:?}", open.last());
            open.push(span);
        }
        let shares = track.shares();
        let sum: f64 = shares.iter().map(|share| share.share).sum();
        assert!(sum > 0.0 && sum < 1.0 + 1e-6, "{}: {sum} {shares:?}", track.name);
        let end = track.spans.iter().map(Span::end).fold(0.0, f64::max);
        assert!(end * 1e-6 < seconds, "{}: {end} µs in a run of {seconds} s", track.name);
    }
}

#[test]
fn everybody_is_in_the_timeline_and_the_bits_are_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gate.json");
    let without = gate().run();
    for (what, run) in [("processes", gate()), ("threads", gate().in_process())] {
        let run = traced(run, &file, 20..30).argument("--force").run();
        assert_eq!(run.state_hash(), without.state_hash(), "{what}");
        assert_eq!(run.report.steps, without.report.steps);
        let timeline = Timeline::read(&file).unwrap();
        assert_eq!(names(&timeline), ["coupler", "fluid", "solid"], "{what}");
        holds(&timeline, 20..30, run.outcome.seconds);
        let [coupler, fluid, solid] = &timeline.tracks[..] else { panic!("three tracks") };
        for (track, phases) in [
            (coupler, &["wait for state", "cross force", "balance and time step", "checks", "send"][..]),
            (
                fluid,
                &["publish", "sums", "pair pass", "walls: extrapolation", "interface", "wait for forces"],
            ),
            (solid, &["wait for state", "wait for forces", "sub-step", "integrate", "send"]),
        ] {
            for phase in phases {
                assert!(of(track, phase).count() >= 10, "{what}: {} has no `{phase}`", track.name);
            }
        }
        let sub_steps = of(solid, "sub-step").filter(|span| (span.step, span.stage) == (25, 1)).count();
        assert!(sub_steps >= 2 && sub_steps.is_multiple_of(2), "{what}: {sub_steps} sub-steps");
        let numbers: Vec<u32> = timeline.tracks.iter().map(|track| track.process.1).collect();
        let processes = [coupler, fluid, solid].map(|track| track.process.0.as_str());
        match what {
            "processes" => {
                assert!(numbers[0] != numbers[1] && numbers[1] != numbers[2], "{numbers:?}");
                assert_eq!(processes, ["coupler", "fluid", "solid"]);
            }
            _ => {
                assert!(numbers[0] == numbers[1] && numbers[1] == numbers[2], "{numbers:?}");
                assert_eq!(processes, ["halfstep"; 3]);
            }
        }
        assert!(run.dir().join("trace.png").is_file());
        let left = std::fs::read_dir(run.dir()).unwrap().flatten();
        let parts = left.filter(|entry| entry.file_name().to_string_lossy().starts_with("timeline-"));
        assert_eq!(parts.count(), 0, "{what}: the parts have gone into the file");
    }
    assert!(!without.dir().join("trace.png").exists());
}

/// The processes' clocks are one: the coupler has the state of a half-step after its sender began to send it.
#[test]
fn messages_arrive_after_they_were_sent() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gate.json");
    traced(gate(), &file, 10..20).run();
    let timeline = Timeline::read(&file).unwrap();
    let [coupler, fluid, solid] = &timeline.tracks[..] else { panic!("three tracks") };
    for track in [fluid, solid] {
        for sent in of(track, "send") {
            let same = |span: &&Span| (span.step, span.stage) == (sent.step, sent.stage);
            let from = |span: &&Span| span.with.as_deref() == Some(track.name.as_str());
            let wait = of(coupler, "wait for state").filter(same).find(from).expect("a wait");
            // Ten microseconds: the two clocks of a process are read one after the other.
            assert!(wait.end() > sent.start - 10.0, "{sent:?} {wait:?}");
        }
    }
}

#[test]
fn several_solids_have_a_track_each_in_whatever_process() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plates.json");
    for own in [false, true] {
        let mut run = traced(scene("two-plates").until(0.02), &file, 5..9).argument("--force");
        if own {
            run = run.set("solid.stiff.process", "own");
        }
        let run = run.run();
        let timeline = Timeline::read(&file).unwrap();
        assert_eq!(names(&timeline), ["coupler", "fluid", "soft", "stiff"]);
        holds(&timeline, 5..9, run.outcome.seconds);
        let processes: Vec<&str> = timeline.tracks.iter().map(|track| track.process.0.as_str()).collect();
        assert_eq!(processes, ["coupler", "fluid", "solid", if own { "stiff" } else { "solid" }]);
    }
}

#[test]
fn a_single_phase_has_its_track_and_the_couplers() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("dam.json");
    let dam = || scene("dam-break").set("resolution", 0.005715).until(0.02);
    let run = traced(dam(), &file, 0..5).run();
    assert_eq!(run.state_hash(), dam().run().state_hash());
    let timeline = Timeline::read(&file).unwrap();
    assert_eq!(names(&timeline), ["coupler", "fluid"]);
    holds(&timeline, 0..5, run.outcome.seconds);
}

#[test]
fn the_wait_for_a_foreign_solid_shows() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("block.json");
    let script = repository().join("tests/python/spring_block.py");
    let command = format!("{} {} 2e4", python().display(), script.display());
    let run = scene("spring-block").until(0.01).argument("--solid").argument(command);
    let run = traced(run, &file, 3..6).run();
    let timeline = Timeline::read(&file).unwrap();
    assert_eq!(names(&timeline), ["coupler", "fluid"]);
    holds(&timeline, 3..6, run.outcome.seconds);
    for track in &timeline.tracks {
        let waits = of(track, "wait for state").filter(|span| span.with.as_deref() == Some("solid"));
        assert_eq!(waits.count(), 6, "{}", track.name);
    }
}

fn refused(run: RunBuilder, told: &[&str]) {
    let outcome: Outcome = run.outcome();
    assert_eq!(outcome.code(), Some(1), "{}", outcome.stderr);
    for part in told {
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    assert!(!outcome.dir.exists(), "nothing was started");
}

#[test]
fn wrong_arguments_are_told_before_anything_starts() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gate.json");
    let backwards = gate().argument("--trace").argument(&file).argument("--trace-steps").argument("30..20");
    refused(backwards, &["--trace-steps", "30..20 holds no step"]);
    refused(traced(gate(), &file, 0..1001), &["holds 1001 steps, more than the 1000"]);
    let alone = gate().argument("--trace-steps").argument("1..2");
    refused(alone, &["--trace <FILE>"]);
    let text = gate().argument("--trace").argument(&file).argument("--trace-steps").argument("5");
    refused(text, &["`5` is not FROM..TO"]);
    refused(traced(gate(), folder.path(), 1..2), &["--trace", "is a folder"]);
    refused(traced(gate(), &folder.path().join("none/gate.json"), 1..2), &["there is no folder"]);
    refused(traced(gate(), Path::new("/proc/gate.json"), 1..2), &["/proc/gate.json: cannot be written"]);
    refused(traced(gate(), Path::new("/dev/null"), 1..2), &["is no regular file"]);
    let out = folder.path().join("out");
    for own in ["run.json", "scene.json", "probes.csv", "frames", "checkpoint-a"] {
        refused(traced(gate(), &out.join(own), 1..2).out(&out), &["is a file that the run itself leaves"]);
    }
    let picture = folder.path().join("gate.png");
    refused(traced(gate(), &picture, 1..2), &["their picture is trace.png"]);
    std::fs::write(&picture, "mine").unwrap();
    refused(traced(gate(), &picture, 1..2), &["their picture is trace.png"]);
    let own = folder.path().join("own.toml");
    std::fs::copy(repository().join("scenes/spring-block.toml"), &own).unwrap();
    refused(traced(scene_at(&own), &own, 1..2).argument("--force"), &["is the scene"]);
    refused(traced(scene_at(&own), &own, 1..2), &["is the scene"]);
    std::fs::write(&file, "mine").unwrap();
    refused(traced(gate(), &file, 1..2), &["the file exists; --force replaces it"]);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
}

#[test]
fn a_window_that_the_run_does_not_reach_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let [within, beyond] = ["within", "beyond"].map(|name| folder.path().join(name));
    let run = traced(gate(), &within, 50..900).run();
    let steps = run.report.steps;
    assert!(steps > 60 && steps < 900, "{steps}");
    let told = format!("the run ended within the timeline's window: step {} is its last, not 899", steps - 1);
    assert!(run.outcome.stderr.contains(&told), "{told}\n{}", run.outcome.stderr);
    let timeline = Timeline::read(&within).unwrap();
    assert_eq!(timeline.steps(), Some((50, steps - 1)));

    let run = traced(gate(), &beyond, 5000..5001).run();
    let told = format!("no timeline: the run ended at step {steps}, before the window 5000..5001 began");
    assert!(run.outcome.stderr.contains(&told), "{told}\n{}", run.outcome.stderr);
    assert!(!beyond.exists() && !run.dir().join("trace.png").exists());
}

#[test]
fn a_run_that_diverges_leaves_what_it_did() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plate.json");
    let plate = scene("dam-break-plate").set("preset", "kayaki").until(0.02);
    let outcome = traced(plate, &file, 0..1000).outcome();
    assert_eq!(outcome.code(), Some(2), "{}", outcome.stderr);
    let timeline = Timeline::read(&file).unwrap();
    assert_eq!(names(&timeline), ["coupler", "fluid", "solid"]);
    let (first, last) = timeline.steps().unwrap();
    let steps = outcome.report().steps;
    // The step that diverged is not whole.
    assert!(first == 0 && last + 2 >= steps && last < steps, "{first} to {last} of {steps}");
}
