//! A fluid that nobody exchanges anything with, step by step.

use halfstep_fluid::Fluid;
use halfstep_output::Frame;
use halfstep_role::role::Role;
use halfstep_scene as scene;
use halfstep_sph::lane::Isa;
use halfstep_wire::frame::FLUID;
use halfstep_wire::half_step::{HalfStep, Stage};
use std::path::Path;

/// Goes on from 0 s to a time, s; calls `see` after each step with its number, from 1 on, and the time reached.
///
/// # Panics
/// A quantity leaves its bounds.
pub fn go_on(fluid: &mut Fluid<2>, until: f64, mut see: impl FnMut(&mut Fluid<2>, u64, f64)) {
    let (mut t, mut step, mut record) = (0.0, 0, Vec::new());
    while t < until {
        fluid.set_time(t);
        fluid.publish(&[], &mut record);
        let dt = fluid.dt_limit().min(until - t);
        for half_step in HalfStep::begin(step, t).lasting(dt).both() {
            if half_step.stage == Stage::Second {
                fluid.set_time(half_step.before());
                fluid.publish(&[], &mut record);
            }
            fluid.own_sums();
            fluid.advance(&half_step, &[]).expect("within bounds");
        }
        t += dt;
        step += 1;
        see(fluid, step, t);
    }
    fluid.set_time(t);
}

/// Runs the fluid of a scene's text to a time, s, and returns it with its last frame.
///
/// # Panics
/// The text is no scene with a fluid, or a quantity leaves its bounds.
pub fn run_to(text: &str, until: f64) -> (Fluid<2>, Frame) {
    let scene = scene::parse(text, Path::new("fluid.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let mut fluid = Fluid::<2>::new(&scene, Isa::detect()).expect("a scene with fluid");
    let mut reached = 0.0;
    go_on(&mut fluid, until, |_, _, t| reached = t);
    let mut frame = Frame::default();
    fluid.fill_frame(reached, &mut frame);
    (fluid, frame)
}

/// Mean over the fluid's particles of what is said of a place, m, and a velocity, m/s; of those that count.
pub fn mean_of(frame: &Frame, what: impl Fn([f64; 2], [f64; 2]) -> Option<f64>) -> f64 {
    let wide = |v: &[f32; 3]| [f64::from(v[0]), f64::from(v[1])];
    let all = frame.points.iter().zip(&frame.velocity).zip(&frame.phase);
    let fluid = all.filter(|(_, phase)| **phase == FLUID);
    let counted: Vec<f64> = fluid.filter_map(|((x, v), _)| what(wide(x), wide(v))).collect();
    counted.iter().sum::<f64>() / counted.len() as f64
}
