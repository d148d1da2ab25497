//! A solid in C (`include/halfstep.h`): the functions that it calls.
//!
//! A program is one participant, so there is no handle: the connection belongs to the thread that opened it, and a call
//! after its end is an error like any other. Pointers are checked before they are used; what is wrong is a code and a
//! text, and nothing unwinds into C.

mod call;
mod solid;
mod table;

pub use call::Code;
use call::{Fault, call, input, optional, output, text};
use solid::Solid;
pub use solid::Step;
use std::cell::RefCell;
use std::ffi::{c_char, c_int};
use std::mem::ManuallyDrop;
use table::Table;

thread_local! {
    /// Not dropped where the thread ends: the transport's own objects of the thread may be gone by then.
    static SOLID: RefCell<Option<ManuallyDrop<Solid>>> = const { RefCell::new(None) };
    static TABLE: RefCell<Option<Table>> = const { RefCell::new(None) };
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
        let table = Table::read()?;
        // SAFETY: as of this function.
        let count = unsafe { output(count, 1, "count")? };
        count[0] = table.count();
        TABLE.set(Some(table));
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
        let table = match TABLE.take() {
            Some(table) => table,
            None => Table::read()?,
        };
        call::same_count(count, table.count())?;
        // SAFETY: as of this function.
        unsafe {
            let vectors = [(position, 0, "position"), (velocity, 3, "velocity")];
            for (to, first, name) in vectors {
                table.copy(first..first + 3, output(to, 3 * count, name)?);
            }
            for (to, column, name) in [(mass, 6, "mass"), (density, 7, "density")] {
                table.copy(column..column + 1, output(to, count, name)?);
            }
            for (to, value) in output(clamped, count, "clamped")?.iter_mut().zip(table.column(8)) {
                *to = u8::from(value != 0.0);
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
        let plan = solid::Plan::of_run(count)?;
        // SAFETY: as of this function; the count fits into a message.
        let solid = unsafe {
            let records = solid::records(
                input(position, 3 * count, "position")?,
                input(velocity, 3 * count, "velocity")?,
                input(mass, count, "mass")?,
                input(density, count, "density")?,
                optional(clamped, count, "clamped")?,
            )?;
            Solid::open(plan, records, own_walls != 0)?
        };
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
            let (step, forces) = unsafe { (output(step, 1, "step")?, output(forces, 3 * count, "forces")?) };
            solid.wait(&mut step[0], forces)
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
                unsafe { [input(position, 3 * count, "position")?, input(velocity, 3 * count, "velocity")?] };
            solid.publish(x, v)
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
            solid.stress(unsafe { input(stress, 6 * count, "stress")? })
        })
    })
}

/// Says the largest time step that the solid allows from the next state on, s.
#[unsafe(no_mangle)]
pub extern "C" fn halfstep_dt_limit(seconds: f64) -> c_int {
    call(|| with(|solid| solid.limit(seconds)))
}

/// Ends the run: a quantity of a particle left its bounds.
#[unsafe(no_mangle)]
pub extern "C" fn halfstep_diverged(quantity: c_int, particle: u32, value: f64) -> c_int {
    call(|| with(|solid| solid.diverged(quantity, particle, value)))
}

/// Leaves the run. Where it is not over it ends with it: the solid has failed.
#[unsafe(no_mangle)]
pub extern "C" fn halfstep_close() -> c_int {
    call(|| match SOLID.take() {
        None => Ok(Code::Ok),
        Some(solid) => ManuallyDrop::into_inner(solid).close(),
    })
}
