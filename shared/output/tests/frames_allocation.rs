//! Handing over a frame allocates nothing on the computing thread once the memory circulates.

use halfstep_output::{FramePoint, FrameWriter};
use halfstep_scene::Phase;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local!(static ALLOCATIONS: Cell<u64> = const { Cell::new(0) });

struct Counting;

// SAFETY: every call goes to the system's allocator unchanged; the counter is a plain thread-local number.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn submitting_does_not_allocate_once_warmed_up() {
    let dir = tempfile::tempdir().unwrap();
    let mut writer = FrameWriter::start(dir.path(), "fluid").unwrap();
    let particle = FramePoint {
        position: [0.0; 3],
        velocity: [0.0; 3],
        density: 1000.0,
        pressure: 0.0,
        stress: [0.0; 6],
        phase: Phase::Fluid,
        id: 0,
    };
    let mut submit = |number: u32| {
        let fill = |frame: &mut halfstep_output::Frame| (0..5000).for_each(|_| frame.push(particle));
        writer.submit(number, fill).unwrap();
    };
    let before = ALLOCATIONS.get();
    (0..8).for_each(&mut submit);
    let warm = ALLOCATIONS.get();
    assert!(warm > before, "the columns grow at first: the counter counts");
    (8..40).for_each(&mut submit);
    assert_eq!(ALLOCATIONS.get(), warm);
    assert_eq!(writer.finish().unwrap(), 40);
}
