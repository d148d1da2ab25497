//! A scene with one phase: the same role, clock and writer in one process, no exchange.

use crate::clock::{Clock, Limit};
use crate::error::RunError;
use crate::recorder::{Measured, Recorder};
use halfstep_output::FrameWriter;
use halfstep_output::run_json::RoleSeconds;
use halfstep_role::role::{Costs, Role};
use halfstep_wire::failure::RoleName;
use halfstep_wire::half_step::Stage;
use halfstep_wire::protocol::MAX_PROBE_VALUES;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// How a run without partner went.
#[derive(Clone, Copy, Debug)]
pub struct SoloOutcome {
    /// It was told to stop before its end.
    pub stopped: bool,
    /// Hash of the final state.
    pub state_hash: u64,
    /// Where the time went.
    pub seconds: RoleSeconds,
    /// What the effects took of it, s.
    pub costs: Costs,
    /// See [`Role::pair_evaluations`].
    pub pair_evaluations: u64,
}

/// Runs a role to the clock's end or until `stop`.
///
/// # Errors
/// Divergence or output; the last state before a divergence is written as a frame first.
pub fn run_solo(
    role: &mut dyn Role,
    clock: &mut Clock,
    writer: &mut FrameWriter,
    recorder: &mut Recorder,
    stop: &AtomicBool,
) -> Result<SoloOutcome, RunError> {
    let mut frame = 0;
    let mut probes = [0.0; MAX_PROBE_VALUES];
    let mut scratch = Vec::new();
    let mut seconds = RoleSeconds::default();
    let mut in_sums = 0.0;
    loop {
        let start = Instant::now();
        let stopped = stop.load(Ordering::Relaxed);
        role.set_time(clock.time());
        role.publish(&[], &mut scratch);
        let sums = role.audit();
        let of = |name| (role.name() == name).then_some(&sums);
        let grown = recorder.judge(clock.step(), clock.time(), of(RoleName::Fluid), of(RoleName::Solid), 0.0);
        // Energy from nowhere ends the run in order, with its last state on disk.
        let stop = stopped || grown.is_some();
        let tick = clock.tick(&[Limit { role: role.name(), dt: role.dt_limit() }], stop)?;
        let n = role.probes(&mut probes);
        let measured = Measured {
            probes: &probes[..n],
            audit: &sums,
            sub_steps: role.sub_steps(),
            particles: role.particles(),
        };
        let mut notes = [None, None];
        notes[usize::from(role.name() == RoleName::Solid)] = Some(measured);
        let [fluid, solid] = notes;
        recorder.note(&tick, fluid, solid)?;
        // What walls show belongs to the state at n once the sums are there: frames come after them.
        let summed = Instant::now();
        role.own_sums();
        in_sums += summed.elapsed().as_secs_f64();
        let computed = Instant::now();
        seconds.compute += (computed - start).as_secs_f64();
        if tick.frame {
            writer.submit(frame, |f| role.fill_frame(tick.time, f))?;
            frame += 1;
        }
        let written = Instant::now();
        seconds.output += (written - computed).as_secs_f64();
        if let Some(diverged) = grown {
            return Err(diverged.into());
        }
        if tick.dt.is_none() {
            return Ok(SoloOutcome {
                stopped,
                state_hash: role.state_hash(),
                seconds,
                costs: role.costs().of(in_sums, seconds.compute),
                pair_evaluations: role.pair_evaluations(),
            });
        }
        for half_step in tick.half_step().both() {
            if half_step.stage == Stage::Second {
                role.set_time(half_step.before());
                role.publish(&[], &mut scratch);
                let start = Instant::now();
                role.own_sums();
                in_sums += start.elapsed().as_secs_f64();
            }
            if let Err(diverged) = role.advance(&half_step, &[]) {
                if let Err(error) = writer.submit(frame, |f| role.fill_frame(half_step.after(), f)) {
                    tracing::warn!("the last frame could not be written: {error}");
                }
                return Err(diverged.into());
            }
        }
        clock.advance(&tick);
        seconds.compute += written.elapsed().as_secs_f64();
    }
}
