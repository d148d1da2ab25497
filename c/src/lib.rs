//! A solid in C (`include/halfstep.h`): the functions that it calls.
//!
//! A program is one participant, so there is no handle: the connection belongs to the thread that opened it, and a call
//! after its end is an error like any other. Pointers are checked before they are used; what is wrong is a code and a
//! text, and nothing unwinds into C.

mod call;

pub use call::Code;
use call::{Fault, call, input, name, optional, output, text, vectors, vectors_mut};
use halfstep_client::{Contact, Particles, Quantity, Run, Solid};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ffi::{c_char, c_int};
use std::mem::ManuallyDrop;

/// A half step, as the header has it.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Step {
    number: u64,
    stage: u32,
    reserved: u32,
    time: f64,
    dt: f64,
    next_time: f64,
    span: f64,
}

impl From<halfstep_client::Step> for Step {
    fn from(step: halfstep_client::Step) -> Self {
        let halfstep_client::Step { number, stage, time, dt, next_time, span } = step;
        Self { number, stage, reserved: 0, time, dt, next_time, span }
    }
}

thread_local! {
    /// Not dropped where the thread ends: the transport's own objects of the thread may be gone by then.
    static SOLID: RefCell<Option<ManuallyDrop<Solid>>> = const { RefCell::new(None) };
    static PARTICLES: RefCell<Option<Particles>> = const { RefCell::new(None) };
    /// What is said before the solid is opened: the bodies of its particles, and what it keeps.
    static BODIES: RefCell<Vec<u32>> = const { RefCell::new(Vec::new()) };
    static KEPT: RefCell<BTreeMap<String, Vec<f64>>> = const { RefCell::new(BTreeMap::new()) };
}

/// Calls `act` with the solid of this thread.
fn with<T>(act: impl FnOnce(&mut Solid) -> Result<T, Fault>) -> Result<T, Fault> {
    SOLID.with_borrow_mut(|solid| match solid {
        Some(solid) => act(solid),
        None => Err(Fault::state("no solid is open in this thread: halfstep_open comes first")),
    })
}

/// Text of the last error in this thread, UTF-8; empty where there was none. It holds until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn halfstep_error() -> *const c_char {
    text()
}

/// Number of particles that the scene gives this solid.
///
/// # Safety
/// `count` is null or points to a `size_t`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_particle_count(count: *mut usize) -> c_int {
    call(|| {
        let particles = Particles::of_scene()?;
        // SAFETY: as of this function.
        let count = unsafe { output(count, 1, "count")? };
        count[0] = particles.count();
        PARTICLES.set(Some(particles));
        Ok(Code::Ok)
    })
}

/// The particles that the scene gives this solid.
///
/// # Safety
/// Each array is null or has the length that the header says for `count`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_particles(
    count: usize,
    position: *mut f64,
    velocity: *mut f64,
    mass: *mut f64,
    density: *mut f64,
    clamped: *mut u8,
) -> c_int {
    call(|| {
        let particles = match PARTICLES.take() {
            Some(particles) => particles,
            None => Particles::of_scene()?,
        };
        call::same_count(count, particles.count())?;
        // SAFETY: as of this function.
        unsafe {
            let columns =
                [(position, &particles.position, "position"), (velocity, &particles.velocity, "velocity")];
            for (to, from, name) in columns {
                output(to, 3 * count, name)?.copy_from_slice(from.as_flattened());
            }
            for (to, from, name) in
                [(mass, &particles.mass, "mass"), (density, &particles.density, "density")]
            {
                output(to, count, name)?.copy_from_slice(from);
            }
            for (to, held) in output(clamped, count, "clamped")?.iter_mut().zip(&particles.clamped) {
                *to = u8::from(*held);
            }
        }
        Ok(Code::Ok)
    })
}

/// Joins the run with these particles and publishes their first state.
///
/// # Safety
/// Each array is null or has the length that the header says for `count`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_open(
    count: usize,
    position: *const f64,
    velocity: *const f64,
    mass: *const f64,
    density: *const f64,
    clamped: *const u8,
    own_walls: c_int,
) -> c_int {
    call(|| {
        if SOLID.with_borrow(Option::is_some) {
            return Err(Fault::state("a solid is open already: a program is one participant"));
        }
        let mut run = Run::of_environment()?;
        run.room_for(count)?;
        KEPT.with_borrow(|kept| kept.iter().try_for_each(|(name, values)| run.keep(name, values)))?;
        // SAFETY: as of this function; the count fits into a message.
        let particles = unsafe {
            Particles {
                position: vectors(position, count, "position")?.to_vec(),
                velocity: vectors(velocity, count, "velocity")?.to_vec(),
                mass: input(mass, count, "mass")?.to_vec(),
                density: input(density, count, "density")?.to_vec(),
                clamped: match optional(clamped, count, "clamped")? {
                    Some(clamped) => clamped.iter().map(|held| *held != 0).collect(),
                    None => vec![false; count],
                },
                body: BODIES.with_borrow(Clone::clone),
            }
        };
        let solid = run.join(&particles, if own_walls != 0 { Contact::Own } else { Contact::Coupler })?;
        SOLID.set(Some(ManuallyDrop::new(solid)));
        Ok(Code::Ok)
    })
}

/// Waits for the forces on the state that was published last.
///
/// # Safety
/// `step` is null or points to a `halfstep_step`, `forces` is null or has 3 x `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_wait(step: *mut Step, count: usize, forces: *mut f64) -> c_int {
    call(|| {
        with(|solid| {
            call::same_count(count, solid.count())?;
            // SAFETY: as of this function.
            let (step, forces) = unsafe { (output(step, 1, "step")?, vectors_mut(forces, count, "forces")?) };
            let Some(told) = solid.wait()? else { return Ok(Code::Stopped) };
            step[0] = told.into();
            forces.copy_from_slice(solid.forces());
            Ok(Code::Ok)
        })
    })
}

/// Publishes the state after the half step that `halfstep_wait` told.
///
/// # Safety
/// Each array is null or has 3 x `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_publish(count: usize, position: *const f64, velocity: *const f64) -> c_int {
    call(|| {
        with(|solid| {
            call::same_count(count, solid.count())?;
            // SAFETY: as of this function.
            let [x, v] =
                unsafe { [vectors(position, count, "position")?, vectors(velocity, count, "velocity")?] };
            solid.publish(x, v)?;
            Ok(Code::Ok)
        })
    })
}

/// Gives the states from now on a stress, for pictures and stress probes.
///
/// # Safety
/// `stress` is null or has 6 x `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_stress(count: usize, stress: *const f64) -> c_int {
    call(|| {
        with(|solid| {
            call::same_count(count, solid.count())?;
            // SAFETY: as of this function.
            solid.stress(unsafe { vectors(stress, count, "stress")? })?;
            Ok(Code::Ok)
        })
    })
}

/// Number of the connected body of each particle that the scene gives this solid.
///
/// # Safety
/// `body` is null or has `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_particle_bodies(count: usize, body: *mut u32) -> c_int {
    call(|| {
        let particles = Particles::of_scene()?;
        call::same_count(count, particles.count())?;
        // SAFETY: as of this function.
        unsafe { output(body, count, "body")? }.copy_from_slice(&particles.body);
        Ok(Code::Ok)
    })
}

/// Says the connected body of each particle of the solid that is opened next.
///
/// # Safety
/// `body` is null or has `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_bodies(count: usize, body: *const u32) -> c_int {
    call(|| {
        if SOLID.with_borrow(Option::is_some) {
            return Err(Fault::state("the bodies are said before halfstep_open"));
        }
        // SAFETY: as of this function.
        BODIES.set(unsafe { input(body, count, "body")? }.to_vec());
        Ok(Code::Ok)
    })
}

/// Keeps numbers for the checkpoint of the state that is published next.
///
/// # Safety
/// `name` is null or ends with a zero, `values` is null or has `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_keep(key: *const c_char, count: usize, values: *const f64) -> c_int {
    call(|| {
        // SAFETY: as of this function.
        let (key, values) = unsafe { (name(key)?, input(values, count, "values")?) };
        if SOLID.with_borrow(Option::is_some) {
            return with(|solid| Ok(solid.keep(key, values).map(|()| Code::Ok)?));
        }
        if values.iter().any(|x| !x.is_finite()) {
            return Err(Fault::new(Code::Value, format!("`{key}` has a number that is not finite")));
        }
        KEPT.with_borrow_mut(|kept| kept.insert(key.to_owned(), values.to_vec()));
        Ok(Code::Ok)
    })
}

/// Numbers that were kept at the checkpoint that the run goes on from.
///
/// # Safety
/// `name` is null or ends with a zero, `values` is null or has `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_saved(key: *const c_char, count: usize, values: *mut f64) -> c_int {
    call(|| {
        let run = Run::of_environment()?;
        // SAFETY: as of this function.
        let (key, values) = unsafe { (name(key)?, output(values, count, "values")?) };
        let Some(saved) = run.saved(key) else { return Ok(Code::Nothing) };
        if saved.len() != count {
            let text = format!("{count} numbers, but `{key}` has {}", saved.len());
            return Err(Fault::new(Code::Count, text));
        }
        values.copy_from_slice(saved);
        Ok(Code::Ok)
    })
}

/// Gives the states from now on a pressure, for pictures and probes.
///
/// # Safety
/// `pressure` is null or has `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_pressure(count: usize, pressure: *const f64) -> c_int {
    call(|| {
        with(|solid| {
            call::same_count(count, solid.count())?;
            // SAFETY: as of this function.
            solid.pressure(unsafe { input(pressure, count, "pressure")? })?;
            Ok(Code::Ok)
        })
    })
}

/// Gives the states from now on a density.
///
/// # Safety
/// `density` is null or has `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn halfstep_density(count: usize, density: *const f64) -> c_int {
    call(|| {
        with(|solid| {
            call::same_count(count, solid.count())?;
            // SAFETY: as of this function.
            solid.density(unsafe { input(density, count, "density")? })?;
            Ok(Code::Ok)
        })
    })
}

/// Says in how many steps of its own the solid advances.
#[unsafe(no_mangle)]
pub extern "C" fn halfstep_sub_steps(count: u32) -> c_int {
    call(|| with(|solid| Ok(solid.sub_steps(count).map(|()| Code::Ok)?)))
}

/// Says what energy the solid stores, J (2D: J/m).
#[unsafe(no_mangle)]
pub extern "C" fn halfstep_stored_energy(joules: f64) -> c_int {
    call(|| with(|solid| Ok(solid.stored_energy(joules).map(|()| Code::Ok)?)))
}

/// Says the largest time step that the solid allows from the next state on, s.
#[unsafe(no_mangle)]
pub extern "C" fn halfstep_dt_limit(seconds: f64) -> c_int {
    call(|| {
        with(|solid| {
            solid.dt_limit(seconds)?;
            Ok(Code::Ok)
        })
    })
}

/// Ends the run: a quantity of a particle left its bounds.
#[unsafe(no_mangle)]
pub extern "C" fn halfstep_diverged(quantity: c_int, particle: u32, value: f64) -> c_int {
    call(|| {
        with(|solid| {
            let known = u32::try_from(quantity).ok().and_then(Quantity::from_wire);
            let unknown = || Fault::new(Code::Value, format!("no quantity has the number {quantity}"));
            solid.diverged(known.ok_or_else(unknown)?, particle, value)?;
            Ok(Code::Ok)
        })
    })
}

/// Leaves the run. Where it is not over it ends with it: the solid has failed.
#[unsafe(no_mangle)]
pub extern "C" fn halfstep_close() -> c_int {
    call(|| {
        let left = SOLID.take().map(|solid| ManuallyDrop::into_inner(solid).close());
        // At the end of the thread they are gone already.
        let _ = BODIES.try_with(RefCell::take);
        let _ = KEPT.try_with(RefCell::take);
        left.transpose()?;
        Ok(Code::Ok)
    })
}
