//! Remarks on units: columns of files that are hardly in metres or radians, angles that are hardly in degrees.

use super::shapes::length;
use halfstep_scene::{Column, Course, Geometry, Motion, Part, Scene, Spline};
use std::f64::consts::{PI, TAU};

/// Radians in a degree.
pub(super) const DEGREE: f64 = PI / 180.0;
/// Factors within which a scale is that of a unit, and of more or less motion than was recorded.
const ABOUT: [f64; 2] = [0.2, 5.0];
/// Of more or less motion than was recorded; beyond these a scale is that of a unit.
const LARGER_OR_SMALLER: [f64; 2] = [0.1, 10.0];
/// How near an angle is to a twelfth of pi that is meant to be one, rad.
const ROUNDED: f64 = 1e-3;

pub(super) fn about(scale: f64, unit: f64) -> bool {
    (ABOUT[0]..=ABOUT[1]).contains(&(scale / unit).abs())
}

/// The parts of a motion that files say, with their columns.
fn of_files(motion: &Motion) -> impl Iterator<Item = (&Part, &Spline, &Column)> + Clone {
    motion.parts().iter().filter_map(|part| match &part.course {
        Course::Points(spline) => Some((part, spline, spline.column()?)),
        _ => None,
    })
}

/// Words of titles of velocities and accelerations.
const RATES: [(&str, &[&str]); 2] =
    [("a velocity", &["vel", "velocity", "speed"]), ("an acceleration", &["acc", "accel", "acceleration"])];
/// Units of rates, of lengths and of angles.
const PER_SECOND: [(&str, &[&str]); 2] = [
    ("a velocity", &["m/s", "cm/s", "mm/s", "rad/s", "deg/s", "°/s"]),
    (
        "an acceleration",
        &["m/s2", "m/s^2", "m/s²", "cm/s2", "mm/s2", "rad/s2", "rad/s^2", "rad/s²", "deg/s2"],
    ),
];

/// What a title says that is neither a way nor an angle.
pub(super) fn rate(title: &str) -> Option<&'static str> {
    let title = title.to_lowercase();
    let unit = title.split(['[', ']', '(', ')', ' ', ',', '_']).map(str::trim);
    let by_unit = PER_SECOND.into_iter().find(|(_, units)| unit.clone().any(|unit| units.contains(&unit)));
    let by_word = || RATES.into_iter().find(|(_, of)| words(&title).any(|word| of.contains(&&*word)));
    by_unit.or_else(by_word).map(|(what, _)| what)
}

/// The unit of time that a title says and that is no second, with its seconds.
fn other_time(title: &str) -> Option<(&'static str, f64)> {
    let units = [("ms", 1e-3), ("µs", 1e-6), ("us", 1e-6), ("min", 60.0)];
    units.into_iter().find(|(unit, _)| words(title).any(|word| word == *unit))
}

/// A column of times in another unit: none has a scale.
pub(super) fn times(what: &str, column: &Column, [first, last]: [f64; 2], end: f64) -> Option<String> {
    let (unit, seconds) = other_time(&column.time)?;
    let remedy = match seconds < 1.0 {
        true => format!("divided by {}", 1.0 / seconds),
        false => format!("times {seconds}"),
    };
    Some(format!(
        "{what} takes the times of the column `{}`, whose title says {unit}, as seconds: they last from {} to {} s, \
         and the run {end} s (times have no `scale`: in the file they need to be {remedy})",
        column.time,
        length(first),
        length(last)
    ))
}

fn says_degrees(title: &str) -> bool {
    title.contains('°') || words(title).any(|word| word.starts_with("deg"))
}

pub(super) fn words(title: &str) -> impl Iterator<Item = String> {
    title.split(|c: char| !c.is_alphabetic()).map(str::to_lowercase)
}

/// The unit of length that a title says and that is no metre, with its metres.
fn small_unit(title: &str) -> Option<(&'static str, f64)> {
    [("mm", 1e-3), ("cm", 1e-2)].into_iter().find(|(unit, _)| words(title).any(|word| word == *unit))
}

/// Whether a column of angles in degrees is taken for one in radians.
pub(super) fn has_degrees(motion: &Motion) -> bool {
    of_files(motion).any(|(part, _, column)| {
        part.angle != 0.0 && says_degrees(&column.title) && !about(column.scale, DEGREE)
    })
}

/// Columns of recorded motions.
pub(super) fn columns(scene: &Scene, all: &mut Vec<String>) {
    let of_shapes = scene
        .shapes
        .iter()
        .filter_map(|shape| Some((format!("the motion of `{}`", shape.name), shape.motion.as_ref()?)));
    let of_frame = scene.frame.iter().map(|frame| ("`frame.motion`".to_owned(), &frame.motion));
    let mut told: Vec<&Motion> = Vec::new();
    for (name, motion) in of_frame.chain(of_shapes) {
        // Walls that move together say the same.
        if told.contains(&motion) {
            continue;
        }
        told.push(motion);
        all.extend(one_scale(&name, motion));
        let first = of_files(motion).next();
        all.extend(first.and_then(|(_, spline, column)| times(&name, column, spline.ends(), scene.end_time)));
        all.extend(
            of_files(motion).filter_map(|(part, spline, column)| of_column(&name, part, spline, column)),
        );
    }
}

/// A column of ways or angles.
fn of_column(name: &str, part: &Part, spline: &Spline, column: &Column) -> Option<String> {
    let (low, high) = spline.extent();
    let most = high.max(-low);
    let Column { title, scale, .. } = column;
    let turns = part.angle != 0.0;
    if let Some(rate) = rate(title) {
        let (goes, taken) = if turns { ("turns", "angles in rad") } else { ("goes", "ways in m") };
        return Some(format!(
            "{name} {goes} by the column `{title}`, whose title says {rate}: its numbers are taken as {taken}, up to \
             {}, and nothing integrates them",
            length(most)
        ));
    }
    if turns {
        return (says_degrees(title) && !about(*scale, DEGREE)).then(|| {
            format!(
                "{name} turns by the column `{title}`, whose title says degrees, times scale = {scale}, in radians: by \
                 up to {} rad, {:.0} degrees (scale = {DEGREE} makes radians of degrees)",
                length(most),
                most.to_degrees()
            )
        });
    }
    let (unit, metres) = small_unit(title).filter(|(_, metres)| !about(*scale, *metres))?;
    Some(format!(
        "{name} goes by the column `{title}`, whose title says {unit}, times scale = {scale}, in metres: by up to {} m \
         (scale = {metres} makes metres of {unit})",
        length(most)
    ))
}

/// A scale that makes metres or radians of the one and spoils the other.
fn one_scale(name: &str, motion: &Motion) -> Option<String> {
    let unlike = |scale: f64| !(LARGER_OR_SMALLER[0]..=LARGER_OR_SMALLER[1]).contains(&scale.abs());
    // Thousandths of both are right.
    let turns = of_files(motion).map(|(part, _, column)| (part.angle != 0.0, column));
    let mut angles = turns.clone().filter(|(turns, column)| *turns && unlike(column.scale));
    angles.find_map(|(_, angle)| {
        let milli = words(&angle.title).any(|word| word == "mrad");
        let (_, way) = turns.clone().find(|(turns, way)| {
            !turns && way.file == angle.file && way.scale == angle.scale && !milli
        })?;
        Some(format!(
            "one scale = {} in {name} is that of the lengths of `{}` and of the angles of `{}`: as a unit it fits one \
             of them (two motions that add up, `motion = [{{ file = .., columns = .., scale = .. }}, {{ .. }}]`, have \
             each its own)",
            angle.scale, way.title, angle.title
        ))
    })
}

/// Angles in degrees that are round in radians.
pub(super) fn degrees(scene: &Scene, all: &mut Vec<String>) {
    let turned = |geometry: &Geometry| match geometry {
        Geometry::Moved(moved) => moved.angle,
        _ => 0.0,
    };
    let of_shapes = scene.shapes.iter().flat_map(|shape| {
        let name = shape.name.as_str();
        [(name, "rotate.angle", turned(&shape.geometry)), (name, "lattice_angle", shape.lattice_angle)]
    });
    let of_voids =
        scene.voids.iter().map(|void| (void.name.as_str(), "rotate.angle", turned(&void.geometry)));
    for (name, key, angle) in of_shapes.chain(of_voids) {
        let twelfths = (angle / (PI / 12.0)).round();
        if twelfths == 0.0 || angle.abs() > TAU + ROUNDED || (angle - twelfths * PI / 12.0).abs() > ROUNDED {
            continue;
        }
        let meant = 15.0 * twelfths;
        all.push(format!(
            "{key} = {angle} of `{name}` is in degrees, and as radians it would be {meant} degrees: if that is meant, \
             it is {key} = {meant}"
        ));
    }
}
