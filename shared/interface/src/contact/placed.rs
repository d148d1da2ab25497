//! Where an outline is, and which of its points belong together no longer.

use super::law::{depth_in, less};
use super::outline::{Outline, Point, REACH, distance};
use halfstep_wire::protocol::StateRecord;

/// A point is torn whose particles lie farther from it than this, over [`REACH`]: they belong to different fragments.
const TORN: f64 = 1.5;

/// An axis-parallel box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    low: [f64; 2],
    high: [f64; 2],
}

impl Around {
    const NOTHING: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    fn add(&mut self, x: [f64; 2]) {
        for d in 0..2 {
            self.low[d] = self.low[d].min(x[d]);
            self.high[d] = self.high[d].max(x[d]);
        }
    }

    /// Around both.
    fn and(&self, other: &Self) -> Self {
        let mut both = *self;
        both.add(other.low);
        both.add(other.high);
        both
    }

    fn of(all: impl Iterator<Item = [f64; 2]>) -> Self {
        all.fold(Self::NOTHING, |mut around, x| {
            around.add(x);
            around
        })
    }

    pub(super) fn meets(&self, other: &Self, margin: f64) -> bool {
        (0..2).all(|d| self.low[d] <= other.high[d] + margin && other.low[d] <= self.high[d] + margin)
    }

    pub(super) fn holds(&self, x: [f64; 2], margin: f64) -> bool {
        (0..2).all(|d| x[d] >= self.low[d] - margin && x[d] <= self.high[d] + margin)
    }
}

/// Where an outline is.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    around: Around,
    margin: f64,
    /// Positions and velocities are those of the present state.
    fresh: bool,
    /// Of each point, m.
    pub(super) position: Vec<[f64; 2]>,
    /// Of each point, m/s.
    pub(super) velocity: Vec<[f64; 2]>,
    /// Around the points of each piece.
    pub(super) pieces: Vec<Around>,
    /// Around the outline of each piece, in which others' points are looked for: nothing where it is torn.
    pub(super) targets: Vec<Around>,
    /// Points whose particles are no longer together, and single particles that other points carry; empty where none
    /// of the outline's points is torn.
    torn: Vec<bool>,
}

impl Default for Placed {
    fn default() -> Self {
        Self {
            around: Around::NOTHING,
            margin: 0.0,
            fresh: false,
            position: Vec::new(),
            velocity: Vec::new(),
            pieces: Vec::new(),
            targets: Vec::new(),
            torn: Vec::new(),
        }
    }
}

impl Placed {
    /// Some points' particles belong to different fragments.
    pub(super) fn has_torn(&self) -> bool {
        !self.torn.is_empty()
    }

    /// From one point to another, m.
    pub(super) fn line(&self, [from, to]: [u32; 2]) -> [f64; 2] {
        less(self.position[to as usize], self.position[from as usize])
    }

    /// A point's particles belong to different fragments, or the point is a single particle that others carry.
    pub(super) fn is_torn(&self, point: u32) -> bool {
        self.torn.get(point as usize).is_some_and(|torn| *torn)
    }

    /// Finds the points whose particles are no longer together.
    fn tear(&mut self, outline: &Outline, records: &[StateRecord]) {
        self.torn.clear();
        if !outline.breaks {
            return;
        }
        let most = TORN * REACH * outline.spacing;
        let torn = |(point, at): (&Point, &[f64; 2])| {
            let place = |record: u32| {
                let x = records[record as usize].position;
                [x[0], x[1]]
            };
            point.weights.iter().any(|(record, _)| distance(place(*record), *at) > most)
        };
        self.torn.extend(outline.points.iter().zip(&self.position).map(torn));
        if !self.torn.contains(&true) {
            self.torn.clear();
            return;
        }
        let mut carried = vec![false; records.len()];
        for (point, _) in outline.points.iter().zip(&self.torn).filter(|(_, torn)| !**torn) {
            point.weights.iter().for_each(|(record, _)| carried[*record as usize] = true);
        }
        for single in &outline.points[self.torn.len()..] {
            let record = single.weights[0].0 as usize;
            let in_plane = |x: [f64; 3]| [x[0], x[1]];
            self.torn.push(carried[record]);
            self.position.push(in_plane(records[record].position));
            self.velocity.push(in_plane(records[record].velocity));
        }
    }

    /// Takes the records of a state.
    pub(super) fn bound(&mut self, outline: &Outline, records: &[StateRecord]) {
        self.around = Around::of(records.iter().map(|r| [r.position[0], r.position[1]]));
        // The surface lies up to a spacing before the particles.
        self.margin = 1.5 * outline.spacing;
        self.fresh = false;
    }

    /// The two may touch.
    pub(super) fn meets(&self, other: &Self) -> bool {
        self.around.meets(&other.around, self.margin + other.margin)
    }

    /// Puts the points of an outline of one piece without parts, m and m/s.
    pub(super) fn put(&mut self, position: Vec<[f64; 2]>, velocity: Vec<[f64; 2]>) {
        self.pieces.clear();
        self.pieces.push(Around::of(position.iter().copied()));
        (self.position, self.velocity) = (position, velocity);
    }

    /// How deep a place is in a piece of the outline, m: zero outside.
    pub(super) fn depth_of(&self, outline: &Outline, at: [f64; 2]) -> f64 {
        let depth = |(k, target): (usize, &Around)| match target.holds(at, 0.0) {
            true => depth_in((outline, self), k, at),
            false => 0.0,
        };
        self.targets.iter().enumerate().map(depth).fold(0.0, f64::max)
    }

    /// Places all points.
    pub(super) fn place(&mut self, outline: &Outline, records: &[StateRecord]) {
        if std::mem::replace(&mut self.fresh, true) {
            return;
        }
        let sum = |point: &Point, of: &dyn Fn(&StateRecord) -> [f64; 3], start: [f64; 2]| {
            point.weights.iter().fold(start, |sum, (record, w)| {
                let x = of(&records[*record as usize]);
                [sum[0] + w * x[0], sum[1] + w * x[1]]
            })
        };
        self.position.clear();
        self.velocity.clear();
        let singles: usize = outline.pieces.iter().map(|piece| piece.singles.len()).sum();
        let points = &outline.points[..outline.points.len() - singles];
        self.position.extend(points.iter().map(|p| sum(p, &|r| r.position, p.offset)));
        self.velocity.extend(points.iter().map(|p| sum(p, &|r| r.velocity, [0.0; 2])));
        self.tear(outline, records);
        let (torn, position) = (&self.torn, &self.position);
        let whole = |p: &&u32| torn.is_empty() || !torn[**p as usize];
        let around = |points: &[u32]| Around::of(points.iter().filter(whole).map(|&p| position[p as usize]));
        self.targets.clear();
        self.pieces.clear();
        for piece in &outline.pieces {
            let own = around(&piece.points);
            let closed = torn.is_empty() || piece.points.iter().all(|&p| !torn[p as usize]);
            self.targets.push(if closed { own } else { Around::NOTHING });
            self.pieces.push(if torn.is_empty() { own } else { own.and(&around(&piece.singles)) });
        }
    }
}
