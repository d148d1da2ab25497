//! One instant of one process: the columns that go into a frame file.

use crate::protocol::StateRecord;
use halfstep_sph::Phase;

/// Number of the fluid in [`Frame::phase`].
pub const FLUID: u8 = 0;
/// Number of the solid in [`Frame::phase`].
pub const SOLID: u8 = 1;
/// Number of the walls in [`Frame::phase`].
pub const WALL: u8 = 2;

/// All particles of a process at one instant, in single precision. The columns are equally long; those
/// of what only solids have may be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Simulated time, s.
    pub time: f64,
    /// Positions, m.
    pub points: Vec<[f32; 3]>,
    /// Velocities, m/s.
    pub velocity: Vec<[f32; 3]>,
    /// Densities, kg/m³.
    pub density: Vec<f32>,
    /// Pressures, Pa.
    pub pressure: Vec<f32>,
    /// Cauchy stresses xx, yy, zz, xy, yz, xz, Pa; zero for fluid and walls.
    pub stress: Vec<[f32; 6]>,
    /// Damage of a solid that can break, 0 to 1; of all others this column is empty.
    pub damage: Vec<f32>,
    /// Displacements from the initial configuration, m: of a solid.
    pub displacement: Vec<[f32; 3]>,
    /// Von Mises stresses, Pa: of a solid that strains.
    pub von_mises: Vec<f32>,
    /// Numbers of the bodies, from 0 on in each solid: of a solid.
    pub body: Vec<i32>,
    /// [`FLUID`], [`SOLID`] or [`WALL`].
    pub phase: Vec<u8>,
    /// Particle numbers: unique in a phase, the same in every frame.
    pub id: Vec<i32>,
}

/// Why frames could not be written.
pub type SinkError = Box<dyn std::error::Error + Send + Sync>;

/// Where the frames of a participant go.
pub trait FrameSink: Send {
    /// Hands frame `number` over. `fill` gets an empty frame, with the memory of an earlier one.
    ///
    /// # Errors
    /// An earlier frame could not be written.
    fn submit(&mut self, number: u32, fill: &mut dyn FnMut(&mut Frame)) -> Result<(), SinkError>;
    /// Number up to which, not including it, all frames are on disk.
    fn safe(&self) -> u32;
    /// Waits until everything submitted is on disk; returns what [`Self::safe`] then is.
    ///
    /// # Errors
    /// A frame could not be written.
    fn finish(self: Box<Self>) -> Result<u32, SinkError>;
}

/// Flags of a record: the particle is moved by others than its model, and its body, from 0 on.
pub fn flags_of(held: bool, body: Option<u32>) -> u32 {
    u32::from(held) | body.map_or(0, |body| (body + 1) << 8)
}

/// The body that a record says, from 0 on; `None` where it says none.
pub fn body_of(record: &StateRecord) -> Option<u32> {
    (record.flags >> 8).checked_sub(1)
}

/// One particle, as the numerics hold it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramePoint {
    /// Position, m.
    pub position: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Density, kg/m³.
    pub density: f64,
    /// Pressure, Pa.
    pub pressure: f64,
    /// Cauchy stress xx, yy, zz, xy, yz, xz, Pa; zero for fluid and walls.
    pub stress: [f64; 6],
    /// Phase of the particle.
    pub phase: Phase,
    /// Number of the particle.
    pub id: u32,
}

/// Von Mises stress of a stress or its deviatoric part xx, yy, zz, xy, yz, xz.
pub fn von_mises(stress: &[f64; 6]) -> f64 {
    let [xx, yy, zz, xy, yz, xz] = stress;
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + xz * xz)).sqrt()
}

/// Cauchy stress xx, yy, zz, xy, yz, xz of a record, Pa.
fn stress_of(r: &StateRecord) -> [f64; 6] {
    let mut stress = r.deviatoric_stress;
    for normal in &mut stress[..3] {
        *normal -= r.pressure;
    }
    stress
}

/// Mean Cauchy stress xx, yy, zz, xy, yz, xz of records, Pa; of none NaN.
pub fn mean_stress<'a>(records: impl IntoIterator<Item = &'a StateRecord>) -> [f64; 6] {
    let (mut sum, mut count) = ([0.0; 6], 0.0);
    for record in records {
        let stress = stress_of(record);
        (0..6).for_each(|c| sum[c] += stress[c]);
        count += 1.0;
    }
    sum.map(|s| s / count)
}

impl FramePoint {
    /// A solid particle as its record shows it.
    pub fn solid(r: &StateRecord) -> Self {
        let stress = stress_of(r);
        Self {
            position: r.position,
            velocity: r.velocity,
            density: r.density,
            pressure: r.pressure,
            stress,
            phase: Phase::Solid,
            id: r.id,
        }
    }
}

impl Frame {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Forgets time and particles and keeps the memory.
    pub fn clear(&mut self) {
        self.time = 0.0;
        self.points.clear();
        self.velocity.clear();
        self.density.clear();
        self.pressure.clear();
        self.stress.clear();
        self.damage.clear();
        self.displacement.clear();
        self.von_mises.clear();
        self.body.clear();
        self.phase.clear();
        self.id.clear();
    }

    /// Appends a particle, rounded to single precision.
    pub fn push(&mut self, particle: FramePoint) {
        self.points.push(particle.position.map(|x| x as f32));
        self.velocity.push(particle.velocity.map(|v| v as f32));
        self.density.push(particle.density as f32);
        self.pressure.push(particle.pressure as f32);
        self.stress.push(particle.stress.map(|s| s as f32));
        self.phase.push(match particle.phase {
            Phase::Fluid => FLUID,
            Phase::Solid => SOLID,
            Phase::Wall => WALL,
        });
        self.id.push(particle.id as i32);
    }

    /// Whether all columns are equally long, those of solids apart where they are empty: what a file can hold.
    pub fn is_consistent(&self) -> bool {
        let n = self.len();
        let of_solids = [self.damage.len(), self.displacement.len(), self.von_mises.len(), self.body.len()];
        [
            self.velocity.len(),
            self.density.len(),
            self.pressure.len(),
            self.stress.len(),
            self.phase.len(),
            self.id.len(),
        ]
        .iter()
        .all(|&length| length == n)
            && of_solids.iter().all(|&length| length == 0 || length == n)
    }
}
