//! The tables of docs/protocol.md say what the program does.

use halfstep_link::{LinkConfig, PhaseLink, Processes};
use halfstep_tests::conformance::link::raw::RawRole;
use halfstep_tests::conformance::link::{Run, eventually};
use halfstep_wire::failure::{Quantity, RoleName};
use halfstep_wire::protocol::{ForceHeader, ForceRecord, LAYOUT, MAX_PROBE_VALUES};
use halfstep_wire::protocol::{StateHeader, StateRecord, order, status};
use iceoryx2::prelude::PortFactory;
use std::collections::BTreeMap;
use std::mem::offset_of;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const PAGE: &str = include_str!("../../docs/protocol.md");

/// Rows of the table under a heading that begins so, cells trimmed of spaces and backticks.
fn table(heading: &str) -> Vec<Vec<String>> {
    let rows: Vec<Vec<String>> = PAGE
        .lines()
        .skip_while(|line| !line.starts_with(heading))
        .skip_while(|line| !line.starts_with('|'))
        .take_while(|line| line.starts_with('|'))
        .skip(2)
        .map(|line| {
            let cells = line.trim_matches('|').split('|');
            cells.map(|cell| cell.trim().trim_matches('`').to_owned()).collect()
        })
        .collect();
    assert!(!rows.is_empty(), "no table under {heading}");
    rows
}

fn size(kind: &str) -> usize {
    let (base, count) = match kind.split_once('[') {
        Some((base, count)) => (base, count.trim_end_matches(']').parse().unwrap()),
        None => (kind, 1),
    };
    count * if base.ends_with("32") { 4 } else { 8 }
}

/// Compares a struct's table with the struct: offsets, and that no field is missing in between.
macro_rules! check {
    ($structure:ident { $($field:ident),* $(,)? }) => {{
        let name = stringify!($structure);
        let heading = format!("### {name}: {} bytes", size_of::<$structure>());
        let rows = table(&heading);
        let documented: Vec<(usize, &str)> =
            rows.iter().map(|row| (row[0].parse().unwrap(), row[1].as_str())).collect();
        let actual = vec![$((offset_of!($structure, $field), stringify!($field))),*];
        assert_eq!(documented, actual, "{name}");
        let mut end = 0;
        for row in &rows {
            assert_eq!(row[0].parse::<usize>().unwrap(), end, "{name}.{}", row[1]);
            end += size(&row[2]);
        }
        assert_eq!(end, size_of::<$structure>(), "{name}");
        let layout: Vec<String> = rows.iter().map(|row| format!("{}:{}", row[1], row[2])).collect();
        let layout = format!("{name}{{{}}}", layout.join(","));
        assert!(LAYOUT.contains(&layout), "{layout} is not what the schema number stands for");
    }};
}

#[test]
fn byte_offsets() {
    check!(StateRecord { id, flags, position, velocity, density, pressure, mass, deviatoric_stress });
    check!(ForceRecord { id, flags, cross_viscosity, stress_force });
    check!(StateHeader {
        run_id,
        schema,
        protocol,
        status,
        step,
        stage,
        count,
        epoch,
        time,
        dt,
        dt_limit,
        displacement,
        sub_steps,
        frames_safe,
        failure_quantity,
        failure_particle,
        failure_value,
        failure_position,
        state_hash,
        seconds,
        audit,
        particles,
        probe_count,
        probes,
    });
    check!(ForceHeader {
        run_id,
        schema,
        protocol,
        order,
        step,
        stage,
        count,
        epoch,
        time,
        dt,
        next_time,
        frame,
    });
    assert_eq!(LAYOUT.split(';').count(), 4);
    assert!(PAGE.contains(&format!("at most {MAX_PROBE_VALUES} |")));
}

#[test]
fn environment() {
    let documented: Vec<String> = table("## Start").into_iter().map(|mut row| row.remove(0)).collect();
    let mut actual: Vec<&str> = LinkConfig::new(1, 1).to_env().into_iter().map(|(key, _)| key).collect();
    actual.push("HALFSTEP_SCENE");
    assert_eq!(documented, actual);
}

/// The services that the link makes have the options of the table.
#[test]
fn services() {
    let rows = table("The names of the types are");
    let documented = |column: usize| -> Vec<(String, String)> {
        let told = rows.iter().filter(|row| !row[column].is_empty() && !row[0].starts_with("attribute"));
        told.map(|row| (row[0].clone(), row[column].clone())).collect()
    };
    let run = Run::new(5, 5);
    let abort = Arc::new(AtomicBool::new(false));
    std::thread::scope(|threads| {
        let flag = Some(Arc::clone(&abort));
        threads.spawn(|| PhaseLink::<Processes>::open(&run, RoleName::Solid, flag).map(drop).unwrap_err());
        // Its messages' memory comes last.
        eventually(20.0, "the solid's ports", || run.leftovers().iter().any(|name| name.ends_with(".data")));
        // Opened with the least demands, so that what is found is what the solid asked for.
        let role = RawRole::<Processes>::enter(&run, "fluid");
        for (channel, column) in [("solid/state", 1), ("fluid/state", 1), ("solid/force", 2)] {
            let actual = if column == 1 {
                *role.channel::<StateRecord, StateHeader>(channel, 1).static_config()
            } else {
                *role.channel::<ForceRecord, ForceHeader>(channel, 1).static_config()
            };
            let actual = [
                ("enable_safe_overflow", actual.has_safe_overflow().to_string()),
                ("history_size", actual.history_size().to_string()),
                ("subscriber_max_buffer_size", actual.subscriber_max_buffer_size().to_string()),
                ("subscriber_max_borrowed_samples", actual.subscriber_max_borrowed_samples().to_string()),
                ("max_publishers", actual.max_publishers().to_string()),
                ("max_subscribers", actual.max_subscribers().to_string()),
                ("max_nodes", actual.max_nodes().to_string()),
            ]
            .map(|(name, value)| (name.to_owned(), value));
            assert_eq!(documented(column), actual, "{channel}");
        }
        let actual = role.wake_options("coupler");
        let actual =
            ["max_listeners", "max_notifiers", "max_nodes"].map(str::to_owned).into_iter().zip(actual);
        assert_eq!(documented(3), actual.collect::<Vec<_>>());
        abort.store(true, Ordering::Relaxed);
    });
    for row in table("Services, each opened") {
        assert!(row[0].starts_with("halfstep/"), "{row:?}");
    }
}

#[test]
fn orders_and_statuses() {
    let numbers = |heading: &str| -> BTreeMap<String, u32> {
        table(heading).into_iter().map(|row| (row[1].clone(), row[0].parse().unwrap())).collect()
    };
    let expected = |pairs: &[(&str, u32)]| -> BTreeMap<String, u32> {
        pairs.iter().map(|(name, number)| ((*name).to_owned(), *number)).collect()
    };
    assert_eq!(
        numbers("**Orders**"),
        expected(&[
            ("go", order::GO),
            ("write frame", order::WRITE_FRAME),
            ("write checkpoint", order::WRITE_CHECKPOINT),
            ("stop", order::STOP),
        ])
    );
    assert_eq!(
        numbers("## Failure"),
        expected(&[
            ("ok", status::OK),
            ("diverged", status::DIVERGED),
            ("failed", status::FAILED),
            ("finished", status::FINISHED),
        ])
    );
    for row in table("and ends. Of such a message") {
        let quantity = Quantity::from_wire(row[0].parse().unwrap()).unwrap().to_string();
        assert!(row[1].starts_with(&quantity), "{quantity}: {}", row[1]);
    }
}
