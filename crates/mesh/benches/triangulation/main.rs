//! Our constrained Delaunay triangulation and the whole mesher against spade as it comes, CGAL and Shewchuk's Triangle.
//!
//! `cargo bench -p softfold-mesh` prints ratios and peak memory, then the plain timings. For ratios all programs take
//! turns on the same points; times are processor time, the least of all rounds, so that other work on the machine hardly
//! counts. `SOFTFOLD_BENCH_PYTHON` names a Python that has `triangle` and `numpy`; without it the environment of
//! `cargo xtask readers` is tried.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a benchmark prints, and may stop at the first surprise"
)]

#[path = "../../tests/common/mod.rs"]
mod common;
mod contenders;
mod input;
mod table;

use contenders::Contender;
use std::hint::black_box;

const SIZES: [usize; 3] = [10_000, 100_000, 1_000_000];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [flag, name, size] = arguments.as_slice()
        && flag == table::MEMORY_FLAG
    {
        println!("{}", table::peak_bytes(name, size.parse().expect("a number")));
        return;
    }
    // Cargo's tests run this without a flag, and a name asks for one of the plain timings.
    if arguments == ["--bench"] {
        table::print(&SIZES);
    }
    divan::main();
}

#[divan::bench(args = SIZES, sample_count = 3)]
fn ours(bencher: divan::Bencher<'_, '_>, size: usize) {
    time(bencher, Contender::Ours, size);
}

#[divan::bench(args = SIZES, sample_count = 3)]
fn bare_spade(bencher: divan::Bencher<'_, '_>, size: usize) {
    time(bencher, Contender::Spade, size);
}

#[divan::bench(args = SIZES, sample_count = 3)]
fn cgal(bencher: divan::Bencher<'_, '_>, size: usize) {
    time(bencher, Contender::Cgal, size);
}

/// The points that [`whole_mesher`] ends with.
#[divan::bench(args = SIZES, sample_count = 3)]
fn bare_spade_of_the_mesh(bencher: divan::Bencher<'_, '_>, size: usize) {
    let (soft, options) = input::sheet(size, input::Kind::Even);
    let graph = softfold_mesh::mesh(&soft, &options).unwrap().graph;
    bencher.bench_local(|| Contender::Spade.run(black_box(&graph)));
}

#[divan::bench(args = SIZES, sample_count = 3)]
fn whole_mesher(bencher: divan::Bencher<'_, '_>, size: usize) {
    let (soft, options) = input::sheet(size, input::Kind::Even);
    bencher.bench_local(|| softfold_mesh::mesh(black_box(&soft), &options).unwrap());
}

fn time(bencher: divan::Bencher<'_, '_>, contender: Contender, size: usize) {
    let graph = input::graph(size);
    bencher.bench_local(|| contender.run(black_box(&graph)));
}
