//! STEP files of a sheet and of its board beside those of the same mesh carried into CAD triangle by triangle: size, time to
//! write, time to read back.
//!
//! `cargo bench -p softfold --bench step`. CPU seconds of this thread, the least of three; only the ratios are worth
//! comparing.

#![allow(
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a benchmark may stop at the first surprise, and prints its table"
)]

#[path = "fold/measure.rs"]
#[allow(dead_code, reason = "the other benchmark measures more")]
mod measure;

use measure::cpu_seconds;
use softfold::progress::Quiet;
use softfold::{Loaded, Stage};
use softfold_geometry::DVec3;
use softfold_kernel::MeshView;
use softfold_kernel::occt::{self, NamedShape, Shape, StepOptions};
use std::path::{Path, PathBuf};

/// Times that a file is written and read; the least counts.
const REPEATS: usize = 3;

/// What one file costs.
struct Cost {
    bytes: f64,
    write_s: f64,
    read_s: f64,
}

fn cost(folder: &Path, name: &str, shape: &Shape) -> Cost {
    let path = folder.join(format!("{name}.step"));
    let part = NamedShape { name, color_srgb: [0.8; 3], material: None, shape };
    let least = |work: &dyn Fn()| {
        let one = |_| {
            let start = cpu_seconds();
            work();
            cpu_seconds() - start
        };
        (0..REPEATS).map(one).fold(f64::INFINITY, f64::min)
    };
    let write_s = least(&|| occt::write_step(&path, &[part], &StepOptions::default()).expect("written"));
    let read_s = least(&|| drop(occt::read_step(&path).expect("read")));
    Cost { bytes: std::fs::metadata(&path).expect("a file").len() as f64, write_s, read_s }
}

fn row(name: &str, ours: &Cost, faceted: &Cost) {
    let column = |ours: f64, faceted: f64, unit: f64| {
        format!("{:9.2} {:9.2} {:8.1}", ours / unit, faceted / unit, faceted / ours)
    };
    println!(
        "{name:8} | {} | {} | {}",
        column(ours.bytes, faceted.bytes, 1e6),
        column(ours.write_s, faceted.write_s, 1.0),
        column(ours.read_s, faceted.read_s, 1.0)
    );
}

/// A mesh as plane faces, one a triangle.
fn faceted(positions: &[DVec3], triangles: &[[u32; 3]]) -> Shape {
    let positions: Vec<[f64; 3]> = positions.iter().map(|p| p.to_array()).collect();
    occt::faceted(MeshView { positions: &positions, triangles }).expect("a shape of triangles")
}

fn main() {
    let fixture: PathBuf =
        [env!("CARGO_MANIFEST_DIR"), "../../fixtures/sculpture/project.toml"].iter().collect();
    let loaded = Loaded::read(&fixture).expect("the sculpture");
    let results = softfold::run(&loaded, Stage::Board, &mut Quiet).expect("a board");
    let seconds = |stage: &str| results.seconds.iter().find(|s| s.0 == stage).map_or(0.0, |s| s.1);
    println!("sculpture: surface {:.1} s, board {:.1} s", seconds("surface"), seconds("board"));
    let (fold, surface) = (results.fold.expect("folded"), results.surface.expect("a surface"));
    let board = results.board.expect("a board");
    let mesh = &fold.sheet.mesh;
    let sheet: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(|v| v.0)).collect();
    let solid = softfold_mold::solid_of_skins(&board, &mesh.vertices, &sheet);
    let folder = std::env::temp_dir().join(format!("softfold-step-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    println!(
        "         | size MB: ours, faceted, ratio  | write s: ours, faceted, ratio | read s: ours, faceted, ratio"
    );
    let flat = cost(&folder, "sheet-faceted", &faceted(&fold.sheet.positions, &sheet));
    row("sheet", &cost(&folder, "sheet", &surface.face), &flat);
    let thick = cost(&folder, "board-faceted", &faceted(&solid.positions, &solid.triangles));
    row("board", &cost(&folder, "board", &board.shape), &thick);
    let _ = std::fs::remove_dir_all(folder); // only a temporary folder
}
