//! The fuzzer of [`halfstep_fuzz::message`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| halfstep_fuzz::message(bytes));
