//! What the last frames of a run say of how it ended.

use halfstep_output::series::Series;
use halfstep_output::{Frame, OutputError, RunReport, vtkhdf};
use halfstep_scene::{Fluid, Phase, Scene, geometry};
use halfstep_wire::frame;
use std::path::Path;

/// Tension that counts, over rho c0²: a tenth of the pressure that the fastest expected fluid has where it is stopped.
/// Near free surfaces there is always some less.
const TENSION: f64 = 1e-3;

/// Notes in the report which part of the fluid is under tension at the end, and how many particles of each solid are
/// outside of the domain; nothing of participants without frames.
///
/// # Errors
/// A frame cannot be read.
pub(crate) fn note(scene: &Scene, dir: &Path, report: &mut RunReport) -> Result<(), OutputError> {
    let domain = geometry::domain(scene);
    for participant in scene.participants() {
        let Some((path, _)) = Series::of_run(dir, &participant.name)?.pop() else { continue };
        let last = vtkhdf::read(&path)?;
        match (participant.phase, &scene.fluid) {
            (Phase::Fluid, Some(fluid)) => report.audit.tension = tension(fluid, &last),
            _ => {
                let own = report.participants.iter_mut().find(|own| own.name == participant.name);
                // Scenes are in the plane.
                let outside =
                    |x: &&[f32; 3]| !geometry::holds(&domain, &[f64::from(x[0]), f64::from(x[1])], 0.0);
                own.into_iter()
                    .for_each(|own| own.outside = last.points.iter().filter(outside).count() as u64);
            }
        }
    }
    Ok(())
}

/// Part of the fluid's particles whose pressure, less the background's, is tension; `None` where there are none.
fn tension(fluid: &Fluid, last: &Frame) -> Option<f64> {
    let limit = fluid.background_pressure - TENSION * fluid.density * fluid.sound_speed.powi(2);
    let own = || last.phase.iter().zip(&last.pressure).filter(|(phase, _)| **phase == frame::FLUID);
    let drawn = own().filter(|(_, pressure)| f64::from(**pressure) < limit).count();
    let count = own().count();
    (count > 0).then(|| drawn as f64 / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_output::run_json::ParticipantReport;
    use halfstep_output::{FramePoint, FrameWriter};

    /// rho c0² is 4e5 Pa, so that tension counts from 400 Pa on. The shapes are 1.2 m by 0.5 m: the domain is thrice as
    /// large.
    #[test]
    fn tension_and_what_has_left() {
        let text = "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\nsound_speed = 20.0\n[solid]\n\
                    model = \"rigid\"\ndensity = 500.0\n[[shape]]\nname = \"water\"\nphase = \"fluid\"\n\
                    box = { min = [0.0, 0.0], max = [1.0, 0.5] }\n[[shape]]\nname = \"block\"\nphase = \"solid\"\n\
                    box = { min = [1.0, 0.0], max = [1.2, 0.5] }\n";
        let scene = halfstep_scene::parse(text, "x.toml".as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, points: &[([f64; 3], f64, Phase)]| {
            let mut writer = FrameWriter::start(folder.path(), name).unwrap();
            let fill = |frame: &mut Frame| {
                frame.clear();
                for (id, &(position, pressure, phase)) in points.iter().enumerate() {
                    let (velocity, stress, id) = ([0.0; 3], [0.0; 6], id as u32);
                    frame.push(FramePoint {
                        position,
                        velocity,
                        density: 1000.0,
                        pressure,
                        stress,
                        phase,
                        id,
                    });
                }
            };
            writer.submit(0, fill).unwrap();
            writer.wait().unwrap();
        };
        let drop = |pressure| ([0.5, 0.2, 0.0], pressure, Phase::Fluid);
        // Walls do not count.
        let wall = ([0.5, -0.1, 0.0], -1e4, Phase::Wall);
        write("fluid", &[drop(-500.0), drop(-300.0), drop(0.0), drop(900.0), wall]);
        let at = |x, y| ([x, y, 0.0], 0.0, Phase::Solid);
        write("solid", &[at(1.1, 0.3), at(2.3, 0.3), at(2.5, 0.3), at(1.1, -0.6)]);
        let solid = ParticipantReport { name: "solid".into(), ..ParticipantReport::default() };
        let mut report = RunReport { participants: vec![solid], ..RunReport::default() };
        note(&scene, folder.path(), &mut report).unwrap();
        assert_eq!(report.audit.tension, Some(0.25));
        assert_eq!(report.participants[0].outside, 2);
    }

    #[test]
    fn a_run_without_frames_says_nothing() {
        let text = "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
                    phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [1.0, 0.5] }\n";
        let scene = halfstep_scene::parse(text, "x.toml".as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let mut report = RunReport::default();
        note(&scene, tempfile::tempdir().unwrap().path(), &mut report).unwrap();
        assert_eq!(report, RunReport::default());
    }
}
