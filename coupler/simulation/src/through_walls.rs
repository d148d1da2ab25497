//! Solids in walls that do not stop them, by the frames of a run.

use halfstep_output::series::Series;
use halfstep_output::{Frame, OutputError, vtkhdf};
use halfstep_scene::{Block, Geometry, Phase, Scene, Shape, TankSide, geometry};
use std::path::Path;

/// Most frames that are looked at.
const FRAMES: usize = 40;
/// Depth from which on a particle is in a wall, in spacings: at its surface some are pressed into it a little.
const DEEP: f64 = 1.0;

/// What to say of solids that are in a wall which they did not begin in; of walls that turn nothing is.
///
/// # Errors
/// A frame cannot be read.
pub(crate) fn through_walls(scene: &Scene, dir: &Path) -> Result<Vec<String>, OutputError> {
    let turns = |wall: &Shape| wall.motion.as_ref().is_some_and(|motion| motion.pivot().is_some());
    let open = |wall: &&Shape| wall.phase == Phase::Wall && !wall.contact && !turns(wall);
    let walls: Vec<&Shape> = scene.shapes.iter().filter(open).collect();
    let mut all = Vec::new();
    // Scenes are in the plane.
    if walls.is_empty() || scene.dimension != 2 {
        return Ok(all);
    }
    for participant in scene.participants().iter().filter(|own| own.phase == Phase::Solid) {
        let frames = Series::of_run(dir, &participant.name)?;
        let every = frames.len().div_ceil(FRAMES).max(1);
        let looked_at = frames.iter().rev().step_by(every).rev();
        let mut left = walls.clone();
        for (path, time) in looked_at {
            if left.is_empty() {
                break;
            }
            let frame = vtkhdf::read(path)?;
            left.retain(|wall| {
                let inside = is_entered(&frame, wall, *time, DEEP * scene.resolution);
                if inside {
                    all.push(format!(
                        "the {} is in the wall `{}` at {} s: nothing holds them apart, since `contact` of `{}` is \
                         false (walls that do not say it stop only bodies that neither a clamp nor a joint holds)",
                        participant.name, wall.name, *time as f32, wall.name
                    ));
                }
                !inside
            });
        }
    }
    Ok(all)
}

/// Whether a particle is so deep in a wall in which it did not begin.
fn is_entered(frame: &Frame, wall: &Shape, time: f64, deep: f64) -> bool {
    let moved = wall.motion.as_ref().map_or([0.0; 3], |motion| motion.at(time).displacement);
    frame.points.iter().zip(&frame.displacement).any(|(x, way)| {
        let now = [0, 1].map(|d| f64::from(x[d]) - moved[d]);
        let first = [0, 1].map(|d| f64::from(x[d]) - f64::from(way[d]));
        is_in(&wall.geometry, now, deep) && !is_in(&wall.geometry, first, 0.0)
    })
}

/// Whether a place is so deep in a wall; in a tank's, or beyond one of its closed sides.
fn is_in(geometry: &Geometry, at: [f64; 2], deep: f64) -> bool {
    match geometry {
        Geometry::Tank { cavity, open } => {
            let beyond = |by: f64| sides(cavity, at).filter(move |(_, out)| *out > by);
            beyond(deep).next().is_some() && beyond(0.0).all(|(side, _)| !open.contains(&side))
        }
        _ => [[0.0; 2], [deep, 0.0], [-deep, 0.0], [0.0, deep], [0.0, -deep]]
            .iter()
            .all(|by| geometry::distance(geometry, &[at[0] + by[0], at[1] + by[1], 0.0]) == 0.0),
    }
}

/// How far a place lies beyond each side of a box, m.
fn sides(cavity: &Block, at: [f64; 2]) -> impl Iterator<Item = (TankSide, f64)> {
    let (min, max) = (cavity.min, cavity.max);
    (0..2).flat_map(move |a| {
        let [low, high] = geometry::sides(a);
        [(low, min[a] - at[a]), (high, at[a] - max[a])]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_output::{FramePoint, FrameWriter};

    const SCENE: &str = "resolution = 0.1\nend_time = 1.0\n\
        [solid]\ndensity = 1000.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n\
        [[shape]]\nname = \"plate\"\nphase = \"solid\"\nbox = { min = [0.4, -0.3], max = [0.6, 1.0] }\n\
        clamp = { min = [0.4, -0.3], max = [0.6, 0.0] }\n\
        [[shape]]\nname = \"stop\"\nphase = \"wall\"\nbox = { min = [1.0, 0.5], max = [1.5, 1.0] }\n\
        [[shape]]\nname = \"tank\"\nphase = \"wall\"\ntank = { min = [0.0, 0.0], max = [2.0, 1.0], open = [\"top\"] }\n";

    /// What is said of a plate one of whose particles is at places one after the other, 0.1 s apart, and another in its
    /// clamp.
    fn of(tip: &[[f64; 2]]) -> Vec<String> {
        let scene = halfstep_scene::parse(SCENE, "x.toml".as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let folder = tempfile::tempdir().unwrap();
        let mut writer = FrameWriter::start(folder.path(), "solid").unwrap();
        for (k, at) in tip.iter().enumerate() {
            let fill = |frame: &mut Frame| {
                frame.clear();
                frame.time = 0.1 * k as f64;
                for (id, position) in [[at[0], at[1], 0.0], [0.5, -0.2, 0.0]].into_iter().enumerate() {
                    let (velocity, stress, phase) = ([0.0; 3], [0.0; 6], Phase::Solid);
                    let (density, pressure, id) = (1000.0, 0.0, id as u32);
                    frame.push(FramePoint { position, velocity, density, pressure, stress, phase, id });
                }
                let first = [[0.55, 0.95], [0.5, -0.2]];
                frame.displacement = (frame.points.iter().zip(first))
                    .map(|(x, first)| [x[0] - first[0] as f32, x[1] - first[1] as f32, 0.0])
                    .collect();
            };
            writer.submit(k as u32, fill).unwrap();
        }
        writer.wait().unwrap();
        through_walls(&scene, folder.path()).unwrap()
    }

    #[test]
    fn a_plate_that_bends_into_walls() {
        let bent = of(&[[0.55, 0.95], [0.9, 0.8], [1.2, 0.7], [1.3, 0.65]]);
        assert_eq!(bent.len(), 1, "{bent:?}");
        assert!(
            bent[0].starts_with("the solid is in the wall `stop` at 0.2 s: nothing holds them apart"),
            "{bent:?}"
        );
        let fallen = of(&[[0.55, 0.95], [0.6, -0.2]]);
        assert!(fallen.len() == 1 && fallen[0].contains("in the wall `tank` at 0.1 s"), "{fallen:?}");
        // At the stop's face, half a spacing in it; over the rim, which is open.
        assert!(of(&[[0.55, 0.95], [1.05, 0.7]]).is_empty());
        assert!(of(&[[0.55, 0.95], [-0.3, 1.2]]).is_empty());
    }
}
