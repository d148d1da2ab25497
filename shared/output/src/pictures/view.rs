//! What part of space a picture of particles shows, and where on the picture.

use super::contact::Instant;
use super::stamp::Rect;
use halfstep_scene::{Motion, Phase, Scene, Shape};
use halfstep_wire::frame::{FLUID, SOLID, WALL};

/// Largest picture, pixels.
const LARGEST: [f64; 2] = [1680.0, 1300.0];
/// Pixels between the panels and around them, and above each one for its time.
const GAP: i32 = 18;
const CAPTION: i32 = 26;
/// Largest distance of two particles on the picture, pixels.
const WIDEST_SPACING: f64 = 30.0;
/// The view grows with what moves, at most by this part of its size at each side.
const GROWTH: f64 = 0.5;
/// What is left free beside the outermost particles, in spacings.
const EDGE: f64 = 1.5;
/// Part of the fluid on each side that does not make the view grow: spray.
const SPRAY: f64 = 0.02;

/// A rectangle of the x-y plane; of three-dimensional scenes a slice through the middle.
#[derive(Clone)]
pub(crate) struct View {
    min: [f64; 2],
    max: [f64; 2],
    slice: Option<[f64; 2]>,
    /// Walls are followed wherever they go.
    walls: bool,
}

impl View {
    /// The box of all particles at the first instant, widened by where solid, bulk of the fluid and swinging walls go.
    /// `None` without particles.
    pub(crate) fn of(scene: &Scene, instants: &[Instant]) -> Option<Self> {
        let first = instants.first()?;
        let initial = [FLUID, SOLID, WALL].into_iter().flat_map(|phase| first.phase(phase));
        let initial = around(initial.map(|(frame, k)| frame.points[k].map(f64::from)))?;
        let mut bounds = [initial[0], initial[1]];
        let walls = follows_walls(scene);
        for instant in &instants[1..] {
            for axis in 0..2 {
                for x in bulk(instant, axis, walls).into_iter().flatten() {
                    bounds[axis].include(initial[axis].limit(x));
                }
            }
        }
        Some(Self { walls, ..Self::new(scene, bounds, initial[2]) })
    }

    /// The view of an instant, moved to where the bulk of its particles is, and by how much, m: what goes on and on, as
    /// a tank that is towed, does not leave it.
    pub(crate) fn following(&self, scene: &Scene, instant: &Instant) -> (Self, [f64; 2]) {
        let edge = EDGE * scene.resolution;
        let by = [0, 1].map(|axis| {
            let ends = bulk(instant, axis, self.walls).into_iter().flatten();
            let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            let (before, after) = (self.min[axis] - (low - edge), (high + edge) - self.max[axis]);
            // What sticks out on both sides is larger than the view.
            match (before > 0.0, after > 0.0) {
                (false, true) => after.min(-before),
                (true, false) => -before.min(-after),
                _ => 0.0,
            }
        });
        let moved = |corner: [f64; 2]| [corner[0] + by[0], corner[1] + by[1]];
        (Self { min: moved(self.min), max: moved(self.max), ..self.clone() }, by)
    }

    /// The box around these points, m; `None` without points.
    pub(crate) fn of_points(scene: &Scene, points: impl Iterator<Item = [f64; 3]>) -> Option<Self> {
        around(points).map(|[x, y, z]| Self::new(scene, [x, y], z))
    }

    fn new(scene: &Scene, bounds: [Range; 2], depth: Range) -> Self {
        let edge = EDGE * scene.resolution;
        let middle = 0.5 * (depth.low + depth.high);
        Self {
            min: bounds.map(|range| range.low - edge),
            max: bounds.map(|range| range.high + edge),
            slice: (scene.dimension == 3).then_some([middle - scene.resolution, middle + scene.resolution]),
            walls: false,
        }
    }

    /// Width and height, m.
    pub(crate) fn size(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.max[axis] - self.min[axis])
    }

    /// Whether a point lies in the slice that is shown.
    pub(crate) fn shows(&self, point: [f32; 3]) -> bool {
        self.slice.is_none_or(|[low, high]| (low..=high).contains(&f64::from(point[2])))
    }

    /// How many particles of fluid and solid an instant has beyond the edges.
    pub(crate) fn beyond(&self, instant: &Instant) -> usize {
        let outside = |point: &[f32; 3]| {
            let x = [0, 1].map(|axis| f64::from(point[axis]));
            !(0..2).all(|axis| (self.min[axis]..=self.max[axis]).contains(&x[axis]))
        };
        let moving = [FLUID, SOLID].into_iter().flat_map(|phase| instant.phase(phase));
        moving.filter(|(frame, k)| self.shows(frame.points[*k]) && outside(&frame.points[*k])).count()
    }

    /// Where in a panel a point lies; y points up in space and down in the picture.
    pub(crate) fn pixel(&self, point: [f32; 3], panel: Rect, scale: f64) -> [f64; 2] {
        let [x, y] = [f64::from(point[0]), f64::from(point[1])];
        [f64::from(panel.x) + (x - self.min[0]) * scale, f64::from(panel.y) + (self.max[1] - y) * scale]
    }
}

/// Whether walls are shown wherever they go: those that swing or turn, and where all move. A gate that opens is not
/// followed.
fn follows_walls(scene: &Scene) -> bool {
    let mut walls = scene.shapes.iter().filter(|s| s.phase == Phase::Wall).peekable();
    let swings = |s: &Shape| s.motion.as_ref().is_some_and(|m| !matches!(m, Motion::Steady { .. }));
    let all_move = walls.peek().is_some() && walls.all(|s| s.motion.is_some());
    all_move || scene.shapes.iter().any(swings)
}

/// Ends of the fluid but for its spray, of the solids, and of walls if they count, along an axis, m.
fn bulk(instant: &Instant, axis: usize, walls: bool) -> [Option<f64>; 6] {
    let along = |phase| {
        let all = instant.phase(phase).map(|(frame, k)| f64::from(frame.points[k][axis]));
        let mut all: Vec<f64> = all.filter(|x| x.is_finite()).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let (fluid, solid) = (along(FLUID), along(SOLID));
    let spray = (fluid.len() as f64 * SPRAY) as usize;
    let walls = if walls { along(WALL) } else { Vec::new() };
    let fluid = [fluid.get(spray), fluid.iter().nth_back(spray)];
    [fluid[0], fluid[1], solid.first(), solid.last(), walls.first(), walls.last()].map(Option::<&f64>::copied)
}

/// Ranges of the points' coordinates; `None` without points.
fn around(points: impl Iterator<Item = [f64; 3]>) -> Option<[Range; 3]> {
    let mut ranges = [Range::EMPTY; 3];
    for point in points {
        for (range, x) in ranges.iter_mut().zip(point) {
            range.include(x);
        }
    }
    ranges[..2].iter().all(Range::is_finite).then_some(ranges)
}

#[derive(Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    const EMPTY: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };

    fn include(&mut self, x: f64) {
        self.low = self.low.min(x);
        self.high = self.high.max(x);
    }

    fn is_finite(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// The nearest value inside the range widened by its growth.
    fn limit(&self, x: f64) -> f64 {
        let growth = GROWTH * (self.high - self.low);
        x.clamp(self.low - growth, self.high + growth)
    }
}

/// Where everything lies on the picture.
pub(crate) struct Layout {
    /// Of the picture, pixels.
    pub(crate) width: i32,
    /// Of the picture, pixels.
    pub(crate) height: i32,
    /// Pixels per metre.
    pub(crate) scale: f64,
    pub(crate) panels: Vec<Rect>,
}

/// Arranges `count` views in the grid that shows them largest, below a heading and above a foot.
pub(crate) fn layout(count: usize, size: [f64; 2], head: i32, foot: i32, spacing: f64) -> Layout {
    let count = count.max(1) as i32;
    let scale = |columns: i32| {
        let rows = (count + columns - 1) / columns;
        let width = (LARGEST[0] - f64::from(GAP * (columns + 1))) / f64::from(columns);
        let height = (LARGEST[1] - f64::from(head + foot + (GAP + CAPTION) * rows)) / f64::from(rows);
        (width / size[0]).min(height / size[1]).min(WIDEST_SPACING / spacing)
    };
    // Of equals the widest: people scroll down, and the heading needs room.
    let columns = (1..=count).max_by(|&a, &b| f64::total_cmp(&scale(a), &scale(b))).unwrap_or(1);
    let rows = (count + columns - 1) / columns;
    let scale = scale(columns);
    let [width, height] = size.map(|length| ((length * scale).round() as i32).max(1));
    let panel = |k| Rect {
        x: GAP + k % columns * (width + GAP),
        y: head + CAPTION + k / columns * (height + GAP + CAPTION),
        width,
        height,
    };
    Layout {
        width: (GAP + columns * (width + GAP)).max(700),
        height: head + foot + rows * (height + GAP + CAPTION),
        scale,
        panels: (0..count).map(panel).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Frame;
    use halfstep_scene::parse;

    #[test]
    fn panels_fit_and_do_not_overlap() {
        for size in [[1.0, 1.0], [8.0, 1.0], [1.0, 5.0], [0.02, 0.01]] {
            for count in 1..=6 {
                let place = layout(count, size, 50, 80, 1e-4);
                assert_eq!(place.panels.len(), count);
                assert!(
                    f64::from(place.width) <= LARGEST[0] + 1.0 && f64::from(place.height) <= LARGEST[1] + 6.0
                );
                for (k, a) in place.panels.iter().enumerate() {
                    assert!(
                        a.x >= GAP
                            && a.x + a.width + GAP <= place.width
                            && a.y + a.height + 80 <= place.height
                    );
                    let apart = |b: &Rect| a.x + a.width < b.x || a.y + a.height + CAPTION <= b.y;
                    assert!(place.panels[k + 1..].iter().all(apart), "{size:?} {count}");
                }
            }
        }
        // Long channels stand above each other, towers side by side.
        assert!(layout(6, [8.0, 1.0], 50, 80, 1e-4).panels[1].x == GAP);
        assert!(layout(6, [1.0, 5.0], 50, 80, 1e-4).panels[5].x > GAP);
    }

    /// A tank 1 m wide at this x, with water in it, and a drop 30 m away.
    fn at(x: f64) -> Instant {
        let mut frame = Frame::default();
        let mut put = |phase: u8, x: f64, y: f64| {
            frame.points.push([x as f32, y as f32, 0.0]);
            frame.phase.push(phase);
        };
        for k in 0..=100 {
            put(WALL, x + 0.01 * f64::from(k), 0.0);
            put(FLUID, x + 0.01 * f64::from(k), 0.1);
        }
        put(FLUID, x + 30.0, 0.1);
        Instant { time: 0.0, frames: vec![frame] }
    }

    fn tank(motion: &str) -> Scene {
        let text = format!(
            "resolution = 0.02\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n\
             [[shape]]\nname = \"tank\"\nphase = \"wall\"\ntank = {{ min = [0.0, 0.0], max = [1.0, 0.4] }}\n{motion}\n\
             [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [1.0, 0.2] }}\n"
        );
        parse(&text, "tank.toml".as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}"))
    }

    #[test]
    fn a_view_follows_a_tank_that_is_towed() {
        let scene = tank("motion = { velocity = [1.0, 0.0] }");
        let instants = [0.0, 1.0, 2.0, -3.0].map(at);
        let view = View::of(&scene, &instants[..3]).expect("particles");
        // Particles at the first instant reach to the drop, 30 m away, and the view grows by no more than half of that.
        let narrow = View { min: [-0.03, -0.03], max: [1.53, 0.13], ..view };
        let moved: Vec<f64> = instants.iter().map(|i| narrow.following(&scene, i).1[0]).collect();
        for (found, by_hand) in moved.iter().zip([0.0, 0.5, 1.5, -3.0]) {
            assert!((found - by_hand).abs() < 1e-6, "{moved:?}");
        }
        let (followed, _) = narrow.following(&scene, &instants[2]);
        assert!((followed.min[0] - 1.47).abs() < 1e-6 && (followed.size()[0] - 1.56).abs() < 1e-9);
        // The drop; in a view of 0.5 m the water from 0.5 to 1 m, too.
        assert_eq!(narrow.beyond(&instants[0]), 1);
        assert_eq!(View { max: [0.505, 0.13], ..narrow }.beyond(&instants[0]), 51);
    }

    #[test]
    fn walls_that_open_are_not_followed() {
        assert!(follows_walls(&tank("motion = { velocity = [1.0, 0.0] }")));
        assert!(!follows_walls(&tank("")));
        let gate = "motion = { velocity = [1.0, 0.0] }\n[[shape]]\nname = \"floor\"\nphase = \"wall\"\n\
                    box = { min = [2.0, 0.0], max = [3.0, 0.2] }";
        assert!(!follows_walls(&tank(gate)));
    }
}
