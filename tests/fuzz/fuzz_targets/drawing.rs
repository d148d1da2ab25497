//! The fuzzer of [`halfstep_fuzz::drawing`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| halfstep_fuzz::drawing(bytes));
