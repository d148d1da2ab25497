//! What walls do to a block that does not turn, by hand.

use super::*;
use halfstep_scene::geometry;
use halfstep_wire::state::State;
use std::path::Path;

/// A block of 0.1 m and 10 kg/m, which goes as a solid goes through its half-steps.
struct Run {
    walls: WallContact,
    records: Vec<StateRecord>,
    start: Vec<[f64; 2]>,
    at: [f64; 2],
    velocity: [f64; 2],
    gravity: f64,
    time: f64,
    dt: f64,
}

const MASS: f64 = 10.0;

/// A scene with the block's lower side at this height and these walls; `contact`: keys of the block's.
fn scene(bottom: f64, contact: &str, walls: &str) -> Scene {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -10.0]\n[numerics]\ncfl = 0.4\n\
         [fluid]\ndensity = 1000.0\n[solid]\n\
         model = \"rigid\"\ndensity = 1000.0\ncontact = {{ {contact} }}\n[[shape]]\nname = \"block\"\n\
         phase = \"solid\"\nbox = {{ min = [0.0, {bottom}], max = [0.1, {}] }}\n[[shape]]\nname = \"water\"\n\
         phase = \"fluid\"\nbox = {{ min = [5.0, 0.0], max = [5.1, 0.1] }}\n[[shape]]\nname = \"wall\"\n\
         phase = \"wall\"\ncontact = true\n{walls}\n",
        bottom + 0.1
    );
    halfstep_scene::parse(&text, Path::new("x.toml"), &[]).expect("a right scene")
}

const FLOOR: &str = "box = { min = [-1.0, -0.1], max = [4.0, 0.0] }";

impl Run {
    fn of(scene: &Scene, velocity: [f64; 2]) -> Self {
        let mut walls = WallContact::new(scene, 0).expect("a wall that can be touched");
        let points = geometry::layout(scene).with_solid(scene, 0).solid;
        let start: Vec<[f64; 2]> = points.iter().map(|p| p.position).collect();
        let record = |x: &[f64; 2]| StateRecord {
            mass: MASS / start.len() as f64,
            position: [x[0], x[1], 0.0],
            ..StateRecord::default()
        };
        let records: Vec<StateRecord> = start.iter().map(record).collect();
        walls.begin(&records);
        let (dt, gravity) = (walls.limit(), -10.0);
        Self { walls, records, start, at: [0.0; 2], velocity, gravity, time: 0.0, dt }
    }

    fn acceleration(&mut self, [at, velocity]: [[f64; 2]; 2], time: f64, whole: bool) -> [f64; 2] {
        for (record, start) in self.records.iter_mut().zip(&self.start) {
            record.position = [start[0] + at[0], start[1] + at[1], 0.0];
            record.velocity = [velocity[0], velocity[1], 0.0];
        }
        self.walls.evaluate(&self.records, [time, self.dt], whole);
        let forces = (0..self.records.len()).map(|record| self.walls.on(record));
        forces.fold([0.0, self.gravity], |sum, f| [sum[0] + f[0] / MASS, sum[1] + f[1] / MASS])
    }

    fn until(&mut self, end: f64) {
        while self.time < end {
            let (dt, x, v) = (self.dt, self.at, self.velocity);
            let a = self.acceleration([x, v], self.time, true);
            let middle = [
                [0, 1].map(|d| x[d] + 0.5 * dt * v[d] + 0.125 * dt * dt * a[d]),
                [0, 1].map(|d| v[d] + 0.5 * dt * a[d]),
            ];
            let a = self.acceleration(middle, self.time + 0.5 * dt, false);
            let way = [0, 1].map(|d| dt * v[d] + 0.5 * dt * dt * a[d]);
            self.walls.work(|_| way);
            self.at = [0, 1].map(|d| x[d] + way[d]);
            self.velocity = [0, 1].map(|d| v[d] + dt * a[d]);
            self.time += dt;
        }
    }

    /// How deep the weight presses the block, which does not bounce, into a floor: at rest the force is half of K g,
    /// and both corners have half a part of the sides beside them, too.
    fn sunk(&self) -> f64 {
        MASS * 10.0 / (self.walls.law().stiffness * 0.5 * (0.1 + 0.005))
    }
}

#[test]
fn a_block_that_falls_comes_to_rest_as_deep_as_its_weight_presses_it() {
    let mut run = Run::of(&scene(0.01, "", FLOOR), [0.0; 2]);
    run.until(1.5);
    let (depth, sunk) = (-0.01 - run.at[1], run.sunk());
    println!("{depth:e} of {sunk:e}, {:?}", run.walls.booked());
    assert!((run.walls.booked().normal / (-MASS * 10.0 * (0.01 + depth)) - 1.0).abs() < 1e-3);
    assert!(run.velocity[1].abs() < 1e-6);
    assert!((depth / sunk - 1.0).abs() < 1e-3, "{depth} {sunk}");
}

/// The error of the speed, 2.1e-3 with the largest step, is that of the midpoint rule: of second order.
#[test]
fn an_elastic_impact_gives_the_speed_back() {
    let error = |part: f64| {
        let mut run = Run::of(&scene(0.001, "restitution = 1.0", FLOOR), [0.0, -2.0]);
        (run.gravity, run.dt) = (0.0, part * run.dt);
        run.until(0.1);
        (run.velocity[1] / 2.0 - 1.0).abs()
    };
    let errors = [1.0, 0.5, 0.25].map(error);
    println!("{errors:?}");
    assert!(errors[0] < 4e-3 && errors[1] < 0.5 * errors[0] && errors[2] < 0.3 * errors[1], "{errors:?}");
}

/// A block that does not strain, in steps of the limit and of a tenth of it: the speed within which the force changes
/// is what a step changes. Measured: off by 0.031, 0.145 and 0.305, and by 0.0005, 0.006 and 0.074.
#[test]
fn shorter_steps_come_nearer_to_the_restitution_that_is_asked() {
    for (restitution, most) in [(0.5, 0.002), (0.2, 0.01), (0.0, 0.08)] {
        let off = [1.0, 0.1].map(|part| {
            let mut run = Run::of(&scene(0.001, &format!("restitution = {restitution}"), FLOOR), [0.0, -2.0]);
            (run.gravity, run.dt) = (0.0, part * run.dt);
            run.until(0.1);
            run.velocity[1] / 2.0 - restitution
        });
        println!("e = {restitution}: off by {off:?}");
        assert!(off[1].abs() < most && off[1].abs() < 0.25 * off[0].abs(), "e = {restitution}: {off:?}");
    }
}

#[test]
fn a_block_slides_as_coulomb_says_and_a_belt_takes_it_along() {
    let mut run = Run::of(&scene(0.0, "friction = 0.3", FLOOR), [1.0, 0.0]);
    run.until(0.6);
    let expected = 1.0 / (2.0 * 0.3 * 10.0);
    println!("way {} of {expected}, {:?}", run.at[0], run.walls.booked());
    assert!((run.at[0] / expected - 1.0).abs() < 5e-3, "{}", run.at[0]);
    assert!((run.walls.booked().friction / (-0.5 * MASS) - 1.0).abs() < 0.01);

    // With the belt's 0.6 m/s after 0.2 s, in which it went 0.06 m; then it stays where it is on the belt.
    let belt = format!("{FLOOR}\nvelocity = [0.6, 0.0]");
    let mut run = Run::of(&scene(0.0, "friction = 0.3", &belt), [0.0; 2]);
    run.until(0.5);
    let expected = 0.06 + 0.6 * (run.time - 0.2);
    println!("belt: way {} of {expected}, speed {}", run.at[0], run.velocity[0]);
    assert!((run.velocity[0] / 0.6 - 1.0).abs() < 1e-3, "{:?}", run.velocity);
    assert!((run.at[0] / expected - 1.0).abs() < 5e-3, "{}", run.at[0]);
}

/// A floor that goes up and to the right takes the block along; one that turns does, too: its place goes round.
#[test]
fn walls_that_move_take_a_block_along() {
    let lift = format!("{FLOOR}\nmotion = {{ velocity = [0.2, 0.3] }}");
    let mut run = Run::of(&scene(0.0, "friction = 1.0", &lift), [0.0; 2]);
    run.until(0.5);
    println!("lifted by {:?} with {:?} m/s", run.at, run.velocity);
    assert!((run.velocity[0] - 0.2).abs() < 1e-3 && (run.velocity[1] - 0.3).abs() < 1e-3);
    assert!((run.at[1] - 0.3 * run.time + run.sunk()).abs() < 1e-3, "{:?}", run.at);

    let placement =
        halfstep_scene::Motion::Steady { velocity: [0.2, 0.3, 0.0], start: 0.0, end: 1e9 }.at(2.0);
    assert_eq!(placement.point_at([0.4, 0.6]), [0.0, 0.0]);
    let turn =
        halfstep_scene::Turn { pivot: [1.0, 0.0, 0.0], sin: 0.6, cos: 0.8, rate: 0.0, acceleration: 0.0 };
    let turned = halfstep_scene::Placement { turn: Some(turn), ..placement };
    let found = turned.point_at(turned.position_of([0.3, 0.7]));
    assert!((found[0] - 0.3).abs() < 1e-15 && (found[1] - 0.7).abs() < 1e-15, "{found:?}");
}

/// What is let into the floor is not thrown out of it, and is held where it would go deeper.
#[test]
fn what_begins_in_a_wall_is_not_thrown_out() {
    let mut run = Run::of(&scene(-0.03, "", FLOOR), [0.0; 2]);
    assert_eq!(run.acceleration([[0.0; 2]; 2], 0.0, true), [0.0, -10.0]);
    run.until(1.0);
    println!("{:?}", run.at);
    assert!(run.at[1] < 0.0 && run.at[1] > -1.001 * run.sunk(), "{:?}", run.at);
}

/// A tip between two points, which are 5 mm apart.
const TIP: &str = "polygon = [[0.0323, -0.1], [0.0723, -0.1], [0.0523, 0.0]]";

/// The tip has 5 mm of the outline's stiffness, of which half acts at rest.
#[test]
fn a_tip_between_two_points_carries_a_block() {
    let mut run = Run::of(&scene(0.01, "", TIP), [0.0; 2]);
    run.until(1.5);
    let depth = -0.01 - run.at[1];
    let sunk = MASS * 10.0 / (run.walls.law().stiffness * 0.5 * 0.005);
    println!("{depth:e} of {sunk:e}, {:?}", run.walls.booked());
    assert!(run.velocity[1].abs() < 1e-6);
    assert!((depth / sunk - 1.0).abs() < 1e-3, "{depth} {sunk}");
    assert!((run.walls.booked().normal / (-MASS * 10.0 * (0.01 + depth)) - 1.0).abs() < 1e-3);
}

/// The points of the block that are in the tip are pushed by neither flank.
#[test]
fn a_tip_without_friction_holds_nothing_sideways() {
    let mut run = Run::of(&scene(0.0, "", TIP), [0.1, 0.0]);
    run.until(0.2);
    println!("{:?}, {:?}", run.velocity, run.walls.booked());
    assert!(run.walls.booked().largest_penetration > 1e-3);
    assert!((run.velocity[0] / 0.1 - 1.0).abs() < 1e-12, "{:?}", run.velocity);
}

/// A foot that is let into the floor is not thrown out by the floor's corners beside it.
#[test]
fn corners_in_the_solid_at_the_start_are_left_out() {
    let beside =
        "polygon = [[-1.0, -0.1], [0.0, -0.1], [0.0, -0.02], [0.05, -0.02], [0.05, 0.0], [-1.0, 0.0]]";
    let mut run = Run::of(&scene(-0.03, "", beside), [0.0; 2]);
    assert_eq!(run.acceleration([[0.0; 2]; 2], 0.0, true), [0.0, -10.0]);
}

#[test]
fn a_scene_says_who_touches() {
    let told = scene(0.0, "", FLOOR);
    assert!(WallContact::new(&told, 0).is_some());
    let none = scene(0.0, "", &FLOOR.replace("box", "velocity = [0.0, 0.0]\nbox")).shapes;
    let mut untouched = Scene { shapes: none, ..told.clone() };
    untouched.shapes.iter_mut().for_each(|shape| shape.contact = false);
    assert!(WallContact::new(&untouched, 0).is_none());
    let mut off = told.clone();
    off.effects.insert(halfstep_scene::EffectName::WallContact, halfstep_scene::Switch::Off);
    assert!(WallContact::new(&off, 0).is_none());
    let space = Scene { dimension: 3, ..told };
    assert!(WallContact::new(&space, 0).is_none());
}

/// Interrupted in the middle of sliding, on the same floor or tip that moves.
#[test]
fn a_contact_goes_on_to_the_same_bits() {
    [FLOOR, TIP].into_iter().for_each(goes_on);
}

fn goes_on(wall: &str) {
    let moving = format!("{wall}\nmotion = {{ velocity = [0.2, 0.0] }}");
    let told = scene(0.0, "friction = 0.3", &moving);
    let depths = |run: &Run| run.walls.booked().largest_penetration;
    let mut whole = Run::of(&told, [0.8, 0.0]);
    whole.until(0.1);
    assert!(depths(&whole) > 0.0, "it touches");
    let saved = whole.walls.save();
    let mut other = Run::of(&told, [0.0; 2]);
    other.walls = WallContact::new(&told, 0).expect("a wall");
    other.walls.load(&saved).expect("its own state");
    (other.at, other.velocity, other.time) = (whole.at, whole.velocity, whole.time);
    [&mut whole, &mut other].into_iter().for_each(|run| run.until(0.4));
    assert_eq!((whole.at, whole.velocity), (other.at, other.velocity));
    assert_eq!(whole.walls.booked(), other.walls.booked());
}
