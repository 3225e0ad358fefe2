//! Closed-form states, from the folder `../shared` beside the checkout.
//!
//! Where that folder is absent each test says so and ends; `.ci/run` refuses to begin without it.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

#[path = "common/align.rs"]
mod align;
#[path = "common/shared.rs"]
mod shared;
#[path = "common/state.rs"]
mod state;

use align::{Alignment, aligned_rms_mm, shaken};
use shared::{files, say, shared};
use softfold_fold::{
    CoPlanar, EdgeLengths, Goal, Hinges, NewtonOptions, OnCurve, Scales, SheetPoint, Solver, SpaceCurve,
    fold, upright,
};
use softfold_geometry::{
    DMat3, DVec2, DVec3, Edge, EdgeClass, EdgeId, FlatMesh, FoldedSheet, SolveRecord, VertexId,
};
use state::Truth;

/// How far a folded sheet may be from its closed form: root mean square over the vertices, by the sheet's size.
const RMS_MAX: f64 = 2e-3;
/// How far a fold's turn may be from the closed form's angle at the middle of its chord, degrees; the worst is 0.004, on
/// the cones.
const ANGLE_MAX_DEG: f64 = 0.01;
/// Closed-form states in `../shared/truth`.
const STATES: usize = 7;

impl Truth {
    /// Springs at the flat lengths with the weights of an elastic sheet.
    fn membrane(&self) -> Box<dyn Goal> {
        let mesh = &self.exact.mesh;
        Box::new(EdgeLengths::of_mesh(mesh, |id| MEMBRANE / square(mesh, id)))
    }

    /// Rest turns of all interior edges as the closed form has them.
    fn all_angles(&self) -> Vec<Box<dyn Goal>> {
        let mesh = &self.exact.mesh;
        let bending = BENDING * self.size_mm.powi(2);
        let turns = |id: EdgeId, e: &Edge| Some((self.exact.turn_rad(e)?, bending * square(mesh, id)));
        vec![self.membrane(), Box::new(Hinges::of_mesh(mesh, "turns of the closed form", turns))]
    }

    /// A share of the rest turns of the creases alone, each held in a plane, wherever that is, or on its curve in space; faces are flat at rest
    /// and of bending stiffness `faces` over E t and the square of the size.
    fn crease_angles(&self, faces: f64, share: f64) -> Vec<Box<dyn Goal>> {
        let mesh = &self.exact.mesh;
        let [creases, faces] = [CREASES, faces].map(|d| d * self.size_mm.powi(2));
        let turns = |id: EdgeId, e: &Edge| match e.class {
            EdgeClass::Fold { .. } => Some((share * self.exact.turn_rad(e)?, creases * square(mesh, id))),
            _ => Some((0.0, faces * square(mesh, id))),
        };
        let hinges: Box<dyn Goal> = Box::new(Hinges::of_mesh(mesh, "turns of the creases", turns));
        let held = self.creases().into_iter().map(|crease| self.held(&crease));
        [self.membrane(), hinges].into_iter().chain(held).collect()
    }

    /// A crease held as it is known to lie.
    fn held(&self, crease: &[u32]) -> Box<dyn Goal> {
        let points: Vec<SheetPoint> = crease.iter().map(|&v| SheetPoint::vertex(VertexId(v))).collect();
        let planar = CoPlanar { name: "plane".into(), points: points.clone(), stiffness: MEMBRANE };
        if planar.residual(&self.exact.positions) < PLANAR * self.size_mm {
            return Box::new(planar);
        }
        let places: Vec<DVec3> = crease.iter().map(|&v| self.exact.positions[v as usize]).collect();
        let target = SpaceCurve::polyline(&places).expect("a curve");
        Box::new(OnCurve { name: "curve".into(), points, target, stiffness: MEMBRANE })
    }

    /// The flat sheet, lying on the closed form where the triangle in its middle is.
    fn tangent_start(&self) -> Vec<DVec3> {
        let mesh = &self.exact.mesh;
        let middle = mesh.vertices.iter().sum::<DVec2>() / mesh.vertices.len() as f64;
        let off = |t: &&[VertexId; 3]| {
            (t.iter().map(|v| mesh.vertices[v.index()]).sum::<DVec2>() / 3.0).distance(middle)
        };
        let nearest = mesh.triangles.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("a triangle");
        let with_normal = |[a, b, c]: [DVec3; 3]| [a, b, c, a + (b - a).cross(c - a).normalize()];
        let flat: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
        let [from, to] = [&flat, &self.exact.positions].map(|x| with_normal(nearest.map(|v| x[v.index()])));
        let aligned = Alignment::of(&from, &to);
        flat.into_iter().map(|p| aligned.place(p)).collect()
    }

    fn shortest_edge_mm(&self) -> f64 {
        let mesh = &self.exact.mesh;
        (0..mesh.edges.len()).map(|i| mesh.edge_length_mm(EdgeId::new(i))).fold(f64::INFINITY, f64::min)
    }
}

/// L²/(A₁ + A₂) at an edge.
fn square(mesh: &FlatMesh, id: EdgeId) -> f64 {
    let area = neighbour_area_mm2(mesh, &mesh.edges[id.index()]);
    mesh.edge_length_mm(id).powi(2) / area
}

/// Stiffness of creases of which alone the angles are known, over E t and the square of the size: they keep them.
const CREASES: f64 = 1e-4;
/// Bending stiffness of the faces beside them, over E t and the square of the size, one after the other: each fold begins where the one
/// before it ended, for a thin sheet crumples that a thick one does not.
const THINNER: [f64; 4] = [1e-6, 1e-7, 1e-8, 3e-9];
/// Steps of the angle in which a sheet is folded whose creases' angles alone are known.
const STEPS: u32 = 4;
/// Points this near to a plane, by the sheet's size, lie in it.
const PLANAR: f64 = 1e-6;
/// How far a noisy start is off the flat one, by the shortest edge: more would turn triangles over.
const NOISE: f64 = 0.2;
/// Membrane stiffness E t, N/mm; only its ratio to [`BENDING`] matters.
const MEMBRANE: f64 = 1.0;
/// Bending stiffness D over E t and the square of the size: that of a sheet as thick as 0.35 % of its size. The closed
/// form has next to no energy whatever this is; thicker sheets (1 %) come out of the flat into other equilibria of the
/// cones.
const BENDING: f64 = 1e-6;

fn neighbour_area_mm2(mesh: &FlatMesh, edge: &Edge) -> f64 {
    edge.triangles.iter().flatten().map(|&t| mesh.triangle_area_mm2(t)).sum()
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

fn folded(truth: &Truth, goals: &[Box<dyn Goal>], start: &[DVec3], solver: &Solver) -> FoldedSheet {
    fold(&truth.exact.mesh, goals, start, solver, &mut |_| ()).expect("a fold")
}

/// Takes every state to a folded sheet, from the flat start and from a noisy one, and tells how far it is from the closed form.
fn each_state(
    test: &str,
    start: impl Fn(&Truth) -> Vec<DVec3>,
    folded: impl Fn(&Truth, Vec<DVec3>) -> FoldedSheet,
) {
    let Some(folder) = shared(test, "truth") else { return };
    let states = files(&folder, &["fold"]);
    assert_eq!(states.len(), STATES, "closed-form states in {}", folder.display());
    let mut faults = Vec::new();
    let mut lines = vec![format!(
        "\n{test}\nclosed form                     vertices  start  steps  gradient  rms % of size"
    )];
    for state in &states {
        let truth = Truth::read(state);
        let flat = start(&truth);
        let noisy = shaken(&flat, NOISE * truth.shortest_edge_mm());
        for (word, start) in [("flat", flat), ("noisy", noisy)] {
            let sheet = folded(&truth, start);
            let rms = aligned_rms_mm(&sheet.positions, &truth.exact.positions) / truth.size_mm;
            let SolveRecord { iterations, relative_gradient, .. } = sheet.solve;
            let (name, vertices) = (&truth.name, truth.exact.mesh.vertices.len());
            lines.push(format!(
                "{name:<30} {vertices:>9} {word:>6} {iterations:>6} {relative_gradient:>9.1e} {:>14.5}",
                100.0 * rms
            ));
            if rms.is_nan() || rms > RMS_MAX {
                let (off, why) = (100.0 * rms, &sheet.solve.stop);
                faults.push(format!("{name} from {word}: {off:.3} % of the size off: {why}"));
            }
        }
    }
    say(&lines.join("\n"));
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn folding_by_all_angles_reaches_the_closed_forms_from_flat_and_from_noise() {
    let test = "folding_by_all_angles_reaches_the_closed_forms_from_flat_and_from_noise";
    each_state(
        test,
        |t| upright(&t.exact.mesh),
        |t, start| folded(t, &t.all_angles(), &start, &Solver::default()),
    );
}

#[test]
fn folding_by_crease_angles_tends_to_the_closed_forms_as_the_sheet_gets_thinner() {
    let test = "folding_by_crease_angles_tends_to_the_closed_forms_as_the_sheet_gets_thinner";
    let as_it_is = Solver::Newton(NewtonOptions { ramp: vec![Scales::FULL], ..NewtonOptions::default() });
    each_state(test, Truth::tangent_start, |truth, start| {
        let fold_on = |x: Vec<DVec3>, (faces, share): (f64, f64)| {
            folded(truth, &truth.crease_angles(faces, share), &x, &as_it_is).positions
        };
        let angles = (1..=STEPS).map(|k| (THINNER[0], f64::from(k) / f64::from(STEPS)));
        let thick = angles.fold(start, fold_on);
        let off_mm = |x: &[DVec3]| aligned_rms_mm(x, &truth.exact.positions);
        let before_mm = off_mm(&thick);
        let thinner = THINNER[1..].iter().map(|faces| (*faces, 1.0));
        let x = thinner.fold(thick, fold_on);
        let last = folded(truth, &truth.crease_angles(THINNER[THINNER.len() - 1], 1.0), &x, &as_it_is);
        say(&format!(
            "{}: {before_mm:.4} mm off while thick, {:.4} mm thin",
            truth.name,
            off_mm(&last.positions)
        ));
        last
    });
}

#[test]
fn the_files_angles_are_those_of_their_shapes() {
    let Some(folder) = shared("the_files_angles_are_those_of_their_shapes", "truth") else { return };
    for state in files(&folder, &["fold"]) {
        let Truth { name, exact, .. } = Truth::read(&state);
        let off_deg = worst_angle_rad(&exact).to_degrees();
        assert!(
            off_deg <= ANGLE_MAX_DEG,
            "{name}: a fold turns by {off_deg} degrees other than the file says"
        );
    }
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
