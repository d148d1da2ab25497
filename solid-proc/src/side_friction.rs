//! Friction on the two faces of a solid that two dimensions do not see (`solid.side_friction`), as a force per volume
//! against the velocity (Coulomb, with a normal force that does not change):
//!   f = -F v / |v|.
//! It jumps where a particle turns round, so it is not evaluated but solved for: over dt, friction alone leads to
//!   v <- v max(0, 1 - dt F / (rho0 |v|)),
//! which is exact while the particle slides, stops it without turning it round, and holds it while less than F acts on
//! it. That is the backward Euler step of the law (Moreau 1988): stable for any step, and no speed is needed below
//! which the law would have to be smoothed.

use crate::columns::Vectors;

/// Slows every particle that is free down by a change of velocity dt F / rho0, m/s.
pub(crate) fn slow<const D: usize>(velocity: &mut Vectors<D>, change: f64, free: impl Fn(usize) -> bool) {
    for slot in (0..velocity[0].len()).filter(|&slot| free(slot)) {
        let speed = (0..D).map(|d| velocity[d][slot].powi(2)).sum::<f64>().sqrt();
        let left = if speed > change { 1.0 - change / speed } else { 0.0 };
        for column in velocity.iter_mut() {
            column[slot] *= left;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_slows_and_stops_but_does_not_turn_round() {
        // |v| = 5, then at rest, then slower than the change.
        let mut velocity = [vec![3.0, 0.0, 0.5], vec![-4.0, 0.0, 0.0]];
        slow(&mut velocity, 1.0, |_| true);
        assert!((velocity[0][0] - 2.4).abs() < 1e-15 && (velocity[1][0] + 3.2).abs() < 1e-15);
        assert_eq!([velocity[0][1], velocity[0][2], velocity[1][2]], [0.0; 3]);
        // What a clamp moves goes on as it is moved.
        let mut driven = [vec![3.0]];
        slow(&mut driven, 1.0, |_| false);
        assert_eq!(driven, [vec![3.0]]);
    }
}
