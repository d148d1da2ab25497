//! A warmed-up step allocates nothing: roles driven directly, on one thread, and every allocation of it counted.

use halfstep_coupling::roles;
use halfstep_interface::{Interface, Parameters};
use halfstep_role::role::{Peer, Role};
use halfstep_role::serve::on_threads;
use halfstep_scene::{self as scene, Scene};
use halfstep_sph::lane::Isa;
use halfstep_tests::run::repository;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::ForceRecord;
use std::alloc::{GlobalAlloc, Layout, System};
use std::backtrace::Backtrace;
use std::cell::Cell;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
    static WATCHED: Cell<bool> = const { Cell::new(false) };
}

struct Counting;

fn count() {
    let before = ALLOCATIONS.replace(ALLOCATIONS.get() + 1);
    // Each says where it comes from; taking the trace allocates, too, but that does not count.
    if WATCHED.replace(false) {
        eprintln!("allocated during a warmed-up step:\n{}", Backtrace::force_capture());
        ALLOCATIONS.set(before + 1);
        WATCHED.set(true);
    }
}

// SAFETY: every call goes to the system's allocator unchanged; the counters are plain thread-local numbers.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn shipped(name: &str, overrides: &[&str]) -> Scene {
    let path = repository().join("scenes").join(name).with_extension("toml");
    let overrides: Vec<String> = overrides.iter().map(|o| o.to_string()).collect();
    scene::load(&path, &overrides).unwrap_or_else(|errors| panic!("{name}: {errors:?}"))
}

/// Allocations of `step` in a hundred steps after the first `warm`, on the thread that computes.
fn allocations(warm: u64, mut step: impl FnMut(u64) + Send) -> u64 {
    on_threads(1, || {
        (0..warm).for_each(&mut step);
        let before = ALLOCATIONS.get();
        assert!(before > 0, "the counter counts: lists grew at first");
        WATCHED.set(true);
        (warm..warm + 100).for_each(&mut step);
        WATCHED.set(false);
        ALLOCATIONS.get() - before
    })
    .unwrap()
}

/// Steps of a role that is alone.
fn alone(scene: &Scene) -> u64 {
    let mut role: Option<Box<dyn Role>> = None;
    let mut records = Vec::new();
    let mut time = 0.0;
    allocations(600, |n| {
        let role = role.get_or_insert_with(|| roles::build(0, scene, Isa::detect()).expect("the phase"));
        let mut half_step = HalfStep::begin(n, time);
        while half_step.step == n {
            role.set_time(half_step.before());
            role.publish(&[], &mut records);
            if half_step.stage == Stage::First {
                half_step = half_step.lasting(role.dt_limit());
            }
            role.own_sums();
            role.advance(&half_step, &[]).unwrap();
            half_step = half_step.next();
        }
        time = half_step.time;
    })
}

/// Steps of both roles of a coupled scene, with the forces that the coupler would send but for f_i.
fn coupled(scene: &Scene) -> u64 {
    let mut state: Option<[Box<dyn Role>; 2]> = None;
    let parameters = || Parameters::<2>::new(scene, 0, Isa::detect()).expect("both phases");
    let mut interface = Interface::new(parameters());
    let [mut of_fluid, mut of_solid] = [(); 2].map(|()| [Peer::default()]);
    let mut forces = [Vec::new(), Vec::new()];
    allocations(300, |n| {
        let [fluid, solid] = state.get_or_insert_with(|| {
            [0, 1].map(|place| roles::build(place, scene, Isa::detect()).expect("the phase"))
        });
        let mut half_step = HalfStep::begin(n, 0.0);
        while half_step.step == n {
            solid.publish(&of_fluid, &mut of_solid[0].records);
            let epoch = fluid.publish(&of_solid, &mut of_fluid[0].records);
            of_fluid[0].epoch = epoch;
            if half_step.stage == Stage::First {
                half_step = half_step.lasting(fluid.dt_limit().min(solid.dt_limit()));
            }
            fluid.own_sums();
            solid.own_sums();
            fluid.cross_sums(&of_fluid[0].records, &of_solid).unwrap();
            solid.cross_sums(&of_solid[0].records, &of_fluid).unwrap();
            for (forces, records) in forces.iter_mut().zip([&of_fluid[0].records, &of_solid[0].records]) {
                forces.clear();
                forces.extend(records.iter().map(|r| ForceRecord { id: r.id, ..ForceRecord::default() }));
            }
            interface.update(&of_fluid[0].records, &of_solid[0].records, epoch);
            interface.act_on_solid(|record, [x, y]| forces[1][record].stress_force = [x, y, 0.0]);
            interface.drag_on_solid(|record, [x, y]| forces[1][record].cross_viscosity = [x, y, 0.0]);
            interface.drag_on_fluid(|record, [x, y]| forces[0][record].cross_viscosity = [x, y, 0.0]);
            fluid.advance(&half_step, &forces[0]).unwrap();
            solid.advance(&half_step, &forces[1]).unwrap();
            half_step = half_step.next();
        }
    })
}

#[test]
fn fluid_at_rest() {
    assert_eq!(alone(&shipped("hydrostatic-tank", &[])), 0);
}

#[test]
fn fluid_that_spreads() {
    assert_eq!(alone(&shipped("dam-break", &["resolution=0.0028575"])), 0);
}

#[test]
fn fluid_between_moving_walls() {
    assert_eq!(alone(&shipped("wave-paddle", &["resolution=0.02"])), 0);
}

#[test]
fn position_verlet() {
    let verlet = "fluid.time_integration=verlet";
    assert_eq!(alone(&shipped("dam-break", &["resolution=0.0028575", verlet])), 0);
    assert_eq!(coupled(&shipped("elastic-gate", &["resolution=0.0025", verlet])), 0);
}

#[test]
fn viscous_fluid() {
    assert_eq!(alone(&shipped("taylor-green", &[])), 0);
    let overrides = ["resolution=0.002286", "fluid.viscosity=1", "effects.viscosity=on"];
    assert_eq!(alone(&shipped("dam-break", &overrides)), 0);
}

#[test]
fn solid_that_bends() {
    for model in ["solid.model=hypoelastic", "solid.model=total-lagrangian"] {
        assert_eq!(alone(&shipped("oscillating-plate", &["resolution=0.004", model])), 0);
    }
}

#[test]
fn solids_that_collide() {
    assert_eq!(alone(&shipped("colliding-rings", &["resolution=0.002"])), 0);
}

#[test]
fn total_lagrangian_solids_that_collide() {
    let overrides = ["resolution=0.002", "solid.model=total-lagrangian"];
    assert_eq!(alone(&shipped("colliding-rings", &overrides)), 0);
}

#[test]
fn both_phases_with_a_total_lagrangian_solid() {
    assert_eq!(coupled(&shipped("elastic-gate", &["resolution=0.0025", "solid.model=total-lagrangian"])), 0);
}

#[test]
fn both_phases_with_a_moving_wall() {
    assert_eq!(coupled(&shipped("elastic-gate", &["resolution=0.0025", "solid.model=hypoelastic"])), 0);
}

#[test]
fn both_phases_with_viscous_stress_between_them() {
    let overrides = ["resolution=0.0025", "fluid.viscosity=1", "effects.viscosity=on"];
    assert_eq!(coupled(&shipped("elastic-gate", &overrides)), 0);
}

#[test]
fn both_phases_phase_blind() {
    let overrides = ["resolution=0.0025", "interface.treatment=phase-blind"];
    assert_eq!(coupled(&shipped("elastic-gate", &overrides)), 0);
}
