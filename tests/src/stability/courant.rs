//! How much room the fluid's Courant number has: the largest one with which a hard case keeps its criteria.

use super::case::Case;
use super::criteria::{evaluate, short};
use super::table::brief;
use halfstep_output::run_json::RunStatus;

/// The numbers that are tried; 0.4 is that of the midpoint rule.
const NUMBERS: [f64; 8] = [0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0];

/// A case at its coarsest spacing with larger and larger Courant numbers.
#[derive(Clone, Debug)]
pub struct Room {
    /// Heading of the case's family.
    pub family: String,
    /// The case's name.
    pub case: String,
    /// The solid's model, empty without a solid.
    pub model: String,
    /// The largest number up to which everything holds; `None` if nothing does.
    pub largest: Option<f64>,
    /// Steps with the first number over those with the largest.
    pub fewer: f64,
    /// What fails with the next number; empty where all hold.
    pub fails: String,
}

/// The room of a family's case with each of its models; nothing where the case sets the step itself.
pub fn room(family: &str, case: &Case) -> Vec<Room> {
    let own_step = |over: &String| over.starts_with("time_step") || over.starts_with("numerics.cfl");
    if case.set.iter().any(own_step) {
        return Vec::new();
    }
    case.each_model().into_iter().map(|model| of_model(family, case, model)).collect()
}

fn of_model(family: &str, case: &Case, model: Option<&str>) -> Room {
    let dx = case.resolution[0];
    let mut room = Room {
        family: family.into(),
        case: case.name.clone(),
        model: model.unwrap_or_default().into(),
        largest: None,
        fewer: 1.0,
        fails: String::new(),
    };
    let mut first = None;
    for number in NUMBERS {
        let with = |more: &[String]| {
            let mut all = vec![format!("numerics.cfl={number}")];
            all.extend_from_slice(more);
            case.run(dx, model, false, &all).outcome()
        };
        let others: Vec<_> =
            case.criteria.iter().map(|c| (!c.to_run.is_empty()).then(|| with(&c.to_run))).collect();
        let outcome = with(&[]);
        let measured = evaluate(&case.criteria, &outcome, dx, &others);
        let failed: Vec<String> = measured
            .iter()
            .enumerate()
            .filter(|(k, m)| !m.holds && !case.is_known_limit(*k))
            .map(|(_, m)| format!("{} {}", m.label, short(m.value)))
            .collect();
        let report = outcome.report();
        if !failed.is_empty() {
            let diverged = report.status == Some(RunStatus::Diverged);
            let what = if diverged { "diverged".to_owned() } else { failed.join(", ") };
            room.fails = format!("{number}: {what}");
            break;
        }
        let steps = report.steps.max(1) as f64;
        room.fewer = *first.get_or_insert(steps) / steps;
        room.largest = Some(number);
    }
    room
}

/// The rows as Markdown, the least room first.
pub fn courant_table(mut rooms: Vec<Room>) -> String {
    rooms.sort_by(|a, b| {
        let order = a.largest.partial_cmp(&b.largest).expect("no NaN");
        order.then(a.fails.is_empty().cmp(&b.fails.is_empty()))
    });
    let mut text = String::from(
        "| family | case | solid | holds up to | steps, times fewer | fails with |\n|---|---|---|---|---|---|\n",
    );
    for room in &rooms {
        let largest = room.largest.map_or("-".to_owned(), |number| number.to_string());
        let model = brief(&room.model);
        text += &format!(
            "| {} | {} | {model} | {largest} | {:.2} | {} |\n",
            room.family, room.case, room.fewer, room.fails
        );
    }
    text
}
