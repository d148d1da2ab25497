//! The wire: the records and headers that travel between the processes of a run.
//!
//! All records are dimension-independent (a two-dimensional run leaves z components at zero), little-endian, `repr(C)`
//! and free of padding, so that a process in any language can read and write them. Message k of a force channel answers
//! message k of the same phase's state channel.

use std::fmt::Debug;

/// Version of the protocol; both sides of every channel must agree.
pub const PROTOCOL: u32 = 1;
/// Probe values that fit into a state header.
pub const MAX_PROBE_VALUES: usize = 32;

/// State of one interface particle. 128 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateRecord {
    /// The owner's particle number: unique in its phase, ascending in a message.
    pub id: u32,
    /// 1: the velocity is prescribed (a clamped particle); else 0.
    pub flags: u32,
    /// Position, m.
    pub position: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Density, kg/m³.
    pub density: f64,
    /// Pressure, Pa.
    pub pressure: f64,
    /// Mass, kg (2D: kg/m).
    pub mass: f64,
    /// Deviatoric stress xx, yy, zz, xy, yz, xz, Pa; zero for a fluid.
    pub deviatoric_stress: [f64; 6],
}

/// Cross-phase force on one interface particle. 56 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceRecord {
    /// The particle's number, as in the state record it answers.
    pub id: u32,
    /// Zero.
    pub flags: u32,
    /// f_i: acceleration by the cross-phase artificial viscosity, m/s².
    pub cross_viscosity: [f64; 3],
    /// Force by the other phase's pressure and stress, N (2D: N/m). Filled for the solid; zero for the fluid, which
    /// evaluates it from the same records itself.
    pub stress_force: [f64; 3],
}

impl ForceRecord {
    /// Whole force on a particle of this mass (kg, 2D: kg/m), N (2D: N/m).
    pub fn force(&self, mass: f64) -> [f64; 3] {
        std::array::from_fn(|d| mass * self.cross_viscosity[d] + self.stress_force[d])
    }
}

/// How the sender of a state is.
pub mod status {
    /// The run goes on.
    pub const OK: u32 = 0;
    /// A quantity left its bounds; the failure fields say which.
    pub const DIVERGED: u32 = 1;
    /// Something else failed; the log says what.
    pub const FAILED: u32 = 2;
    /// Last message of a run that ends as ordered.
    pub const FINISHED: u32 = 3;
}

/// Bits of [`ForceHeader::order`].
pub mod order {
    /// Advance.
    pub const GO: u32 = 1;
    /// Write the state just published as frame `frame`.
    pub const WRITE_FRAME: u32 = 2;
    /// Write the state just published as a checkpoint.
    pub const WRITE_CHECKPOINT: u32 = 4;
    /// Do not advance: answer with a last message (stage 2, status finished) and end.
    pub const STOP: u32 = 8;
}

/// [`StateHeader::stage`] of a last message.
pub const LAST_STAGE: u32 = 2;

/// Heads every state message.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateHeader {
    /// The run's number.
    pub run_id: u64,
    /// Hash of record and header layouts.
    pub schema: u64,
    /// [`PROTOCOL`].
    pub protocol: u32,
    /// See [`status`].
    pub status: u32,
    /// Step n.
    pub step: u64,
    /// 0: state at n; 1: state at n + 1/2; 2: last message.
    pub stage: u32,
    /// Number of records that follow.
    pub count: u32,
    /// Generation of the fluid's interface set: within one, slots keep their particles. The solid repeats 0.
    pub epoch: u64,
    /// Time of step n, s, as last told by the coupler.
    pub time: f64,
    /// Stage 0: zero. Stage 1: the time step as told by the coupler.
    pub dt: f64,
    /// Stage 0: the largest time step this side allows, s.
    pub dt_limit: f64,
    /// Largest displacement of an own interface particle since the epoch began, m.
    pub displacement: f64,
    /// Solid sub-steps of the last full step (fluid: 1).
    pub sub_steps: u32,
    /// Frames on disk: all up to, not including, this one.
    pub frames_safe: u32,
    /// What diverged: see [`crate::failure::Quantity`].
    pub failure_quantity: u32,
    /// The particle that diverged.
    pub failure_particle: u32,
    /// The value that was out of bounds.
    pub failure_value: f64,
    /// Where, m.
    pub failure_position: [f64; 3],
    /// Hash over this side's final particle states in id order (last message only).
    pub state_hash: u64,
    /// Seconds spent computing, waiting, exchanging, writing (last message only).
    pub seconds: [f64; 4],
    /// Sums over all own particles: linear momentum x, y, z (kg m/s), kinetic energy (J), mass (kg), largest relative
    /// density error, smallest distance to the other phase over dx, stored energy (J).
    pub audit: [f64; 8],
    /// Number of own particles.
    pub particles: u64,
    /// Number of probe values.
    pub probe_count: u64,
    /// Probe values of this phase, in the scene's order (stage 0); of a last message, their places are the receiver's.
    pub probes: [f64; MAX_PROBE_VALUES],
}

/// Heads every force message.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceHeader {
    /// The run's number.
    pub run_id: u64,
    /// Hash of record and header layouts.
    pub schema: u64,
    /// [`PROTOCOL`].
    pub protocol: u32,
    /// See [`order`].
    pub order: u32,
    /// Step n of the state it answers.
    pub step: u64,
    /// Stage of the state it answers.
    pub stage: u32,
    /// Number of records that follow.
    pub count: u32,
    /// Epoch of the state it answers.
    pub epoch: u64,
    /// Time of step n, s.
    pub time: f64,
    /// Time step from n to n + 1, s.
    pub dt: f64,
    /// Time of step n + 1, s.
    pub next_time: f64,
    /// Number of the frame to write.
    pub frame: u64,
}

/// What a message is made of: plain bytes, `repr(C)` and without padding, that mean the same in every process.
///
/// # Safety
/// The type has no padding, no pointers, and every bit pattern is a value.
pub unsafe trait Plain: Copy + Default + Debug + Send + Sync + 'static {
    /// Name and version by which programs in other languages know the layout.
    const NAME: &'static str;
}

// SAFETY: a number.
unsafe impl Plain for f64 {
    const NAME: &'static str = "f64";
}

// SAFETY: `repr(C)`, numbers only, and no padding: asserted at the end of this file.
unsafe impl Plain for StateRecord {
    const NAME: &'static str = "halfstep.StateRecord.1";
}

// SAFETY: `repr(C)`, numbers only, and no padding: asserted at the end of this file.
unsafe impl Plain for ForceRecord {
    const NAME: &'static str = "halfstep.ForceRecord.1";
}

// SAFETY: `repr(C)`, numbers only, and no padding: asserted at the end of this file.
unsafe impl Plain for StateHeader {
    const NAME: &'static str = "halfstep.StateHeader.1";
}

// SAFETY: `repr(C)`, numbers only, and no padding: asserted at the end of this file.
unsafe impl Plain for ForceHeader {
    const NAME: &'static str = "halfstep.ForceHeader.1";
}

/// The layout that both ends must share, spelt out; its hash travels in every header and as a service attribute.
pub const LAYOUT: &str = concat!(
    "StateRecord{id:u32,flags:u32,position:f64[3],velocity:f64[3],density:f64,pressure:f64,mass:f64,",
    "deviatoric_stress:f64[6]};",
    "ForceRecord{id:u32,flags:u32,cross_viscosity:f64[3],stress_force:f64[3]};",
    "StateHeader{run_id:u64,schema:u64,protocol:u32,status:u32,step:u64,stage:u32,count:u32,epoch:u64,time:f64,",
    "dt:f64,dt_limit:f64,displacement:f64,sub_steps:u32,frames_safe:u32,failure_quantity:u32,failure_particle:u32,",
    "failure_value:f64,failure_position:f64[3],state_hash:u64,seconds:f64[4],audit:f64[8],particles:u64,",
    "probe_count:u64,probes:f64[32]};",
    "ForceHeader{run_id:u64,schema:u64,protocol:u32,order:u32,step:u64,stage:u32,count:u32,epoch:u64,time:f64,",
    "dt:f64,next_time:f64,frame:u64}"
);

/// FNV-1a (64 bit) of [`LAYOUT`].
pub const SCHEMA: u64 = fnv1a(LAYOUT.as_bytes());

const fn fnv1a(bytes: &[u8]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut i = 0;
    while i < bytes.len() {
        hash = (hash ^ bytes[i] as u64).wrapping_mul(0x0000_0100_0000_01b3);
        i += 1;
    }
    hash
}

// No padding anywhere: sizes are sums of the fields.
const _: () = assert!(size_of::<StateRecord>() == 128);
const _: () = assert!(size_of::<ForceRecord>() == 56);
const _: () = assert!(size_of::<StateHeader>() == 504);
const _: () = assert!(size_of::<ForceHeader>() == 80);
