use super::*;

fn span(name: &str, category: &str, [start, end]: [f64; 2]) -> Span {
    let (name, category) = (name.to_owned(), category.to_owned());
    Span { name, category, start, duration: end - start, step: 7, stage: 1, with: None }
}

fn track(name: &str, pid: u32, spans: Vec<Span>) -> Track {
    Track { process: (format!("{name} process"), pid), name: name.into(), spans }
}

/// A half-step of 100 µs: 40 of sums, of which 30 are the pair pass, and 50 of waiting for the gate.
fn fluid() -> Track {
    let wait = Span { with: Some("gate".into()), ..span("wait for state", "wait", [1050.0, 1100.0]) };
    let spans = vec![
        span("half-step", HALF_STEP, [1000.0, 1100.0]),
        span("sums", "compute", [1000.0, 1040.0]),
        span("pair pass", "compute", [1005.0, 1035.0]),
        wait,
    ];
    track("fluid", 12, spans)
}

#[test]
fn a_phase_has_the_time_that_no_phase_in_it_has() {
    let shares = fluid().shares();
    let told: Vec<_> = shares.iter().map(|share| (share.name.as_str(), share.share)).collect();
    let expected = [("sums", 0.1), ("pair pass", 0.3), ("wait for state: gate", 0.5)];
    assert_eq!(told.len(), expected.len(), "{told:?}");
    for ((name, share), expected) in told.into_iter().zip(expected) {
        assert_eq!(name, expected.0);
        assert!((share - expected.1).abs() < 1e-12, "{name}: {share}");
    }
}

#[test]
fn parts_become_one_that_counts_from_the_first_of_all() {
    let coupler = track("coupler", 10, vec![span("half-step", HALF_STEP, [990.0, 1105.0])]);
    let gate = track("gate", 12, vec![]);
    let parts =
        vec![Timeline { tracks: vec![gate, fluid()], lost: 2 }, Timeline { tracks: vec![coupler], lost: 1 }];
    let merged = Timeline::merged(parts, &["fluid".into(), "gate".into()]);
    let names: Vec<&str> = merged.tracks.iter().map(|track| track.name.as_str()).collect();
    assert_eq!(names, ["coupler", "fluid", "gate"]);
    assert_eq!((merged.tracks[0].spans[0].start, merged.tracks[1].spans[0].start), (0.0, 10.0));
    assert_eq!((merged.lost, merged.steps()), (3, Some((7, 7))));
}

#[test]
fn the_file_is_a_trace_event_file_and_reads_back() {
    let timeline = Timeline { tracks: vec![track("coupler", 10, vec![]), fluid()], lost: 4 };
    let text = timeline.to_json().unwrap();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let events = value["traceEvents"].as_array().unwrap();
    let pass = events.iter().find(|event| event["name"] == "pair pass").unwrap();
    let told = ["ph", "cat", "ts", "dur", "pid", "tid"].map(|key| pass[key].to_string());
    assert_eq!(told, ["\"X\"", "\"compute\"", "1005.0", "30.0", "12", "1"]);
    let name = events.iter().find(|event| event["name"] == "thread_name" && event["tid"] == 1).unwrap();
    assert_eq!((name["ph"].as_str(), name["args"]["name"].as_str()), (Some("M"), Some("fluid")));
    assert_eq!(Timeline::from_json(&text).unwrap(), timeline);
    assert!(Timeline::from_json("{}").is_err());
}
