//! The fuzzer of [`halfstep_fuzz::curve`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| halfstep_fuzz::curve(bytes));
