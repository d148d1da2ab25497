//! The wire: the records and headers that travel between the processes of a run.
//!
//! All records are dimension-independent (a two-dimensional run leaves z components at zero), little-endian, `repr(C)`
//! and free of padding, so that a process in any language can read and write them. Message k of a force channel answers
//! message k of the same participant's state channel.

use std::fmt::Debug;

/// Version of the protocol; both sides of every channel must agree.
pub const PROTOCOL: u32 = 2;

/// State of one interface particle. 128 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateRecord {
    /// The owner's particle number: unique within the participant, ascending in a message.
    pub id: u32,
    /// Bit 0: the velocity is prescribed (a clamped particle). Bits 8 to 31: number of the body, 0 where the sender
    /// does not say. The others are zero.
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
    /// Acceleration by viscosity across the interface, m/s²: f_i, which is artificial, and viscous stress where the
    /// scene calls for it.
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
    /// Write the state just published as checkpoint `checkpoint`.
    pub const WRITE_CHECKPOINT: u32 = 4;
    /// Do not advance: answer with a last message (stage 2, status finished) and end.
    pub const STOP: u32 = 8;
    /// Send the probe values of the state just published; for participants with the ability [`super::ability::PROBES`].
    pub const SEND_PROBES: u32 = 16;
}

/// Bits of [`StateHeader::abilities`]: what a participant does besides exchanging states.
pub mod ability {
    /// The participant writes checkpoints of its own.
    pub const CHECKPOINTS: u32 = 1;
    /// The participant evaluates its walls and the contacts between its own bodies.
    pub const WALLS_AND_CONTACTS: u32 = 2;
    /// The participant sends the values of its probes where a row is due.
    pub const PROBES: u32 = 4;
}

/// [`StateHeader::stage`] of a last message.
pub const LAST_STAGE: u32 = 2;

/// What diverged: the failure fields of a state message.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Failure {
    /// Place in the list of participants of the one that diverged, which may be another than the sender.
    pub participant: u32,
    /// Which quantity: the number of a [`crate::failure::Quantity`]; 0: none.
    pub quantity: u32,
    /// The particle that diverged.
    pub particle: u32,
    /// Zero.
    pub reserved: u32,
    /// The value that was out of bounds.
    pub value: f64,
    /// Where, m.
    pub position: [f64; 3],
}

/// Sums over all particles of a participant.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Audit {
    /// Linear momentum x, y, z, kg m/s (2D: per metre).
    pub momentum: [f64; 3],
    /// Kinetic energy, J.
    pub kinetic_energy: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Largest |rho / rho0 - 1|.
    pub density_error: f64,
    /// Smallest distance to the other phase over dx; infinite where none is near.
    pub gap: f64,
    /// Energy stored in the material, J: strain energy of a solid, work of compression of a fluid.
    pub stored_energy: f64,
}

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
    /// Generation of the fluid's interface set: within one, slots keep their particles. A solid repeats 0.
    pub epoch: u64,
    /// Time of step n, s, as last told by the coupler.
    pub time: f64,
    /// Stage 0: zero. Stage 1: the time step as told by the coupler.
    pub dt: f64,
    /// Stage 0: the largest time step this participant allows, s.
    pub dt_limit: f64,
    /// Largest displacement of an own interface particle since the epoch began, m.
    pub displacement: f64,
    /// Solid sub-steps of the last full step (fluid: 1).
    pub sub_steps: u32,
    /// Frames on disk: all up to, not including, this one.
    pub frames_safe: u32,
    /// What the sender does besides exchanging states, see [`ability`]; read from its first message.
    pub abilities: u32,
    /// Number of the last checkpoint on disk; 0: none.
    pub checkpoint_safe: u32,
    /// What diverged (status diverged only).
    pub failure: Failure,
    /// Sums over all own particles (stage 0).
    pub audit: Audit,
    /// Hash over the participant's final particle states in id order (last message only).
    pub state_hash: u64,
    /// Number of own particles.
    pub particles: u64,
}

impl StateHeader {
    /// The sender evaluates its contact with walls itself.
    pub fn holds_own_walls(&self) -> bool {
        self.abilities & ability::WALLS_AND_CONTACTS != 0
    }
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
    /// Number of the checkpoint to write.
    pub checkpoint: u64,
}

/// Heads the probe values of a participant: as many numbers follow as its probes have components, in the scene's order,
/// then for each probe of a body's moment its centre of mass.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProbeHeader {
    /// The run's number.
    pub run_id: u64,
    /// Hash of record and header layouts.
    pub schema: u64,
    /// [`PROTOCOL`].
    pub protocol: u32,
    /// Number of values that follow.
    pub count: u32,
    /// Step n of the state that was measured.
    pub step: u64,
    /// Time of the row, s.
    pub time: f64,
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
    const NAME: &'static str = "halfstep.StateHeader.2";
}

// SAFETY: `repr(C)`, numbers only, and no padding: asserted at the end of this file.
unsafe impl Plain for ForceHeader {
    const NAME: &'static str = "halfstep.ForceHeader.2";
}

// SAFETY: `repr(C)`, numbers only, and no padding: asserted at the end of this file.
unsafe impl Plain for ProbeHeader {
    const NAME: &'static str = "halfstep.ProbeHeader.1";
}

/// The layout that both ends must share, spelt out; its hash travels in every header and as a service attribute.
pub const LAYOUT: &str = concat!(
    "StateRecord{id:u32,flags:u32,position:f64[3],velocity:f64[3],density:f64,pressure:f64,mass:f64,",
    "deviatoric_stress:f64[6]};",
    "ForceRecord{id:u32,flags:u32,cross_viscosity:f64[3],stress_force:f64[3]};",
    "StateHeader{run_id:u64,schema:u64,protocol:u32,status:u32,step:u64,stage:u32,count:u32,epoch:u64,time:f64,",
    "dt:f64,dt_limit:f64,displacement:f64,sub_steps:u32,frames_safe:u32,abilities:u32,checkpoint_safe:u32,",
    "failure:{participant:u32,quantity:u32,particle:u32,reserved:u32,value:f64,position:f64[3]},",
    "audit:{momentum:f64[3],kinetic_energy:f64,mass:f64,density_error:f64,gap:f64,stored_energy:f64},",
    "state_hash:u64,particles:u64};",
    "ForceHeader{run_id:u64,schema:u64,protocol:u32,order:u32,step:u64,stage:u32,count:u32,epoch:u64,time:f64,",
    "dt:f64,next_time:f64,frame:u64,checkpoint:u64};",
    "ProbeHeader{run_id:u64,schema:u64,protocol:u32,count:u32,step:u64,time:f64}"
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
const _: () = assert!(size_of::<StateHeader>() == 224);
const _: () = assert!(size_of::<ForceHeader>() == 88);
const _: () = assert!(size_of::<ProbeHeader>() == 40);
