//! The border to C: codes, texts, pointers.

use halfstep_client::Error;
use std::cell::RefCell;
use std::ffi::{CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a function returns, as the header has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Code {
    /// Done.
    Ok = 0,
    /// The run has ended as it should: the solid has left it.
    Stopped = 1,
    /// The run begins, or nothing of that name was kept.
    Nothing = 2,
    /// A pointer is null or not aligned.
    Pointer = -1,
    /// Another number of particles than the solid's, or one that the run has no room for.
    Count = -2,
    /// A number that nothing has: not finite, or not positive where it must be.
    Value = -3,
    /// Not now, or not in this thread.
    State = -4,
    /// The run: there is none, it speaks another version, or another process of it has ended.
    Run = -5,
    /// A mistake of the library.
    Internal = -6,
}

/// Why a call failed.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) code: Code,
    text: String,
}

impl Fault {
    pub(crate) fn new(code: Code, text: impl Into<String>) -> Self {
        Self { code, text: text.into() }
    }

    pub(crate) fn state(text: &str) -> Self {
        Self::new(Code::State, text)
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        let code = match &error {
            Error::Count(_) => Code::Count,
            Error::Value(_) => Code::Value,
            Error::State(_) => Code::State,
            Error::Run(_) => Code::Run,
        };
        Self::new(code, error.to_string())
    }
}

thread_local! {
    static TEXT: RefCell<CString> = RefCell::default();
}

/// The text of the last error in this thread.
pub(crate) fn text() -> *const c_char {
    TEXT.with_borrow(|text| text.as_ptr())
}

/// Runs what a function does; keeps the text of what is wrong, and lets no panic out.
pub(crate) fn call(act: impl FnOnce() -> Result<Code, Fault>) -> c_int {
    let done = catch_unwind(AssertUnwindSafe(act));
    let internal =
        || Err(Fault::new(Code::Internal, "a mistake of the library: its message is on standard error"));
    match done.unwrap_or_else(|_| internal()) {
        Ok(code) => code as c_int,
        Err(Fault { code, text }) => {
            TEXT.set(CString::new(text.replace('\0', "")).unwrap_or_default());
            code as c_int
        }
    }
}

/// The caller means as many particles as there are.
pub(crate) fn same_count(found: usize, expected: usize) -> Result<(), Fault> {
    if found == expected {
        return Ok(());
    }
    Err(Fault::new(Code::Count, format!("{found} particles, but the solid has {expected}")))
}

fn usable<T>(pointer: *const T, name: &str) -> Result<(), Fault> {
    if pointer.is_null() {
        return Err(Fault::new(Code::Pointer, format!("`{name}` is NULL")));
    }
    if !pointer.is_aligned() {
        return Err(Fault::new(Code::Pointer, format!("`{name}` is not aligned")));
    }
    Ok(())
}

/// An array of the caller's to read.
///
/// # Safety
/// The pointer is null, not aligned, or that of so many elements, which nobody changes meanwhile.
pub(crate) unsafe fn input<'a, T>(pointer: *const T, count: usize, name: &str) -> Result<&'a [T], Fault> {
    usable(pointer, name)?;
    // SAFETY: as of this function.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// An array of vectors of N numbers each, all of them one after the other.
///
/// # Safety
/// As for [`input`] with N times as many elements.
pub(crate) unsafe fn vectors<'a, const N: usize>(
    pointer: *const f64,
    count: usize,
    name: &str,
) -> Result<&'a [[f64; N]], Fault> {
    // SAFETY: as of this function; an array of numbers has their alignment and no gaps.
    unsafe { input(pointer.cast(), count, name) }
}

/// The same to write.
///
/// # Safety
/// As for [`output`] with N times as many elements.
pub(crate) unsafe fn vectors_mut<'a, const N: usize>(
    pointer: *mut f64,
    count: usize,
    name: &str,
) -> Result<&'a mut [[f64; N]], Fault> {
    // SAFETY: as of this function; an array of numbers has their alignment and no gaps.
    unsafe { output(pointer.cast(), count, name) }
}

/// The same as [`input`], or nothing where it is null.
///
/// # Safety
/// As for [`input`].
pub(crate) unsafe fn optional<'a, T>(
    pointer: *const T,
    count: usize,
    name: &str,
) -> Result<Option<&'a [T]>, Fault> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: as of this function.
    unsafe { input(pointer, count, name) }.map(Some)
}

/// A text of the caller's.
///
/// # Safety
/// The pointer is null or that of characters that a zero ends, which nobody changes meanwhile.
pub(crate) unsafe fn name<'a>(pointer: *const c_char) -> Result<&'a str, Fault> {
    usable(pointer, "name")?;
    // SAFETY: as of this function.
    let text = unsafe { std::ffi::CStr::from_ptr(pointer) };
    text.to_str().map_err(|_| Fault::new(Code::Value, "the name is no UTF-8"))
}

/// An array of the caller's to write.
///
/// # Safety
/// The pointer is null, not aligned, or that of so many elements, which nobody else uses meanwhile.
pub(crate) unsafe fn output<'a, T>(pointer: *mut T, count: usize, name: &str) -> Result<&'a mut [T], Fault> {
    usable(pointer, name)?;
    // SAFETY: as of this function.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn nothing_gets_out_but_a_code_and_a_text() {
        let said = || unsafe { CStr::from_ptr(text()) }.to_str().unwrap().to_owned();
        assert_eq!(call(|| Ok(Code::Stopped)), 1);
        assert_eq!(call(|| Err(Fault::state("not now\0"))), -4);
        assert_eq!(said(), "not now");
        assert_eq!(call(|| panic!("a mistake")), -6);
        assert!(said().starts_with("a mistake of the library"));
    }

    #[test]
    fn pointers_are_checked() {
        let values = [1.0_f64, 2.0];
        let code = |pointer: *const f64| unsafe { input(pointer, 1, "x") }.map_err(|fault| fault.code);
        assert_eq!(code(values.as_ptr()), Ok(&values[..1]));
        assert_eq!(code(std::ptr::null()), Err(Code::Pointer));
        assert_eq!(code(values.as_ptr().cast::<u8>().wrapping_add(1).cast()), Err(Code::Pointer));
    }
}
