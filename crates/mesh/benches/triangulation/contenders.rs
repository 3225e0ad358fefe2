//! The programs that are compared.

use softfold_mesh::{Backend, PlanarGraph, triangulate};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Instant;

/// A program that triangulates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Contender {
    /// [`triangulate`], with the triangles of the sheet in their order.
    Ours,
    /// spade's bulk load and nothing after it.
    Spade,
    /// CGAL through the kernel: triangles of the convex hull.
    Cgal,
    /// Shewchuk's Triangle as its Python package has it.
    Triangle,
}

impl Contender {
    pub(crate) const ALL: [Self; 4] = [Self::Ours, Self::Spade, Self::Cgal, Self::Triangle];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Ours => "ours",
            Self::Spade => "bare spade",
            Self::Cgal => "CGAL",
            Self::Triangle => "Triangle",
        }
    }

    pub(crate) fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }

    /// How many triangles it makes; Triangle runs in Python alone.
    pub(crate) fn run(self, graph: &PlanarGraph) -> usize {
        match self {
            Self::Ours => triangulate(graph, Backend::Spade).unwrap().triangles.len(),
            Self::Spade => {
                let points = graph.points.iter().map(|p| Point2::new(p.x, p.y)).collect();
                let edges = graph.constraints.iter().map(|(e, _)| e.map(|v| v.index())).collect();
                let cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::bulk_load_cdt(points, edges);
                cdt.unwrap().num_inner_faces()
            }
            Self::Cgal => {
                let points: Vec<[f64; 2]> = graph.points.iter().map(|p| p.to_array()).collect();
                let edges: Vec<[u32; 2]> = graph.constraints.iter().map(|(e, _)| e.map(|v| v.0)).collect();
                softfold_kernel::cgal::constrained_delaunay(&points, &edges).unwrap().triangles.len()
            }
            Self::Triangle => 0,
        }
    }
}

/// The system counts processor time in steps of up to 4 ms: short calls are repeated until they are on so many points.
const POINTS_AT_A_TIME: usize = 400_000;

/// Processor time of a call on so many points, s; by the clock where the system does not tell.
pub(crate) fn seconds<T>(points: usize, call: impl Fn() -> T) -> f64 {
    let calls = POINTS_AT_A_TIME.div_ceil(points);
    let (clock, before) = (Instant::now(), processor_ns());
    (0..calls).for_each(|_| drop(std::hint::black_box(call())));
    let taken = match (before, processor_ns()) {
        (Some(before), Some(after)) => (after - before) as f64 * 1e-9,
        _ => clock.elapsed().as_secs_f64(),
    };
    taken / calls as f64
}

fn processor_ns() -> Option<u64> {
    std::fs::read_to_string("/proc/self/schedstat").ok()?.split(' ').next()?.parse().ok()
}

/// A Python with `triangle`.
pub(crate) struct Python(PathBuf);

/// Points and constraints come as binary numbers; prints seconds, and bytes of memory that were taken.
const SCRIPT: &str = "
import sys, time, resource, numpy, triangle
n, m = (int(a) for a in sys.argv[1:])
data = sys.stdin.buffer
points = numpy.frombuffer(data.read(16 * n)).reshape(n, 2).copy()
edges = numpy.frombuffer(data.read(8 * m), dtype='uint32').astype('int32').reshape(m, 2)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
start = time.process_time()
triangle.triangulate({'vertices': points, 'segments': edges}, 'p')
print(time.process_time() - start, 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before))
";

impl Python {
    /// The one that the environment names, or that of the outside readers.
    pub(crate) fn find() -> Option<Self> {
        let readers = || {
            let exe = std::env::current_exe().ok()?;
            let folder = exe.ancestors().find(|a| a.join("readers-venv").is_dir())?;
            Some(folder.join("readers-venv/bin/python").into_os_string())
        };
        let python = std::env::var_os("SOFTFOLD_BENCH_PYTHON").or_else(readers)?;
        let works =
            Command::new(&python).args(["-c", "import triangle, numpy"]).stderr(Stdio::null()).status();
        works.is_ok_and(|s| s.success()).then(|| Self(python.into()))
    }

    /// Seconds and bytes that Triangle takes for a graph.
    pub(crate) fn run(&self, graph: &PlanarGraph) -> (f64, f64) {
        let sizes = [graph.points.len(), graph.constraints.len()].map(|n| n.to_string());
        let mut command = Command::new(&self.0);
        command.args(["-c", SCRIPT]).args(sizes).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut input: Vec<u8> =
            graph.points.iter().flat_map(|p| p.to_array()).flat_map(f64::to_ne_bytes).collect();
        input.extend(graph.constraints.iter().flat_map(|(e, _)| e.map(|v| v.0)).flat_map(u32::to_ne_bytes));
        child.stdin.take().unwrap().write_all(&input).unwrap();
        let output = String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap();
        let mut numbers = output.split_whitespace().map(|n| n.parse().unwrap());
        (numbers.next().unwrap(), numbers.next().unwrap())
    }
}
