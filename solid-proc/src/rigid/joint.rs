//! Joints as rows of constraints, and springs.

use super::Vec3;
use super::body::{Body, Pose};
use super::row::Row;
use nalgebra::UnitQuaternion;

/// A joint between two bodies; a and b as indices.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub(super) name: String,
    /// What it is tied to, and the body.
    pub(super) ends: [usize; 2],
    pub(super) kind: LinkKind,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
    /// m or rad.
    pub(super) rest: f64,
    /// m or rad.
    pub(super) limits: Option<[f64; 2]>,
}

/// Points and directions belong to the reference configuration.
#[derive(Clone, Debug)]
pub(super) enum LinkKind {
    /// No way is left.
    Fixed { at: Vec3 },
    /// Turns about a point, and about an axis through it; zero: any axis.
    Hinge { at: Vec3, axis: Vec3 },
    /// A point on a line.
    Rail { at: Vec3, axis: Vec3, turns: bool },
    /// Between a point of a and a point of b.
    Spring { points: [Vec3; 2] },
}

/// Two unit vectors across a third, all at right angles.
pub(super) fn across(axis: &Vec3) -> [Vec3; 2] {
    let k = (0..3).fold(0, |least, k| if axis[k].abs() < axis[least].abs() { k } else { least });
    let mut other = Vec3::zeros();
    other[k] = 1.0;
    let first = axis.cross(&other);
    let first = first / first.norm_squared().sqrt();
    [axis.cross(&first), first]
}

impl Link {
    /// Appends the rows that the joint keeps at zero. `plane`: bodies turn about z alone.
    pub(super) fn rows(&self, plane: bool, bodies: &[Body], poses: &[Pose], rows: &mut Vec<Row>) {
        let [a, b] = self.ends;
        let place = |end: usize, point: &Vec3| bodies[end].place(&poses[end], point);
        let mut together = |at: &Vec3, directions: &[Vec3]| {
            // Directions go along with a, whose arm therefore reaches to b's point.
            let (on_a, on_b) = (place(a, at), place(b, at));
            let row = |d: &Vec3| Row::between(self.ends, poses, on_b, *d, d.dot(&(on_b - on_a)));
            rows.extend(directions.iter().map(row));
        };
        let space = [Vec3::x(), Vec3::y(), Vec3::z()].map(|d| poses[a].turn * d);
        let space = if plane { &space[..2] } else { &space[..] };
        match &self.kind {
            LinkKind::Fixed { at } => {
                together(at, space);
                self.no_turn(plane, poses, rows);
            }
            LinkKind::Hinge { at, axis } => {
                together(at, space);
                if !plane && *axis != Vec3::zeros() {
                    let [on_a, on_b] = self.ends.map(|end| poses[end].turn * axis);
                    for d in across(&on_a) {
                        rows.push(Row::turning(self.ends, on_b.cross(&d), d.dot(&on_b)));
                    }
                }
            }
            LinkKind::Rail { at, axis, turns } => {
                let along = poses[a].turn * axis;
                let [first, second] = across(&along);
                let in_plane = Vec3::new(-along[1], along[0], 0.0);
                let directions: &[Vec3] = if plane { &[in_plane] } else { &[first, second] };
                together(at, directions);
                if !turns {
                    self.no_turn(plane, poses, rows);
                }
            }
            LinkKind::Spring { .. } => {}
        }
    }

    /// How far its ends are apart, m.
    pub(super) fn apart(&self, plane: bool, bodies: &[Body], poses: &[Pose]) -> f64 {
        let mut rows = Vec::new();
        self.rows(plane, bodies, poses, &mut rows);
        let ways = rows.iter().filter(|row| row.linear != Vec3::zeros());
        ways.map(|row| row.gap * row.gap).sum::<f64>().sqrt()
    }

    fn no_turn(&self, plane: bool, poses: &[Pose], rows: &mut Vec<Row>) {
        let [a, b] = self.ends;
        if plane {
            rows.push(Row::turning(self.ends, Vec3::z(), poses[b].angle - poses[a].angle));
            return;
        }
        let turned: UnitQuaternion<f64> = poses[b].turn * poses[a].turn.inverse();
        let way = if turned.w < 0.0 { -2.0 } else { 2.0 };
        for (k, axis) in [Vec3::x(), Vec3::y(), Vec3::z()].into_iter().enumerate() {
            rows.push(Row::turning(self.ends, axis, way * turned.imag()[k]));
        }
    }

    /// Appends the ways that the joint leaves free, m or rad, as the gaps of rows along them; `plane` as above. None of
    /// a fixed joint and of a ball; of a spring that rests at no length one along each axis.
    pub(super) fn ways(&self, plane: bool, bodies: &[Body], poses: &[Pose], rows: &mut Vec<Row>) {
        let [a, b] = self.ends;
        match &self.kind {
            LinkKind::Fixed { .. } => {}
            LinkKind::Hinge { axis, .. } if plane => {
                rows.push(Row::turning(self.ends, *axis, poses[b].angle - poses[a].angle));
            }
            LinkKind::Hinge { axis, .. } => {
                if *axis == Vec3::zeros() {
                    return;
                }
                let [mark, side] = across(axis);
                let on_b = poses[b].turn * mark;
                let (cos, sin) = (on_b.dot(&(poses[a].turn * mark)), -on_b.dot(&(poses[a].turn * side)));
                // Since mark = axis x side, mark turns away from side.
                rows.push(Row::turning(self.ends, poses[a].turn * axis, libm::atan2(sin, cos)));
            }
            LinkKind::Rail { at, axis, .. } => {
                let [on_a, on_b] = self.ends.map(|end| bodies[end].place(&poses[end], at));
                let along = poses[a].turn * axis;
                rows.push(Row::between(self.ends, poses, on_b, along, along.dot(&(on_b - on_a))));
            }
            LinkKind::Spring { points } => {
                let on_a = bodies[a].place(&poses[a], &points[0]);
                let on_b = bodies[b].place(&poses[b], &points[1]);
                let way = on_b - on_a;
                let length = way.norm_squared().sqrt();
                if self.rest == 0.0 {
                    let axes = [Vec3::x(), Vec3::y(), Vec3::z()].into_iter().take(if plane { 2 } else { 3 });
                    rows.extend(axes.map(|d| Row::between(self.ends, poses, on_b, d, d.dot(&way))));
                } else if length > 0.0 {
                    rows.push(Row::between(self.ends, poses, on_b, way / length, length));
                }
            }
        }
    }
}
