//! The tables of docs/protocol.md say what the program does.

mod scene_keys;

use halfstep_link::{LinkConfig, Participant, ProcessLink, Processes, Slot};
use halfstep_tests::conformance::link::raw::node;
use halfstep_tests::conformance::link::{Run, eventually};
use halfstep_tests::python::python;
use halfstep_wire::Name;
use halfstep_wire::failure::Quantity;
use halfstep_wire::protocol::{
    ForceHeader, ForceRecord, LAST_STAGE, LAYOUT, PROTOCOL, Plain, ProbeHeader, SCHEMA,
};
use halfstep_wire::protocol::{StateHeader, StateRecord, ability, order, status};
use iceoryx2::prelude::*;
use std::collections::BTreeMap;
use std::mem::offset_of;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const PAGE: &str = include_str!("../../docs/protocol.md");
/// Headings of the two tables of places.
const CHANNELS: &str = "Places in the publish-subscribe services";
const WAKE_UPS: &str = "Places in the wake-up services";

/// Lines of the table under a heading that begins so, its own heading included; cells without spaces and backticks.
fn lines(heading: &str) -> Vec<Vec<String>> {
    let lines: Vec<Vec<String>> = PAGE
        .lines()
        .skip_while(|line| !line.starts_with(heading))
        .skip_while(|line| !line.starts_with('|'))
        .take_while(|line| line.starts_with('|'))
        .map(|line| {
            let cells = line.trim_matches('|').split('|');
            cells.map(|cell| cell.trim().trim_matches('`').to_owned()).collect()
        })
        .collect();
    assert!(lines.len() > 2, "no table under {heading}");
    lines
}

/// Rows of the table under a heading that begins so.
fn table(heading: &str) -> Vec<Vec<String>> {
    lines(heading).split_off(2)
}

fn size(kind: &str) -> usize {
    let (base, count) = match kind.split_once('[') {
        Some((base, count)) => (base, count.trim_end_matches(']').parse().unwrap()),
        None => (kind, 1),
    };
    count * if base.ends_with("32") { 4 } else { 8 }
}

/// A table of fields as the schema number spells it: those of an inner structure in braces behind its name.
fn spelt(name: &str, rows: &[Vec<String>]) -> String {
    let outer = |row: &[String]| row[1].split_once('.').map(|(outer, _)| outer.to_owned());
    let groups = rows.chunk_by(|a, b| outer(a).is_some() && outer(a) == outer(b));
    let groups = groups.map(|group| {
        let field = |row: &Vec<String>| format!("{}:{}", row[1].rsplit('.').next().unwrap(), row[2]);
        let fields = group.iter().map(field).collect::<Vec<_>>().join(",");
        outer(&group[0]).map_or(fields.clone(), |outer| format!("{outer}:{{{fields}}}"))
    });
    format!("{name}{{{}}}", groups.collect::<Vec<_>>().join(","))
}

/// Compares a structure's table with the structure: offsets, and that no field is missing in between. Returns the
/// layout that the table spells.
fn compare(name: &str, length: usize, actual: &[(usize, String)]) -> String {
    let rows = table(&format!("### {name}: {length} bytes"));
    let documented: Vec<(usize, String)> =
        rows.iter().map(|row| (row[0].parse().unwrap(), row[1].clone())).collect();
    assert_eq!(documented, actual, "{name}");
    let mut end = 0;
    for row in &rows {
        assert_eq!(row[0].parse::<usize>().unwrap(), end, "{name}.{}", row[1]);
        end += size(&row[2]);
    }
    assert_eq!(end, length, "{name}");
    spelt(name, &rows)
}

/// [`compare`] with the fields of a structure; those of inner structures by their paths.
macro_rules! layout {
    ($structure:ident { $($($field:ident).+),* $(,)? }) => {
        compare(
            stringify!($structure),
            size_of::<$structure>(),
            &[$((offset_of!($structure, $($field).+), [$(stringify!($field)),+].join("."))),*],
        )
    };
}

#[test]
fn byte_offsets() {
    let layouts = [
        layout!(StateRecord { id, flags, position, velocity, density, pressure, mass, deviatoric_stress }),
        layout!(ForceRecord { id, flags, cross_viscosity, stress_force }),
        layout!(StateHeader {
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
            abilities,
            checkpoint_safe,
            failure.participant,
            failure.quantity,
            failure.particle,
            failure.reserved,
            failure.value,
            failure.position,
            audit.momentum,
            audit.kinetic_energy,
            audit.mass,
            audit.density_error,
            audit.gap,
            audit.stored_energy,
            state_hash,
            particles,
        }),
        layout!(ForceHeader {
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
            checkpoint,
        }),
        layout!(ProbeHeader { run_id, schema, protocol, count, step, time }),
    ];
    assert_eq!(layouts.join(";"), LAYOUT, "what the schema number stands for");
    for name in [
        StateRecord::NAME,
        StateHeader::NAME,
        ForceRecord::NAME,
        ForceHeader::NAME,
        ProbeHeader::NAME,
        f64::NAME,
    ] {
        assert!(PAGE.contains(&format!("`{name}`")), "{name}");
    }
}

/// The Python package has the bytes of this page, which are those of the structures.
#[test]
fn the_python_package_has_these_bytes() {
    let output = Command::new(python()).args(["-m", "halfstep.wire"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8(output.stdout).unwrap();
    let mut expected = String::new();
    for (name, kind, length) in [
        ("StateRecord", StateRecord::NAME, size_of::<StateRecord>()),
        ("ForceRecord", ForceRecord::NAME, size_of::<ForceRecord>()),
        ("StateHeader", StateHeader::NAME, size_of::<StateHeader>()),
        ("ForceHeader", ForceHeader::NAME, size_of::<ForceHeader>()),
        ("ProbeHeader", ProbeHeader::NAME, size_of::<ProbeHeader>()),
    ] {
        expected += &format!("{name} {kind} {length}\n");
        for row in table(&format!("### {name}: {length} bytes")) {
            expected += &format!("{} {} {}\n", row[0], row[1], row[2]);
        }
    }
    expected += &format!("protocol {PROTOCOL}\nschema {SCHEMA}\n");
    for (name, number) in [
        ("go", order::GO),
        ("write frame", order::WRITE_FRAME),
        ("write checkpoint", order::WRITE_CHECKPOINT),
        ("stop", order::STOP),
        ("send probes", order::SEND_PROBES),
        ("checkpoints", ability::CHECKPOINTS),
        ("walls and contacts", ability::WALLS_AND_CONTACTS),
        ("ok", status::OK),
        ("diverged", status::DIVERGED),
        ("failed", status::FAILED),
        ("finished", status::FINISHED),
        ("last stage", LAST_STAGE),
    ] {
        expected += &format!("{name} {number}\n");
    }
    for number in 1..=6 {
        expected += &format!("{} {number}\n", Quantity::from_wire(number).unwrap());
    }
    assert_eq!(told, expected);
}

#[test]
fn environment() {
    let documented: Vec<String> = table("## Start").into_iter().map(|mut row| row.remove(0)).collect();
    let config = LinkConfig::of_two(1, 1);
    let variables = config.to_env_of(&config.participants[1]);
    let mut actual: Vec<&str> = variables.into_iter().map(|(key, _)| key).collect();
    actual.extend(["HALFSTEP_SCENE", "HALFSTEP_OUT", "HALFSTEP_PARTICLES", "HALFSTEP_CHECKPOINT"]);
    assert_eq!(documented, actual);
    assert!(PAGE.contains(&format!("The version of the protocol is {PROTOCOL}.")));
}

/// Three solids in two processes.
fn several_solids() -> Run {
    let participant = |name: &str, process: &str, probes: u32| Participant {
        name: name.parse().unwrap(),
        process: process.parse().unwrap(),
        capacity: 5,
        probes,
    };
    let participants = vec![
        participant("fluid", "fluid", 0),
        participant("a", "solid", 2),
        participant("b", "b", 0),
        participant("c", "solid", 0),
    ];
    let config = LinkConfig::new(participants);
    Run(LinkConfig { handshake_seconds: 20.0, patience_seconds: 20.0, ..config })
}

/// What a row of places says of three solids in two processes.
fn places(heading: &str, service: &str) -> Vec<usize> {
    let rows = table(heading);
    let row = rows.iter().find(|row| row[0].starts_with(service)).expect(service);
    let number = |term: &str| -> usize {
        match term {
            "S" => 3,
            "P" => 2,
            number => number.parse().expect(number),
        }
    };
    row[1..].iter().map(|cell| cell.split(" + ").map(number).sum()).collect()
}

/// The attributes that the page tells, with this run's values.
fn attributes(config: &LinkConfig) -> AttributeVerifier {
    let variables = config.to_env();
    table("Attributes of every service").iter().fold(AttributeVerifier::new(), |verifier, row| {
        let value = &variables.iter().find(|(key, _)| *key == row[1]).unwrap().1;
        let (key, value) = (row[0].as_str().try_into().unwrap(), value.as_str().try_into().unwrap());
        verifier.require(&key, &value).unwrap()
    })
}

/// Opened once it exists, whatever it tells.
fn existing<T, E>(service: &str, open: impl Fn(&ServiceName) -> Result<T, E>) -> T {
    let name: ServiceName = service.try_into().unwrap();
    let mut found = None;
    eventually(20.0, service, || {
        found = open(&name).ok();
        found.is_some()
    });
    found.unwrap()
}

/// Checks a channel that somebody has made against the row for `documented`.
fn check_channel<R: Plain, H: Plain>(
    node: &Node<Processes>,
    attributes: &AttributeVerifier,
    documented: &str,
    service: &str,
) {
    let channel = existing(service, |name| {
        let builder = node.service_builder(name).publish_subscribe::<[Slot<R>]>().user_header::<Slot<H>>();
        builder.open_with_attributes(attributes)
    });
    let actual = channel.static_config();
    let told: BTreeMap<String, String> =
        table("Options of every").into_iter().map(|row| (row[0].clone(), row[1].clone())).collect();
    let found = [
        ("enable_safe_overflow", actual.has_safe_overflow().to_string()),
        ("history_size", actual.history_size().to_string()),
        ("subscriber_max_buffer_size", actual.subscriber_max_buffer_size().to_string()),
        ("subscriber_max_borrowed_samples", actual.subscriber_max_borrowed_samples().to_string()),
    ]
    .map(|(name, value)| (name.to_owned(), value));
    assert_eq!(told, BTreeMap::from(found), "{service}");
    let found = [actual.max_publishers(), actual.max_subscribers(), actual.max_nodes()];
    assert_eq!(places(CHANNELS, documented), found, "{service}");
}

/// The services that the link makes have the options of the tables.
#[test]
fn services() {
    let run = several_solids();
    let abort = Arc::new(AtomicBool::new(false));
    std::thread::scope(|threads| {
        let flag = Some(Arc::clone(&abort));
        threads.spawn(|| ProcessLink::<Processes>::open(&run, Name::SOLID, flag).map(drop).unwrap_err());
        eventually(20.0, "the solids' ports", || run.leftovers().iter().any(|name| name.ends_with(".data")));
        {
            let (node, attributes) = (node::<Processes>(&run), attributes(&run));
            let state = check_channel::<StateRecord, StateHeader>;
            state(&node, &attributes, "halfstep/fluid/state", "halfstep/fluid/state");
            state(&node, &attributes, "halfstep/SOLID/state", "halfstep/a/state");
            let force = check_channel::<ForceRecord, ForceHeader>;
            force(&node, &attributes, "halfstep/NAME/force", "halfstep/a/force");
            check_channel::<f64, ProbeHeader>(
                &node,
                &attributes,
                "halfstep/NAME/probes",
                "halfstep/a/probes",
            );
            for (documented, process) in [("fluid", "fluid"), ("PROCESS", "solid"), ("coupler", "coupler")] {
                let service = existing(&format!("halfstep/{process}/wake"), |name| {
                    node.service_builder(name).event().open_with_attributes(&attributes)
                });
                let actual = service.static_config();
                let found = [actual.max_listeners(), actual.max_notifiers(), actual.max_nodes()];
                assert_eq!(places(WAKE_UPS, &format!("halfstep/{documented}/wake")), found, "{process}");
            }
        }
        abort.store(true, Ordering::Relaxed);
    });
    assert_eq!(lines(CHANNELS)[0], ["service", "max_publishers", "max_subscribers", "max_nodes"]);
    assert_eq!(lines(WAKE_UPS)[0], ["service", "max_listeners", "max_notifiers", "max_nodes"]);
    let mut all: Vec<String> =
        table("Services, each opened").into_iter().map(|mut row| row.remove(0)).collect();
    assert_eq!(all.pop().as_deref(), Some("halfstep/PROCESS/wake"));
    let channels: Vec<String> = table(CHANNELS).into_iter().map(|mut row| row.remove(0)).collect();
    assert_eq!(all, channels);
}

#[test]
fn orders_abilities_and_statuses() {
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
            ("send probes", order::SEND_PROBES),
        ])
    );
    assert_eq!(
        numbers("**Abilities**"),
        expected(&[
            ("checkpoints", ability::CHECKPOINTS),
            ("walls and contacts", ability::WALLS_AND_CONTACTS),
            ("probes", ability::PROBES),
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
    let quantities = table("`failure.quantity` is one of");
    for row in &quantities {
        let quantity = Quantity::from_wire(row[0].parse().unwrap()).unwrap().to_string();
        assert!(row[1].starts_with(&quantity), "{quantity}: {}", row[1]);
    }
    assert_eq!(Quantity::from_wire(quantities.len() as u32 + 1), None, "one is missing on the page");
}
