//! From a closed form's sheet to a mesh of it, through the stages that a user's pattern goes through.

#![allow(dead_code, reason = "each test binary uses its part")]

use crate::mirror::Mirror;
use softfold_fold::{EdgeLengths, Goal, Hinges, SheetMaterial};
use softfold_geometry::{
    Crease, CreaseId, CreasePattern, DVec2, DVec3, EdgeClass, EdgeId, FlatMesh, FoldedSheet, PlanarCurve,
    Role, Segment, SolveRecord, Source, TriangleId, VertexId,
};
use softfold_mesh::{MeshOptions, mesh};
use softfold_soften::{Along, CreaseSoftness, Segments, soften};

/// Cubic pieces of a smooth curve: their error is of fourth order, far below a micrometre here.
const PIECES: usize = 24;
/// Step of the differences that give tangents, share of the curve: 1e-10 of it off.
const STEP: f64 = 1e-5;
/// Places at which a fold angle that changes is given.
const PLACES: usize = 200;

/// A curve by cubics that share its points and tangents; its parameter runs from 0 to 1.
pub(crate) fn smooth(at: impl Fn(f64) -> DVec2) -> Vec<Segment> {
    let share = |k: usize| k as f64 / PIECES as f64;
    let third = |k: usize| (at(share(k) + STEP) - at(share(k) - STEP)) / (2.0 * STEP) / (3.0 * PIECES as f64);
    let piece = |k: usize| {
        let (from, to) = (at(share(k)), at(share(k + 1)));
        Segment::Cubic { from, c1: from + third(k), c2: to - third(k + 1), to }
    };
    (0..PIECES).map(piece).collect()
}

/// A sheet with one crease.
pub(crate) fn pattern(outline: Vec<Segment>, crease: Vec<Segment>) -> CreasePattern {
    let outline = PlanarCurve::new(outline).expect("an outline");
    let counter_clockwise = outline.signed_area_mm2() > 0.0;
    let crease = Crease {
        id: CreaseId(0),
        name: "crease".into(),
        role: Role::Unassigned,
        curve: PlanarCurve::new(crease).expect("a crease"),
        fold_angle_rad: None,
        source: Source::default(),
    };
    CreasePattern {
        name: "sheet".into(),
        outline: if counter_clockwise { outline } else { outline.reversed() },
        holes: Vec::new(),
        slits: Vec::new(),
        creases: vec![crease],
    }
}

/// A rectangle with a straight crease across it, from below to above.
pub(crate) fn rectangle(size_mm: DVec2, crease_u_mm: f64) -> CreasePattern {
    let corners = [DVec2::ZERO, DVec2::new(size_mm.x, 0.0), size_mm, DVec2::new(0.0, size_mm.y)];
    let side = |k: usize| Segment::Line { from: corners[k], to: corners[(k + 1) % 4] };
    let ends = [DVec2::new(crease_u_mm, 0.0), DVec2::new(crease_u_mm, size_mm.y)];
    pattern((0..4).map(side).collect(), vec![Segment::Line { from: ends[0], to: ends[1] }])
}

/// Soften and mesh, as they are by default.
pub(crate) fn meshed(pattern: &CreasePattern, softness: CreaseSoftness, target_edge_mm: f64) -> FlatMesh {
    let soft = soften(pattern, &[softness]).expect("a band that fits");
    mesh(&soft, &MeshOptions { target_edge_mm, ..MeshOptions::default() }).expect("a mesh").mesh
}

/// An elastic sheet of `E t = 1` N/mm by its bending stiffness over E t, mm²; Poisson's ratio 0.
pub(crate) fn sheet(bending_mm2: f64, fold_line_factor: f64) -> SheetMaterial {
    let thickness_mm = (12.0 * bending_mm2).sqrt();
    SheetMaterial {
        youngs_modulus_mpa: 1.0 / thickness_mm,
        poisson_ratio: 0.0,
        thickness_mm,
        fold_line_factor,
    }
}

/// The vertices of a fold line.
pub(crate) fn on_line(mesh: &FlatMesh, line: u32) -> Vec<VertexId> {
    let of_line = |class: EdgeClass| matches!(class, EdgeClass::Fold { line: l, .. } if l == line);
    let mut found: Vec<VertexId> =
        mesh.edges.iter().filter(|e| of_line(e.class)).flat_map(|e| e.vertices).collect();
    found.sort();
    found.dedup();
    found
}

/// Membrane of `E t = 1` N/mm; fold lines turn as the band has it, edges on the faces as the closed form's surface does at their places. Strips
/// between fold lines have no closed form and bend freely.
pub(crate) fn all_angles(mirror: &Mirror, mesh: &FlatMesh, bending_mm2: f64) -> Vec<Box<dyn Goal>> {
    let exact = mirror.exact(mesh);
    let folds = mesh.edges.iter().filter(|e| matches!(e.class, EdgeClass::Fold { .. }));
    let off_crease_mm = |v: VertexId| mirror.off_crease_mm(mesh.vertices[v.index()]).abs();
    let half_width_mm = folds.flat_map(|e| e.vertices).map(off_crease_mm).fold(0.0, f64::max);
    let in_band = |t: &TriangleId| {
        mesh.triangles[t.index()].iter().all(|v| off_crease_mm(*v) <= half_width_mm * (1.0 + 1e-9))
    };
    let square = |id: EdgeId| {
        let sides = mesh.edges[id.index()].triangles;
        let area_mm2: f64 = sides.iter().flatten().map(|&t| mesh.triangle_area_mm2(t)).sum();
        mesh.edge_length_mm(id).powi(2) / area_mm2
    };
    let hinges = Hinges::of_mesh(mesh, "turns", |id, e| {
        let rest_rad = match e.class {
            EdgeClass::Fold { turn_rad, .. } => turn_rad,
            _ if e.triangles.iter().flatten().any(in_band) => return None,
            _ => exact.turn_rad(e)?,
        };
        Some((rest_rad, bending_mm2 * square(id)))
    });
    vec![Box::new(EdgeLengths::of_mesh(mesh, |id| 1.0 / square(id))), Box::new(hinges)]
}

impl Mirror {
    /// How far beyond the crease a point of the flat sheet is, along its ruling, mm.
    pub(crate) fn off_crease_mm(&self, p: DVec2) -> f64 {
        let [r, along] = self.surface.unrolled(p);
        along - self.crease(r)
    }

    /// The flat sheet with its crease.
    pub(crate) fn pattern(&self) -> CreasePattern {
        let at = |share: f64, reach_mm: f64| {
            let r = self.ruling(share);
            self.surface.flat(r, self.crease(r) + reach_mm)
        };
        let [low, high] = [-self.reach_mm[0], self.reach_mm[1]];
        let mut outline = smooth(|t| at(t, low));
        outline.push(Segment::Line { from: at(1.0, low), to: at(1.0, high) });
        outline.extend(smooth(|t| at(1.0 - t, high)));
        outline.push(Segment::Line { from: at(0.0, high), to: at(0.0, low) });
        pattern(outline, smooth(|t| at(t, 0.0)))
    }

    /// The closed form's fold angle along the pattern's crease, with its sign on a sheet seen from the front.
    pub(crate) fn softness(&self, pattern: &CreasePattern, radius_mm: f64, segments: u32) -> CreaseSoftness {
        let curve = &pattern.creases[0].curve;
        let sign = self.sign();
        let angle = |k: usize| {
            let s_mm = curve.length_mm() * k as f64 / PLACES as f64;
            let [r, _] = self.surface.unrolled(curve.point(s_mm));
            (s_mm, sign * 2.0 * self.half_angle_rad(r))
        };
        CreaseSoftness {
            radius_mm: radius_mm.into(),
            fold_angle_rad: Along::Places((0..=PLACES).map(angle).collect()),
            segments: Segments::Count(segments),
        }
    }

    /// +1 if the closed form's crease is a valley seen from the front of the flat sheet.
    fn sign(&self) -> f64 {
        let r = self.ruling(0.5);
        let at = |dr: f64, along: f64| {
            (self.surface.flat(r + dr, self.crease(r) + along), self.place(r + dr, self.crease(r) + along))
        };
        let small = 1e-3 * (self.rulings[1] - self.rulings[0]);
        let [p, along, below, above] =
            [at(0.0, 0.0), at(small, self.crease(r + small) - self.crease(r)), at(0.0, -1.0), at(0.0, 1.0)];
        // Counter-clockwise around the flat sheet's normal: front.
        let front = |a: (DVec2, DVec3), b: (DVec2, DVec3)| {
            let flat = (a.0 - p.0).perp_dot(b.0 - p.0).signum();
            flat * (a.1 - p.1).cross(b.1 - p.1)
        };
        let [one, other] = [front(along, below), front(along, above)];
        // A valley's faces look towards each other.
        let towards = one.dot(above.1 - p.1) + other.dot(below.1 - p.1);
        towards.signum()
    }

    /// The closed form at the vertices of a mesh.
    pub(crate) fn positions(&self, mesh: &FlatMesh) -> Vec<DVec3> {
        let place = |p: &DVec2| {
            let [r, along] = self.surface.unrolled(*p);
            self.place(r, along)
        };
        mesh.vertices.iter().map(place).collect()
    }

    /// The closed form on a mesh.
    pub(crate) fn exact(&self, mesh: &FlatMesh) -> FoldedSheet {
        FoldedSheet { mesh: mesh.clone(), positions: self.positions(mesh), solve: SolveRecord::default() }
    }
}
