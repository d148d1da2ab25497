//! The fuzzer of [`halfstep_fuzz::outline`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| halfstep_fuzz::outline(bytes));
