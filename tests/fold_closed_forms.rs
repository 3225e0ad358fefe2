//! Folding against closed forms at any fineness: a cylinder or a cone, cut by a plane and one part of it mirrored.
//!
//! Rest angles here are those of the smooth surface, so that what a mesh gives is as far from it as the mesh is coarse.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

#[path = "common/align.rs"]
mod align;
#[path = "common/mirror.rs"]
mod mirror;
#[path = "common/shared.rs"]
#[allow(dead_code, reason = "only `say` is wanted")]
mod shared;

use align::{aligned_rms_mm, shaken};
use mirror::{Mirror, mirrors};
use shared::say;
use softfold_fold::{
    CoPlanar, EdgeLengths, Goal, Hinges, NewtonOptions, OnCurve, Scales, SheetPoint, Solver, SpaceCurve,
    fold, upright,
};
use softfold_geometry::{
    CreaseId, DVec2, DVec3, Edge, EdgeClass, EdgeId, FlatMesh, FoldedSheet, LoopId, Site, SolveRecord,
    VertexId,
};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// How far a folded sheet may be from its closed form: root mean square over the vertices, by the sheet's size.
const RMS_MAX: f64 = 2e-3;
/// Least fall of the error when the mesh is twice as fine: second order is 4.
const FALL: f64 = 3.5;
/// Error of κ_g = κ cos α.
const CURVATURE_MAX: f64 = 0.01;
/// Membrane stiffness E t, N/mm: only ratios to it matter.
const MEMBRANE: f64 = 1.0;

/// A circular crease of constant fold angle whose rulings meet it at the same angle on both sides: in space a helix (relations of Fuchs &
/// Tabachnikov 1999: `κ = κ_g / cos α`, `τ = κ_g tan α cot β`), its sides tangent developables.
struct Helix {
    /// Radius of the crease on the flat sheet, 1/κ_g, mm.
    radius_mm: f64,
    /// Half the fold angle α.
    half_angle_rad: f64,
    /// Angle β of the rulings with the crease.
    ruling_rad: f64,
    length_mm: f64,
    /// How far the sheet reaches to both sides along the rulings, mm.
    reach_mm: f64,
}

/// Of about the size and the curvature of the others.
const HELIX: Helix = Helix {
    radius_mm: 150.0,
    half_angle_rad: 40.0 * PI / 180.0,
    ruling_rad: 70.0 * PI / 180.0,
    length_mm: 180.0,
    reach_mm: 50.0,
};
const HELIX_NAME: &str = "helix, rulings at 70°";
/// Points of the polyline on which the helix's crease is held.
const CURVE: u32 = 2000;

impl Helix {
    /// Along the crease, and across it to the left.
    fn steps(&self, across_mm: f64) -> [f64; 2] {
        let (sin, cos) = self.ruling_rad.sin_cos();
        [across_mm.abs() * cos, across_mm * sin]
    }

    fn flat(&self, s_mm: f64, across_mm: f64) -> DVec2 {
        let tangent = DVec2::from_angle(s_mm / self.radius_mm);
        let [along, left] = self.steps(across_mm);
        let centre = DVec2::new(0.0, self.radius_mm);
        centre - self.radius_mm * tangent.perp() + along * tangent + left * tangent.perp()
    }

    /// Point, tangent, normal and binormal of the crease in space.
    fn frame(&self, s_mm: f64) -> [DVec3; 4] {
        let curvature = 1.0 / (self.radius_mm * self.half_angle_rad.cos());
        let torsion = self.half_angle_rad.tan() / (self.radius_mm * self.ruling_rad.tan());
        let whole = curvature.powi(2) + torsion.powi(2);
        let (radius, pitch, speed) = (curvature / whole, torsion / whole, whole.sqrt());
        let (sin, cos) = (speed * s_mm).sin_cos();
        let point = DVec3::new(radius * cos, radius * sin, pitch * speed * s_mm);
        let tangent = speed * DVec3::new(-radius * sin, radius * cos, pitch);
        let normal = DVec3::new(-cos, -sin, 0.0);
        [point, tangent, normal, tangent.cross(normal)]
    }

    fn place(&self, s_mm: f64, across_mm: f64) -> DVec3 {
        let [point, tangent, normal, binormal] = self.frame(s_mm);
        let (sin, cos) = self.half_angle_rad.sin_cos();
        let [along, left] = self.steps(across_mm);
        point + along * tangent + left * cos * normal + left.abs() * sin * binormal
    }

    /// The flat sheet in the osculating plane at the middle of the crease.
    fn tangent(&self, p: DVec2) -> DVec3 {
        let middle = 0.5 * self.length_mm;
        let [point, tangent, normal, _] = self.frame(middle);
        let along = DVec2::from_angle(middle / self.radius_mm);
        let off = p - self.flat(middle, 0.0);
        point + off.dot(along) * tangent + off.dot(along.perp()) * normal
    }
}

/// A mesh with the closed form's positions and rest turns.
struct State {
    exact: FoldedSheet,
    /// Per edge: size of the smooth surface's turn there; its sign is that of the closed form.
    turns_rad: Vec<f64>,
    /// Vertices of the crease in order.
    crease: Vec<VertexId>,
    size_mm: f64,
    /// Where the crease lies; none if it is only known to be planar.
    curve: Option<SpaceCurve>,
    /// The flat sheet, where folding begins.
    flat: Vec<DVec3>,
}

impl State {
    /// A mesh of rulings, `rows` to each side of the crease; the crease is row `rows`.
    fn of(mirror: &Mirror, columns: usize, rows: usize) -> Self {
        let mut flat = Vec::new();
        let mut exact = Vec::new();
        for i in 0..=columns {
            let r = mirror.ruling(i as f64 / columns as f64);
            for j in 0..=2 * rows {
                let t = j as f64 / rows as f64 - 1.0;
                let reach_mm = if t < 0.0 { mirror.reach_mm[0] } else { mirror.reach_mm[1] };
                let along = mirror.crease(r) + t * reach_mm;
                flat.push(mirror.surface.flat(r, along));
                exact.push(mirror.place(r, along));
            }
        }
        let turn = |crease: bool, along_ruling: bool, share: f64| match (crease, along_ruling) {
            (true, _) => 2.0 * mirror.half_angle_rad(mirror.ruling(share)),
            (_, true) => {
                mirror.surface.turn_rad((mirror.rulings[1] - mirror.rulings[0]).abs() / columns as f64)
            }
            _ => 0.0,
        };
        Self::new([columns, rows], flat, exact, turn)
    }

    /// A mesh of rulings of a fold along a helix.
    fn of_helix(helix: &Helix, columns: usize, rows: usize) -> Self {
        let (mut flat, mut exact) = (Vec::new(), Vec::new());
        for i in 0..=columns {
            let s_mm = helix.length_mm * i as f64 / columns as f64;
            for j in 0..=2 * rows {
                let across_mm = helix.reach_mm * (j as f64 / rows as f64 - 1.0);
                flat.push(helix.flat(s_mm, across_mm));
                exact.push(helix.place(s_mm, across_mm));
            }
        }
        // The sides are known by their crease alone.
        let turn = |crease: bool, _: bool, _: f64| if crease { 2.0 * helix.half_angle_rad } else { 0.0 };
        let start = flat.iter().map(|p| helix.tangent(*p)).collect();
        let places: Vec<DVec3> = (0..=CURVE)
            .map(|k| helix.place(helix.length_mm * f64::from(k) / f64::from(CURVE), 0.0))
            .collect();
        let curve = SpaceCurve::polyline(&places).expect("a curve");
        Self { flat: start, curve: Some(curve), ..Self::new([columns, rows], flat, exact, turn) }
    }

    /// `turn` of an edge: whether it is on the crease, whether it is along a ruling, and where its middle is, from the first ruling 0 to
    /// the last 1.
    fn new(
        [columns, rows]: [usize; 2],
        flat: Vec<DVec2>,
        exact: Vec<DVec3>,
        turn: impl Fn(bool, bool, f64) -> f64,
    ) -> Self {
        let per = 2 * rows + 1;
        let at = |i: usize, j: usize| VertexId::new(i * per + j);
        let cut = |(i, j): (usize, usize)| match (i + j) % 2 {
            0 => [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]],
            _ => [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]],
        };
        let mut triangles: Vec<[VertexId; 3]> =
            (0..columns).flat_map(|i| (0..2 * rows).map(move |j| (i, j))).flat_map(cut).collect();
        let [a, b, c] = triangles[0].map(|v| flat[v.index()]);
        if (b - a).perp_dot(c - a) < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let size = flat.iter().fold([flat[0]; 2], |[lo, hi], p| [lo.min(*p), hi.max(*p)]);
        let sites = vec![Site::Interior; flat.len()]; // nothing here asks for them
        let on_crease = |v: VertexId| v.index() % per == rows;
        let mesh = FlatMesh::new(flat, sites, triangles, |[a, b], boundary| match boundary {
            true => EdgeClass::Boundary { loop_id: LoopId(0) },
            false if on_crease(a) && on_crease(b) => {
                EdgeClass::Fold { crease: CreaseId(0), line: 0, turn_rad: 0.0 }
            }
            false => EdgeClass::Facet,
        });
        mesh.check().expect("a sound mesh");
        let column = |v: VertexId| (v.index() / per) as f64;
        let turn_of = |e: &Edge| {
            let [a, b] = e.vertices.map(column);
            let crease = matches!(e.class, EdgeClass::Fold { .. });
            turn(crease, a == b, 0.5 * (a + b) / columns as f64)
        };
        let turns_rad = mesh.edges.iter().map(turn_of).collect();
        let crease = (0..=columns).map(|i| at(i, rows)).collect();
        let flat = upright(&mesh);
        let exact = FoldedSheet { mesh, positions: exact, solve: SolveRecord::default() };
        Self { exact, turns_rad, crease, size_mm: (size[1] - size[0]).max_element(), curve: None, flat }
    }

    fn stiffness(&self, id: EdgeId) -> f64 {
        let mesh = &self.exact.mesh;
        let area: f64 =
            mesh.edges[id.index()].triangles.iter().flatten().map(|&t| mesh.triangle_area_mm2(t)).sum();
        mesh.edge_length_mm(id).powi(2) / area
    }

    fn rest_rad(&self, id: EdgeId, e: &Edge) -> Option<f64> {
        Some(self.turns_rad[id.index()].copysign(self.exact.turn_rad(e)?))
    }

    fn membrane(&self) -> Box<dyn Goal> {
        Box::new(EdgeLengths::of_mesh(&self.exact.mesh, |id| MEMBRANE / self.stiffness(id)))
    }

    /// Hinges of the given stiffness over E t and the square of the size.
    fn hinges(&self, of: impl Fn(EdgeId, &Edge) -> Option<(f64, f64)>) -> Box<dyn Goal> {
        let unit = MEMBRANE * self.size_mm.powi(2);
        Box::new(Hinges::of_mesh(&self.exact.mesh, "turns", |id, e| {
            of(id, e).map(|(rest_rad, share)| (rest_rad, share * unit * self.stiffness(id)))
        }))
    }

    /// Every rest angle known; the sheet is as thick as 0.35 % of its size.
    fn all_angles(&self) -> Vec<Box<dyn Goal>> {
        vec![self.membrane(), self.hinges(|id, e| Some((self.rest_rad(id, e)?, 1e-6)))]
    }

    /// The crease's angles alone, the crease held planar or on its curve; faces are flat at rest.
    fn crease_angles(&self, faces: f64) -> Vec<Box<dyn Goal>> {
        let hinges = self.hinges(|id, e| match e.class {
            EdgeClass::Fold { .. } => Some((self.rest_rad(id, e)?, CREASE)),
            _ => Some((0.0, faces)),
        });
        let points = self.crease.iter().map(|v| SheetPoint::vertex(*v)).collect();
        let (name, stiffness) = ("crease".into(), MEMBRANE);
        let held: Box<dyn Goal> = match self.curve.clone() {
            None => Box::new(CoPlanar { name, points, stiffness }),
            Some(target) => Box::new(OnCurve { name, points, target, stiffness }),
        };
        vec![self.membrane(), hinges, held]
    }

    fn run(&self, goals: &[Box<dyn Goal>], start: &[DVec3], solver: &Solver) -> FoldedSheet {
        let sheet = fold(&self.exact.mesh, goals, start, solver, &mut |_| ()).expect("a fold");
        assert!(sheet.solve.converged, "{:?}", sheet.solve);
        sheet
    }

    /// Distance from the closed form by the size.
    fn rms(&self, sheet: &FoldedSheet) -> f64 {
        aligned_rms_mm(&sheet.positions, &self.exact.positions) / self.size_mm
    }

    /// The flat sheet, and the same shaken by a tenth of the columns' mean width.
    fn starts(&self) -> [Vec<DVec3>; 2] {
        let flat = self.flat.clone();
        let noisy = shaken(&flat, 0.1 * self.size_mm / self.crease.len() as f64);
        [flat, noisy]
    }

    /// Largest |κ cos α / κ_g − 1| along the crease: curvatures of its polylines in space and in the flat sheet, half
    /// fold angles as folded.
    fn curvature_error(&self, sheet: &FoldedSheet) -> f64 {
        let mesh = &sheet.mesh;
        let half_turn = |a: VertexId, b: VertexId| {
            let edge = mesh.edges.iter().find(|e| e.vertices == [a, b] || e.vertices == [b, a]);
            0.5 * sheet.turn_rad(edge.expect("an edge of the crease")).expect("two sides").abs()
        };
        let error = |w: &[VertexId]| {
            let [p, q, r] = [w[0], w[1], w[2]].map(|v| mesh.vertices[v.index()]);
            let [x, y, z] = [w[0], w[1], w[2]].map(|v| sheet.position(v));
            let flat = (q - p).angle_to(r - q).abs() / (q.distance(p) + r.distance(q));
            let space = (y - x).angle_between(z - y) / (y.distance(x) + z.distance(y));
            let cosine = 0.5 * (half_turn(w[0], w[1]).cos() + half_turn(w[1], w[2]).cos());
            (space * cosine / flat - 1.0).abs()
        };
        self.crease.windows(3).map(error).fold(0.0, f64::max)
    }
}

/// Stiffness of a crease of which alone the angles are known, over E t and the square of the size: it keeps them.
const CREASE: f64 = 1e-4;
/// Columns and rows of the meshes.
const MESHES: [(usize, usize); 3] = [(8, 2), (16, 4), (32, 8)];

#[test]
fn the_closed_forms_are_isometric_and_fold_by_their_angles() {
    for (name, State { exact, turns_rad, .. }) in states(48, 10) {
        for (e, turn) in exact.mesh.edges.iter().zip(turns_rad) {
            let [a, b] = e.vertices;
            let flat = exact.mesh.vertices[a.index()].distance(exact.mesh.vertices[b.index()]);
            assert!((exact.position(a).distance(exact.position(b)) / flat - 1.0).abs() < 2e-4);
            let known = name != HELIX_NAME || matches!(e.class, EdgeClass::Fold { .. });
            if let Some(got) = exact.turn_rad(e).filter(|_| known) {
                assert!((got.abs() - turn).abs() < 2e-3, "{name}: {got} {turn}");
            }
        }
    }
}

/// One line of the table.
fn tell(name: &str, given: &str, columns: usize, figures: [f64; 3]) {
    let [rms, fall, curvature] = figures;
    say(&format!(
        "{:<22} {given:<14} {columns:>4} columns  {:>9.5} % of the size off, fall {fall:>5.2}; κ cos α / κ_g {:>7.4} % off",
        name,
        100.0 * rms,
        100.0 * curvature
    ));
}

#[test]
fn by_all_angles_folding_tends_to_the_closed_forms_at_second_order() {
    for mirror in mirrors() {
        let mut last: Option<f64> = None;
        for (columns, rows) in MESHES {
            let state = State::of(&mirror, columns, rows);
            let goals = state.all_angles();
            let [flat, noisy] = state.starts().map(|start| state.run(&goals, &start, &Solver::default()));
            let (rms, curvature) = (state.rms(&flat), state.curvature_error(&flat));
            let fall = last.map_or(f64::INFINITY, |l| l / rms);
            tell(mirror.name, "all angles", columns, [rms, fall, curvature]);
            assert!((state.rms(&noisy) / rms - 1.0).abs() < 1e-3, "{}: noise ends elsewhere", mirror.name);
            assert!(fall > FALL && curvature < CURVATURE_MAX && rms < RMS_MAX, "{}", mirror.name);
            last = Some(rms);
        }
    }
}

/// How far the bending of the faces moves the sheet: most of it is in layers along the free rulings at its two ends, as long as the sheet (L) and
/// `w ~ (L² R t)^(1/4)` wide (semi-membrane theory of cylinders), which rise by `w²/R`. Root mean square over the sheet that is `w^(5/2) ~ t^(5/8)`, or
/// `D^(5/16)`: 2.05 for a tenth of the stiffness.
const PER_DECADE: RangeInclusive<f64> = 1.85..=2.3;

#[test]
fn what_the_faces_bending_moves_falls_by_its_law() {
    let [_, Thin { columns, rows, thinnest }, _] = THIN_MESHES;
    for (name, state) in states(columns, rows) {
        let folded = thinned(&state, thinnest);
        let thinnest = &folded[folded.len() - 1].positions;
        // From 1e-6 to 1e-9: further on the mesh itself is left.
        let off_mm = [0, 3].map(|k: usize| aligned_rms_mm(&folded[k].positions, thinnest));
        let per_decade = (off_mm[0] / off_mm[1]).cbrt();
        say(&format!("{name:<22} a tenth of the bending stiffness moves it {per_decade:.3} times less"));
        assert!(PER_DECADE.contains(&per_decade), "{name}: {per_decade}");
    }
}

/// A mesh, and the power of ten of its faces' bending stiffness over E t and the square of the size.
struct Thin {
    columns: usize,
    rows: usize,
    thinnest: i32,
}

/// By [`PER_DECADE`] what bending moves falls with the square of the edges if the stiffness is a hundredth for edges of half the length.
const THIN_MESHES: [Thin; 3] = [
    Thin { columns: 16, rows: 4, thinnest: -10 },
    Thin { columns: 32, rows: 8, thinnest: -12 },
    Thin { columns: 64, rows: 16, thinnest: -14 },
];
/// Where folding begins: a thin sheet crumples where a thick one does not.
const THICKEST: i32 = -6;
/// Least falls of the error from mesh to mesh: second order is 4. Not before the finest pair are the meshes fine enough for it.
const THIN_FALLS: [f64; 2] = [2.7, 3.4];

/// Folds by a crease's angles, from the thickest faces to the thinnest; each begins where the one before it ended.
fn thinned(state: &State, thinnest: i32) -> Vec<FoldedSheet> {
    let first = state.run(&state.crease_angles(10f64.powi(THICKEST)), &state.flat, &Solver::default());
    let mut folded = vec![first];
    let ramp = vec![Scales::FULL];
    let go_on = Solver::Newton(NewtonOptions { ramp, ..NewtonOptions::default() });
    for power in (thinnest..THICKEST).rev() {
        let start = &folded[folded.len() - 1].positions;
        folded.push(state.run(&state.crease_angles(10f64.powi(power)), start, &go_on));
    }
    folded
}

fn states(columns: usize, rows: usize) -> Vec<(&'static str, State)> {
    let helix = State::of_helix(&HELIX, columns, rows);
    mirrors().iter().map(|m| (m.name, State::of(m, columns, rows))).chain([(HELIX_NAME, helix)]).collect()
}

#[test]
fn by_crease_angles_folding_tends_to_the_closed_forms_at_second_order_as_the_sheet_gets_thinner() {
    let mut last = BTreeMap::new();
    for (k, Thin { columns, rows, thinnest }) in THIN_MESHES.into_iter().enumerate() {
        // On its curve the finest and thinnest sheet slides into place over hundreds of steps: the helix has two meshes.
        for (name, state) in states(columns, rows).into_iter().filter(|s| k < 2 || s.0 != HELIX_NAME) {
            let folded = thinned(&state, thinnest);
            let sheet = &folded[folded.len() - 1];
            let (rms, curvature) = (state.rms(sheet), state.curvature_error(sheet));
            let fall = last.insert(name, rms).map_or(f64::INFINITY, |l: f64| l / rms);
            tell(name, "crease angles", columns, [rms, fall, curvature]);
            assert!(k == 0 || fall > THIN_FALLS[k - 1], "{name}, {columns} columns: {fall}");
            assert!(curvature < CURVATURE_MAX && rms < RMS_MAX, "{name}: {rms} {curvature}");
        }
    }
}

#[test]
fn by_crease_angles_noise_ends_where_the_flat_sheet_does() {
    for (name, state) in states(8, 2) {
        let goals = state.crease_angles(10f64.powi(THICKEST));
        let [flat, noisy] =
            state.starts().map(|start| state.rms(&state.run(&goals, &start, &Solver::default())));
        assert!((noisy / flat - 1.0).abs() < 1e-2, "{name}: noise ends elsewhere: {noisy}, {flat}");
    }
}
