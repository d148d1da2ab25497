//! Rows of constraints: J v of two bodies, and impulses along them.

use super::Vec3;
use super::body::{Body, Pose};

/// A row J: a relative velocity of body b toward body a.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// a and b.
    pub(super) ends: [usize; 2],
    /// Direction of the force on b.
    pub(super) linear: Vec3,
    /// Moment of that force about the centre of a, and of b.
    pub(super) angular: [Vec3; 2],
    /// What the constraint should keep at zero, m or rad.
    pub(super) gap: f64,
}

impl Row {
    /// A force between points of a and b at the same place (or along the line between them).
    pub(super) fn between(ends: [usize; 2], poses: &[Pose], at: Vec3, linear: Vec3, gap: f64) -> Self {
        let angular = ends.map(|end| (at - poses[end].center).cross(&linear));
        Self { ends, linear, angular, gap }
    }

    /// A moment about an axis.
    pub(super) fn turning(ends: [usize; 2], axis: Vec3, gap: f64) -> Self {
        Self { ends, linear: Vec3::zeros(), angular: [axis; 2], gap }
    }

    /// J v of what end 0 (a) or 1 (b) does alone.
    pub(super) fn of_end(&self, end: usize, bodies: &[Body], poses: &[Pose]) -> f64 {
        let k = self.ends[end];
        let rate = bodies[k].angular_velocity(&poses[k]);
        let of = self.linear.dot(&poses[k].velocity) + self.angular[end].dot(&rate);
        if end == 0 { -of } else { of }
    }

    /// J v.
    pub(super) fn rate(&self, bodies: &[Body], poses: &[Pose]) -> f64 {
        self.of_end(0, bodies, poses) + self.of_end(1, bodies, poses)
    }

    /// An impulse on b, and its opposite on a.
    pub(super) fn push(&self, bodies: &[Body], poses: &mut [Pose], impulse: f64) {
        for (end, way) in [(0, -impulse), (1, impulse)] {
            let k = self.ends[end];
            if bodies[k].gives_way() {
                poses[k].velocity += self.linear * (way / bodies[k].mass);
                poses[k].spin += self.angular[end] * way;
            }
        }
    }

    /// How fast this row goes after a unit impulse along another: J M^-1 J'^T.
    pub(super) fn response(&self, other: &Self, bodies: &[Body], poses: &[Pose]) -> f64 {
        let mut sum = 0.0;
        for (mine, k) in self.ends.into_iter().enumerate().filter(|(_, k)| bodies[*k].gives_way()) {
            for (its, _) in other.ends.into_iter().enumerate().filter(|(_, other)| *other == k) {
                let sign = if mine == its { 1.0 } else { -1.0 };
                let turned = bodies[k].turn_rate(&poses[k].rotation(), &other.angular[its]);
                let straight = self.linear.dot(&other.linear) / bodies[k].mass;
                sum += sign * (straight + self.angular[mine].dot(&turned));
            }
        }
        sum
    }
}

/// Factors L D L^T of J M^-1 J^T; rows that others imply have no pivot, and no impulse. Of L each row is kept from the
/// first other row on that acts on a body of it: left of that it is zero.
#[derive(Clone, Debug, Default)]
pub(super) struct Factors {
    lower: Vec<Lower>,
    pivots: Vec<f64>,
    /// Of each column, the row after the last one that may have an entry in it.
    until: Vec<usize>,
}

/// A row of L, left of the diagonal.
#[derive(Clone, Debug)]
struct Lower {
    from: usize,
    entries: Vec<f64>,
}

impl Lower {
    /// Entries of the columns from one on, which this row has.
    fn after(&self, column: usize) -> &[f64] {
        &self.entries[column - self.from..]
    }
}

/// A pivot below this part of the diagonal is what rounding left of zero.
const SMALLEST_PIVOT: f64 = 1e-10;

/// The first row that acts on a body of each row.
fn first_beside(rows: &[Row], bodies: &[Body]) -> Vec<usize> {
    let mut first = vec![usize::MAX; bodies.len()];
    let beside = |(i, row): (usize, &Row)| {
        let own = row.ends.into_iter().filter(|k| bodies[*k].gives_way());
        own.fold(i, |least, k| {
            first[k] = first[k].min(i);
            least.min(first[k])
        })
    };
    rows.iter().enumerate().map(beside).collect()
}

impl Factors {
    pub(super) fn of(rows: &[Row], bodies: &[Body], poses: &[Pose]) -> Self {
        let n = rows.len();
        let mut f = Self { lower: Vec::with_capacity(n), pivots: vec![0.0; n], until: (1..=n).collect() };
        for (i, from) in first_beside(rows, bodies).into_iter().enumerate() {
            let mut own = Lower { from, entries: Vec::with_capacity(i - from) };
            for j in from..i {
                let pivot = f.pivots[j];
                if pivot <= 0.0 {
                    own.entries.push(0.0);
                    continue;
                }
                let whole = rows[i].response(&rows[j], bodies, poses);
                let (other, start) = (&f.lower[j], from.max(f.lower[j].from));
                let pairs = own.after(start).iter().zip(other.after(start));
                let taken: f64 =
                    pairs.zip(&f.pivots[start..]).map(|((mine, its), pivot)| mine * its * pivot).sum();
                own.entries.push((whole - taken) / pivot);
            }
            let diagonal = rows[i].response(&rows[i], bodies, poses);
            let squares = own.entries.iter().zip(&f.pivots[from..]);
            let pivot = diagonal - squares.map(|(entry, pivot)| entry.powi(2) * pivot).sum::<f64>();
            if pivot > SMALLEST_PIVOT * diagonal {
                f.pivots[i] = pivot;
            }
            f.until[from..i].fill(i + 1);
            f.lower.push(own);
        }
        f
    }

    /// Impulses that change the rows' rates by `change`, which they replace.
    pub(super) fn solve(&self, change: &mut [f64]) {
        let n = self.pivots.len();
        for (i, Lower { from, entries }) in self.lower.iter().enumerate() {
            let taken: f64 =
                entries.iter().zip(&change[*from..i]).map(|(entry, before)| entry * before).sum();
            change[i] -= taken;
        }
        for i in (0..n).rev() {
            change[i] = if self.pivots[i] > 0.0 { change[i] / self.pivots[i] } else { 0.0 };
            let rows = (i + 1..self.until[i]).filter(|&k| self.lower[k].from <= i);
            let later: f64 = rows.map(|k| self.lower[k].entries[i - self.lower[k].from] * change[k]).sum();
            change[i] = if self.pivots[i] > 0.0 { change[i] - later } else { 0.0 };
        }
    }
}
