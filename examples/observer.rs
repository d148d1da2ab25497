//! An observer that plots: it sees every step, ends the run when it has seen enough, and draws what it saw.

use halfstep::{Error, Simulation};
use plotters::prelude::*;
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::path::Path;
use std::rc::Rc;

/// Steps after which it has seen enough.
const STEPS: u64 = 400;

/// Time, s, and level at the right wall, m, of a dam break until the observer ends it.
fn watch() -> Result<Vec<(f64, f64)>, Error> {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/dam-break.toml");
    let seen = Rc::new(RefCell::new(Vec::new()));
    let own = Rc::clone(&seen);
    Simulation::load(scene, &[])?
        .observe(move |run| {
            let front = run.probe("front.x").unwrap_or(f64::NAN);
            own.borrow_mut().push((run.time(), front));
            if run.steps() < STEPS { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        })
        .run()?;
    Ok(Rc::try_unwrap(seen).map(RefCell::into_inner).unwrap_or_default())
}

fn draw(path: &Path, points: &[(f64, f64)]) -> Result<(), Box<dyn std::error::Error>> {
    let end = points.last().map_or(1.0, |point| point.0);
    let largest = points.iter().map(|point| point.1).fold(0.0, f64::max);
    let area = SVGBackend::new(path, (640, 400)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(12)
        .x_label_area_size(36)
        .y_label_area_size(56)
        .build_cartesian_2d(0.0..end, 0.0..1.05 * largest)?;
    chart.configure_mesh().x_desc("t [s]").y_desc("front [m]").draw()?;
    chart.draw_series(LineSeries::new(points.iter().copied(), BLUE.stroke_width(2)))?;
    area.present()?;
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = Path::new("front.svg");
    draw(path, &watch()?)?;
    println!("the front over time: {}", path.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_sees_the_front_advance_until_it_has_seen_enough() {
        let seen = watch().unwrap();
        assert_eq!(seen.len() as u64, STEPS);
        assert!(seen.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert!(seen[STEPS as usize - 1].1 > seen[0].1);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("front.svg");
        draw(&path, &seen).unwrap();
        assert!(std::fs::read_to_string(path).unwrap().contains("<svg"));
    }
}
