//! Curves in space on their way to the sheet: lines and cubics, and arcs made of cubics.

use glam::{DMat3, DVec2, DVec3};
use kurbo::{BezPath, PathEl, Point};
use softfold_geometry::Segment;

/// Largest angle of an arc that stands as one cubic, rad: the error is then below 1e-8 of the radius
/// (4/27 · sin⁶(θ/4)/cos²(θ/4)).
const ARC_PIECE_RAD: f64 = 0.25;
/// Lines and cubics of a drawing at most.
pub(super) const MAX_PIECES: usize = 1_000_000;
/// Ends that differ by less than this share of the coordinates are one point: rounding of knots and angles.
const ROUNDING: f64 = 1e-12;

/// A line or a cubic Bézier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Piece {
    Line([DVec3; 2]),
    Cubic([DVec3; 4]),
}

/// Pieces that continue each other.
pub(super) type Chain = Vec<Piece>;

impl Piece {
    pub(super) fn points(&self) -> &[DVec3] {
        match self {
            Self::Line(points) => points,
            Self::Cubic(points) => points,
        }
    }

    fn ends(&mut self) -> [&mut DVec3; 2] {
        match self {
            Self::Line([a, b]) | Self::Cubic([a, _, _, b]) => [a, b],
        }
    }

    fn end(mut self) -> DVec3 {
        *self.ends()[1]
    }

    /// The piece with `f` applied to its points; exact for affine maps.
    pub(super) fn mapped(&self, f: impl Fn(DVec3) -> DVec3) -> Self {
        match *self {
            Self::Line(points) => Self::Line(points.map(f)),
            Self::Cubic(points) => Self::Cubic(points.map(f)),
        }
    }

    /// Seen from above, in units of `unit_mm`.
    pub(super) fn on_sheet(&self, unit_mm: f64) -> Segment {
        let flat = |p: DVec3| p.truncate() * unit_mm;
        match *self {
            Self::Line([from, to]) => Segment::Line { from: flat(from), to: flat(to) },
            Self::Cubic([from, c1, c2, to]) => {
                Segment::Cubic { from: flat(from), c1: flat(c1), c2: flat(c2), to: flat(to) }
            }
        }
    }
}

/// Adds a piece to the last chain if it continues that one (then from its last point on, to the last bit), or
/// begins a new chain.
pub(super) fn push(chains: &mut Vec<Chain>, mut piece: Piece) {
    let start = *piece.ends()[0];
    let last = chains.last_mut().and_then(|chain| chain.last().map(|p| p.end()).zip(Some(chain)));
    match last {
        Some((end, chain)) if end.distance(start) <= ROUNDING * end.abs().max_element() => {
            *piece.ends()[0] = end;
            chain.push(piece);
        }
        _ => chains.push(vec![piece]),
    }
}

/// A path in the plane, laid into space.
pub(super) fn of_path(path: &BezPath, place: impl Fn(Point) -> DVec3) -> Chain {
    let mut chain = Chain::new();
    let mut at = DVec3::ZERO;
    for element in path.elements() {
        let piece = match *element {
            PathEl::MoveTo(p) => {
                at = place(p);
                continue;
            }
            PathEl::CurveTo(a, b, p) => Piece::Cubic([at, place(a), place(b), place(p)]),
            PathEl::LineTo(p) => Piece::Line([at, place(p)]),
            // Paths of arcs have nothing else.
            PathEl::QuadTo(..) | PathEl::ClosePath => continue,
        };
        at = piece.end();
        chain.push(piece);
    }
    chain
}

/// A polyline at height `z`: corners, each with the bulge of the piece that starts there.
pub(super) fn polyline(corners: &[(DVec2, f64)], closed: bool, z: f64) -> Chain {
    let mut chain = Chain::new();
    let next = corners.iter().skip(1).chain(corners.first().filter(|_| closed && corners.len() > 1));
    for ((from, bulge), (to, _)) in corners.iter().zip(next) {
        bulged(&mut chain, *from, *to, *bulge, z);
    }
    chain
}

/// How many pieces [`polyline`] makes.
pub(super) fn polyline_pieces(corners: &[(DVec2, f64)]) -> usize {
    let of = |bulge: f64| ((4.0 * bulge.atan().abs() / ARC_PIECE_RAD).ceil() as usize).next_power_of_two();
    corners.iter().map(|(_, bulge)| of(*bulge)).sum()
}

/// The arc from `from` to `to` whose bulge is the tangent of a quarter of its angle, positive to the left.
///
/// Halved until it is a cubic, by chords and bulges alone: no centre, which for almost straight arcs lies so
/// far away that rounding shows.
fn bulged(chain: &mut Chain, from: DVec2, to: DVec2, bulge: f64, z: f64) {
    if bulge == 0.0 {
        chain.push(Piece::Line([from.extend(z), to.extend(z)]));
        return;
    }
    let angle_rad = 4.0 * bulge.atan();
    let chord = to - from;
    if angle_rad.abs() > ARC_PIECE_RAD {
        let top = 0.5 * (from + to) - 0.5 * bulge * chord.perp();
        let half = (0.125 * angle_rad).tan();
        bulged(chain, from, top, half, z);
        bulged(chain, top, to, half, z);
        return;
    }
    // 4/3 tan(θ/4) r with r = chord (1 + b²)/(4 b).
    let handle = chord * ((1.0 + bulge * bulge) / 3.0);
    let turned = |sign: f64| DVec2::from_angle(sign * 0.5 * angle_rad).rotate(handle);
    let points = [from, from + turned(-1.0), to - turned(1.0), to];
    chain.push(Piece::Cubic(points.map(|p| p.extend(z))));
}

/// An affine map of space: where an element's own coordinates lie in the drawing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    pub(super) linear: DMat3,
    pub(super) shift: DVec3,
}

impl Placement {
    pub(super) const IDENTITY: Self = Self { linear: DMat3::IDENTITY, shift: DVec3::ZERO };

    pub(super) fn of(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.shift
    }

    /// First `inner`, then `self`.
    pub(super) fn after(&self, inner: &Self) -> Self {
        Self { linear: self.linear * inner.linear, shift: self.of(inner.shift) }
    }
}

/// The axes of an element whose normal is given ("arbitrary axis algorithm" of the DXF Reference).
pub(super) fn axes(normal: DVec3) -> DMat3 {
    /// Normals this near to z take their x axis from y.
    const NEAR_Z: f64 = 1.0 / 64.0;
    let Some(z) = normal.try_normalize() else { return DMat3::IDENTITY };
    let near = z.x.abs() < NEAR_Z && z.y.abs() < NEAR_Z;
    let x = if near { DVec3::Y } else { DVec3::Z }.cross(z).normalize_or_zero();
    DMat3::from_cols(x, z.cross(x), z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points along the cubics of a chain.
    fn samples(chain: &Chain) -> Vec<DVec3> {
        let of = |piece: &Piece| match *piece {
            Piece::Line([a, b]) => vec![a, b],
            Piece::Cubic([a, b, c, d]) => (0..=16)
                .map(|k| {
                    let t = f64::from(k) / 16.0;
                    let s = 1.0 - t;
                    s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
                })
                .collect(),
        };
        chain.iter().flat_map(of).collect()
    }

    #[test]
    fn bulges_are_arcs_of_their_circle() {
        let circle = polyline(&[(DVec2::X * 1000.0, 1.0), (DVec2::X * -1000.0, 1.0)], true, 7.0);
        assert_eq!(circle.len(), polyline_pieces(&[(DVec2::ZERO, 1.0), (DVec2::ZERO, 1.0)]));
        assert!(samples(&circle).iter().all(|p| (p.truncate().length() - 1000.0).abs() < 1e-5 && p.z == 7.0));
        // A quarter to the right, and its end is the corner itself.
        let quarter =
            polyline(&[(DVec2::ZERO, -(std::f64::consts::PI / 8.0).tan()), (DVec2::ONE, 0.0)], false, 0.0);
        assert!(samples(&quarter).iter().all(|p| (p.truncate().distance(DVec2::X) - 1.0).abs() < 1e-8));
        assert_eq!(quarter.last().unwrap().end(), DVec3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn almost_straight_arcs_keep_their_rise() {
        let chain = polyline(&[(DVec2::ZERO, 1e-9), (DVec2::X * 1000.0, 0.0)], false, 0.0);
        let lowest = samples(&chain).iter().map(|p| p.y).fold(0.0, f64::min);
        assert!((lowest + 0.5e-6).abs() < 1e-12, "half the chord by the bulge: {lowest}");
    }

    #[test]
    fn a_normal_that_points_down_mirrors() {
        assert_eq!(axes(DVec3::NEG_Z) * DVec3::new(2.0, 3.0, 1.0), DVec3::new(-2.0, 3.0, -1.0));
        assert_eq!(axes(DVec3::Z), DMat3::IDENTITY);
        assert_eq!(axes(DVec3::ZERO), DMat3::IDENTITY);
        let tilted = axes(DVec3::new(1.0, 2.0, 2.0));
        assert!((tilted.determinant() - 1.0).abs() < 1e-15);
        assert!((tilted.x_axis.z).abs() < 1e-15, "x stays level");
    }

    #[test]
    fn chains_break_where_pieces_do_not_meet() {
        let line = |a: f64, b: f64| Piece::Line([DVec3::X * a, DVec3::X * b]);
        let mut chains = Vec::new();
        for piece in [line(0.0, 1.0), line(1.0 + 1e-14, 2.0), line(2.1, 3.0)] {
            push(&mut chains, piece);
        }
        assert_eq!(chains, [vec![line(0.0, 1.0), line(1.0, 2.0)], vec![line(2.1, 3.0)]]);
    }
}
