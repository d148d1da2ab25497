//! A frame that moves, beside the rest of the scene.

use super::check::Check;
use super::*;

/// Part of the fastest velocity that a record may lack of rest at its ends.
const JUMP: f64 = 0.05;

impl Check<'_> {
    /// What gravity that changes would make wrong is refused, and what no acceleration says, too.
    pub(super) fn frame(&self) {
        let Some(Frame { motion }) = &self.scene.frame else { return };
        if self.report.has_any(&["frame", "end_time"]) {
            return;
        }
        if motion.makes().is_some() {
            return self.place("frame.motion", "a frame makes no waves: `wave` belongs to a wall");
        }
        if let Some((time, speed)) = jump(motion, self.scene.end_time) {
            let reason = format!(
                "the frame jumps to another velocity at {time} s, by {speed:.3} m/s, which no acceleration says: it \
                 needs a `ramp`, or a series that begins and ends at rest"
            );
            return self.place("frame.motion", reason);
        }
        let makers = self.scene.shapes.iter().enumerate();
        for (index, _) in makers.filter(|(_, s)| s.motion.as_ref().is_some_and(|m| m.makes().is_some())) {
            let reason = "makes waves whose length `gravity` gives, and `frame` changes it";
            self.place(&format!("{}.motion", self.shape_key(index)), reason);
        }
        for probe in self.scene.probes.iter().filter(|p| matches!(p.kind, ProbeKind::Energy { .. })) {
            let reason =
                "the energy ledger counts a potential energy, and gravity that `frame` changes has none";
            self.wrong(&format!("probe.{}.kind", probe.name), reason);
        }
    }
}

/// When the frame first jumps to another velocity after the start and before the end, s, and by how much, m/s. At the
/// start all that is at rest goes along.
fn jump(motion: &Motion, end_time: f64) -> Option<(f64, f64)> {
    let mut instants: Vec<f64> = match motion {
        Motion::Steady { start, end, .. } => vec![*start, *end],
        Motion::Oscillating { start, .. } => vec![*start],
        Motion::Composed(composed) => composed.parts.iter().flat_map(|part| part.course.ends()).collect(),
    };
    instants.retain(|&t| t > 0.0 && t < end_time);
    instants.sort_by(f64::total_cmp);
    instants.into_iter().find_map(|t| {
        let [before, after] = [-1e-9, 1e-9].map(|part| motion.at(t * (1.0 + part)));
        let change = (0..3).map(|d| (after.velocity[d] - before.velocity[d]).powi(2)).sum::<f64>().sqrt();
        let fastest = motion.fastest(&Block { min: [0.0; 3], max: [0.0; 3] });
        (change > JUMP * fastest).then_some((t, change))
    })
}
