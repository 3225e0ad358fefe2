//! Bytes that call themselves .cp: a pattern that keeps its contract, or a refusal.
#![no_main]
use softfold_pattern::Format;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| softfold_pattern_fuzz::read(bytes, Format::Cp));
