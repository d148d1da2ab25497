//! The fuzzer of [`halfstep_fuzz::scene`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| halfstep_fuzz::scene(bytes));
