//! The project's own chores: `cargo xtask demo`, `test`, `setup`, `readers`.
//!
//! Standard library only, so that it builds in seconds and before any C++ library is there.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command line tool talks to its terminal")]

mod chore;
mod demo;
mod outside;
mod packages;
mod suite;

use std::process::ExitCode;

use chore::{Chores, Failure};

const USAGE: &str = "\
cargo xtask demo             install what is missing, build, run the sculpture into ./out, check its files
cargo xtask test             install what is missing, then formatting, outside readers, clippy and all tests
cargo xtask setup            install the system packages that the build needs
cargo xtask readers [DIR]    set up the outside readers, test them, and let them read DIR (./out if it is there)
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut chores = Chores::new();
    let outcome = match words.as_slice() {
        ["demo"] => demo::run(&mut chores),
        ["test"] => suite::run(&mut chores),
        ["setup"] => packages::install(&mut chores),
        ["readers"] => outside::run(&mut chores, None),
        ["readers", folder] => outside::run(&mut chores, Some(folder)),
        ["help" | "--help" | "-h"] => {
            print!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    chores.print_times();
    finish(outcome)
}

fn finish(outcome: Result<(), Failure>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("\nxtask: {failure}");
            ExitCode::FAILURE
        }
    }
}
