//! All that fuzzing found worth keeping is read again, and each file with changes that a seed decides.

use fastrand::Rng;
use std::path::{Path, PathBuf};

/// Changed copies of each file.
const CHANGED: usize = 20;

/// A few bytes overwritten, removed or taken twice.
fn changed(bytes: &[u8], random: &mut Rng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + random.usize(..4) {
        if bytes.is_empty() {
            break;
        }
        let place = random.usize(..bytes.len());
        let end = (place + 1 + random.usize(..16)).min(bytes.len());
        match random.usize(..3) {
            0 => bytes[place] = random.u8(..),
            1 => drop(bytes.drain(place..end)),
            _ => {
                let twice = bytes[place..end].to_vec();
                bytes.splice(place..place, twice);
            }
        }
    }
    bytes
}

fn files(target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("a file").path()).collect();
    files.sort();
    assert!(files.len() >= 10, "{}: {} files", folder.display(), files.len());
    files
}

fn replay(target: &str, read: fn(&[u8])) {
    for file in files(target) {
        let bytes = std::fs::read(&file).expect("a file of the corpus");
        let mut random = Rng::with_seed(bytes.len() as u64);
        let copies: Vec<Vec<u8>> = (0..CHANGED).map(|_| changed(&bytes, &mut random)).collect();
        for (copy, bytes) in std::iter::once(&bytes).chain(&copies).enumerate() {
            let outcome = std::panic::catch_unwind(|| read(bytes));
            assert!(outcome.is_ok(), "{}, copy {copy}", file.display());
        }
    }
}

#[test]
fn scenes() {
    replay("scene", halfstep_fuzz::scene);
}

#[test]
fn curves() {
    replay("curve", halfstep_fuzz::curve);
}

#[test]
fn outlines() {
    replay("outline", halfstep_fuzz::outline);
}

#[test]
fn drawings() {
    replay("drawing", halfstep_fuzz::drawing);
}

#[test]
fn messages() {
    replay("message", halfstep_fuzz::message);
}

#[test]
fn checkpoints() {
    replay("checkpoint", halfstep_fuzz::checkpoint);
}
