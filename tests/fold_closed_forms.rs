//! Folding against closed forms at any fineness: a cylinder or a cone, cut by a plane and one part of it mirrored.
//!
//! What is mirrored meets the rest in a planar crease; rulings go straight on across it in the flat sheet, and both sides
//! keep the surface's curvature (Fuchs & Tabachnikov 1999; the reflection construction of Mitani). Rest angles here are those of the smooth
//! surface, so that what a mesh gives is as far from it as the mesh is coarse.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

#[path = "common/align.rs"]
mod align;
#[path = "common/shared.rs"]
#[allow(dead_code, reason = "only `say` is wanted")]
mod shared;

use align::{aligned_rms_mm, shaken};
use shared::say;
use softfold_fold::{
    CoPlanar, EdgeLengths, Goal, Hinges, NewtonOptions, Scales, SheetPoint, Solver, fold, upright,
};
use softfold_geometry::{
    CreaseId, DVec2, DVec3, Edge, EdgeClass, EdgeId, FlatMesh, FoldedSheet, LoopId, Site, SolveRecord,
    VertexId,
};

/// How far a folded sheet may be from its closed form: root mean square over the vertices, by the sheet's size.
const RMS_MAX: f64 = 2e-3;
/// Least fall of the error when the mesh is twice as fine: second order is 4.
const FALL: f64 = 3.5;
/// The same where only the crease's angles are known: what is left is mostly the bending of a sheet that is not yet thin enough.
const LEAST_FALL: f64 = 1.4;
/// Error of κ_g = κ cos α.
const CURVATURE_MAX: f64 = 0.01;
/// Membrane stiffness E t, N/mm: only ratios to it matter.
const MEMBRANE: f64 = 1.0;

/// A developable surface by ruling and place on it, cut by the plane through `origin` with unit `normal`.
struct Mirror {
    name: &'static str,
    surface: Surface,
    origin: DVec3,
    normal: DVec3,
    /// First and last ruling: mm across the cylinder, angle of the flat cone.
    rulings: [f64; 2],
    /// How far the sheet reaches to both sides of the crease along the rulings, mm.
    reach_mm: [f64; 2],
}

enum Surface {
    /// Axis z.
    Cylinder { radius_mm: f64 },
    /// Axis z, apex at the origin.
    Cone { half_angle_rad: f64 },
}

impl Surface {
    /// Of a ruling: where on it, in space, the place 0 lies, and its direction.
    fn ruling(&self, r: f64) -> [DVec3; 2] {
        match *self {
            Surface::Cylinder { radius_mm } => {
                let (s, c) = (r / radius_mm).sin_cos();
                [radius_mm * DVec3::new(c, s, 0.0), DVec3::Z]
            }
            Surface::Cone { half_angle_rad } => {
                let (sw, cw) = half_angle_rad.sin_cos();
                let (s, c) = (r / sw).sin_cos();
                [DVec3::ZERO, DVec3::new(sw * c, sw * s, cw)]
            }
        }
    }

    fn flat(&self, r: f64, along: f64) -> DVec2 {
        match *self {
            Surface::Cylinder { .. } => DVec2::new(r, along),
            Surface::Cone { .. } => along * DVec2::from_angle(r),
        }
    }

    fn normal(&self, r: f64) -> DVec3 {
        match *self {
            Surface::Cylinder { radius_mm } => DVec3::new((r / radius_mm).cos(), (r / radius_mm).sin(), 0.0),
            Surface::Cone { half_angle_rad } => {
                let (sw, cw) = half_angle_rad.sin_cos();
                DVec3::new(cw * (r / sw).cos(), cw * (r / sw).sin(), -sw)
            }
        }
    }

    /// How far the surface turns between two rulings, rad.
    fn turn_rad(&self, between: f64) -> f64 {
        match *self {
            Surface::Cylinder { radius_mm } => between / radius_mm,
            Surface::Cone { half_angle_rad } => between / half_angle_rad.tan(),
        }
    }
}

impl Mirror {
    /// Place along a ruling where the plane cuts it, mm.
    fn crease(&self, r: f64) -> f64 {
        let [start, direction] = self.surface.ruling(r);
        (self.origin - start).dot(self.normal) / direction.dot(self.normal)
    }

    fn place(&self, r: f64, along: f64) -> DVec3 {
        let [start, direction] = self.surface.ruling(r);
        let p = start + along * direction;
        match along > self.crease(r) {
            true => p - 2.0 * (p - self.origin).dot(self.normal) * self.normal,
            false => p,
        }
    }

    /// Half the fold angle: between the plane and the surface.
    fn half_angle_rad(&self, r: f64) -> f64 {
        self.surface.normal(r).dot(self.normal).abs().acos()
    }

    /// A mesh of rulings, `rows` to each side of the crease; the crease is row `rows`.
    fn state(&self, columns: usize, rows: usize) -> State {
        let mut flat = Vec::new();
        let mut exact = Vec::new();
        for i in 0..=columns {
            let r = self.ruling(i as f64 / columns as f64);
            for j in 0..=2 * rows {
                let t = j as f64 / rows as f64 - 1.0;
                let along =
                    self.crease(r) + if t < 0.0 { t * self.reach_mm[0] } else { t * self.reach_mm[1] };
                flat.push(self.surface.flat(r, along));
                exact.push(self.place(r, along));
            }
        }
        State::new(self, columns, rows, flat, exact)
    }

    fn ruling(&self, share: f64) -> f64 {
        self.rulings[0] + share * (self.rulings[1] - self.rulings[0])
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
}

impl State {
    fn new(mirror: &Mirror, columns: usize, rows: usize, flat: Vec<DVec2>, exact: Vec<DVec3>) -> Self {
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
        let turn = |e: &Edge| {
            let [a, b] = e.vertices;
            let middle = mirror.ruling(0.5 * (column(a) + column(b)) / columns as f64);
            match e.class {
                EdgeClass::Fold { .. } => 2.0 * mirror.half_angle_rad(middle),
                _ if column(a) == column(b) => {
                    mirror.surface.turn_rad((mirror.rulings[1] - mirror.rulings[0]).abs() / columns as f64)
                }
                _ => 0.0,
            }
        };
        let turns_rad = mesh.edges.iter().map(turn).collect();
        let crease = (0..=columns).map(|i| at(i, rows)).collect();
        let exact = FoldedSheet { mesh, positions: exact, solve: SolveRecord::default() };
        Self { exact, turns_rad, crease, size_mm: (size[1] - size[0]).max_element() }
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

    /// The crease's angles alone, the crease held planar; faces are flat at rest.
    fn crease_angles(&self, faces: f64) -> Vec<Box<dyn Goal>> {
        let hinges = self.hinges(|id, e| match e.class {
            EdgeClass::Fold { .. } => Some((self.rest_rad(id, e)?, CREASE)),
            _ => Some((0.0, faces)),
        });
        let points = self.crease.iter().map(|v| SheetPoint::vertex(*v)).collect();
        let planar = CoPlanar { name: "crease".into(), points, stiffness: MEMBRANE };
        vec![self.membrane(), hinges, Box::new(planar)]
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
        let flat = upright(&self.exact.mesh);
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
/// Columns and rows of the meshes, and the bending stiffness of the faces beside such a crease: the sheet gets thinner as the
/// mesh gets finer.
const MESHES: [(usize, usize, f64); 3] = [(8, 2, 1e-6), (16, 4, 1e-7), (32, 8, 1e-8)];

fn mirrors() -> [Mirror; 3] {
    let slope = 2.0_f64;
    let tilt = DVec3::new(0.25, 0.0, 1.0).normalize();
    let half_angle_rad = 50f64.to_radians();
    [
        Mirror {
            name: "cylinder, sine crease",
            surface: Surface::Cylinder { radius_mm: 100.0 },
            origin: DVec3::ZERO,
            normal: DVec3::new(-slope, 0.0, 1.0).normalize(),
            rulings: [-70.0, 60.0],
            reach_mm: [50.0, 60.0],
        },
        Mirror {
            name: "cone, arc crease",
            surface: Surface::Cone { half_angle_rad },
            origin: DVec3::Z * 100.0,
            normal: DVec3::Z,
            rulings: [0.0, 1.4],
            reach_mm: [50.0, 60.0],
        },
        Mirror {
            name: "cone, tilted plane",
            surface: Surface::Cone { half_angle_rad },
            origin: DVec3::Z * 100.0,
            normal: tilt,
            rulings: [-0.6, 0.8],
            reach_mm: [40.0, 50.0],
        },
    ]
}

#[test]
fn the_closed_forms_are_isometric_and_fold_by_their_angles() {
    for mirror in mirrors() {
        let State { exact, turns_rad, .. } = mirror.state(48, 10);
        for (e, turn) in exact.mesh.edges.iter().zip(turns_rad) {
            let [a, b] = e.vertices;
            let flat = exact.mesh.vertices[a.index()].distance(exact.mesh.vertices[b.index()]);
            assert!((exact.position(a).distance(exact.position(b)) / flat - 1.0).abs() < 2e-4);
            if let Some(got) = exact.turn_rad(e) {
                assert!((got.abs() - turn).abs() < 2e-3, "{}: {got} {turn}", mirror.name);
            }
        }
    }
}

/// One line of the table.
fn tell(mirror: &Mirror, given: &str, columns: usize, figures: [f64; 3]) {
    let [rms, fall, curvature] = figures;
    say(&format!(
        "{:<22} {given:<14} {columns:>4} columns  {:>9.5} % of the size off, fall {fall:>5.2}; κ cos α / κ_g {:>7.4} % off",
        mirror.name,
        100.0 * rms,
        100.0 * curvature
    ));
}

#[test]
fn by_all_angles_folding_tends_to_the_closed_forms_at_second_order() {
    for mirror in mirrors() {
        let mut last: Option<f64> = None;
        for (columns, rows, _) in MESHES {
            let state = mirror.state(columns, rows);
            let goals = state.all_angles();
            let [flat, noisy] = state.starts().map(|start| state.run(&goals, &start, &Solver::default()));
            let (rms, curvature) = (state.rms(&flat), state.curvature_error(&flat));
            let fall = last.map_or(f64::INFINITY, |l| l / rms);
            tell(&mirror, "all angles", columns, [rms, fall, curvature]);
            assert!((state.rms(&noisy) / rms - 1.0).abs() < 1e-3, "{}: noise ends elsewhere", mirror.name);
            assert!(fall > FALL && curvature < CURVATURE_MAX && rms < RMS_MAX, "{}", mirror.name);
            last = Some(rms);
        }
    }
}

#[test]
fn by_crease_angles_folding_tends_to_the_closed_forms_as_the_sheet_gets_thinner() {
    let as_it_is = Solver::Newton(NewtonOptions { ramp: vec![Scales::FULL], ..NewtonOptions::default() });
    for mirror in mirrors() {
        let mut last = f64::INFINITY;
        for (columns, rows, thinnest) in MESHES {
            let state = mirror.state(columns, rows);
            let goals = state.crease_angles(MESHES[0].2);
            let mut sheets = state.starts().map(|start| state.run(&goals, &start, &Solver::default()));
            // A thin sheet crumples where a thick one does not: it begins where the thicker one ended.
            for (_, _, faces) in MESHES.iter().filter(|m| (thinnest..MESHES[0].2).contains(&m.2)) {
                sheets = sheets.map(|s| state.run(&state.crease_angles(*faces), &s.positions, &as_it_is));
            }
            let [rms, noisy] = [0, 1].map(|k| state.rms(&sheets[k]));
            let curvature = state.curvature_error(&sheets[0]);
            tell(&mirror, "crease angles", columns, [rms, last / rms, curvature]);
            assert!((noisy / rms - 1.0).abs() < 1e-2, "{}: noise ends elsewhere: {noisy}", mirror.name);
            assert!(last > LEAST_FALL * rms, "{}", mirror.name);
            last = rms;
            if columns == MESHES[2].0 {
                assert!(curvature < CURVATURE_MAX && rms < RMS_MAX, "{}", mirror.name);
            }
        }
    }
}
