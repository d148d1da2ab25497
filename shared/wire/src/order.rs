//! The order of saved particles: their numbers by slot, and the rows that they were sorted into.

use crate::state::StateError;
use halfstep_sph::neighbours::{PADDING, Rows};

/// How many particles stand in slots with these numbers: each below `among`, and none twice.
///
/// # Errors
/// One is not, or stands twice: `wrong` says what that means.
pub fn count(ids: &[u32], among: usize, wrong: &str) -> Result<usize, StateError> {
    let mut seen = vec![false; among];
    let mut particles = 0;
    for &id in ids.iter().filter(|&&id| id != PADDING) {
        match seen.get_mut(id as usize) {
            Some(seen) if !*seen => *seen = true,
            _ => return Err(StateError::contradiction(wrong)),
        }
        particles += 1;
    }
    Ok(particles)
}

/// Sorts particles into rows as they were sorted when they stood at `x`, m, in these slots: see [`Rows::sort`].
///
/// # Errors
/// They take other slots: `whose` names the rows.
pub fn sort_again<const D: usize>(
    rows: &mut Rows<D>,
    x: &[Vec<f64>; D],
    ids: &[u32],
    height: f64,
    (low, high): ([f64; D], [f64; D]),
    whose: &str,
) -> Result<(), StateError> {
    rows.sort(x, ids, height, low, high);
    match rows.slots() == ids.len() {
        true => Ok(()),
        false => Err(StateError::contradiction(format!("{whose} are not where they were"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_counted_once_each() {
        assert_eq!(count(&[2, 0, PADDING, PADDING], 3, "wrong"), Ok(2));
        for ids in [[1, 1], [0, 3]] {
            let message = count(&ids, 3, "other particles").unwrap_err().to_string();
            assert_eq!(message, "the saved state is no state of this scene: other particles");
        }
    }

    #[test]
    fn other_slots_are_told() {
        let mut rows = Rows::<2>::default();
        let x = [vec![0.0; 3], vec![0.0; 3]];
        let again = sort_again(&mut rows, &x, &[0, 1, 2], 1.0, ([-1.0; 2], [1.0; 2]), "the rows");
        assert!(again.unwrap_err().to_string().ends_with("the rows are not where they were"));
    }
}
