//! Whether lines of corners bound a region.

use super::MAX_CORNERS;
use robust::{Coord, orient2d};

/// What is wrong with the lines of corners of a polygon.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fault {
    /// Which line: `None` the outline, else the index of a hole.
    pub(crate) hole: Option<usize>,
    /// The reason.
    pub(crate) reason: String,
}

/// A side: its line, its index there, its ends.
#[derive(Clone, Copy)]
struct Side {
    line: usize,
    index: usize,
    of: usize,
    from: [f64; 2],
    to: [f64; 2],
}

impl Side {
    fn span(&self) -> [f64; 2] {
        [self.from[0].min(self.to[0]), self.from[0].max(self.to[0])]
    }

    fn follows(&self, other: &Self) -> bool {
        self.line == other.line && self.index == (other.index + 1) % other.of
    }
}

pub(super) fn check(outline: &[[f64; 2]], holes: &[Vec<[f64; 2]>]) -> Result<(), Fault> {
    let lines: Vec<&[[f64; 2]]> = std::iter::once(outline).chain(holes.iter().map(Vec::as_slice)).collect();
    let corners: usize = lines.iter().map(|line| line.len()).sum();
    if corners > MAX_CORNERS {
        let reason = format!("has {corners} corners with its holes; at most {MAX_CORNERS}");
        return Err(Fault { hole: None, reason });
    }
    for (line, corners) in lines.iter().enumerate() {
        let fault = |reason: String| Fault { hole: line.checked_sub(1), reason };
        if corners.len() < 3 {
            return Err(fault(format!("has {} corners; at least 3 bound a region", corners.len())));
        }
        let next = corners.iter().cycle().skip(1);
        if let Some(k) = corners.iter().zip(next).position(|(a, b)| a == b) {
            return Err(fault(format!("has corner {k} twice in a row, {}", place(&corners[k]))));
        }
        if corners.windows(3).all(|c| side(&c[0], &c[1], &c[2]) == 0.0) {
            return Err(fault("bounds no area: its corners lie on one line".into()));
        }
    }
    crossings(&lines)?;
    for (k, hole) in holes.iter().enumerate() {
        let reason = match holes.iter().position(|other| other != hole && inside(&hole[0], other)) {
            _ if !inside(&hole[0], outline) => "does not lie in the polygon".to_owned(),
            Some(other) => format!("lies in hole {other}"),
            None => continue,
        };
        return Err(Fault { hole: Some(k), reason });
    }
    Ok(())
}

/// Refuses sides that meet other than at their common corner.
fn crossings(lines: &[&[[f64; 2]]]) -> Result<(), Fault> {
    let of_line = |(line, corners): (usize, &&[[f64; 2]])| {
        let of = corners.len();
        let corners = corners.to_vec();
        (0..of).map(move |index| Side {
            line,
            index,
            of,
            from: corners[index],
            to: corners[(index + 1) % of],
        })
    };
    let mut sides: Vec<Side> = lines.iter().enumerate().flat_map(of_line).collect();
    sides.sort_by(|a, b| a.span()[0].total_cmp(&b.span()[0]));
    for (k, a) in sides.iter().enumerate() {
        let end = a.span()[1];
        for b in sides[k + 1..].iter().take_while(|b| b.span()[0] <= end) {
            let Some(at) = meet(a, b) else { continue };
            let (a, b) = if (a.line, a.index) <= (b.line, b.index) { (a, b) } else { (b, a) };
            let name =
                |line: usize| line.checked_sub(1).map_or("the outline".into(), |h| format!("hole {h}"));
            let reason = match a.line == b.line {
                true => format!(
                    "crosses or touches itself at {}: the sides from corner {} and from corner {} meet there",
                    place(&at),
                    a.index,
                    b.index
                ),
                false => format!("crosses or touches {} at {}", name(a.line), place(&at)),
            };
            return Err(Fault { hole: b.line.checked_sub(1), reason });
        }
    }
    Ok(())
}

/// Where two sides meet, other than in the corner that they share.
fn meet(a: &Side, b: &Side) -> Option<[f64; 2]> {
    if b.follows(a) || a.follows(b) {
        // Neighbours may not fold back; in a triangle each side follows the other's follower.
        let (first, second) = if b.follows(a) { (a, b) } else { (b, a) };
        let back = |c: usize| (first.from[c] - first.to[c]) * (second.to[c] - second.from[c]);
        let folds = side(&first.from, &first.to, &second.to) == 0.0 && back(0) + back(1) > 0.0;
        return folds.then_some(first.to);
    }
    let [p, q] = [side(&a.from, &a.to, &b.from), side(&a.from, &a.to, &b.to)];
    let [r, s] = [side(&b.from, &b.to, &a.from), side(&b.from, &b.to, &a.to)];
    let apart = |x: f64, y: f64| (x < 0.0 && y > 0.0) || (x > 0.0 && y < 0.0);
    if apart(p, q) && apart(r, s) {
        let share = p.abs() / (p.abs() + q.abs());
        return Some([0, 1].map(|c| b.from[c] + share * (b.to[c] - b.from[c])));
    }
    let touches = [(p, a, b.from), (q, a, b.to), (r, b, a.from), (s, b, a.to)];
    touches.into_iter().find(|(sign, side, at)| *sign == 0.0 && within(side, at)).map(|(.., at)| at)
}

/// On which side of a line through two points a third one lies: positive on the left.
fn side(a: &[f64; 2], b: &[f64; 2], c: &[f64; 2]) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p[0], y: p[1] });
    orient2d(a, b, c)
}

fn within(side: &Side, at: &[f64; 2]) -> bool {
    (0..2).all(|c| side.from[c].min(side.to[c]) <= at[c] && at[c] <= side.from[c].max(side.to[c]))
}

/// Whether a line of corners goes around a point.
fn inside(p: &[f64; 2], corners: &[[f64; 2]]) -> bool {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).fold(false, |inside, (a, b)| {
        let crosses = (a[1] <= p[1]) != (b[1] <= p[1]);
        let left = if a[1] <= b[1] { side(a, b, p) > 0.0 } else { side(b, a, p) > 0.0 };
        inside ^ (crosses && left)
    })
}

fn place(at: &[f64; 2]) -> String {
    // In single precision: without the last digits that a division leaves.
    format!("[{}, {}]", at[0] as f32, at[1] as f32)
}
