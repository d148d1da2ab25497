//! The fuzzer of [`halfstep_fuzz::checkpoint`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| halfstep_fuzz::checkpoint(bytes));
