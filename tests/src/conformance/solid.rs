//! What every [solid model](halfstep_solid::SolidModel) must do, in two and in three dimensions: the lock-step,
//! prescribed particles, contact, conservation, bounds.

mod setup;

use halfstep_role::serve::on_threads;
use halfstep_scene::geometry;
use halfstep_solid::Load;
use halfstep_sph::lane::Isa;
use halfstep_wire::failure::Quantity;
use halfstep_wire::half_step::{HalfStep, Stage};
pub use setup::Make;
use setup::{
    BALL, BLOCK, DEPTH, FLOOR, Model, all, along, angular_momentum, apart, both, mass, model, momentum,
    parse, position, record, reference, step, velocity, volume,
};

/// Particles are the scene's, numbered in its order; the record of the first state shows the reference configuration.
pub fn identity<const D: usize>(make: Make<D>) {
    let scene = parse(make, &[BLOCK, BALL], &[]);
    let model = (make.build)(&scene, Isa::detect()).expect("a solid");
    let layout = geometry::layout::<D>(&scene);
    assert_eq!(model.particles().len(), layout.solid.len());
    for p in all(&model) {
        let (record, point) = (record(&model, p), layout.solid[p as usize]);
        let columns = model.particles();
        assert_eq!(columns.position[p as usize], point.position);
        assert_eq!((columns.velocity[p as usize], columns.density[p as usize]), (point.velocity, 1000.0));
        // From bit 8 on stands the number of a rigid body, from 1.
        let body = model.body_of().get(p as usize).map_or(0, |body| body + 1);
        assert_eq!((record.id, record.flags), (p, body << 8));
        assert_eq!(record.position[..D], point.position);
        assert_eq!(reference(&model, p), point.position);
        assert_eq!(record.velocity[..D], point.velocity);
        assert_eq!((record.density, record.pressure), (1000.0, 0.0));
        assert!((record.mass - 1000.0 * volume::<D>()).abs() < 1e-15, "{}", record.mass);
        assert_eq!((record.mass, record.deviatoric_stress), (mass(&model, p), [0.0; 6]));
    }
    assert_eq!(model.strain_energy(), 0.0);
    // The block and the ball, where they do not strain.
    let rigid = model.rigid_bodies().len();
    assert!([0, 2].contains(&rigid), "{rigid} bodies");
    let [first, last] = [0, model.particles().len() as u32 - 1].map(|p| record(&model, p).flags >> 8);
    assert_eq!([first, last], if rigid == 2 { [1, 2] } else { [0, 0] });
}

/// 60 x 60 spacings (in space 8 deep), 2h = 3 dx: surface rows lie half a spacing under the surface, two more are
/// closer than that.
pub fn interface_set<const D: usize>(make: Make<D>) {
    let model = model(make, &[BLOCK], &["shape.block.box.max=[0.6,0.6]"]);
    let (all, inner) = if D == 2 { (60 * 60, 54 * 54) } else { (60 * 60 * 8, 54 * 54 * 2) };
    assert_eq!(model.interface_set().len(), all - inner);
    assert!(model.interface_set().windows(2).all(|w| w[0] < w[1]));
}

/// A block at rest stays at rest.
pub fn rest<const D: usize>(make: Make<D>) {
    let mut model = model(make, &[BLOCK], &[]);
    let load = Load::none(model.particles().len());
    for _ in 0..10 {
        let dt = model.sub_step_limit();
        step(&mut model, dt, 1, &load);
    }
    for p in all(&model) {
        assert!(apart(&position(&model, p), &reference(&model, p)) < 1e-14);
    }
}

/// A block that flies and turns about nothing: ten times its mass as force on every particle makes 10 m/s² everywhere.
pub fn uniform_force<const D: usize>(make: Make<D>) {
    for sub_steps in [1, 4] {
        let mut model = model(make, &[BLOCK], &[]);
        let mut load = Load::none(model.particles().len());
        load.force.fill(along(0, 1e4 * volume::<D>()));
        let dt = f64::from(sub_steps) * model.sub_step_limit();
        for _ in 0..20 {
            step(&mut model, dt, sub_steps, &load);
        }
        let time = 20.0 * dt;
        for p in all(&model) {
            let (v, x) = (velocity(&model, p), record(&model, p).position[0] - reference(&model, p)[0]);
            assert!((v[0] - 10.0 * time).abs() < 1e-12 && v[1..].iter().all(|v| v.abs() < 1e-12));
            assert!((x - 5.0 * time * time).abs() < 1e-12, "{x}");
        }
    }
}

/// Stage 0 leads to n + 1/2 under its load, and leaves no trace in n + 1.
pub fn stage_0_is_forgotten<const D: usize>(make: Make<D>) {
    let particles = model(make, &[BLOCK], &[]).particles().len();
    let mut loads = [0, 1, 2].map(|_| Load::none(particles));
    // Forces that give 3 m/s² and the like.
    let mass = 1000.0 * volume::<D>();
    let force = |x: f64, y: f64| std::array::from_fn(|d| [x * mass, y * mass, 0.5 * x * mass][d]);
    loads[1].force.iter_mut().enumerate().for_each(|(k, f)| *f = force(3.0 * (k % 7) as f64, 1.0));
    loads[2].force.fill(force(-50.0, 30.0));
    for sub_steps in [1, 6] {
        // One goes to the middle under the load of stage 1, the other under a wild one.
        let ends = [&loads[1], &loads[2]].map(|first| {
            let mut model = model(make, &[BLOCK], &[]);
            let [stage_0, stage_1] = both(f64::from(sub_steps) * model.sub_step_limit());
            let start = record(&model, 7).position;
            for _ in 0..5 {
                model.advance(&stage_0, sub_steps, first).unwrap();
                let middle = record(&model, 7).position;
                model.advance(&stage_1, sub_steps, &loads[1]).unwrap();
                assert_ne!(middle, record(&model, 7).position);
            }
            assert_ne!(start, record(&model, 7).position);
            all(&model).map(|p| (record(&model, p).position, velocity(&model, p))).collect::<Vec<_>>()
        });
        // With one sub-step, midpoint's stage 1 takes its rates from the state in the middle.
        if sub_steps > 1 {
            assert!(ends[0] == ends[1]);
        }
    }
}

/// The same time with 4 sub-steps of a step four times as long: without load the sub-steps are the single steps.
pub fn sub_steps<const D: usize>(make: Make<D>) {
    let swing = ["shape.block.cantilever_mode={fraction=0.01,root=0.0,length=0.2}"];
    let [mut one, mut four] = [(); 2].map(|()| model(make, &[BLOCK], &swing));
    let load = Load::none(one.particles().len());
    let dt = 0.25 * one.sub_step_limit();
    // Mean velocity over the last step; at first the velocity.
    let mut last: Vec<f64> = all(&four).map(|p| velocity(&four, p)[1]).collect();
    for round in 0..10 {
        (0..4).for_each(|_| step(&mut one, dt, 1, &load));
        let before: Vec<_> = all(&four).map(|p| record(&four, p).position[1]).collect();
        for half_step in both(4.0 * dt) {
            four.advance(&half_step, 4, &load).expect("within bounds");
            for p in all(&four) {
                let (r, k) = (record(&four, p), p as usize);
                let mean = (r.position[1] - before[k]) / half_step.span();
                if half_step.stage == Stage::Second {
                    assert_eq!(r.velocity[1], velocity(&four, p)[1], "at n its own");
                    last[k] = mean;
                } else {
                    // Half-way what the mean over the step will be, from that over half of it and the last step's.
                    let ahead = if round == 0 { 1.0 } else { 1.0 / 3.0 };
                    assert!((r.velocity[1] - (mean + (mean - last[k]) * ahead)).abs() < 1e-9);
                }
            }
        }
    }
    for p in all(&one) {
        let (r, columns, k) = (record(&one, p), one.particles(), p as usize);
        assert_eq!(r.position[..D], columns.position[k], "records and columns show one state");
        assert_eq!(r.density, columns.density[k]);
        assert!((record(&one, p).position[1] - record(&four, p).position[1]).abs() < 1e-13);
        assert!((velocity(&one, p)[1] - velocity(&four, p)[1]).abs() < 1e-9);
    }
    assert!(all(&one).any(|p| (record(&one, p).position[1] - reference(&one, p)[1]).abs() > 1e-4));
}

/// Clamped particles say so and never move; the others bend away.
pub fn clamps<const D: usize>(make: Make<D>) {
    let clamp = "shape.block.clamp={min=[0.0,0.0],max=[0.05,0.2]}";
    let mut model = model(make, &[BLOCK], &[clamp, "gravity=[0.0,-10.0]"]);
    let mut load = Load::none(model.particles().len());
    load.force.fill(along(1, -1e4 * volume::<D>()));
    let dt = model.sub_step_limit();
    for _ in 0..50 {
        step(&mut model, dt, 2, &load);
    }
    for p in all(&model) {
        let (x0, r) = (reference(&model, p), record(&model, p));
        if x0[0] < 0.05 {
            assert_eq!((r.flags, r.velocity), (1, [0.0; 3]));
            assert_eq!(r.position[..D], x0);
        } else {
            assert_eq!(r.flags, 0);
            assert!(r.position[1] < x0[1]);
        }
    }
}

/// The model strains: a cantilever's mode can make it swing.
fn bends<const D: usize>(make: Make<D>) -> bool {
    !make.keys.contains("\"rigid\"")
}

/// Inner forces and contacts change neither momentum nor, but for what the scheme of one that strains loses, angular
/// momentum.
pub fn conservation<const D: usize>(make: Make<D>) {
    let swing =
        ["shape.block.velocity=[1,2]", "shape.block.cantilever_mode={fraction=0.02,root=0.0,length=0.2}"];
    // What does not bend meets the ball.
    let mut model = model(make, &[BLOCK, BALL], &swing[..if bends(make) { 2 } else { 1 }]);
    let load = Load::none(model.particles().len());
    let (p0, l0) = (momentum(&model), angular_momentum(&model));
    let scale: f64 = all(&model).map(|p| mass(&model, p) * apart(&velocity(&model, p), &[0.0; D])).sum();
    let dt = model.sub_step_limit();
    for _ in 0..150 {
        step(&mut model, dt, 1, &load);
    }
    let (p1, l1) = (momentum(&model), angular_momentum(&model));
    assert!(apart(&p0, &p1) < 1e-12 * scale, "{p0:?} {p1:?}");
    // A rigid body's cells turn about their middles, too, with m dx²/6, which this sum over points leaves out: 2.7e-4.
    let part = if bends(make) { 5e-3 } else { 5e-4 };
    for (l0, l1) in l0.iter().zip(&l1) {
        assert!((l1 - l0).abs() < part * scale * 0.2, "{l0} {l1}, scale {}", 0.2 * scale);
    }
}

/// A ball thrown at a block bounces off: it pushes the block and does not enter it.
pub fn bodies_collide<const D: usize>(make: Make<D>) {
    let mut model = model(make, &[BLOCK, BALL], &[]);
    let load = Load::none(model.particles().len());
    let start = model.particles().kinetic_energy();
    let is_ball = |model: &Model<D>, p| reference(model, p)[0] > 0.21;
    let mut closest = f64::INFINITY;
    let (mut time, mut looked) = (0.0, 0.0);
    while time < 0.06 {
        // An implicit solid's steps are as long as what it touches allows.
        let dt = model.sub_step_limit();
        step(&mut model, dt, 1, &load);
        time += dt;
        if time > looked + 2e-3 {
            looked = time;
            for i in all(&model).filter(|&p| is_ball(&model, p)) {
                for j in all(&model).filter(|&p| !is_ball(&model, p)) {
                    closest = f64::min(closest, apart(&position(&model, i), &position(&model, j)));
                }
            }
        }
    }
    let mean = |ball: bool| {
        let speeds: Vec<f64> =
            all(&model).filter(|&p| is_ball(&model, p) == ball).map(|p| velocity(&model, p)[0]).collect();
        speeds.iter().sum::<f64>() / speeds.len() as f64
    };
    println!("closest {:.2} dx, ball {:.2} m/s, block {:.2} m/s", closest / 0.01, mean(true), mean(false));
    assert!(closest > 0.4 * 0.01 && closest < 0.015, "they met, and kept apart: {closest}");
    assert!(mean(false) < -0.5 && mean(true) > mean(false), "{} {}", mean(true), mean(false));
    assert!(model.particles().kinetic_energy() < start);
}

/// A wall stops a block that is thrown at it before its first row is reached (how elastic that is, is the model's
/// affair); a wall that it may not touch lets it in.
pub fn wall_contact<const D: usize>(make: Make<D>) {
    let lowest = |overrides: &[&str]| {
        let all_of = [&["shape.block.velocity=[0,-1]"], overrides].concat();
        let mut model = model(make, &[BLOCK, FLOOR], &all_of);
        let load = Load::none(model.particles().len());
        let dt = model.sub_step_limit();
        let mut lowest = f64::INFINITY;
        for _ in 0..(0.06 / dt) as usize {
            step(&mut model, dt, 1, &load);
            lowest = all(&model).map(|p| record(&model, p).position[1]).fold(lowest, f64::min);
        }
        println!("lowest {lowest:.4} m, momentum {:.2}", momentum(&model)[1]);
        (lowest, momentum(&model)[1])
    };
    // The wall's first row is at -0.025.
    let (depth, away) = lowest(&[]);
    // The body came with this, kg m/s (2D: per metre).
    let came = 1000.0 * 0.2 * 0.15 * if D == 2 { 1.0 } else { DEPTH };
    assert!(depth > -0.02 && away > -1e-3 * came, "{depth} {away}");
    let (depth, away) = lowest(&["effects.wall-contact=\"off\""]);
    assert!(depth < -0.05 && away < 0.0, "{depth} {away}");
}

/// A time step far beyond the limit, and a load that is NaN, end as errors that name a particle and a quantity.
pub fn bounds<const D: usize>(make: Make<D>) {
    let swing = ["shape.block.cantilever_mode={fraction=0.01,root=0.0,length=0.2}"];
    let mut unstable = model(make, &[BLOCK], &swing);
    let load = Load::none(unstable.particles().len());
    let stages = both(4.0 * unstable.sub_step_limit());
    let failure = (0..100)
        .find_map(|_| stages.iter().find_map(|stage| unstable.advance(stage, 1, &load).err()))
        .expect("unstable");
    assert!([Quantity::Density, Quantity::Speed].contains(&failure.quantity), "{failure:?}");
    assert!((failure.particle as usize) < unstable.particles().len());

    let mut poisoned = model(make, &[BLOCK], &[]);
    let mut load = Load::none(poisoned.particles().len());
    load.force[17] = along(0, f64::NAN);
    let [stage_0, _] = both(poisoned.sub_step_limit());
    let failure = poisoned.advance(&stage_0, 1, &load).expect_err("NaN");
    assert_eq!(failure.quantity, Quantity::Speed);
    let (named, cause) = (reference(&poisoned, failure.particle), reference(&poisoned, 17));
    // In one evaluation it spreads to whatever is listed together with a neighbour: of the same row, which is as wide
    // as the neighbours' reach across each of the other axes.
    assert!(apart(&named, &cause) < 0.06 * ((D - 1) as f64).sqrt(), "{failure:?}");
}

/// The same bits for any number of threads; large enough for several chunks of the pass.
pub fn threads<const D: usize>(make: Make<D>) {
    let swing = match bends(make) {
        true => "shape.block.cantilever_mode={fraction=0.02,root=0.0,length=0.2}",
        // It falls on the floor.
        false => "shape.block.velocity=[0.5,-1]",
    };
    // In space the block has as many particles as it is.
    let big = [swing, "shape.block.box.max=[0.4,0.4]"];
    let overrides = &big[..if D == 2 { 2 } else { 1 }];
    let run = |threads| {
        on_threads(threads, || {
            let mut model = model(make, &[BLOCK, FLOOR], overrides);
            assert!(model.particles().len() > 1500);
            let load = Load::none(model.particles().len());
            let dt = model.sub_step_limit();
            for _ in 0..40 {
                step(&mut model, dt, 2, &load);
            }
            all(&model).map(|p| (record(&model, p), velocity(&model, p))).collect::<Vec<_>>()
        })
        .expect("threads")
    };
    let one = run(1);
    assert!(run(2) == one && run(3) == one);
}

/// A model that can be saved goes on to the same bits: free bodies that collide and touch a wall, under a load, with
/// one sub-step and with several.
pub fn interruption<const D: usize>(make: Make<D>) {
    let scene = parse(make, &[BLOCK, BALL, FLOOR], &["gravity=[0.0, -9.81]"]);
    let build = || (make.build)(&scene, Isa::detect()).expect("a solid");
    for sub_steps in [1, 4] {
        let mut model = build();
        // An implicit model takes steps in which these loads would throw it out of bounds.
        let limit = model.sub_step_limit().min(1.5e-4);
        let mut load = Load::<D>::none(model.particles().len());
        // 1 m/s² more for each next of 300 particles; 30 m/s² down.
        let mass = 1000.0 * volume::<D>();
        load.force.iter_mut().enumerate().for_each(|(p, force)| {
            *force = std::array::from_fn(|d| mass * [(p % 300) as f64, -30.0, 0.0][d]);
        });
        let half_step = |k: u64| {
            // Steps of different lengths.
            let dt = 0.5 * limit * f64::from(sub_steps) * if k.is_multiple_of(3) { 1.0 } else { 0.8 };
            HalfStep::begin(k, 0.0).lasting(dt).both()
        };
        let advance = |model: &mut Model<D>, steps: std::ops::Range<u64>| {
            for stage in steps.flat_map(half_step) {
                model.advance(&stage, sub_steps, &load).expect("within bounds");
            }
        };
        advance(&mut model, 0..40);
        let Some(saved) = model.state().map(|state| state.save()) else { return };
        advance(&mut model, 40..80);
        let mut resumed = build();
        resumed.state().expect("it was saved").load(&saved).expect("its own state");
        advance(&mut resumed, 40..80);
        let bits = |model: &Model<D>| -> Vec<String> {
            // Zeros keep their sign in this form.
            all(model).map(|p| format!("{:?} {:?}", record(model, p), velocity(model, p))).collect()
        };
        assert_eq!(bits(&resumed), bits(&model), "{sub_steps} sub-steps");
        assert_eq!(resumed.strain_energy().to_bits(), model.strain_energy().to_bits());
        // A state of another solid is refused.
        let other = parse(make, &[BLOCK], &[]);
        let mut other = (make.build)(&other, Isa::detect()).expect("a solid");
        assert!(other.state().expect("the same model").load(&saved).is_err());
    }
}
