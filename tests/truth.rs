//! Closed-form states, from the folder `../shared` beside the checkout.
//!
//! Where that folder is absent each test says so and ends; `.ci/run` refuses to begin without it.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

#[path = "common/shared.rs"]
mod shared;

use serde_json::Value;
use shared::{files, say, shared};
use softfold_fold::{EdgeLengths, Goal, Hinges, Solver, fold, upright};
use softfold_geometry::{
    CreaseId, DMat3, DVec2, DVec3, Edge, EdgeClass, EdgeId, FlatMesh, FoldedSheet, LoopId, Site, SolveRecord,
    VertexId, polygon,
};
use std::collections::BTreeMap;
use std::path::Path;

/// How far a folded sheet may be from its closed form: root mean square over the vertices, by the sheet's size.
const RMS_MAX: f64 = 2e-3;
/// How far a fold's turn may be from the closed form's angle at the middle of its chord, degrees; the worst is 0.004, on
/// the cones.
const ANGLE_MAX_DEG: f64 = 0.01;
/// Closed-form states in `../shared/truth`.
const STATES: usize = 7;

/// A closed-form state: the positions of the flat mesh's vertices; its folds carry the angles that the file tells.
struct Truth {
    name: String,
    exact: FoldedSheet,
    size_mm: f64,
}

impl Truth {
    fn read(file: &Path) -> Self {
        let text = std::fs::read_to_string(file).expect("a readable state");
        let flat: Value = serde_json::from_str(&text).expect("JSON");
        let points = |frame: &Value| -> Vec<Vec<f64>> { from(&frame["vertices_coords"]) };
        let folded = &flat["file_frames"][0];
        let mesh = flat_mesh(&flat, points(&flat).iter().map(|p| DVec2::new(p[0], p[1])).collect());
        mesh.check().expect("a sound mesh");
        let (low, high) = polygon::bounds(&mesh.vertices);
        let positions = points(folded).iter().map(|p| DVec3::new(p[0], p[1], p[2])).collect();
        let exact = FoldedSheet { mesh, positions, solve: SolveRecord::default() };
        exact.check().expect("a sound state");
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Self { name, exact, size_mm: (high - low).max_element() }
    }

    /// Rest turns of all interior edges as the closed form has them, and flat edge lengths, with the weights of an
    /// elastic sheet.
    fn goals(&self) -> Vec<Box<dyn Goal>> {
        let mesh = &self.exact.mesh;
        let square = |id: EdgeId, e: &Edge| mesh.edge_length_mm(id).powi(2) / neighbour_area_mm2(mesh, e);
        let membrane = EdgeLengths::of_mesh(mesh, |id| MEMBRANE / square(id, &mesh.edges[id.index()]));
        let bending = BENDING * self.size_mm.powi(2);
        let turns = |id: EdgeId, e: &Edge| Some((self.exact.turn_rad(e)?, bending * square(id, e)));
        let hinges = Hinges::of_mesh(mesh, "turns of the closed form", turns);
        vec![Box::new(membrane), Box::new(hinges)]
    }
}

/// Membrane stiffness E t, N/mm; only its ratio to [`BENDING`] matters.
const MEMBRANE: f64 = 1.0;
/// Bending stiffness D over E t and the square of the size: that of a sheet as thick as 0.35 % of its size. The closed
/// form has next to no energy whatever this is; thicker sheets (1 %) come out of the flat into other equilibria of the
/// cones.
const BENDING: f64 = 1e-6;

fn from<T: serde::de::DeserializeOwned>(value: &Value) -> T {
    serde_json::from_value(value.clone()).expect("a list of the expected kind")
}

/// Faces as fans of triangles; edges that the file calls mountain or valley are folds by its angle.
fn flat_mesh(frame: &Value, vertices: Vec<DVec2>) -> FlatMesh {
    let ends: Vec<[u32; 2]> = from(&frame["edges_vertices"]);
    let letters: Vec<String> = from(&frame["edges_assignment"]);
    let angles_deg: Vec<Option<f64>> = from(&frame["edges_foldAngle"]);
    let folds: BTreeMap<[u32; 2], f64> = (0..ends.len())
        .filter(|&i| ["M", "V"].contains(&letters[i].as_str()))
        .map(|i| {
            let [a, b] = ends[i];
            ([a.min(b), a.max(b)], angles_deg[i].expect("a fold has its angle").to_radians())
        })
        .collect();
    let faces: Vec<Vec<u32>> = from(&frame["faces_vertices"]);
    let fan = |face: &Vec<u32>| {
        (2..face.len()).map(|k| [face[0], face[k - 1], face[k]].map(VertexId)).collect::<Vec<_>>()
    };
    let triangles = faces.iter().flat_map(fan).collect();
    let sites = vec![Site::Interior; vertices.len()]; // nothing here asks for them
    FlatMesh::new(vertices, sites, triangles, |[a, b], boundary| match folds.get(&[a.0, b.0]) {
        _ if boundary => EdgeClass::Boundary { loop_id: LoopId(0) },
        Some(&turn_rad) => EdgeClass::Fold { crease: CreaseId(0), line: 0, turn_rad },
        None => EdgeClass::Facet,
    })
}

fn neighbour_area_mm2(mesh: &FlatMesh, edge: &Edge) -> f64 {
    edge.triangles.iter().flatten().map(|&t| mesh.triangle_area_mm2(t)).sum()
}

/// Root mean square distance of corresponding points after the best rotation and shift of `points`; a mirror image is
/// far from its original.
///
/// The rotation is the orthogonal factor of the covariance's polar decomposition (Higham 1986: the mean of a matrix
/// and its inverse transpose converges to it).
fn aligned_rms_mm(points: &[DVec3], targets: &[DVec3]) -> f64 {
    let mean = |p: &[DVec3]| p.iter().sum::<DVec3>() / p.len() as f64;
    let (from, to) = (mean(points), mean(targets));
    let pairs = || points.iter().zip(targets).map(|(p, t)| (*p - from, *t - to));
    let mut rotation =
        pairs().fold(DMat3::ZERO, |sum, (p, t)| sum + DMat3::from_cols(t * p.x, t * p.y, t * p.z));
    assert!(rotation.determinant() > 0.0, "a mirror image, or flat");
    for _ in 0..60 {
        rotation = (rotation + rotation.inverse().transpose()) * 0.5;
    }
    let sum: f64 = pairs().map(|(p, t)| (rotation * p).distance_squared(t)).sum();
    (sum / points.len() as f64).sqrt()
}

/// Largest difference between a fold's turn in the state and the angle that the file tells for it, without signs: the
/// cylinders and cones are told as seen from the back of their faces, and the corrugation's letters alternate while its
/// five creases all turn to one side.
fn worst_angle_rad(sheet: &FoldedSheet) -> f64 {
    let error = |e: &Edge| match e.class {
        EdgeClass::Fold { turn_rad, .. } => {
            (sheet.turn_rad(e).expect("two sides").abs() - turn_rad.abs()).abs()
        }
        _ => 0.0,
    };
    sheet.mesh.edges.iter().map(error).fold(0.0, f64::max)
}

#[test]
fn folding_from_flat_reaches_the_closed_forms() {
    let Some(folder) = shared("folding_from_flat_reaches_the_closed_forms", "truth") else { return };
    let states = files(&folder, &["fold"]);
    assert_eq!(states.len(), STATES, "closed-form states in {}", folder.display());
    let mut faults = Vec::new();
    say("\nclosed form                     vertices  steps  gradient  angle deg  rms % of size");
    for state in &states {
        let truth = Truth::read(state);
        let mesh = &truth.exact.mesh;
        let sheet =
            fold(mesh, &truth.goals(), &upright(mesh), &Solver::default(), &mut |_| ()).expect("a fold");
        let rms = aligned_rms_mm(&sheet.positions, &truth.exact.positions) / truth.size_mm;
        let Truth { name, exact, .. } = &truth;
        let angle_deg = worst_angle_rad(exact).to_degrees();
        let SolveRecord { iterations, relative_gradient, .. } = sheet.solve;
        say(&format!(
            "{name:<30} {:>9} {iterations:>6} {relative_gradient:>9.1e} {angle_deg:>10.4} {:>14.5}",
            mesh.vertices.len(),
            100.0 * rms
        ));
        if angle_deg > ANGLE_MAX_DEG {
            faults.push(format!("{name}: a fold turns by {angle_deg} degrees other than the file says"));
        }
        if rms.is_nan() || rms > RMS_MAX {
            faults.push(format!("{name}: {:.3} % of the size off: {}", 100.0 * rms, sheet.solve.stop));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn alignment_sees_shape_and_handedness_alone() {
    let points: Vec<DVec3> =
        [(0., 0., 0.), (3., 0., 0.), (0., 2., 0.), (0., 0., 1.), (1., 2., 3.)].map(DVec3::from).to_vec();
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -2.0) / 3.0, 2.9);
    let moved: Vec<DVec3> = points.iter().map(|p| turn * *p + DVec3::new(5.0, -7.0, 9.0)).collect();
    assert!(aligned_rms_mm(&points, &moved) < 1e-12);
    let longer: Vec<DVec3> = moved.iter().map(|p| 1.1 * *p).collect();
    assert!(aligned_rms_mm(&points, &longer) > 0.1);
    let mirrored: Vec<DVec3> = points.iter().map(|p| DVec3::new(-p.x, p.y, p.z)).collect();
    assert!(std::panic::catch_unwind(|| aligned_rms_mm(&points, &mirrored)).is_err());
}
