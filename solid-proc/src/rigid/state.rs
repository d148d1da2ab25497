//! What rigid bodies keep over an interruption: where they are and how they move, and the last loads of contacts, which
//! probes show. All else comes from the scene.

use super::Vec3;
use super::contact::Remembered;
use super::model::Rigid;
use halfstep_wire::state::{Fields, State, StateError};
use nalgebra::{Quaternion, UnitQuaternion};

impl<const D: usize> State for Rigid<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let (particles, bodies) = (self.count() as u64, self.system.poses.len());
        let mut counted = particles;
        fields.count("particles", &mut counted)?;
        if counted != particles {
            return Err(StateError::contradiction("the solid's bodies are other ones"));
        }
        let poses = &mut self.system.poses;
        let mut column = |name: &str, get: fn(&mut super::body::Pose) -> &mut Vec3| {
            let mut points: Vec<[f64; 3]> = poses.iter_mut().map(|pose| (*get(pose)).into()).collect();
            fields.points(name, &mut points)?;
            fields.length(name, bodies, points.len())?;
            poses.iter_mut().zip(points).for_each(|(pose, point)| *get(pose) = point.into());
            Ok(())
        };
        column("center", |pose| &mut pose.center)?;
        column("velocity", |pose| &mut pose.velocity)?;
        column("spin", |pose| &mut pose.spin)?;
        let mut angle: Vec<f64> = poses.iter().map(|pose| pose.angle).collect();
        let mut turn: Vec<f64> = poses.iter().flat_map(|pose| pose.turn.coords.iter().copied()).collect();
        fields.reals("angle", &mut angle)?;
        fields.reals("turn", &mut turn)?;
        fields.length("angle", bodies, angle.len())?;
        fields.length("turn", 4 * bodies, turn.len())?;
        for (k, pose) in poses.iter_mut().enumerate() {
            pose.angle = angle[k];
            let [i, j, l, w] = [0, 1, 2, 3].map(|c| turn[4 * k + c]);
            pose.turn = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, l));
        }
        let n = self.states.len();
        let mut force: Vec<[f64; D]> = self.states.iter().map(|state| state.contact_force).collect();
        let mut moment: Vec<[f64; 3]> = self.states.iter().map(|state| state.contact_moment).collect();
        fields.points("contact_force", &mut force)?;
        fields.points("contact_moment", &mut moment)?;
        fields.length("contact_force", n, force.len())?;
        fields.length("contact_moment", n, moment.len())?;
        for (state, (force, moment)) in self.states.iter_mut().zip(force.into_iter().zip(moment)) {
            (state.contact_force, state.contact_moment) = (force, moment);
        }
        let memory = &mut self.system.memory;
        let mut ends: Vec<u32> = memory.iter().flat_map(|one| one.ends.map(|end| end as u32)).collect();
        let mut impulses: Vec<[f64; 3]> =
            memory.iter().map(|one| [one.impulse, one.friction[0], one.friction[1]]).collect();
        fields.numbers("contact_ends", &mut ends)?;
        fields.points("contact_impulse", &mut impulses)?;
        fields.length("contact_ends", 2 * impulses.len(), ends.len())?;
        let one = |(ends, [impulse, a, b]): (&[u32], [f64; 3])| Remembered {
            ends: [ends[0] as usize, ends[1] as usize],
            impulse,
            friction: [a, b],
        };
        *memory = ends.chunks_exact(2).zip(impulses).map(one).collect();
        fields.part("shown_velocity", &mut self.shown_velocity)
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.show();
        Ok(())
    }
}
