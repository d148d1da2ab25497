//! A rigid body: its mass and moments of inertia, where it is, and how it turns.

use super::Vec3;
use halfstep_scene::geometry::Surface;
use halfstep_scene::{Motion, Placement, angle_near};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion};

/// A body, or what bodies are tied to or touch: a wall, space.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Numbers of its particles; a wall has none.
    pub(super) particles: Vec<u32>,
    /// kg (2D: kg/m).
    pub(super) mass: f64,
    /// Centre of mass in the reference configuration, m.
    pub(super) center: Vec3,
    /// Principal axes of inertia in the reference configuration: columns.
    axes: Matrix3<f64>,
    /// 1 / I about each of them, 1/(kg m²); zero where it does not turn.
    inverse: Vec3,
    /// It goes as prescribed, whatever acts on it; with its motion, where it moves.
    pub(super) driven: Option<Option<Motion>>,
    /// Its surfaces in the reference configuration, where something may touch it.
    pub(super) surfaces: Vec<Surface>,
    /// A bound of the speed of what moves by prescription, m/s.
    pub(super) fastest: f64,
    /// Shortest period of what swings by prescription, s.
    pub(super) period: f64,
    /// Of a wall's surface, which stays where it is, m/s: what rests on it is taken along by friction.
    pub(super) surface_velocity: Vec3,
    /// What touches others' surfaces.
    pub(super) balls: Vec<Ball>,
    /// Walls that move alike, itself left out: what they cover of its surface is not touched.
    pub(super) alike: Vec<usize>,
    /// Distance of its farthest point from the centre of mass, m.
    pub(super) radius: f64,
    /// Index of the group of bodies and walls that are tied together, and so do not touch.
    pub(super) tied: Vec<usize>,
}

/// What touches others' surfaces: a point, or a disc as a whole.
#[derive(Clone, Debug)]
pub(super) struct Ball {
    /// From the centre of mass, m.
    pub(super) arm: Vec3,
    /// m.
    pub(super) radius: f64,
    /// How deep another surface may lie in it and be pushed out, m.
    pub(super) depth: f64,
    /// Of a point in the plane: between which normals, of the sides before and after it, faces lie on it.
    pub(super) between: Option<[Vec3; 2]>,
}

/// Sine of the angle by which a face may lie on a corner from beside its normals.
const BESIDE: f64 = 1e-3;

impl Ball {
    /// Whether a face with this normal out of its body can lie on the ball, which is turned.
    pub(super) fn is_met_from(&self, turn: &UnitQuaternion<f64>, normal: &Vec3) -> bool {
        let Some(between) = self.between else { return true };
        let [before, after] = between.map(|normal| turn * normal);
        let cross = |a: &Vec3, b: &Vec3| a[0] * b[1] - a[1] * b[0];
        let from = -normal;
        cross(&before, &from) >= -BESIDE
            && cross(&from, &after) >= -BESIDE
            && from.dot(&(before + after)) > 0.0
    }

    /// It is where two sides meet.
    pub(super) fn is_corner(&self) -> bool {
        self.between.is_some_and(|[before, after]| before != after)
    }

    /// Direction from a point into its body, which is turned; none of a disc.
    pub(super) fn inward(&self, turn: &UnitQuaternion<f64>) -> Option<Vec3> {
        self.between.map(|[before, after]| turn * -(before + after).normalize())
    }
}

/// Where a body is, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    /// Centre of mass, m.
    pub(super) center: Vec3,
    /// m/s.
    pub(super) velocity: Vec3,
    /// Rotation from the reference configuration.
    pub(super) turn: UnitQuaternion<f64>,
    /// Angle that it has turned about z, rad; in space only of what is prescribed.
    pub(super) angle: f64,
    /// Angular momentum about the centre of mass, kg m²/s.
    pub(super) spin: Vec3,
}

impl Pose {
    pub(super) fn at(center: Vec3) -> Self {
        let zero = Vec3::zeros();
        Self { center, velocity: zero, turn: UnitQuaternion::identity(), angle: 0.0, spin: zero }
    }

    /// The rotation's axis times its angle, rad.
    pub(super) fn turned(&self) -> Vec3 {
        let (sine, cosine) = (self.turn.imag(), self.turn.w);
        let size = sine.norm_squared().sqrt();
        if size > 0.0 { sine * (2.0 * libm::atan2(size, cosine) / size) } else { Vec3::zeros() }
    }

    /// Rotation as a matrix.
    pub(super) fn rotation(&self) -> Matrix3<f64> {
        self.turn.to_rotation_matrix().into_inner()
    }
}

/// The rotation by an angle about a unit vector.
fn rotation(axis: &Vec3, angle: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = (libm::sin(0.5 * angle), libm::cos(0.5 * angle));
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, axis * sin))
}

impl Body {
    /// A body of this inertia tensor about its centre of mass, kg m²; in the plane only the moment about z counts.
    pub(super) fn new(plane: bool, mass: f64, center: Vec3, inertia: Matrix3<f64>) -> Self {
        let (axes, inverse) = if plane {
            (Matrix3::identity(), Vec3::new(0.0, 0.0, 1.0 / inertia[(2, 2)]))
        } else if (0..3).all(|a| (0..3).all(|b| a == b || inertia[(a, b)] == 0.0)) {
            (Matrix3::identity(), inertia.diagonal().map(|x| 1.0 / x))
        } else {
            let eigen = inertia.symmetric_eigen();
            let mut axes = eigen.eigenvectors;
            if axes.determinant() < 0.0 {
                let last = -axes.column(2);
                axes.set_column(2, &last);
            }
            (axes, eigen.eigenvalues.map(|x| 1.0 / x))
        };
        Self {
            particles: Vec::new(),
            mass,
            center,
            axes,
            inverse,
            driven: None,
            surfaces: Vec::new(),
            balls: Vec::new(),
            alike: Vec::new(),
            fastest: 0.0,
            period: f64::INFINITY,
            surface_velocity: Vec3::zeros(),
            radius: 0.0,
            tied: Vec::new(),
        }
    }

    /// What only moves by prescription, with the scene's origin as its centre.
    pub(super) fn frame(motion: Option<Motion>) -> Self {
        let mut frame = Self::new(true, 1.0, Vec3::zeros(), Matrix3::identity());
        frame.driven = Some(motion);
        frame
    }

    /// Forces change how it moves.
    pub(super) fn gives_way(&self) -> bool {
        self.driven.is_none()
    }

    /// I^-1 of an angular momentum, rad/s.
    pub(super) fn turn_rate(&self, rotation: &Matrix3<f64>, spin: &Vec3) -> Vec3 {
        let axes = rotation * self.axes;
        axes * (axes.tr_mul(spin)).component_mul(&self.inverse)
    }

    /// Angular velocity, rad/s.
    pub(super) fn angular_velocity(&self, pose: &Pose) -> Vec3 {
        self.turn_rate(&pose.rotation(), &pose.spin)
    }

    /// I of an angular velocity, kg m²/s; nothing about axes that it does not turn about.
    pub(super) fn spin(&self, rotation: &Matrix3<f64>, rate: &Vec3) -> Vec3 {
        let axes = rotation * self.axes;
        let moment = |inverse: f64| if inverse > 0.0 { 1.0 / inverse } else { 0.0 };
        axes * (axes.tr_mul(rate)).component_mul(&self.inverse.map(moment))
    }

    /// J (2D: J/m).
    pub(super) fn kinetic_energy(&self, pose: &Pose) -> f64 {
        0.5 * self.mass * pose.velocity.norm_squared() + 0.5 * pose.spin.dot(&self.angular_velocity(pose))
    }

    /// Where it goes freely in `dt`, s.
    pub(super) fn drift(&self, pose: &mut Pose, dt: f64) {
        pose.center += pose.velocity * dt;
        // In the plane.
        if self.inverse[0] == 0.0 {
            pose.angle += dt * self.inverse[2] * pose.spin[2];
            pose.turn = rotation(&Vec3::z(), pose.angle);
            return;
        }
        let mut about = |axis: usize, dt: f64| {
            let direction = pose.turn * self.axes.column(axis).into_owned();
            let angle = dt * self.inverse[axis] * direction.dot(&pose.spin);
            pose.turn = rotation(&direction, angle) * pose.turn;
        };
        let half = 0.5 * dt;
        for (axis, part) in [(0, half), (1, half), (2, dt), (1, half), (0, half)] {
            about(axis, part);
        }
        // Products of rotations drift off the unit sphere by rounding.
        let q = pose.turn.into_inner();
        pose.turn = UnitQuaternion::new_unchecked(q / q.norm_squared().sqrt());
    }

    /// Brings what goes as prescribed to where it is at a time, s.
    pub(super) fn drive(&self, pose: &mut Pose, time: f64) {
        let Some(motion) = &self.driven else { return };
        let placement = motion.as_ref().map_or_else(Placement::default, |motion| motion.at(time));
        let center: [f64; 3] = self.center.into();
        pose.center = placement.position_of(center).into();
        pose.velocity = placement.velocity_of(center).into();
        let (sine, cosine, rate) =
            placement.turn.map_or((0.0, 1.0, 0.0), |turn| (turn.sin, turn.cos, turn.rate));
        pose.angle = angle_near(sine, cosine, pose.angle);
        pose.turn = rotation(&Vec3::z(), pose.angle);
        pose.spin = self.spin(&pose.rotation(), &Vec3::new(0.0, 0.0, rate));
    }

    /// Present place of a point of the reference configuration, m.
    pub(super) fn place(&self, pose: &Pose, point: &Vec3) -> Vec3 {
        pose.center + pose.turn * (point - self.center)
    }
}
