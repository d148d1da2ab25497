//! `run.json`: what a run was and how it went.

mod energy;
mod forces;

pub use energy::{EnergyReport, InterfaceEnergy, LargestEnergy, ParticipantEnergy};
pub use forces::{ContactReport, ForceKind, ForceReport, WALLS};

use super::{FirstMessage, OutputError, atomic};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The report of a run. What is not known yet is `null`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RunReport {
    /// How the run ended; `None` while it goes on, and for ever when it was killed.
    pub status: Option<RunStatus>,
    /// Why it did not finish.
    pub error: Option<String>,
    /// What the author of the scene, or the reader of its results, should know.
    pub warnings: Vec<String>,
    /// Those of them that the end of the run has shown; the file has them among the others.
    #[serde(skip)]
    pub warnings_at_end: Vec<String>,
    /// The scene as resolved.
    pub scene: serde_json::Value,
    /// The shapes as asked and as computed, as `halfstep check --json` lists them.
    pub shapes: Vec<serde_json::Value>,
    /// Version of the program.
    pub version: String,
    /// `halfstep study` or `compare` made the run, and may replace it; `null` of a program that did not say it yet.
    pub by_study: Option<bool>,
    /// Where the run went on after interruptions, in their order.
    pub resumed: Vec<Resumption>,
    /// Steps done.
    pub steps: u64,
    /// Simulated time reached, s.
    pub time: f64,
    /// Duration of the run, s.
    pub wall_seconds: f64,
    /// Numbers of particles.
    pub particles: Particles,
    /// Particles that move or deform (fluid and solid) times steps, over `wall_seconds`, 1/s.
    pub particle_steps_per_second: Option<f64>,
    /// Time steps, s.
    pub dt: TimeSteps,
    /// Largest number of solid sub-steps in a step.
    pub sub_steps: Option<u32>,
    /// Where each process spent its time.
    pub roles: Roles,
    /// Work counted, which no other program on the machine changes.
    pub work: Work,
    /// From publishing a state to having the forces, µs.
    pub round_trip_us: Option<Percentiles>,
    /// What the run checked about itself.
    pub audit: Audit,
    /// Contact of pairs of solids; empty where no two can touch.
    pub contacts: Vec<ContactReport>,
    /// What each kind of force did to each solid, of those that acted.
    pub forces: Vec<ForceReport>,
    /// What the columns of `probes.csv` came to; empty while the run goes on.
    pub probes: Vec<ProbeReport>,
    /// The energy ledgers; `null` where no probe asks for energies.
    pub energy: Option<EnergyReport>,
    /// Owners of particles: the fluid, then the solids in the scene's order. `particles` and `roles` are their sums.
    pub participants: Vec<ParticipantReport>,
    /// What solids of other programs published first, beside what the scene has for them; empty where there is none.
    pub external: Vec<FirstMessage>,
    /// The effects, with the reason for each.
    pub effects: Vec<EffectReport>,
}

/// The state that a run went on from after an interruption.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Resumption {
    /// Number of the checkpoint.
    pub checkpoint: u64,
    /// Step n.
    pub step: u64,
    /// Its time, s.
    pub time: f64,
    /// Part of the limits, or of the scene's own time step, that the run took from then on.
    pub time_step_factor: f64,
    /// Why the run had diverged, where it went back for that.
    pub because: Option<String>,
}

/// One participant: an owner of particles.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ParticipantReport {
    /// Name of the participant.
    pub name: String,
    /// `fluid` or `solid`.
    pub phase: String,
    /// The model that computes it; `null` for a solid of another program.
    pub model: Option<String>,
    /// The command of a solid of another program; empty where it was started by hand.
    pub command: Option<String>,
    /// The process that it ran in.
    pub process: String,
    /// Number of particles at the end.
    pub particles: u64,
    /// Mass of the particles at the end, kg (2D: kg/m).
    pub mass: f64,
    /// Particles of a solid outside of the domain at the end.
    pub outside: u64,
    /// Largest number of its particles in a message; `null` where nothing was exchanged.
    pub capacity: Option<u32>,
    /// Largest number of its sub-steps in a step, of a solid.
    pub sub_steps: Option<u32>,
    /// Its energy that nothing explains, over the energy in play; `null` where it is not judged by itself.
    pub energy_growth: Option<f64>,
    /// Joints of a rigid solid whose ends are apart by more than a tenth of the spacing at the end: name, m.
    pub open_joints: Vec<(String, f64)>,
    /// Joints of a rigid solid whose ends began with different velocities: name, and the difference in m/s and rad/s.
    pub jerked_joints: Vec<(String, [f64; 2])>,
    /// Where its time went, s.
    pub times: Option<RoleSeconds>,
}

/// A column of `probes.csv`: its end and its extremes. `null` where nothing could be measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ProbeReport {
    /// Its title without the unit: `tip.x`.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Value in the last row.
    pub end: Option<f64>,
    /// Least value.
    pub min: Option<f64>,
    /// When it was that for the first time, s.
    pub min_time: Option<f64>,
    /// Largest value.
    pub max: Option<f64>,
    /// When it was that for the first time, s.
    pub max_time: Option<f64>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunStatus {
    /// The run reached its end time.
    Finished,
    /// Somebody stopped it before.
    Stopped,
    /// A quantity left its bounds.
    Diverged,
    /// Something else went wrong.
    Failed,
}

/// Numbers of particles at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Particles {
    /// Of the fluid.
    pub fluid: u64,
    /// Of the solid.
    pub solid: u64,
    /// Of the walls.
    pub wall: u64,
    /// Fluid particles taken out because they left the domain.
    pub removed: u64,
}

/// Statistics of the time step, s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimeSteps {
    /// Smallest, s.
    pub min: Option<f64>,
    /// Mean, s.
    pub mean: Option<f64>,
    /// Largest, s.
    pub max: Option<f64>,
}

/// The processes that took part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Roles {
    /// Fluid process.
    pub fluid: Option<RoleSeconds>,
    /// Solid process.
    pub solid: Option<RoleSeconds>,
    /// Coupler process.
    pub coupler: Option<RoleSeconds>,
}

/// Where a process spent its time, s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RoleSeconds {
    /// Computing, s.
    pub compute: f64,
    /// Waiting for others, s.
    pub wait: f64,
    /// Sending and receiving, s.
    pub exchange: f64,
    /// Handing over what is written, s.
    pub output: f64,
}

/// Work done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Work {
    /// Pairs of particles listed in all passes of a run that reached its end or was stopped.
    pub pair_evaluations: PairEvaluations,
}

/// Pair evaluations of each process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct PairEvaluations {
    /// Of the fluid.
    pub fluid: Option<u64>,
    /// Of the solid.
    pub solid: Option<u64>,
    /// Of the coupler.
    pub coupler: Option<u64>,
}

impl PairEvaluations {
    /// All of them; `None` where nothing was counted.
    pub fn total(&self) -> Option<u64> {
        [self.fluid, self.solid, self.coupler].into_iter().flatten().reduce(|a, b| a + b)
    }
}

/// Percentiles of a duration, µs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// Median, µs.
    pub p50: f64,
    /// Exceeded by one in a hundred, µs.
    pub p99: f64,
}

/// Largest energy that neither start, gravity nor the other phase explains, over the energy in play; `None` where it
/// cannot be judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct EnergyGrowth {
    /// Of the fluid; of both phases together with the phase-blind interface.
    pub fluid: Option<f64>,
    /// Of the solid.
    pub solid: Option<f64>,
}

/// What the run checked about itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Audit {
    /// Largest relative drift of linear momentum that no outer force explains.
    pub momentum_drift: Option<f64>,
    /// Relative drift of kinetic plus stored energy of an isolated solid.
    pub energy_drift: Option<f64>,
    /// Energy of each phase that nothing explains, over the energy in play.
    pub energy_growth: EnergyGrowth,
    /// Largest relative mismatch of the forces that both phases exert on each other.
    pub action_reaction: Option<f64>,
    /// Relative mismatch of the impulses that the fluid took from the solids and the coupler sent to them.
    pub impulse: Option<f64>,
    /// Largest relative deviation of the fluid's density.
    pub density_error: Option<f64>,
    /// Smallest distance between fluid and solid particles, over the spacing.
    pub min_gap: Option<f64>,
    /// Part of the fluid under tension at the end, below -0.001 rho c0².
    pub tension: Option<f64>,
    /// Number of consistency checks passed.
    pub checks: u64,
    /// Hash over every particle's final state in id order, 16 hexadecimal digits.
    pub state_hash: Option<String>,
    /// Instruction set that the hash belongs to.
    pub isa: Option<String>,
}

/// One effect of the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EffectReport {
    /// Name of the effect, as in the scene.
    pub name: String,
    /// Whether it was computed.
    pub on: bool,
    /// The reason.
    pub why: String,
    /// Share of the computing time that the effect takes of all roles, 0 to 1; `null` where it was not measured.
    pub share: Option<f64>,
    /// Memory that it takes, bytes per particle of its phase; `null`: none of its own.
    pub bytes_per_particle: Option<f64>,
}

impl RunReport {
    /// Writes the report to `path`, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        let mut text =
            serde_json::to_vec_pretty(self).map_err(|e| OutputError::malformed(path, e.to_string()))?;
        text.push(b'\n');
        atomic::replace_bytes(path, &text)
    }

    /// Reads a report.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let text = std::fs::read(path).map_err(OutputError::io("read", path))?;
        serde_json::from_slice(&text).map_err(|e| OutputError::malformed(path, e.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    #[test]
    fn a_full_report_has_the_documented_keys_and_reads_back() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("run.json");
        let report = RunReport {
            status: Some(RunStatus::Diverged),
            error: Some("too fast".into()),
            scene: json!({"name": "gate"}),
            steps: 7,
            time: 0.1,
            dt: TimeSteps { min: Some(1e-5), mean: Some(2e-5), max: Some(1.0 / 3.0) },
            sub_steps: Some(4),
            roles: Roles {
                fluid: Some(RoleSeconds { compute: 1.5, ..Default::default() }),
                ..Default::default()
            },
            round_trip_us: Some(Percentiles { p50: 27.0, p99: 49.0 }),
            audit: Audit { state_hash: Some(format!("{:016x}", u64::MAX)), checks: 3, ..Default::default() },
            effects: vec![EffectReport { name: "viscosity".into(), on: true, ..Default::default() }],
            ..Default::default()
        };
        report.write(&path).unwrap();
        assert_eq!(RunReport::read(&path).unwrap(), report);

        let value: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(value["status"], "diverged");
        assert_eq!(value["audit"]["state_hash"], "ffffffffffffffff");
        for pointer in [
            "/error /warnings /scene /version /steps /time /wall_seconds /particles/fluid /particles/solid /particles/wall",
            "/particle_steps_per_second /dt/min /dt/mean /dt/max /sub_steps /roles/fluid/compute /roles/fluid/wait",
            "/roles/fluid/exchange /roles/fluid/output /roles/solid /roles/coupler /round_trip_us/p50",
            "/round_trip_us/p99 /audit/momentum_drift /audit/energy_drift /audit/action_reaction /audit/impulse",
            "/audit/energy_growth/fluid /audit/energy_growth/solid /audit/density_error /audit/min_gap /audit/checks /audit/isa",
            "/work/pair_evaluations/fluid /work/pair_evaluations/solid /work/pair_evaluations/coupler",
            "/effects/0/name /effects/0/on /effects/0/why /effects/0/share",
        ]
        .iter()
        .flat_map(|line| line.split(' '))
        {
            assert!(value.pointer(pointer).is_some(), "{pointer} is missing");
        }
    }

    #[test]
    fn a_report_of_an_older_version_reads_with_defaults() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("run.json");
        std::fs::write(&path, r#"{"status":"finished","steps":3}"#).unwrap();
        let report = RunReport::read(&path).unwrap();
        assert_eq!((report.status, report.steps), (Some(RunStatus::Finished), 3));
        std::fs::write(&path, r#"{"status":"asleep"}"#).unwrap();
        assert!(RunReport::read(&path).is_err());
    }
}
