//! Folded sheets of known shape for the tests of this crate.

use glam::{DVec2, DVec3};
use softfold_geometry::{
    CreaseId, EdgeClass, FlatMesh, FoldedSheet, LoopId, PlanarCurve, Site, SolveRecord, UniformBicubic,
    VertexId,
};

/// Evenly scattered points of the unit square: the additive sequence of the plastic number (the golden ratio's cousin).
pub(crate) fn scatter(k: usize) -> DVec2 {
    let k = k as f64;
    DVec2::new((0.5 + 0.754_877_666_246_693 * k).fract(), (0.5 + 0.569_840_290_998_053 * k).fract())
}

/// A sheet over columns at `us` and rows at `vs`, each square cut in two; `turn(column)` is the rest turn of the fold
/// line along a column, 0 for none.
pub(crate) fn grid(
    us: &[f64],
    vs: &[f64],
    flat: impl Fn(DVec2) -> DVec2,
    space: impl Fn(DVec2) -> DVec3,
    turn: impl Fn(usize) -> f64,
) -> FoldedSheet {
    let rows = vs.len();
    let at = |i: usize, j: usize| VertexId::new(i * rows + j);
    let own: Vec<DVec2> = us.iter().flat_map(|&u| vs.iter().map(move |&v| DVec2::new(u, v))).collect();
    let triangles = (0..us.len() - 1)
        .flat_map(|i| (0..rows - 1).map(move |j| (i, j)))
        .flat_map(|(i, j)| match (i + j) % 2 {
            0 => [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]],
            _ => [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]],
        })
        .collect();
    let class = |[a, b]: [VertexId; 2], boundary| match (boundary, a.index() / rows, b.index() / rows) {
        (true, ..) => EdgeClass::Boundary { loop_id: LoopId(0) },
        (_, i, k) if i == k && turn(i) != 0.0 => {
            EdgeClass::Fold { crease: CreaseId(0), line: i as u32, turn_rad: turn(i) }
        }
        _ => EdgeClass::Facet,
    };
    let vertices: Vec<_> = own.iter().map(|&p| flat(p)).collect();
    let mesh = FlatMesh::new(vertices, vec![Site::Interior; own.len()], triangles, class);
    FoldedSheet { mesh, positions: own.into_iter().map(space).collect(), solve: SolveRecord::default() }
}

/// A sheet over `0..size` with squares of about `step_mm`, its inner vertices moved at random by up to a fifth of that.
pub(crate) fn scattered(size: DVec2, step_mm: f64, space: impl Fn(DVec2) -> DVec3) -> FoldedSheet {
    let line = |length: f64| {
        let n = (length / step_mm).round() as usize;
        (0..=n).map(|k| length * k as f64 / n as f64).collect::<Vec<_>>()
    };
    let mut sheet = grid(&line(size.x), &line(size.y), |p| p, |p| p.extend(0.0), |_| 0.0);
    for (k, p) in sheet.mesh.vertices.iter_mut().enumerate() {
        if (p.cmpgt(DVec2::ZERO) & p.cmplt(size)).all() {
            *p += 0.4 * step_mm * (scatter(k) - 0.5);
        }
    }
    sheet.positions = sheet.mesh.vertices.iter().map(|&p| space(p)).collect();
    sheet.check().unwrap();
    sheet
}

/// The trim of a sheet over `0..size`.
pub(crate) fn rectangle(size: DVec2) -> Vec<PlanarCurve> {
    polygon([(0.0, 0.0), (size.x, 0.0), (size.x, size.y), (0.0, size.y)].map(DVec2::from).to_vec())
}

fn polygon(mut corners: Vec<DVec2>) -> Vec<PlanarCurve> {
    corners.push(corners[0]);
    vec![PlanarCurve::polyline(&corners).unwrap()]
}

/// A bend about a straight crease: flat, an arc of `strips` chords, flat, the polygon that a soft band folds to.
pub(crate) struct BandSheet {
    pub(crate) radius_mm: f64,
    pub(crate) angle_rad: f64,
    pub(crate) strips: usize,
    pub(crate) flank_mm: f64,
    pub(crate) length_mm: f64,
    /// Direction of the crease against v.
    pub(crate) tilt_rad: f64,
}

impl BandSheet {
    /// A bend by 90° between flanks of 100 mm, 250 mm long.
    pub(crate) fn right_angle(radius_mm: f64, strips: usize, tilt_rad: f64) -> Self {
        let angle_rad = std::f64::consts::FRAC_PI_2;
        Self { radius_mm, angle_rad, strips, flank_mm: 100.0, length_mm: 250.0, tilt_rad }
    }

    pub(crate) fn half_width_mm(&self) -> f64 {
        let half_turn = 0.5 * self.angle_rad / self.strips as f64;
        self.strips as f64 * self.radius_mm * half_turn.sin()
    }

    /// Position of a point of the strip's own coordinates: (across, along), the crease at across = 0.
    fn polygonal(&self, p: DVec2) -> DVec3 {
        let x = 2.0 * self.half_width_mm() / self.strips as f64;
        let step = self.angle_rad / self.strips as f64;
        let (mut at, mut direction, mut from) = (DVec2::ZERO, 0.0_f64, -self.half_width_mm());
        if p.x <= from {
            return DVec3::new(p.x - from, p.y, 0.0);
        }
        for k in 0..self.strips {
            direction += if k == 0 { 0.5 * step } else { step };
            let run = (p.x - from).min(x);
            at += run * DVec2::from_angle(direction);
            from += x;
            if p.x <= from {
                return DVec3::new(at.x, p.y, at.y);
            }
        }
        at += (p.x - from) * DVec2::from_angle(self.angle_rad);
        DVec3::new(at.x, p.y, at.y)
    }

    /// Distance of a point in space to the bend that the polygon stands for: flat, true arc, flat.
    pub(crate) fn distance_to_bend(&self, p: DVec3) -> f64 {
        let q = DVec2::new(p.x, p.z) - DVec2::new(0.0, self.radius_mm);
        let angle = q.x.atan2(-q.y);
        if angle < 0.0 {
            p.z.abs()
        } else if angle > self.angle_rad {
            (q.rotate(DVec2::from_angle(-self.angle_rad)).y + self.radius_mm).abs()
        } else {
            (q.length() - self.radius_mm).abs()
        }
    }

    fn flat(&self, p: DVec2) -> DVec2 {
        DVec2::from_angle(self.tilt_rad).rotate(p)
    }

    /// The mesh: fold lines along the crease, `row_mm` between rows, flanks in steps of about twice that.
    pub(crate) fn sheet(&self, row_mm: f64) -> FoldedSheet {
        let (a, n) = (self.half_width_mm(), (self.flank_mm / (1.5 * row_mm)).round().max(1.0) as usize);
        let flank = |k: usize| self.flank_mm * k as f64 / n as f64;
        let us: Vec<f64> = (0..n)
            .map(|k| -a - flank(n - k))
            .chain((0..=self.strips).map(|k| 2.0 * a * k as f64 / self.strips as f64 - a))
            .chain((1..=n).map(|k| a + flank(k)))
            .collect();
        let rows = (self.length_mm / row_mm).round() as usize;
        let vs: Vec<f64> = (0..=rows).map(|j| self.length_mm * j as f64 / rows as f64).collect();
        let line = n..=n + self.strips;
        let turn =
            |column: usize| if line.contains(&column) { self.angle_rad / self.strips as f64 } else { 0.0 };
        grid(&us, &vs, |p| self.flat(p), |p| self.polygonal(p), turn)
    }

    pub(crate) fn trim(&self) -> Vec<PlanarCurve> {
        let w = self.half_width_mm() + self.flank_mm;
        let corners = [(-w, 0.0), (w, 0.0), (w, self.length_mm), (-w, self.length_mm)];
        polygon(corners.map(|c| self.flat(DVec2::from(c))).to_vec())
    }
}

/// The surface through `f` at the knots over -20..120 both ways, `spacing_mm` apart.
pub(crate) fn through(spacing_mm: f64, f: impl Fn(DVec2) -> DVec3) -> UniformBicubic {
    let n = (140.0 / spacing_mm).round() as usize + 1;
    let knot = |k: usize| DVec2::splat(-20.0) + spacing_mm * DVec2::new((k / n) as f64, (k % n) as f64);
    let values: Vec<_> = (0..n * n).map(|k| f(knot(k))).collect();
    UniformBicubic::interpolating(DVec2::splat(-20.0 - spacing_mm), spacing_mm, [n + 2; 2], &values).unwrap()
}

/// The left side of a fold along a circular crease with constant fold angle and constant ruling angle: a tangent
/// developable about a helix (the relations between crease and rulings: Fuchs and Tabachnikov 1999).
pub(crate) struct Developable {
    pub(crate) crease_radius_mm: f64,
    /// Half the fold angle, a: between the osculating plane and the tangent plane.
    pub(crate) half_fold_rad: f64,
    /// From the crease's tangent to the ruling.
    pub(crate) ruling_rad: f64,
}

impl Developable {
    /// Flat point at `v` along the ruling at arc length `s`, and the ruling's unit vector. The crease begins at (50, 0) to
    /// the left of its tangent (1, 0), its centre above.
    pub(crate) fn flat(&self, s: f64, v: f64) -> (DVec2, DVec2) {
        let (r, turn) = (self.crease_radius_mm, s / self.crease_radius_mm);
        let crease = DVec2::new(50.0, r) + r * DVec2::new(turn.sin(), -turn.cos());
        let ruling = DVec2::from_angle(turn + self.ruling_rad);
        (crease + v * ruling, ruling)
    }

    /// Point of the crease in space, and the ruling's unit vector there.
    pub(crate) fn space(&self, s: f64) -> (DVec3, DVec3) {
        let (a, b) = (self.half_fold_rad, self.ruling_rad);
        let geodesic = 1.0 / self.crease_radius_mm;
        let (curvature, torsion) = (geodesic / a.cos(), geodesic * a.tan() / b.tan());
        // The helix about z with this curvature and torsion.
        let c = curvature.hypot(torsion);
        let (radius, rise) = (curvature / (c * c), torsion / (c * c));
        let (sin, cos) = (c * s).sin_cos();
        let point = DVec3::new(radius * cos, radius * sin, rise * c * s);
        let tangent = c * DVec3::new(-radius * sin, radius * cos, rise);
        let normal = -DVec3::new(cos, sin, 0.0);
        let conormal = a.cos() * normal + a.sin() * tangent.cross(normal);
        (point, b.cos() * tangent + b.sin() * conormal)
    }

    /// Curvature across the ruling at `v` along it: k₁ = k_g tan a / sin² b at the crease, and inversely as the distance
    /// from the edge of regression, which is at v = sin b / k_g.
    pub(crate) fn curvature(&self, v: f64) -> f64 {
        let (geodesic, sin) = (1.0 / self.crease_radius_mm, self.ruling_rad.sin());
        let regression = sin / geodesic;
        geodesic * self.half_fold_rad.tan() / (sin * sin) * regression / (regression - v)
    }

    /// Where a flat point goes.
    fn bent(&self, p: DVec2) -> DVec3 {
        // The ruling through p: turned by `turn`, the crease frame sees p along b.
        let center = DVec2::new(50.0, self.crease_radius_mm);
        let q = p - center;
        // |crease + v ruling − center|² with the ruling at b from the tangent: v² − 2 r sin b v + r² = |q|².
        let (r, sin) = (self.crease_radius_mm, self.ruling_rad.sin());
        let v = r * sin - (q.length_squared() - r * r * (1.0 - sin * sin)).sqrt();
        let (own, _) = self.flat(0.0, v);
        let turn = (own - center).angle_to(q);
        let (point, ruling) = self.space(turn * r);
        point + v * ruling
    }

    /// The surface over -20..120.
    pub(crate) fn surface(&self, spacing_mm: f64) -> UniformBicubic {
        through(spacing_mm, |p| self.bent(p))
    }
}
