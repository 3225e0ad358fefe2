//! Surfaces of several faces against closed forms of folded sheets, from the folder `../shared` beside the checkout.
//!
//! Where that folder is absent the test says so and ends; `.ci/run` refuses to begin without it.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

#[path = "common/shared.rs"]
mod shared;
#[path = "common/state.rs"]
mod state;

use shared::{files, say, shared};
use softfold_geometry::{
    CreaseId, DVec2, DVec3, EdgeClass, FlatMesh, FoldedSheet, LoopId, PlanarCurve, SheetShell, ShellEdgeKind,
    Site, SolveRecord, VertexId, polygon,
};
use softfold_kernel::occt;
use softfold_surface::{Cut, CutKind, SurfaceOptions, fit_shell};
use state::Truth;
use std::collections::{BTreeMap, BTreeSet};

/// How far the surface may be from the vertices, mm: half of what it may be off between them.
const TOLERANCE_MM: f64 = 0.01;
/// How far the surface may be from the closed form away from the creases, mm.
const OFF_MAX_MM: f64 = 0.02;
/// How far from a crease that begins, mm: the chords of the crease are the file's, its curve is ours.
const AWAY_MM: f64 = 1.0;

#[test]
fn surfaces_of_creased_sheets_are_their_closed_forms() {
    let Some(folder) = shared("surfaces_of_creased_sheets_are_their_closed_forms", "truth") else { return };
    let mut lines =
        vec!["\nclosed form                     faces spacing  off at rulings mm   gap mm".to_owned()];
    let mut faults = Vec::new();
    for file in files(&folder, &["fold"]) {
        let truth = Truth::read(&file);
        let (line, fault) = judged(&truth);
        lines.push(line);
        faults.extend(fault);
    }
    say(&lines.join("\n"));
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

fn judged(truth: &Truth) -> (String, Option<String>) {
    let kind = CutKind::Crease { crease: CreaseId(0), line: 0 };
    let creases = truth.creases();
    let cuts: Vec<Cut> = creases.iter().map(|c| Cut { curve: through(truth, c), kind }).collect();
    let options = SurfaceOptions { tolerance_mm: TOLERANCE_MM, ..SurfaceOptions::default() };
    let fitted = fit_shell(&finer(truth), &[outline(truth)], &cuts, &options).expect("a surface");
    let shape = softfold_mold::sheet_shell(&fitted.shell).expect("a shell");
    let off = between_vertices_mm(truth, &fitted.shell);
    let gap = fitted.shell.gap_mm.value;
    let line = format!(
        "{:<30} {:>6} {:>7.2} {off:>17.5} {gap:>9.1e}",
        truth.name,
        fitted.shell.faces.len(),
        fitted.spacing_mm
    );
    let good = off <= OFF_MAX_MM
        && fitted.watertight
        && fitted.shell.faces.len() == creases.len() + 1
        && fitted.shell.count(ShellEdgeKind::Smooth) == 0
        && occt::check(&shape).expect("a check").is_empty()
        && occt::largest_tolerance_mm(&shape).expect("a tolerance") <= 1e-6;
    let fault = (!good).then(|| format!("{}: {off} mm off, gap {gap:e} mm, {}", truth.name, fitted.why));
    (line, fault)
}

/// Largest distance from the closed form along the rulings, between vertices: rulings are straight in the sheet and in space,
/// and none of these points was fitted.
fn between_vertices_mm(truth: &Truth, shell: &SheetShell) -> f64 {
    let (flat, space) = (&truth.exact.mesh.vertices, &truth.exact.positions);
    let creases: Vec<Vec<DVec2>> =
        truth.creases().iter().map(|c| c.iter().map(|&v| flat[v as usize]).collect()).collect();
    let distance = |p: DVec2| {
        let sides = creases.iter().flat_map(|c| c.windows(2));
        sides.map(|w| polygon::segment_distance(p, w[0], w[1])).fold(f64::INFINITY, f64::min)
    };
    let faces: Vec<_> = (0..shell.faces.len()).map(|f| shell.face_surface(f).expect("a face")).collect();
    let outlines: Vec<Vec<DVec2>> = faces.iter().map(|f| f.trim[0].flatten(1e-3)).collect();
    let mut worst: f64 = 0.0;
    for [a, b] in rulings(truth) {
        for t in [0.12, 0.4, 0.63, 0.87] {
            let p = flat[a as usize].lerp(flat[b as usize], t);
            let inside = outlines.iter().position(|o| polygon::contains(o, p));
            if let Some(f) = inside.filter(|_| distance(p) > AWAY_MM) {
                let exact: DVec3 = space[a as usize].lerp(space[b as usize], t);
                worst = worst.max(faces[f].spline.at(p).position.distance(exact));
            }
        }
    }
    worst
}

/// Sides of facets that are no pieces of creases, nor opposite to one by way of others.
fn rulings(truth: &Truth) -> Vec<[u32; 2]> {
    let sorted = |a: u32, b: u32| [a.min(b), a.max(b)];
    let mut across: BTreeSet<[u32; 2]> =
        truth.creases().iter().flat_map(|c| c.windows(2)).map(|w| sorted(w[0], w[1])).collect();
    let side = |face: &[u32], k: usize| sorted(face[k % 4], face[(k + 1) % 4]);
    loop {
        let opposite = truth.faces.iter().flat_map(|f| (0..4).map(move |k| (side(f, k), side(f, k + 2))));
        let more: Vec<_> = opposite.filter(|(a, b)| across.contains(a) && !across.contains(b)).collect();
        if more.is_empty() {
            break;
        }
        across.extend(more.into_iter().map(|(_, b)| b));
    }
    let all: BTreeSet<[u32; 2]> = truth.faces.iter().flat_map(|f| (0..4).map(move |k| side(f, k))).collect();
    all.difference(&across).copied().collect()
}

/// The curve of continuous curvature through vertices in order; at its ends it goes on as the parabola there.
fn through(truth: &Truth, vertices: &[u32]) -> PlanarCurve {
    let p: Vec<DVec2> = vertices.iter().map(|&v| truth.exact.mesh.vertices[v as usize]).collect();
    let last = p.len() - 1;
    let ends = [4.0 * p[1] - 3.0 * p[0] - p[2], 3.0 * p[last] - 4.0 * p[last - 1] + p[last - 2]];
    PlanarCurve::spline(&p, ends).expect("a curve")
}

/// Pieces that each facet is cut into across its rulings, so that there are vertices as near to each other along them: what
/// lies on a ruling is known in the sheet and in space.
const PIECES: u32 = 4;

/// The state with more vertices along its rulings.
fn finer(truth: &Truth) -> FoldedSheet {
    let along = rulings(truth).into_iter().collect::<BTreeSet<_>>();
    let (mut flat, mut space) = (truth.exact.mesh.vertices.clone(), truth.exact.positions.clone());
    let mut between: BTreeMap<([u32; 2], u32), u32> = BTreeMap::new();
    let mut at = |a: u32, b: u32, k: u32| -> VertexId {
        match k {
            0 => return VertexId(a),
            PIECES => return VertexId(b),
            _ => {}
        }
        let (ends, k) = if a < b { ([a, b], k) } else { ([b, a], PIECES - k) };
        VertexId(*between.entry((ends, k)).or_insert_with(|| {
            let [i, j] = ends.map(|v| v as usize);
            let t = f64::from(k) / f64::from(PIECES);
            flat.push(flat[i].lerp(flat[j], t));
            space.push(space[i].lerp(space[j], t));
            flat.len() as u32 - 1
        }))
    };
    let mut triangles = Vec::new();
    for face in &truth.faces {
        let turned = usize::from(!along.contains(&[face[0].min(face[1]), face[0].max(face[1])]));
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| face[(k + turned) % 4]);
        for k in 0..PIECES {
            let [p, q, r, s] = [at(a, b, k), at(a, b, k + 1), at(d, c, k + 1), at(d, c, k)];
            triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    let creases: BTreeSet<[u32; 2]> =
        truth.creases().iter().flat_map(|c| c.windows(2)).map(|w| [w[0].min(w[1]), w[0].max(w[1])]).collect();
    let sites = vec![Site::Interior; flat.len()];
    let mesh = FlatMesh::new(flat, sites, triangles, |[a, b], boundary| match boundary {
        true => EdgeClass::Boundary { loop_id: LoopId(0) },
        false if creases.contains(&[a.0, b.0]) => {
            EdgeClass::Fold { crease: CreaseId(0), line: 0, turn_rad: 1.0 }
        }
        false => EdgeClass::Facet,
    });
    mesh.check().expect("a sound mesh");
    FoldedSheet { mesh, positions: space, solve: SolveRecord::default() }
}

/// The outline, from vertex to vertex.
fn outline(truth: &Truth) -> PlanarCurve {
    let mesh = &truth.exact.mesh;
    let next: BTreeMap<VertexId, VertexId> = mesh
        .edges
        .iter()
        .filter(|e| matches!(e.class, EdgeClass::Boundary { loop_id: LoopId(0) }))
        .map(|e| (e.vertices[0], e.vertices[1]))
        .collect();
    let first = *next.keys().next().expect("an outline");
    let mut points = vec![mesh.vertices[first.index()]];
    let mut at = next[&first];
    while at != first {
        points.push(mesh.vertices[at.index()]);
        at = next[&at];
    }
    points.push(points[0]);
    PlanarCurve::polyline(&points).expect("a curve")
}
