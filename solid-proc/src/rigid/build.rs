//! From a scene to its bodies and what holds them.

use super::body::{Ball, Body, Pose};
use super::joint::{Link, LinkKind};
use super::step::{System, Wrench};
use super::{Vec3, wide};
use crate::effects::takes_part;
use crate::ledger::Given;
use halfstep_scene::geometry::{self, Layout, SolidPoint, Surface, WallCorner};
use halfstep_scene::{EffectName, Joint, JointKind, Motion, Phase, RigidKeys, Scene, Shape};
use nalgebra::Matrix3;

/// Part of the spacing within which surfaces touch.
const TOLERANCE: f64 = 1e-4;

/// Depth in a body, in spacings, from which on what of a wall begins there does not touch it.
const BEGUN: f64 = 0.01;

/// The bodies of the scene's solid of that index, each with the name that joints and probes find it by.
pub(super) fn system<const D: usize>(
    scene: &Scene,
    solid: usize,
    keys: &RigidKeys,
    layout: &Layout<D>,
) -> (System, Vec<String>) {
    let points = &layout.solid;
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for (p, piece) in geometry::pieces(scene, layout).into_iter().enumerate() {
        groups.resize(groups.len().max(piece as usize + 1), Vec::new());
        groups[piece as usize].push(p as u32);
    }
    let names: Vec<String> = groups
        .iter()
        .map(|group| scene.shapes[points[group[0] as usize].body as usize].body().to_owned())
        .collect();
    let (mut bodies, mut poses): (Vec<Body>, Vec<Pose>) = groups
        .into_iter()
        .zip(&names)
        .map(|(group, name)| body(scene, solid, keys, points, group, name))
        .unzip();
    let real = bodies.len();
    bodies.push(Body::frame(None));
    let touching = takes_part(scene, solid, EffectName::WallContact);
    let corners = geometry::wall_corners(scene);
    let mut walls: Vec<&Shape> = Vec::new();
    for (index, wall) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.phase == Phase::Wall) {
        let touched = wall.contact && touching;
        if touched || keys.joints.iter().any(|joint| joint.with == wall.name) {
            let mut frame = Body::frame(wall.motion.clone());
            frame.fastest = fastest(scene, wall);
            frame.period = shortest_period(scene, wall);
            frame.surface_velocity = wall.velocity.into();
            if touched {
                let surface = Surface::new(&wall.geometry, None);
                let own = corners.iter().filter(|corner| corner.shape == index);
                frame.balls.extend(own.map(corner_ball));
                if D == 2 && wall.geometry.is_round() {
                    balls::<D>(&surface, &frame.center, scene.resolution, |ball| frame.balls.push(ball));
                }
                frame.surfaces.push(surface);
            }
            let own = bodies.len();
            let alike = walls.iter().zip(real + 1..).filter(|(other, _)| other.moves_like(wall));
            frame.alike = alike.map(|(_, k)| k).collect();
            frame.alike.iter().for_each(|&k| bodies[k].alike.push(own));
            bodies.push(frame);
            walls.push(wall);
        }
    }
    leave_out_begun::<D>(&mut bodies, real, BEGUN * scene.solid_spacing(solid));
    poses.resize(bodies.len(), Pose::at(Vec3::zeros()));
    let find = |name: &str| match names.iter().position(|body| body == name) {
        Some(body) => body,
        None => walls.iter().position(|wall| wall.name == name).map_or(real, |wall| real + 1 + wall),
    };
    let mut links = Vec::new();
    for joint in &keys.joints {
        let ends = [find(&joint.with), find(&joint.body)];
        if joint.holds() {
            bodies[ends[1]].tied.push(ends[0]);
            bodies[ends[0]].tied.push(ends[1]);
        }
        if joint.kind == JointKind::Fixed && ends[0] >= real {
            bodies[ends[1]].driven = bodies[ends[0]].driven.clone();
        } else {
            links.push(link(joint, ends, &bodies));
        }
    }
    let zero = Wrench { force: Vec3::zeros(), arms: Matrix3::zeros() };
    let mut system = System {
        plane: D == 2,
        real,
        links,
        gravity: scene.gravity.into(),
        friction: keys.contact.friction,
        restitution: keys.contact.restitution,
        tolerance: TOLERANCE * scene.solid_spacing(solid),
        wrenches: vec![zero; real],
        contact: vec![[Vec3::zeros(); 2]; real],
        memory: Vec::new(),
        books: Given::default(),
        accounted: false,
        bodies,
        poses,
    };
    system.drive(0.0);
    system.turn_about_hinges();
    (system, names)
}

/// The corner of a wall, as faces of bodies touch it.
fn corner_ball(corner: &WallCorner) -> Ball {
    let between = Some(corner.normals.map(|normal| wide(&normal)));
    Ball { arm: wide(&corner.place), radius: 0.0, depth: f64::INFINITY, between }
}

/// Calls `visit` with the balls of a surface about a centre of the scene, with points at most `spacing`, m, apart.
fn balls<const D: usize>(surface: &Surface, center: &Vec3, spacing: f64, mut visit: impl FnMut(Ball)) {
    surface.balls::<D>(spacing, &mut |place, radius, normals| {
        let between = normals.map(|both| both.map(|normal| wide(&normal)));
        visit(Ball { arm: wide(&place) - center, radius, depth: 0.5 * surface.depth(), between });
    });
}

/// Leaves out what of walls begins deeper in a body than this, m: a pin of a hinge.
fn leave_out_begun<const D: usize>(bodies: &mut [Body], real: usize, deepest: f64) {
    let (own, walls) = bodies.split_at_mut(real);
    let begins = |ball: &Ball| {
        own.iter().flat_map(|body| &body.surfaces).any(|surface| {
            let mut inside = false;
            surface.nearest::<D>(std::array::from_fn(|d| ball.arm[d]), &mut |distance, _| {
                let gap = distance - ball.radius;
                inside |= gap < -deepest && gap >= -ball.depth;
            });
            inside
        })
    };
    walls.iter_mut().for_each(|wall| wall.balls.retain(|ball| !begins(ball)));
}

/// The motion of a shape, and that of the frame.
fn motions<'s>(scene: &'s Scene, shape: &'s Shape) -> impl Iterator<Item = &'s Motion> {
    shape.motion.iter().chain(scene.frame.as_ref().map(|frame| &frame.motion))
}

/// A bound of the speed of a shape that moves by prescription, m/s, and of what stays behind a frame that does.
fn fastest(scene: &Scene, shape: &Shape) -> f64 {
    let around = geometry::bounding_box(shape, scene);
    motions(scene, shape).map(|motion| motion.fastest(&around)).fold(0.0, |sum, speed| sum + speed)
}

/// Shortest period of a shape that swings by prescription, s, and of what stays behind a frame that does.
fn shortest_period(scene: &Scene, shape: &Shape) -> f64 {
    motions(scene, shape).map(Motion::shortest_period).fold(f64::INFINITY, f64::min)
}

fn link(joint: &Joint, ends: [usize; 2], bodies: &[Body]) -> Link {
    let kind = match joint.kind {
        JointKind::Fixed => LinkKind::Fixed { at: bodies[ends[1]].center },
        JointKind::Hinge { at, axis } => LinkKind::Hinge { at: at.into(), axis: axis.into() },
        JointKind::Rail { at, axis, turns } => LinkKind::Rail { at: at.into(), axis: axis.into(), turns },
        JointKind::Spring { at, to } => LinkKind::Spring { points: [to.into(), at.into()] },
    };
    Link {
        name: joint.name.clone(),
        ends,
        kind,
        stiffness: joint.stiffness,
        damping: joint.damping,
        rest: joint.rest,
        limits: joint.limits,
    }
}

/// A body of these particles, and how it begins. Each particle is a cube (square) of the material: without its own
/// moment of inertia, m dx²/6, a box would have that of a smaller one.
fn body<const D: usize>(
    scene: &Scene,
    solid: usize,
    keys: &RigidKeys,
    points: &[SolidPoint<D>],
    particles: Vec<u32>,
    name: &str,
) -> (Body, Pose) {
    let dx = scene.solid_spacing(solid);
    let own = || particles.iter().map(|&p| &points[p as usize]);
    let of_solid = scene.solids[solid].density;
    let mass_of = |point: &SolidPoint<D>| {
        scene.shapes[point.body as usize].density.unwrap_or(of_solid) * dx.powi(D as i32)
    };
    let said = keys.bodies.iter().find(|body| body.name == name);
    let shapes_mass: f64 = own().map(mass_of).sum();
    let shapes_center = own().map(|point| wide(&point.position) * mass_of(point)).sum::<Vec3>() / shapes_mass;
    let cell = dx * dx / 6.0;
    let shapes_inertia = own()
        .map(|point| {
            let (m, r) = (mass_of(point), wide(&point.position) - shapes_center);
            (Matrix3::identity() * (r.norm_squared() + cell) - r * r.transpose()) * m
        })
        .sum::<Matrix3<f64>>();
    let mass = said.and_then(|said| said.mass).unwrap_or(shapes_mass);
    let center = said.and_then(|said| said.center).map_or(shapes_center, Vec3::from);
    let inertia = match said.and_then(|said| said.inertia) {
        Some(moments) => Matrix3::from_diagonal(&moments.into()),
        None => shapes_inertia * (mass / shapes_mass),
    };
    let mut body = Body::new(D == 2, mass, center, inertia);
    let motion = own().find_map(|point| scene.shapes[point.body as usize].motion.clone());
    body.driven = motion.map(Some);
    let of_shape = |point: &SolidPoint<D>| fastest(scene, &scene.shapes[point.body as usize]);
    body.fastest = own().map(of_shape).fold(0.0, f64::max);
    let period = |point: &SolidPoint<D>| shortest_period(scene, &scene.shapes[point.body as usize]);
    body.period = own().map(period).fold(f64::INFINITY, f64::min);
    let mut shapes: Vec<(u32, u32)> = own().map(|point| (point.body, point.copy)).collect();
    shapes.sort_unstable();
    shapes.dedup();
    for (shape, copy) in shapes {
        let surface = Surface::new(&scene.shapes[shape as usize].geometry, Some(copy));
        balls::<D>(&surface, &center, dx, |ball| {
            body.radius = body.radius.max(ball.arm.norm_squared().sqrt() + ball.radius);
            body.balls.push(ball);
        });
        body.surfaces.push(surface);
    }
    let mut pose = Pose::at(center);
    let first = points[particles[0] as usize].velocity;
    if own().all(|point| point.velocity == first) {
        // To the last bit what the scene says.
        pose.velocity = wide(&first);
    } else {
        let momentum: Vec3 = own().map(|point| wide(&point.velocity) * mass_of(point)).sum();
        pose.velocity = momentum / shapes_mass;
        let spin = own().map(|point| {
            let arm = wide(&point.position) - shapes_center;
            arm.cross(&wide(&point.velocity)) * mass_of(point)
        });
        // The motion is that of the shapes' particles, whatever mass, centre and inertia are given.
        let shapes = Body::new(D == 2, shapes_mass, shapes_center, shapes_inertia);
        let rate = shapes.turn_rate(&Matrix3::identity(), &spin.sum());
        pose.velocity += rate.cross(&(center - shapes_center));
        pose.spin = body.spin(&Matrix3::identity(), &rate);
    }
    if let Some(said) = said {
        pose.spin += body.spin(&Matrix3::identity(), &said.angular_velocity.into());
    }
    body.particles = particles;
    (body, pose)
}
