//! Impulses: of joints as one linear system, of contacts one after the other, until neither changes any more (projected
//! Gauss and Seidel; Jean 1999).

use super::body::{Body, Pose};
use super::contact::Touch;
use super::row::{Factors, Row};

/// Most rounds.
const ROUNDS: usize = 2000;
/// A round that changes no impulse by more than this part of the largest is the last one.
const CHANGE: f64 = 1e-12;

/// Rows that are kept at given rates.
pub(super) struct Held<'a> {
    pub(super) rows: &'a [Row],
    pub(super) factors: &'a Factors,
    /// m/s.
    pub(super) rates: &'a [f64],
}

/// Brings joints to their rates, and contacts to at least their targets, with friction. Returns the joints' impulses;
/// those of the contacts stand in them.
pub(super) fn solve(
    bodies: &[Body],
    poses: &mut [Pose],
    held: &Held<'_>,
    touches: &mut [Touch],
    friction: f64,
) -> Vec<f64> {
    let mut total = vec![0.0; held.rows.len()];
    let mut change = vec![0.0; held.rows.len()];
    let response = |row: &Row, poses: &[Pose]| row.response(row, bodies, poses);
    let gives: Vec<(f64, f64)> = touches
        .iter()
        .map(|touch| {
            let across = touch.tangents.iter().map(|row| response(row, poses)).fold(0.0, f64::max);
            (response(&touch.normal, poses), across)
        })
        .collect();
    for _ in 0..ROUNDS {
        let mut largest = 0.0_f64;
        for (k, row) in held.rows.iter().enumerate() {
            change[k] = held.rates[k] - row.rate(bodies, poses);
        }
        held.factors.solve(&mut change);
        for ((row, &impulse), total) in held.rows.iter().zip(&change).zip(&mut total) {
            row.push(bodies, poses, impulse);
            *total += impulse;
        }
        if touches.is_empty() {
            break;
        }
        let mut most = 0.0_f64;
        for (touch, &(normal, across)) in touches.iter_mut().zip(&gives) {
            let step = (touch.target - touch.normal.rate(bodies, poses)) / normal;
            let impulse = (touch.impulse + step).max(0.0);
            touch.normal.push(bodies, poses, impulse - touch.impulse);
            largest = largest.max((impulse - touch.impulse).abs());
            touch.impulse = impulse;
            most = most.max(impulse);
            largest = largest.max(rub(bodies, poses, touch, across, friction * impulse));
        }
        // NaN ends it, too.
        if !(largest > CHANGE * most) {
            break;
        }
    }
    total
}

/// Coulomb's friction at a contact: what stops it, at most `bound`. Returns the largest change of an impulse.
fn rub(bodies: &[Body], poses: &mut [Pose], touch: &mut Touch, give: f64, bound: f64) -> f64 {
    let before = touch.friction.clone();
    for (row, impulse) in touch.tangents.iter().zip(&mut touch.friction) {
        *impulse -= row.rate(bodies, poses) / give;
    }
    let size = touch.friction.iter().map(|x| x * x).sum::<f64>().sqrt();
    if size > bound {
        let scale = bound / size;
        touch.friction.iter_mut().for_each(|impulse| *impulse *= scale);
    }
    let mut largest = 0.0_f64;
    for ((row, now), before) in touch.tangents.iter().zip(&touch.friction).zip(before) {
        row.push(bodies, poses, now - before);
        largest = largest.max((now - before).abs());
    }
    largest
}
