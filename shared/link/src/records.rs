//! The check of all records of a message: without branches, and of the copy that is used.

use halfstep_wire::protocol::{ForceRecord, Plain, StateRecord};

/// Records that are copied at once: the nearest cache still has them when they are checked.
const PART: usize = 64;

/// Bits of a number that are all set in what is not finite.
const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
/// Carries an exponent of which all bits are set into the sign.
const CARRY: u64 = 0x0010_0000_0000_0000;
const SIGN: u64 = 1 << 63;

/// Four sums of what is wrong: a set sign tells. Several, so that they compile to vectors.
type Wrong = [u64; 4];

/// A record that says of itself whether it is possible.
pub(super) trait Checked: Plain {
    /// The particle's number.
    fn id(&self) -> u32;

    /// Adds what is wrong with it.
    fn add_wrong(&self, wrong: &mut Wrong);
}

/// The sign is set where a number is not finite.
#[inline(always)]
fn not_finite(word: u64) -> u64 {
    (word & EXPONENT) + CARRY
}

/// The sign is set where a number is negative or zero.
#[inline(always)]
fn not_positive(value: f64) -> u64 {
    let word = value.to_bits();
    word | word.wrapping_sub(1)
}

impl Checked for StateRecord {
    #[inline(always)]
    fn id(&self) -> u32 {
        self.id
    }

    #[inline(always)]
    fn add_wrong(&self, wrong: &mut Wrong) {
        // SAFETY: sixteen words without padding, each of which is any bits.
        let mut words: [u64; 16] = unsafe { std::mem::transmute_copy(self) };
        // Number and flags.
        words[0] = 0;
        for k in 0..4 {
            wrong[k] |= not_finite(words[k]) | not_finite(words[k + 4]);
            wrong[k] |= not_finite(words[k + 8]) | not_finite(words[k + 12]);
        }
        wrong[0] |= not_positive(self.density) | not_positive(self.mass);
    }
}

impl Checked for ForceRecord {
    #[inline(always)]
    fn id(&self) -> u32 {
        self.id
    }

    #[inline(always)]
    fn add_wrong(&self, wrong: &mut Wrong) {
        // SAFETY: seven words without padding, each of which is any bits.
        let words: [u64; 7] = unsafe { std::mem::transmute_copy(self) };
        for k in 0..2 {
            wrong[k] |= not_finite(words[k + 1]) | not_finite(words[k + 3]) | not_finite(words[k + 5]);
        }
    }
}

/// Whether these are possible records of these particles.
pub(super) fn are_possible<R: Checked>(ids: &[u32], records: &[R]) -> bool {
    if ids.len() != records.len() {
        return false;
    }
    let (mut wrong, mut other) = (Wrong::default(), 0);
    for (id, record) in ids.iter().zip(records) {
        record.add_wrong(&mut wrong);
        other |= id ^ record.id();
    }
    other == 0 && wrong.iter().all(|sum| sum & SIGN == 0)
}

/// Copies records from where their sender can still write, behind those that are there, and checks the copies: whether
/// they are possible records of these particles. Copies all of them in any case.
pub(super) fn copy_checked<R: Checked>(ids: &[u32], from: &[R], into: &mut Vec<R>) -> bool {
    into.reserve(from.len());
    let mut possible = ids.len() == from.len();
    for (k, part) in from.chunks(PART).enumerate() {
        let (first, copied) = (k * PART, into.len());
        into.extend_from_slice(part);
        possible = possible && are_possible(&ids[first..first + part.len()], &into[copied..]);
    }
    possible
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(id: u32) -> StateRecord {
        StateRecord { id, flags: u32::MAX, density: 1.0, mass: f64::MIN_POSITIVE, ..StateRecord::default() }
    }

    fn possible<R: Checked>(record: R) -> bool {
        let records = [record];
        let mut copies = Vec::new();
        let [at_once, copied] = [are_possible(&[7], &records), copy_checked(&[7], &records, &mut copies)];
        assert_eq!(at_once, copied);
        at_once
    }

    const WRONG: [f64; 4] = [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    const RIGHT: [f64; 6] = [0.0, -0.0, f64::MAX, f64::MIN, 5e-324, -5e-324];

    #[test]
    fn each_number_of_a_state_has_to_be_finite() {
        let words = |word: usize, value: f64| {
            let mut record = state(7);
            match word {
                0..3 => record.position[word] = value,
                3..6 => record.velocity[word - 3] = value,
                6 => record.density = value,
                7 => record.pressure = value,
                8 => record.mass = value,
                _ => record.deviatoric_stress[word - 9] = value,
            }
            record
        };
        for word in 0..15 {
            assert!(WRONG.iter().all(|&value| !possible(words(word, value))), "{word}");
            let positive = word == 6 || word == 8;
            for value in RIGHT {
                assert_eq!(possible(words(word, value)), !positive || value > 0.0, "{word}: {value}");
            }
        }
    }

    #[test]
    fn each_number_of_a_force_has_to_be_finite() {
        let force = |word: usize, value: f64| {
            let mut record = ForceRecord { id: 7, flags: u32::MAX, ..ForceRecord::default() };
            if word < 3 {
                record.cross_viscosity[word] = value
            } else {
                record.stress_force[word - 3] = value
            }
            record
        };
        for word in 0..6 {
            assert!(WRONG.iter().all(|&value| !possible(force(word, value))), "{word}");
            assert!(RIGHT.iter().all(|&value| possible(force(word, value))), "{word}");
        }
    }

    #[test]
    fn one_record_of_many_is_found_and_all_are_copied() {
        let ids: Vec<u32> = (0..3 * PART as u32 + 5).collect();
        let good: Vec<StateRecord> = ids.iter().map(|&id| state(id)).collect();
        let mut copies = Vec::new();
        assert!(copy_checked(&ids, &good, &mut copies));
        assert_eq!(copies, good);
        for k in [0, PART - 1, PART, good.len() - 1] {
            for wrong in [StateRecord { id: 1000, ..good[k] }, StateRecord { pressure: f64::NAN, ..good[k] }]
            {
                let mut bad = good.clone();
                bad[k] = wrong;
                copies.clear();
                assert!(!copy_checked(&ids, &bad, &mut copies), "{k}");
                assert_eq!(copies.len(), bad.len());
                assert!(!are_possible(&ids, &bad));
            }
        }
        copies.clear();
        assert!(!copy_checked(&ids[1..], &good, &mut copies) && copies == good);
    }
}
