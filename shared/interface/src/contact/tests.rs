//! The law of contact by hand, on blocks that do not turn and go as a solid goes through its half-steps.

use super::*;
use halfstep_scene::geometry;
use std::path::Path;

/// A block of a solid without rotation.
pub(super) struct Block {
    pub(super) records: Vec<StateRecord>,
    start: Vec<[f64; 2]>,
    pub(super) at: [f64; 2],
    pub(super) velocity: [f64; 2],
    pub(super) mass: f64,
    /// It stays where it is.
    pub(super) fixed: bool,
}

pub(super) struct Run {
    pub(super) contact: Contact,
    pub(super) blocks: Vec<Block>,
    pub(super) gravity: [f64; 2],
    dt: f64,
    steps: usize,
}

pub(super) fn shape(name: &str, geometry: &str) -> String {
    format!("[[shape]]\nname = \"{name}\"\nphase = \"solid\"\nsolid = \"{name}\"\n{geometry}\n")
}

pub(super) fn boxed(name: &str, min: [f64; 2], max: [f64; 2]) -> String {
    shape(name, &format!("box = {{ min = {min:?}, max = {max:?} }}"))
}

fn solids(names: [&str; 2]) -> String {
    let one = |name| format!("[[solid]]\nname = \"{name}\"\nmodel = \"rigid\"\ndensity = 1000.0\n");
    names.map(one).concat()
}

impl Run {
    /// Two solids with these shapes; `more`: keys of their contact.
    pub(super) fn of(resolution: f64, shapes: [String; 2], velocities: [[f64; 2]; 2], more: &str) -> Self {
        let text = format!(
            "resolution = {resolution}\nend_time = 1.0\ngravity = [0.0, -10.0]\n{}[[contact]]\n\
             solids = [\"b\", \"a\"]\n{more}\n{}",
            solids(["a", "b"]),
            shapes.concat()
        );
        let scene = halfstep_scene::parse(&text, Path::new("x.toml"), &[]).expect("a right scene");
        let mut contact = Contact::new(&scene).expect("two solids");
        let block = |(solid, velocity): (usize, [f64; 2])| {
            let points = geometry::layout::<2>(&scene).with_solid(&scene, solid).solid;
            let start: Vec<[f64; 2]> = points.iter().map(|p| p.position).collect();
            let mass = 1000.0 * resolution * resolution;
            let record = |(k, at): (usize, &[f64; 2])| StateRecord {
                id: k as u32,
                mass,
                position: [at[0], at[1], 0.0],
                velocity: [velocity[0], velocity[1], 0.0],
                ..StateRecord::default()
            };
            Block {
                records: start.iter().enumerate().map(record).collect(),
                mass: mass * start.len() as f64,
                start,
                at: [0.0; 2],
                velocity,
                fixed: false,
            }
        };
        let blocks: Vec<Block> = velocities.into_iter().enumerate().map(block).collect();
        contact.begin(blocks.iter().map(|block| block.records.as_slice()));
        Self { dt: contact.limit(), contact, blocks, gravity: [0.0; 2], steps: 0 }
    }

    fn show(&mut self, block: usize, at: [f64; 2], velocity: [f64; 2]) {
        let block = &mut self.blocks[block];
        for (record, start) in block.records.iter_mut().zip(&block.start) {
            record.position = [start[0] + at[0], start[1] + at[1], 0.0];
            record.velocity = [velocity[0], velocity[1], 0.0];
        }
    }

    fn accelerations(&mut self, whole: bool) -> Vec<[f64; 2]> {
        let blocks = &self.blocks;
        self.contact.evaluate(|solid| &blocks[solid].records, whole, self.dt);
        let mut all: Vec<[f64; 2]> = blocks.iter().map(|_| [0.0; 2]).collect();
        self.contact.forces(|solid, _, force| {
            (0..2).for_each(|d| all[solid][d] += force[d] / blocks[solid].mass);
        });
        for (a, block) in all.iter_mut().zip(blocks) {
            *a = if block.fixed { [0.0; 2] } else { [0, 1].map(|d| a[d] + self.gravity[d]) };
        }
        all
    }

    fn step(&mut self) {
        let dt = self.dt;
        let at_n = self.accelerations(true);
        for (k, a) in at_n.iter().enumerate() {
            let Block { at, velocity: v, .. } = self.blocks[k];
            let at = [0, 1].map(|d| at[d] + 0.5 * dt * v[d] + 0.125 * dt * dt * a[d]);
            self.show(k, at, [0, 1].map(|d| v[d] + 0.5 * dt * a[d]));
        }
        let halfway = self.accelerations(false);
        let mut ways = Vec::new();
        for (k, a) in halfway.iter().enumerate() {
            let Block { at, velocity: v, .. } = self.blocks[k];
            let way = [0, 1].map(|d| dt * v[d] + 0.5 * dt * dt * a[d]);
            let (at, v) = ([0, 1].map(|d| at[d] + way[d]), [0, 1].map(|d| v[d] + dt * a[d]));
            (self.blocks[k].at, self.blocks[k].velocity) = (at, v);
            ways.push(way);
            self.show(k, at, v);
        }
        self.contact.work(|solid, _| ways[solid]);
        self.steps += 1;
    }

    pub(super) fn until(&mut self, time: f64) {
        while self.time() < time {
            self.step();
        }
    }

    pub(super) fn dt(&self) -> f64 {
        self.dt
    }

    pub(super) fn time(&self) -> f64 {
        self.steps as f64 * self.dt
    }

    fn momentum(&self) -> [f64; 2] {
        let of = |d: usize| self.blocks.iter().map(|b| b.mass * b.velocity[d]).sum();
        [of(0), of(1)]
    }

    fn kinetic(&self) -> f64 {
        self.blocks.iter().map(|b| 0.5 * b.mass * (b.velocity[0].powi(2) + b.velocity[1].powi(2))).sum()
    }

    pub(super) fn booked(&self) -> Booked {
        self.contact.booked().next().expect("a pair").2
    }
}

/// A block of 0.1 m and one of 0.2 m, 10 mm apart.
fn colliding(resolution: f64, restitution: f64) -> Run {
    let shapes = [boxed("a", [0.0, 0.0], [0.1, 0.1]), boxed("b", [0.11, -0.05], [0.31, 0.15])];
    Run::of(resolution, shapes, [[1.0, 0.0], [-0.5, 0.0]], &format!("restitution = {restitution}"))
}

#[test]
fn an_impact_keeps_momentum_and_gives_the_speed_that_restitution_says() {
    for restitution in [1.0, 0.5, 0.0] {
        let mut run = colliding(0.01, restitution);
        let (before, energy) = (run.momentum(), run.kinetic());
        run.until(0.05);
        let after = run.momentum();
        assert!((after[0] - before[0]).abs() < 1e-12 * 10.0, "{before:?} {after:?}");
        let speed = run.blocks[1].velocity[0] - run.blocks[0].velocity[0];
        println!("e = {restitution}: {} after {} steps, {:?}", speed / 1.5, run.steps, run.booked());
        // Without restitution the force goes to nothing within v_s, which is what a step changes.
        let (least, most) =
            if restitution > 0.0 { (restitution - 0.02, restitution + 0.05) } else { (0.0, 0.35) };
        assert!((least..most).contains(&(speed / 1.5)), "{restitution}: {speed}");
        let lost = run.kinetic() - energy;
        assert!((run.booked().normal - lost).abs() < 1e-9 * energy, "{lost}");
        assert_eq!(run.booked().friction, 0.0);
    }
}

/// A block that falls on another, which stays, from a height that changes where in a step the two meet.
fn falling(restitution: f64, phase: f64) -> Run {
    let shapes = [boxed("a", [0.0, 0.0], [0.1, 0.05]), boxed("b", [-0.1, -0.05], [0.2, 0.0])];
    let more = format!("restitution = {restitution}");
    let mut run = Run::of(0.01, shapes, [[0.0, -0.3], [0.0, 0.0]], &more);
    run.blocks[1].fixed = true;
    run.gravity = [0.0, -10.0];
    let gap = 0.3 * run.dt * (2.0 + phase);
    (run.blocks[0].at, run.blocks[1].at) = ([0.0, gap], [0.0; 2]);
    run.show(0, [0.0, gap], [0.0, -0.3]);
    run
}

#[test]
fn where_in_a_step_two_bodies_meet_does_not_matter() {
    for restitution in [0.0, 0.2, 0.5, 1.0] {
        let mut left = (f64::INFINITY, 0.0_f64);
        for phase in 0..7 {
            let mut run = falling(restitution, f64::from(phase) / 7.0);
            let (mass, limit) = (run.blocks[0].mass, run.contact.limit());
            run.until(20.0 * limit);
            let deep = run.booked().largest_penetration;
            // Undamped a mass m on a spring of K goes v sqrt(m / K) deep.
            let (_, law, _) = run.contact.booked().next().expect("a pair");
            let undamped = 0.3 * (mass / (0.1 * law.stiffness)).sqrt();
            assert!(deep < 1.2 * undamped, "e = {restitution}, phase {phase}: {deep} m of {undamped} m");
            left = (left.0.min(run.blocks[0].velocity[1] / 0.3), left.1.max(run.blocks[0].velocity[1] / 0.3));
            run.until(800.0 * limit);
            if restitution < 1.0 {
                assert!(run.booked().normal < 0.0, "e = {restitution}, phase {phase}: {:?}", run.booked());
                assert!(run.kinetic() < 1e-3 * 0.5 * mass * 0.09, "e = {restitution}, phase {phase} rests");
            }
        }
        println!("e = {restitution}: leaves with {left:?} of its speed");
    }
}

#[test]
fn the_spacing_does_not_matter() {
    let stiff = |resolution: f64| {
        let run = colliding(resolution, 0.5);
        run.contact.booked().next().expect("a pair").1.stiffness
    };
    assert!((stiff(0.01) / stiff(0.005) - 1.0).abs() < 1e-12);
    let depth = [0.01, 0.005].map(|resolution| {
        let mut run = colliding(resolution, 0.5);
        run.until(0.05);
        run.booked().largest_penetration
    });
    println!("{depth:?} m");
    assert!((depth[0] / depth[1] - 1.0).abs() < 0.1, "{depth:?}");
}

#[test]
fn mirrored_blocks_do_mirrored_things() {
    let shapes = [boxed("a", [-0.15, 0.0], [-0.05, 0.1]), boxed("b", [0.05, 0.0], [0.15, 0.1])];
    let mut run = Run::of(0.01, shapes, [[2.0, 0.0], [-2.0, 0.0]], "restitution = 0.7\nfriction = 0.5");
    run.until(0.08);
    let [a, b] = [0, 1].map(|k| run.blocks[k].velocity);
    println!("{a:?} {b:?}");
    assert!((a[0] + b[0]).abs() < 1e-12 && a[1].abs() < 1e-12 && b[0] > 1.0);
}

/// A block of 0.1 m x 0.05 m on a slab.
fn on_slab(velocity: [f64; 2], friction: f64) -> Run {
    let shapes = [boxed("a", [0.0, 0.0], [0.1, 0.05]), boxed("b", [-0.1, -0.05], [0.6, 0.0])];
    let mut run = Run::of(0.01, shapes, [velocity, [0.0; 2]], &format!("friction = {friction}"));
    run.blocks[1].fixed = true;
    run
}

#[test]
fn a_sliding_block_stops_after_its_speed_squared_over_two_mu_g() {
    let mut run = on_slab([1.0, 0.0], 0.25);
    run.gravity = [0.0, -10.0];
    run.until(0.6);
    let block = &run.blocks[0];
    println!("{:?} m, {:?} m/s, {:?}", block.at, block.velocity, run.booked());
    assert!((block.at[0] / 0.2 - 1.0).abs() < 5e-3, "{:?}", block.at);
    assert!(block.velocity[0].abs() < 1e-6, "{:?}", block.velocity);
    // Friction took what the block had.
    assert!((run.booked().friction / (0.5 * block.mass) + 1.0).abs() < 5e-3, "{:?}", run.booked());
}

/// Gravity along and across the slab is a slope.
#[test]
fn a_block_on_a_slope_holds_below_the_angle_of_friction_and_slides_above() {
    let slope = |tangent: f64| {
        let mut run = on_slab([0.0; 2], 0.3);
        run.gravity = [10.0 * tangent, -10.0];
        run.until(0.2);
        let before = (run.blocks[0].at[0], run.blocks[0].velocity[0]);
        run.until(0.4);
        (run.blocks[0].at[0] - before.0, run.blocks[0].velocity[0] - before.1)
    };
    let (held, slides) = (slope(0.99 * 0.3), slope(1.1 * 0.3));
    println!("{held:?} {slides:?}");
    assert!(held.0.abs() < 1e-7, "{held:?}");
    let expected = 10.0 * 0.1 * 0.3 * 0.2;
    assert!((slides.1 / expected - 1.0).abs() < 0.01, "{slides:?} {expected}");
}

/// Points of a turned and strained outline go with the particles.
#[test]
fn outlines_follow_linear_maps() {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n{}{}{}",
        solids(["a", "b"]),
        boxed("a", [0.0, 0.0], [0.1, 0.05]),
        shape("b", "disc = { center = [1.0, 0.0], radius = 0.05 }")
    );
    let scene = halfstep_scene::parse(&text, Path::new("x.toml"), &[]).expect("a right scene");
    for solid in 0..2 {
        let placed = geometry::solids::<2>(&scene);
        let points = placed.clone().with_solid(&scene, solid).solid;
        let at: Vec<[f64; 2]> = points.iter().map(|p| p.position).collect();
        let outline = Outline::new(&scene, &placed, solid, &at, &vec![0.1; at.len()]);
        let map = |x: [f64; 2]| [0.3 + 0.8 * x[0] - 0.7 * x[1], 0.1 + 0.6 * x[0] + 0.9 * x[1], 0.0];
        let moved = |map: &dyn Fn([f64; 2]) -> [f64; 3]| {
            let record = |x: &[f64; 2]| StateRecord { position: map(*x), ..StateRecord::default() };
            let records: Vec<StateRecord> = at.iter().map(record).collect();
            let mut placed = Placed::default();
            placed.bound(&outline, &records);
            placed.place(&outline, &records);
            placed.position
        };
        let (first, then) = (moved(&|x| [x[0], x[1], 0.0]), moved(&map));
        for (from, to) in first.iter().zip(&then) {
            let right = map(*from);
            assert!((0..2).all(|d| (to[d] - right[d]).abs() < 1e-12), "{to:?} {right:?}");
        }
        let length: f64 = outline.points.iter().map(|p| p.length).sum();
        let right = if solid == 0 { 0.3 } else { std::f64::consts::TAU * 0.05 };
        assert!((length / right - 1.0).abs() < 2e-3, "{length}");
    }
}

#[test]
fn solids_that_shall_not_touch_do_not() {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n[[contact]]\nsolids = [\"a\", \"b\"]\ntouch = false\n{}{}{}",
        solids(["a", "b"]),
        boxed("a", [0.0, 0.0], [0.1, 0.1]),
        boxed("b", [0.2, 0.0], [0.3, 0.1])
    );
    let scene = halfstep_scene::parse(&text, Path::new("x.toml"), &[]).expect("a right scene");
    assert!(Contact::new(&scene).is_none());
}

/// A block of a solid that breaks, and a small rigid one 20 mm beside it; the first states of both.
fn breakable_and_rigid() -> (Contact, [Vec<StateRecord>; 2]) {
    let text = "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 0.0]\n[[solid]]\nname = \"a\"\ndensity = 1000.0\n\
                youngs_modulus = 1e7\npoissons_ratio = 0.2\nfracture = { strength = 1e5, energy = 20.0 }\n\
                [[solid]]\nname = \"b\"\nmodel = \"rigid\"\ndensity = 1000.0\n[[contact]]\n\
                solids = [\"b\", \"a\"]\nstiffness = 1e9\n";
    let shapes = [boxed("a", [0.0, 0.0], [0.1, 0.1]), boxed("b", [0.12, 0.03], [0.16, 0.07])];
    let scene = halfstep_scene::parse(&(text.to_owned() + &shapes.concat()), Path::new("x.toml"), &[]);
    let scene = scene.expect("a right scene");
    let mut contact = Contact::new(&scene).expect("two solids");
    let states = [0, 1].map(|solid| {
        let points = geometry::layout::<2>(&scene).with_solid(&scene, solid).solid;
        let record = |(k, p): (usize, &geometry::SolidPoint<2>)| StateRecord {
            id: k as u32,
            mass: 0.1,
            position: [p.position[0], p.position[1], 0.0],
            ..StateRecord::default()
        };
        points.iter().enumerate().map(record).collect::<Vec<_>>()
    });
    contact.begin(states.iter().map(Vec::as_slice));
    (contact, states)
}

/// Force of contact on the second solid, N/m.
fn on_second(contact: &mut Contact, states: [&[StateRecord]; 2]) -> [f64; 2] {
    let dt = contact.limit();
    contact.evaluate(|solid| states[solid], true, dt);
    let mut sum = [0.0; 2];
    contact.forces(|solid, _, force| (0..2).for_each(|d| sum[d] += force[d] * f64::from(solid as u8)));
    sum
}

/// Torn off, a particle is held by its own surface, half a spacing before it. Its spring is K/2 times a length of which
/// no less mass lies behind than of the outline; at rest half of it acts. One that came to be deep inside is not thrown
/// out: it is pushed from there on, and from the surface on once it was out.
#[test]
fn particles_without_an_outline_are_held_one_by_one() {
    let (mut contact, [mut broken, rigid]) = breakable_and_rigid();
    let least = contact.outlines[0].least_mass();
    let crumb = broken.iter().position(|r| r.position[0] > 0.05 && r.position[1] > 0.05).expect("inside");
    let mut pushed = |x: f64, broken: &mut Vec<StateRecord>| {
        broken[crumb].position = [x, 0.0505, 0.0];
        on_second(&mut contact, [broken.as_slice(), rigid.as_slice()])
    };
    assert_eq!(pushed(0.116, &mut broken), [0.0; 2], "no cracks: the outline holds alone");
    for record in broken.iter_mut().filter(|record| record.position[0] > 0.05) {
        record.position[0] -= 0.2;
    }
    let spring = 0.5 * 1e9 * (0.1 / least).min(0.01);
    let mut expect = |x: f64, depth: f64| {
        let found = pushed(x, &mut broken);
        assert!((found[0] - 0.5 * spring * depth).abs() < 1e-9 * spring, "{x}: {found:?}");
        assert!(found[1].abs() < 1e-9 * spring, "{x}: {found:?}");
    };
    expect(0.114, 0.0);
    expect(0.116, 0.001);
    expect(0.113, 0.0);
    expect(0.124, 0.0);
    expect(0.1245, 0.0005);
    expect(0.121, 0.0);
    expect(0.122, 0.001);
    expect(0.113, 0.0);
    expect(0.116, 0.001);
}

/// A block that can break, in two halves 0.1 m apart, and a small one: in the gap nothing holds it, where the block's
/// outline still is a closed line; a quarter of a spacing inside of a half it is pushed out.
#[test]
fn what_lies_between_fragments_is_pushed_by_none() {
    let (mut contact, [mut broken, small]) = breakable_and_rigid();
    let mut pushed = |broken: &[StateRecord], x: f64| {
        let mut there = small.clone();
        there.iter_mut().for_each(|record| record.position[0] += x - 0.12);
        on_second(&mut contact, [broken, there.as_slice()])
    };
    assert!(
        pushed(&broken, 0.03)[1].abs() + pushed(&broken, 0.08)[0].abs() > 1.0,
        "inside of the whole block"
    );
    for record in broken.iter_mut().filter(|record| record.position[0] > 0.05) {
        record.position[0] += 0.1;
    }
    assert_eq!(pushed(&broken, 0.08), [0.0; 2], "in the gap from 0.05 to 0.15 m");
    let out = pushed(&broken, 0.1975);
    assert!(out[0] > 1.0 && out[1].abs() < 1e-9 * out[0], "{out:?}");
}
