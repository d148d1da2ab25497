//! How many sub-steps the solid takes in a step.

use halfstep_scene::{Scene, SubSteps, Treatment};

/// The choice of the number of sub-steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubStepping {
    wanted: SubSteps,
    most: u32,
}

impl SubStepping {
    /// What a scene asks for of its solid of that index.
    pub fn of(scene: &Scene, solid: usize) -> Self {
        // Phase-blind, a particle close to the interface is as stiff as the solid; without fluid there is nothing to
        // sub-step under: the solid's own limit is the time step.
        let single = scene.interface.treatment == Treatment::PhaseBlind || scene.fluid.is_none();
        let wanted = match scene.solids.get(solid) {
            Some(solid) if !single => solid.sub_steps,
            _ => SubSteps::Fixed(1),
        };
        // Half a step must be a whole number of sub-steps.
        let most = match (wanted, scene.numerics.max_sub_steps) {
            (SubSteps::Fixed(k), _) => k,
            (SubSteps::Auto, 0 | 1) => 1,
            (SubSteps::Auto, most) => most & !1,
        };
        Self { wanted, most }
    }

    /// The most that may be taken: the solid's limit of a step over that of a sub-step.
    pub fn most(&self) -> u32 {
        self.most
    }

    /// Sub-steps for a time step where one is stable to `limit`: 1 or the smallest even number that is stable.
    pub fn choose(&self, dt: f64, limit: f64) -> u32 {
        match self.wanted {
            SubSteps::Fixed(k) => k,
            SubSteps::Auto => {
                let needed = (dt / limit * (1.0 - 1e-12)).ceil();
                if needed <= 1.0 { 1 } else { (needed as u32).next_multiple_of(2).min(self.most) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_or_the_smallest_stable_even_number() {
        let auto = SubStepping { wanted: SubSteps::Auto, most: 6 };
        assert_eq!(
            [0.5, 1.0, 1.01, 2.0, 2.1, 5.5, 99.0].map(|dt| auto.choose(dt, 1.0)),
            [1, 1, 2, 2, 4, 6, 6]
        );
        let fixed = SubStepping { wanted: SubSteps::Fixed(4), most: 4 };
        assert_eq!(fixed.choose(0.5, 1.0), 4);
    }
}
