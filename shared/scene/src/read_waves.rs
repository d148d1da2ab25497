//! `motion = { wave = .. }`: wave makers.

use super::motion::{Paddle, Sea, breaking_height, wave_number};
use super::read_motion::Around;
use super::section::{Range, Section};
use super::*;

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Wave {
    Regular,
    Irregular,
    Solitary,
}

pub(crate) const WAVES: [(&str, Wave); 3] =
    [("regular", Wave::Regular), ("irregular", Wave::Irregular), ("solitary", Wave::Solitary)];
/// Whether it is a flap.
pub(crate) const MAKERS: [(&str, bool); 2] = [("piston", false), ("flap", true)];
/// Sign of the way to the waves.
pub(crate) const DIRECTIONS: [(&str, f64); 2] = [("right", 1.0), ("left", -1.0)];
/// Largest angle of a flap to either side, rad.
const STEEPEST: f64 = 0.5;
/// Most waves that are added up.
pub(crate) const MAX_COMPONENTS: u32 = 1000;
/// Highest solitary wave over the depth.
const HIGHEST: f64 = 0.78;
/// Keys of wave makers beside those of regular waves.
const OTHERS: [&str; 9] =
    ["maker", "toward", "floor", "period", "ramp", "peakedness", "components", "seed", "pivot"];

/// The parts of the paddle's motion, and what it makes.
pub(super) fn waves(table: &Section<'_>, around: &Around<'_>) -> Option<(Vec<Part>, Option<WaveMaker>)> {
    let Some(wave) = table.choice("wave", None, &WAVES) else {
        // What they would have meant is not asked.
        ["height", "depth", "start"].into_iter().chain(OTHERS).for_each(|key| _ = table.node(key));
        return None;
    };
    let g = -around.gravity[1];
    let down = g > 0.0 && around.gravity[0] == 0.0;
    if !down && !table.report.has("gravity") {
        table.whole("needs a `gravity` straight down, along -y: it gives the waves their length");
    }
    let depth = table.number("depth", None);
    let start = table.number("start", Some(0.0));
    let sign = table.choice("toward", Some(1.0), &DIRECTIONS).unwrap_or(1.0);
    if wave == Wave::Solitary {
        return solitary(table, (g, depth, start, sign));
    }
    let floor = table.number("floor", Some(0.0));
    let paddle = paddle(table, around.dimension, floor, depth);
    let period = table.number("period", None);
    let ramp = table.number("ramp", Some(period));
    let usable = [g, depth, period, ramp].iter().all(|x| x.is_finite() && *x > 0.0);
    let k = if usable { wave_number(period, depth, g) } else { f64::NAN };
    let breaking = if usable { rounded(breaking_height(k, depth)) } else { f64::MAX };
    let sea = (wave == Wave::Irregular).then(|| Sea {
        height: 0.0,
        period,
        peakedness: table.number("peakedness", Some(3.3)),
        components: table.integer("components", 64),
        seed: table.integer("seed", 1),
    });
    let range = match wave {
        Wave::Regular => Range::positive()
            .up_to(breaking)
            .why("beyond 0.142 L tanh kd waves of this period break in this depth (Miche 1944)"),
        _ => Range::positive().up_to(rounded(0.5 * breaking)).why(
            "single waves are up to twice as high, and those of this period break beyond 0.142 L tanh kd (Miche 1944)",
        ),
    };
    let height = table.number_within("height", None, range);
    if !usable || !height.is_finite() {
        return None;
    }
    let paddle = paddle?;
    // Displacement at the level of the water over a wave's amplitude, toward the waves; a flap turns by it over the
    // distance between hinge and water.
    let by_amplitude = |period| 1.0 / paddle.height_by_stroke(wave_number(period, depth, g), depth);
    let (translation, angle) = match paddle {
        Paddle::Piston => (sign, 0.0),
        Paddle::Flap(hinge) => (0.0, -sign / (depth - hinge)),
    };
    let part = |(amplitude, period, phase): (f64, f64, f64)| {
        let way = amplitude * by_amplitude(period);
        let course = Course::Sine { period, phase, start, ramp };
        Part { course, translation: [translation * way, 0.0, 0.0], angle: angle * way }
    };
    let parts: Vec<Part> = match sea {
        None => vec![part((0.5 * height, period, 0.0))],
        Some(sea) => {
            let waves = Sea { height, ..sea }.waves();
            waves.into_iter().map(|wave| part((wave.amplitude, wave.period, wave.phase))).collect()
        }
    };
    let reach = reach(&parts, (start, ramp, period), around.end_time).map(|way| match paddle {
        Paddle::Piston => way,
        Paddle::Flap(hinge) => way * (depth - hinge),
    });
    if let Paddle::Flap(hinge) = paddle
        && let most = reach[0].max(reach[1]) / (depth - hinge)
        && most > STEEPEST
    {
        table.whole(format!(
            "turns the flap by {most:.2} rad: at most {STEEPEST}, beyond which linear theory means nothing; lower the \
             hinge or the `height`"
        ));
    }
    let stroke = reach[0] + reach[1];
    Some((parts, Some(WaveMaker { height, depth, floor, stroke, reach, end: None })))
}

/// To four digits, as it is told.
fn rounded(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// What the paddle is; `None` where its hinge is wrong.
fn paddle(table: &Section<'_>, dimension: usize, floor: f64, depth: f64) -> Option<Paddle> {
    let flap = table.choice("maker", Some(false), &MAKERS).unwrap_or(false);
    let pivot = table.node("pivot");
    if !flap {
        if let Some(node) = pivot {
            table.wrong("pivot", node, "only a `flap` has a hinge");
        }
        return Some(Paddle::Piston);
    }
    let Some(node) = pivot else {
        table.missing("pivot");
        return None;
    };
    let hinge = table.as_vector("pivot", node, dimension)?[1] - floor;
    if hinge > 0.9 * depth {
        let reason = format!(
            "must be at most 0.9 depths above the floor, at y = {}: above, a flap moves next to no water",
            (floor + 0.9 * depth) as f32
        );
        table.wrong("pivot", node, reason);
        return None;
    }
    hinge.is_finite().then_some(Paddle::Flap(hinge))
}

/// Largest sums of the parts' displacements or angles toward the waves and away from them until the end of the run.
fn reach(parts: &[Part], (start, ramp, period): (f64, f64, f64), end_time: f64) -> [f64; 2] {
    // A regular wave repeats; of irregular ones no more than a million instants are looked at.
    let least = if parts.len() == 1 { ramp + 2.0 * period } else { end_time - start };
    let (step, span) = (period / 100.0, least.min(end_time - start));
    let instants = (span / step).clamp(0.0, 1e6).ceil() as u32;
    let composed = Composed { pivot: None, parts: parts.to_vec(), makes: None };
    let way = |n: u32| composed.ways(start + step * f64::from(n));
    let sign =
        parts.first().map_or(1.0, |p| if p.angle == 0.0 { p.translation[0] } else { p.angle }).signum();
    let ways = (0..=instants).map(|n| sign * way(n));
    let (low, high) = ways.fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    [high, -low]
}

fn solitary(
    table: &Section<'_>,
    (g, depth, start, sign): (f64, f64, f64, f64),
) -> Option<(Vec<Part>, Option<WaveMaker>)> {
    for key in OTHERS.into_iter().filter(|key| *key != "toward" && *key != "maker") {
        if let Some(node) = table.node(key) {
            table.wrong(
                key,
                node,
                "a solitary wave has none: its height and the depth give its piston's motion",
            );
        }
    }
    if let Some(node) = table.node("maker") {
        _ = table.as_choice("maker", node, &[("piston", ())]);
    }
    let most = if depth > 0.0 { rounded(HIGHEST * depth) } else { f64::MAX };
    let range = Range::positive().up_to(most).why("a solitary wave breaks beyond 0.78 depths (McCowan 1894)");
    let height = table.number_within("height", None, range);
    if !(g > 0.0 && height.is_finite() && depth.is_finite()) {
        return None;
    }
    let wave = Solitary::new(height, depth, g, start);
    let (stroke, end) = (wave.stroke(), start + wave.duration());
    let part = Part { course: Course::Solitary(wave), translation: [sign, 0.0, 0.0], angle: 0.0 };
    let makes = WaveMaker { height, depth, floor: 0.0, stroke, reach: [stroke, 0.0], end: Some(end) };
    Some((vec![part], Some(makes)))
}
