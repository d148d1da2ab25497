//! Where something that moves by prescription is.

/// Where a moving wall is, relative to its place in the scene: x = p + u + R (X - p) with the pivot p.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Placement {
    /// Displacement u, m.
    pub displacement: [f64; 3],
    /// Its rate, m/s.
    pub velocity: [f64; 3],
    /// Its second rate, m/s².
    pub acceleration: [f64; 3],
    /// Rotation R; `None`: it does not turn.
    pub turn: Option<Turn>,
}

/// A rotation about an axis along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Where the axis is in the scene, m.
    pub pivot: [f64; 3],
    /// Sine of the angle.
    pub sin: f64,
    /// Cosine of the angle.
    pub cos: f64,
    /// Angular velocity omega, rad/s, positive counter-clockwise.
    pub rate: f64,
    /// Angular acceleration, rad/s².
    pub acceleration: f64,
}

/// Of the angles with a sine and a cosine, times any length, the one nearest to another angle, rad: beyond whole turns.
pub fn angle_near(sine: f64, cosine: f64, before: f64) -> f64 {
    let angle = libm::atan2(sine, cosine);
    let turns = libm::round((before - angle) / std::f64::consts::TAU);
    angle + turns * std::f64::consts::TAU
}

impl Turn {
    /// R v.
    fn turned<const D: usize>(&self, mut v: [f64; D]) -> [f64; D] {
        let [x, y] = [v[0], v[1]];
        (v[0], v[1]) = (self.cos * x - self.sin * y, self.sin * x + self.cos * y);
        v
    }

    /// R (X - p).
    fn arm<const D: usize>(&self, place: [f64; D]) -> [f64; D] {
        self.turned(std::array::from_fn(|d| place[d] - self.pivot[d]))
    }
}

impl Placement {
    /// How far a point of the scene has gone, m.
    pub fn displacement_of<const D: usize>(&self, place: [f64; D]) -> [f64; D] {
        match &self.turn {
            None => std::array::from_fn(|d| self.displacement[d]),
            Some(_) => {
                let now = self.position_of(place);
                std::array::from_fn(|d| now[d] - place[d])
            }
        }
    }

    /// Where a point of the scene is, m.
    pub fn position_of<const D: usize>(&self, place: [f64; D]) -> [f64; D] {
        match &self.turn {
            None => std::array::from_fn(|d| place[d] + self.displacement[d]),
            Some(turn) => {
                let arm = turn.arm(place);
                std::array::from_fn(|d| turn.pivot[d] + self.displacement[d] + arm[d])
            }
        }
    }

    /// The point of the scene that is at a place now, m.
    pub fn point_at<const D: usize>(&self, position: [f64; D]) -> [f64; D] {
        let shifted: [f64; D] = std::array::from_fn(|d| position[d] - self.displacement[d]);
        let Some(Turn { pivot, sin, cos, .. }) = &self.turn else { return shifted };
        let [x, y] = [0, 1].map(|d| shifted[d] - pivot[d]);
        let mut point = shifted;
        (point[0], point[1]) = (pivot[0] + cos * x + sin * y, pivot[1] + cos * y - sin * x);
        point
    }

    /// Velocity of a point of the scene, m/s: u' + omega x r.
    pub fn velocity_of<const D: usize>(&self, place: [f64; D]) -> [f64; D] {
        let mut velocity = std::array::from_fn(|d| self.velocity[d]);
        if let Some(turn) = &self.turn {
            let r = turn.arm(place);
            velocity[0] -= turn.rate * r[1];
            velocity[1] += turn.rate * r[0];
        }
        velocity
    }

    /// Acceleration of a point of the scene, m/s²: u'' + omega' x r - omega² r.
    pub fn acceleration_of<const D: usize>(&self, place: [f64; D]) -> [f64; D] {
        let mut acceleration = std::array::from_fn(|d| self.acceleration[d]);
        if let Some(turn) = &self.turn {
            let r = turn.arm(place);
            let square = turn.rate * turn.rate;
            acceleration[0] -= turn.acceleration * r[1] + square * r[0];
            acceleration[1] += turn.acceleration * r[0] - square * r[1];
        }
        acceleration
    }

    /// A vector that goes along, such as a normal.
    pub fn direction_of<const D: usize>(&self, vector: [f64; D]) -> [f64; D] {
        self.turn.map_or(vector, |turn| turn.turned(vector))
    }

    /// How far a point can have moved since another placement, m, that is at most `radius` away from the pivot.
    pub fn moved_since(&self, before: &Self, radius: f64) -> f64 {
        let way = (0..3).map(|d| (self.displacement[d] - before.displacement[d]).powi(2)).sum::<f64>().sqrt();
        let Some(turn) = &self.turn else { return way };
        let (sin, cos) = before.turn.map_or((0.0, 1.0), |before| (before.sin, before.cos));
        // The chord of the angle between both.
        way + radius * ((turn.sin - sin).powi(2) + (turn.cos - cos).powi(2)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_found_again() {
        let turn = Turn { pivot: [1.0, 2.0, 0.0], sin: 0.6, cos: 0.8, rate: 0.0, acceleration: 0.0 };
        let placement =
            Placement { displacement: [0.5, -0.25, 0.0], turn: Some(turn), ..Placement::default() };
        // One beside the pivot: by 0.8 and 0.6, and shifted.
        let now = placement.position_of([2.0, 2.0]);
        assert!((now[0] - 2.3).abs() < 1e-15 && (now[1] - 2.35).abs() < 1e-15, "{now:?}");
        let back = placement.point_at(now);
        assert!((back[0] - 2.0).abs() < 1e-15 && (back[1] - 2.0).abs() < 1e-15, "{back:?}");
        let shifted = Placement { displacement: [0.5, -0.25, 0.0], ..Placement::default() };
        assert_eq!(shifted.point_at([1.0, 1.0]), [0.5, 1.25]);
    }

    #[test]
    fn angles_go_on_beyond_a_turn() {
        let tau = std::f64::consts::TAU;
        let near =
            |angle: f64, before: f64| angle_near(2.0 * libm::sin(angle), 2.0 * libm::cos(angle), before);
        assert!((near(-3.1, 3.1) - (tau - 3.1)).abs() < 1e-15);
        assert!((near(0.1, 4.0 * tau) - (4.0 * tau + 0.1)).abs() < 1e-12);
        assert!((near(0.5, 0.2) - 0.5).abs() < 1e-15);
    }
}
