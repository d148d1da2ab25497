//! Forces or impulses across the interface that should add up to nothing: what the fluid took beside what the coupler
//! sent to the solids.

use halfstep_wire::state::{Fields, State, StateError};
use serde::{Deserialize, Serialize};

/// Sum of forces, N (2D: N/m), or of impulses, N s (2D: N s/m).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// The sum.
    pub sum: [f64; 3],
    /// That of the magnitudes, component by component: what the sum is small or large beside.
    pub scale: f64,
}

impl Balance {
    /// Adds one of them.
    pub fn add(&mut self, force: [f64; 3]) {
        for (sum, force) in self.sum.iter_mut().zip(force) {
            *sum += force;
            self.scale += force.abs();
        }
    }

    /// Adds all of another balance, each times so much: forces over a time step, s, are impulses.
    pub fn add_all(&mut self, other: &Self, times: f64) {
        self.sum.iter_mut().zip(other.sum).for_each(|(sum, force)| *sum += times * force);
        self.scale += times * other.scale;
    }

    /// How far the sum is from nothing, over the magnitudes; `None` where nothing acted.
    pub fn mismatch(&self) -> Option<f64> {
        (self.scale > 0.0)
            .then(|| self.sum.iter().fold(0.0_f64, |most, sum| most.max(sum.abs())) / self.scale)
    }
}

impl State for Balance {
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
        let (mut taken, mut sent) = (Balance::default(), Balance::default());
        for (dt, force) in [(0.5, 2.0), (0.25, -4.0)] {
            for (impulse, force) in [(&mut taken, force), (&mut sent, -force)] {
                let mut forces = Balance::default();
                forces.add([force, 0.0, 0.0]);
                impulse.add_all(&forces, dt);
            }
        }
        assert_eq!((taken.sum, taken.scale), ([0.0; 3], 2.0));
        let mismatch = |sent: &Balance| {
            let mut both = taken;
            both.add_all(sent, 1.0);
            both.mismatch()
        };
        assert_eq!(mismatch(&sent), Some(0.0));
        sent.sum[1] = 0.1;
        assert_eq!(mismatch(&sent), Some(0.1 / 4.0));
        assert_eq!(Balance::default().mismatch(), None);
    }
}
