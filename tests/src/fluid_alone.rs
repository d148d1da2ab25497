//! A fluid that nobody exchanges anything with, step by step.

use halfstep_fluid::Fluid;
use halfstep_role::role::Role;
use halfstep_wire::half_step::{HalfStep, Stage};

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
