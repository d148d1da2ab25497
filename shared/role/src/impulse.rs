//! Impulse of the forces across the interface: what the fluid took beside what the coupler sent to the solids.

use halfstep_wire::state::{Fields, State, StateError};
use serde::{Deserialize, Serialize};

/// Sum of forces over whole steps, with their rates at n + 1/2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Impulse {
    /// N s (2D: N s/m).
    pub sum: [f64; 3],
    /// The same of the forces' magnitudes, component by component: what the sum is small or large beside.
    pub scale: f64,
}

impl Impulse {
    /// Adds the forces of a step of this length, s: their sum and the sum of their magnitudes, N (2D: N/m).
    pub fn add(&mut self, dt: f64, (sum, scale): ([f64; 3], f64)) {
        self.sum.iter_mut().zip(sum).for_each(|(own, force)| *own += dt * force);
        self.scale += dt * scale;
    }

    /// How far this and what acts against it are from adding up to nothing, over their magnitudes; `None` where
    /// nothing acted.
    pub fn mismatch(&self, against: &Self) -> Option<f64> {
        let scale = self.scale + against.scale;
        let rest = self.sum.iter().zip(&against.sum).map(|(a, b)| (a + b).abs());
        (scale > 0.0).then(|| rest.fold(0.0, f64::max) / scale)
    }
}

/// Adds a force to a sum of forces and of their magnitudes, N (2D: N/m).
pub fn add_force((sum, scale): &mut ([f64; 3], f64), force: [f64; 3]) {
    sum.iter_mut().zip(force).for_each(|(sum, force)| *sum += force);
    *scale += force.iter().map(|f| f.abs()).sum::<f64>();
}

impl State for Impulse {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.vector("sum", &mut self.sum)?;
        fields.real("scale", &mut self.scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two steps of 0.5 and 0.25 s under 2 and -4 N give 0 N s of 2 N s; what acts against it had 0.1 N s more.
    #[test]
    fn opposite_impulses_add_up_to_nothing() {
        let (mut taken, mut sent) = (Impulse::default(), Impulse::default());
        for (dt, force) in [(0.5, 2.0), (0.25, -4.0)] {
            let mut forces = ([0.0; 3], 0.0);
            add_force(&mut forces, [force, 0.0, 0.0]);
            taken.add(dt, forces);
            sent.add(dt, (forces.0.map(|f| -f), forces.1));
        }
        assert_eq!((taken.sum, taken.scale), ([0.0; 3], 2.0));
        assert_eq!(taken.mismatch(&sent), Some(0.0));
        sent.sum[1] = 0.1;
        assert_eq!(taken.mismatch(&sent), Some(0.1 / 4.0));
        assert_eq!(Impulse::default().mismatch(&Impulse::default()), None);
    }
}
