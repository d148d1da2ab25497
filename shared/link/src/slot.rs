//! Records and headers as the transport carries them.

use halfstep_wire::protocol::Plain;
use iceoryx2::prelude::ZeroCopySend;

/// A record or a header in shared memory: the same bytes, under the name that programs in other languages know.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Slot<T>(pub T);

// SAFETY: `Plain` promises one layout without pointers in every process, and a transparent wrapper keeps it.
unsafe impl<T: Plain> ZeroCopySend for Slot<T> {
    unsafe fn type_name() -> &'static str {
        T::NAME
    }
}

impl<T> Slot<T> {
    /// The values in a row of slots.
    pub fn values(slots: &[Self]) -> &[T] {
        // SAFETY: `Slot` is transparent, so both slices have the same layout; the lifetime is that of the argument.
        unsafe { &*(std::ptr::from_ref(slots) as *const [T]) }
    }

    /// Values as slots.
    pub(super) fn of(values: &[T]) -> &[Self] {
        // SAFETY: as in [`Self::values`].
        unsafe { &*(std::ptr::from_ref(values) as *const [Self]) }
    }
}
