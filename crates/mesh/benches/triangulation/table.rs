//! Ratios and peak memory in one table.

use crate::contenders::{Contender, Python, seconds};
use crate::input::{self, Kind};
use softfold_mesh::PlanarGraph;
use std::process::Command;

pub(crate) const MEMORY_FLAG: &str = "--memory-of";
/// How often all take turns; the least time counts.
const ROUNDS: usize = 4;

/// Prints what every program takes at every size, and what meshing takes.
pub(crate) fn print(sizes: &[usize]) {
    let python = Python::find();
    if python.is_none() {
        println!("Triangle is left out: no Python with `triangle` and `numpy` (SOFTFOLD_BENCH_PYTHON)");
    }
    println!("{:>9} {:>11} {:>10} {:>8} {:>10} {:>9}", "points", "", "s", "ratio", "MiB", "exponent");
    let mut before: Option<(usize, Vec<f64>)> = None;
    for &size in sizes {
        let times = triangulation(size, python.as_ref(), before.as_ref());
        before = Some((size, times));
    }
    for kind in Kind::ALL {
        println!("\nwhole mesher, {kind:?}: least ratio to a triangulation of its own points");
        let mut before = None;
        for &size in sizes {
            before = Some(mesher(size, kind, before));
        }
    }
}

fn triangulation(size: usize, python: Option<&Python>, before: Option<&(usize, Vec<f64>)>) -> Vec<f64> {
    let graph = input::graph(size);
    let mut least = vec![f64::MAX; Contender::ALL.len()];
    let mut bytes = vec![0.0; least.len()];
    for _ in 0..ROUNDS {
        for (i, contender) in Contender::ALL.into_iter().enumerate() {
            let taken = match (contender, python) {
                (Contender::Triangle, None) => continue,
                (Contender::Triangle, Some(python)) => {
                    let (taken, memory) = python.run(&graph);
                    bytes[i] = memory;
                    taken
                }
                _ => seconds(size, || contender.run(&graph)),
            };
            least[i] = least[i].min(taken);
        }
    }
    let fastest = least[1..].iter().copied().fold(f64::MAX, f64::min);
    for (i, contender) in Contender::ALL.into_iter().enumerate().filter(|(i, _)| least[*i] < f64::MAX) {
        if contender != Contender::Triangle {
            bytes[i] = memory(contender.name(), size);
        }
        let growth = before.map(|(n, times)| exponent(*n, times[i], size, least[i]));
        let name = contender.name();
        let (ratio, mib) = (least[i] / fastest, bytes[i] / f64::from(1 << 20));
        println!("{size:>9} {name:>11} {:>10.4} {ratio:>8.2} {mib:>10.1} {}", least[i], shown(growth));
    }
    least
}

fn mesher(size: usize, kind: Kind, before: Option<(usize, f64)>) -> (usize, f64) {
    let (soft, options) = input::sheet(size, kind);
    let graph: PlanarGraph = softfold_mesh::mesh(&soft, &options).unwrap().graph;
    let mut least = [f64::MAX; 3];
    for _ in 0..ROUNDS {
        let taken = [
            seconds(size, || softfold_mesh::mesh(&soft, &options).unwrap()),
            seconds(size, || Contender::Spade.run(&graph)),
            seconds(size, || Contender::Ours.run(&graph)),
        ];
        least = [0, 1, 2].map(|k| taken[k].min(least[k]));
    }
    let [mesh, spade, ours] = least;
    let vertices = graph.points.len();
    let growth = before.map(|(n, taken)| exponent(n, taken, vertices, mesh));
    let mib = memory(&format!("{kind:?}"), size) / f64::from(1 << 20);
    println!(
        "{vertices:>9} {mesh:>10.4} s, {:.2} times bare spade, {:.2} times ours, {mib:.1} MiB {}",
        mesh / spade,
        mesh / ours,
        shown(growth)
    );
    (vertices, mesh)
}

fn exponent(n: usize, seconds: f64, more: usize, longer: f64) -> f64 {
    (longer / seconds).ln() / (more as f64 / n as f64).ln()
}

fn shown(growth: Option<f64>) -> String {
    growth.map_or(String::new(), |e| format!("n^{e:.2}"))
}

/// Peak memory that a program, or meshing a kind of sheet, takes on top of its input, in a process of its own; 0 where the system does not tell.
fn memory(name: &str, size: usize) -> f64 {
    let exe = std::env::current_exe().unwrap();
    let output = Command::new(exe).args([MEMORY_FLAG, name, &size.to_string()]).output().unwrap();
    String::from_utf8(output.stdout).unwrap().trim().parse().unwrap()
}

/// The same from inside that process.
pub(crate) fn peak_bytes(name: &str, size: usize) -> f64 {
    if let Some(kind) = Kind::ALL.into_iter().find(|k| format!("{k:?}") == name) {
        let (soft, options) = input::sheet(size, kind);
        let before = resident("VmRSS:");
        drop(softfold_mesh::mesh(&soft, &options).unwrap());
        return resident("VmHWM:") - before;
    }
    let graph = input::graph(size);
    let before = resident("VmRSS:");
    Contender::by_name(name).expect("a contender").run(&graph);
    resident("VmHWM:") - before
}

fn resident(field: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix(field));
    line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok()).map_or(0.0, |kib| 1024.0 * kib)
}
