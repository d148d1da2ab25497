//! The command line of `halfstep fake-fluid`.

use crate::{SceneArguments, external_solids, load, usage};
use halfstep::fake_fluid::{self, Load, Trial, Tried};
use halfstep::options::SolidSource;
use halfstep_coupling::error::RunError;
use halfstep_coupling::say;
use halfstep_coupling::supervise::StopFlags;
use halfstep_output::OutputError;
use halfstep_scene::{Block, Scene};
use std::path::PathBuf;
use std::process::ExitCode;

/// Pushes a solid of your own with a known load, so that it can be tried without water
#[derive(clap::Args)]
pub(crate) struct FakeFluidArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// The solid: a command that speaks the protocol; with several solids NAME=COMMAND
    #[arg(long, value_name = "[NAME=]COMMAND")]
    solid: String,
    /// The whole force, N (2D: N/m): FX,FY or FX,FY,FZ (default: none, so what the scene does to the solid without
    /// water)
    #[arg(long, value_name = "N,N", value_parser = vector, allow_hyphen_values = true)]
    force: Option<[f64; 3]>,
    /// Only on the particles that begin in this box, m: XMIN,YMIN,XMAX,YMAX (default: on all)
    #[arg(long, value_name = "M,M,M,M", value_parser = block, allow_hyphen_values = true, requires = "force")]
    within: Option<Block>,
    /// Time in which the force grows from zero, s
    #[arg(long, value_name = "SECONDS", value_parser = crate::arguments::seconds, requires = "force")]
    ramp: Option<f64>,
    /// Time step, s (default: what sound in the scene's water takes for a fifth of a particle, without water what
    /// is stable for the model that the scene names); the solid may take less
    #[arg(long, value_name = "SECONDS", value_parser = crate::arguments::seconds)]
    time_step: Option<f64>,
    /// Folder of the trial (default: out/fake-fluid-SCENE); files of an earlier trial in it are replaced
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replaces the files of a run in that folder, too
    #[arg(long)]
    replace: bool,
    /// How long the solid may be silent, s
    #[arg(long, value_name = "SECONDS", default_value_t = 600.0, value_parser = crate::arguments::seconds)]
    patience: f64,
    /// `study` or `compare` made the trial, and may replace it
    #[arg(long, hide = true)]
    by_study: bool,
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let number = |part: &str| match part.trim().parse::<f64>() {
        Ok(x) if x.abs() <= 1e12 => Ok(x),
        _ => Err(format!("`{part}` is no number of at most 1e12")),
    };
    text.split(',').map(number).collect()
}

fn vector(text: &str) -> Result<[f64; 3], String> {
    match *numbers(text)?.as_slice() {
        [x, y] => Ok([x, y, 0.0]),
        [x, y, z] => Ok([x, y, z]),
        _ => Err("must be two or three numbers with commas between".into()),
    }
}

fn block(text: &str) -> Result<Block, String> {
    let found = match *numbers(text)?.as_slice() {
        [a, b, c, d] => Block { min: [a, b, 0.0], max: [c, d, 0.0] },
        [a, b, c, d, e, f] => Block { min: [a, b, c], max: [d, e, f] },
        _ => return Err("must be four numbers (six in three dimensions) with commas between".into()),
    };
    match (0..3).all(|axis| found.min[axis] <= found.max[axis]) {
        true => Ok(found),
        false => Err("the lowest corner comes first".into()),
    }
}

/// Runs the trial and says what the solid did.
pub(crate) fn try_solid(arguments: FakeFluidArguments) -> ExitCode {
    let scene = match load(&arguments.scene) {
        Ok(scene) => scene,
        Err(code) => return code,
    };
    let trial = match trial(&scene, arguments) {
        Ok(trial) => trial,
        Err(error) => return usage(&error),
    };
    fake_fluid::clean_up();
    match fake_fluid::run(&scene, &trial) {
        Ok(tried) => {
            say::tell(format_args!("{}", text(&tried, &trial).trim_end()));
            ExitCode::from(if trial.stop.stop.load(std::sync::atomic::Ordering::Relaxed) { 130 } else { 0 })
        }
        // Nothing was tried, and the log there is another run's.
        Err(RunError::Output(error @ (OutputError::HoldsRun { .. } | OutputError::InUse { .. }))) => {
            usage(&error.to_string())
        }
        Err(error) if error.is_stop() => {
            say::warn(format_args!("{error}"));
            ExitCode::from(130)
        }
        Err(error) => {
            let log = trial.out.join("log.txt");
            say::warn(format_args!("error: {error}"));
            if log.exists() {
                say::warn(format_args!("the log has more: {}", log.display()));
            }
            ExitCode::from(2)
        }
    }
}

fn trial(scene: &Scene, arguments: FakeFluidArguments) -> Result<Trial, String> {
    let mut external = external_solids(scene, std::slice::from_ref(&arguments.solid), &[])?;
    let Some((solid, SolidSource::Command(command))) = external.pop() else {
        return Err("--solid needs a command".into());
    };
    if scene.dimension == 2 && arguments.force.is_some_and(|force| force[2] != 0.0) {
        return Err(format!("--force: {} is two-dimensional, its force has no third component", scene.name));
    }
    let time_step = match arguments.time_step.or(of_sound(scene)) {
        Some(dt) => dt,
        None => of_model(scene, solid.as_str())?,
    };
    let out = PathBuf::from("out").join(format!("fake-fluid-{}", scene.name));
    Ok(Trial {
        solid,
        command,
        load: Load {
            force: arguments.force.unwrap_or_default(),
            within: arguments.within,
            ramp: arguments.ramp.unwrap_or(0.0),
        },
        time_step,
        out: arguments.out.unwrap_or(out),
        replace: arguments.replace,
        patience: arguments.patience,
        by_study: arguments.by_study,
        stop: StopFlags::of_signals().map_err(|e| format!("cannot watch for signals: {e}"))?,
    })
}

/// What sound takes in the scene's water for a fifth of a particle, s; `None` without water.
fn of_sound(scene: &Scene) -> Option<f64> {
    scene.fluid.as_ref().map(|fluid| 0.2 * scene.resolution / fluid.sound_speed)
}

/// The stable step of the model that the scene names for a solid, s.
fn of_model(scene: &Scene, solid: &str) -> Result<f64, String> {
    let isa = halfstep::isa::of_environment().map_err(|e| e.to_string())?;
    let index = scene.solids.iter().position(|own| own.name == solid).unwrap_or_default();
    let known = halfstep::check::check(scene, isa).and_then(|check| check.stable_step(index));
    known.ok_or_else(|| "a scene without [fluid] needs --time-step".into())
}

/// What the solid did: of each probe component its ends and its range.
fn text(tried: &Tried, trial: &Trial) -> String {
    let [all, pushed] = tried.particles;
    let mut text = format!(
        "{} steps to t = {} s; the load is on {pushed} of {all} particles\n\
         a half-step of the solid takes {:.0} µs (median; one in a hundred more than {:.0})\n",
        tried.steps, tried.time, tried.half_step_us.p50, tried.half_step_us.p99
    );
    for header in &tried.probes.columns[1..] {
        let Some(values) = tried.probes.column(header) else { continue };
        let known = || values.iter().copied().filter(|x| x.is_finite());
        let (low, high) = known().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        if let (true, Some(last)) = (low <= high, values.last()) {
            text += &format!("{header:24} {low:12.5e} to {high:12.5e}, at the end {last:12.5e}\n");
        }
    }
    text + &format!("probes.csv, run.json and log.txt are in {}", trial.out.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_are_vectors_in_boxes() {
        assert_eq!(vector("1,-2.5"), Ok([1.0, -2.5, 0.0]));
        assert_eq!(vector("1, 2, 3"), Ok([1.0, 2.0, 3.0]));
        for wrong in ["", "1", "1,2,3,4", "1,x", "nan,0", "inf,0"] {
            assert!(vector(wrong).is_err(), "{wrong}");
        }
        let found = block("0,1,2,3").unwrap();
        assert_eq!((found.min, found.max), ([0.0, 1.0, 0.0], [2.0, 3.0, 0.0]));
        assert!(block("2,0,1,3").is_err() && block("1,2,3").is_err());
    }
}
