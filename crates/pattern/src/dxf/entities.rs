//! The curve of each kind of entity.

use super::content::Entity;
use super::curve::{self, Chain, Piece, Placement, axes};
use super::fields::Fields;
use super::spline;
use crate::{PatternError, path};
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::TAU;

/// Kinds that are lines of a pattern.
const DRAWN: [&str; 8] = ["LINE", "ARC", "CIRCLE", "ELLIPSE", "LWPOLYLINE", "POLYLINE", "SPLINE", "INSERT"];
/// Flags of POLYLINE.
const CLOSED: i64 = 1;
const IN_SPACE: i64 = 8;
const MESH: i64 = 16 | 64;
/// Flag of VERTEX: a control point, which only shows the frame of a curve.
const FRAME: i64 = 16;
/// A sweep below this is the whole circle, rad.
const NO_SWEEP_RAD: f64 = 1e-12;

/// What there is to say of an entity that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Remark {
    /// Radius or axes of no size: no curve.
    NoSize,
    /// A radius below 0, taken as if above.
    NegativeRadius,
    /// A spline that is no chain of cubics, within [`spline::APPROXIMATION`].
    Approximated,
    /// As before, but it cannot be kept there with the cubics that a span may have.
    Coarse,
    /// A spline given by points on it.
    ThroughPoints,
    /// A spline without knots: uniform ones.
    NoKnots,
}

/// The curve of an entity, in the coordinates of the space that it is drawn in.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Drawn {
    pub(super) chains: Vec<Chain>,
    pub(super) remark: Option<Remark>,
}

impl Drawn {
    fn one(chain: Chain, place: &Placement) -> Self {
        let chain = chain.iter().map(|p| p.mapped(|q| place.of(q))).collect();
        Self { chains: vec![chain], remark: None }
    }

    fn none() -> Self {
        Self { chains: Vec::new(), remark: Some(Remark::NoSize) }
    }
}

impl<'a> Entity<'a> {
    /// Its groups.
    pub(super) fn fields(&self) -> Fields<'_> {
        Fields { tags: self.tags, origin: &self.origin }
    }

    /// Its kind, if that is no line of a pattern and no block of such.
    pub(super) fn foreign_kind(&self) -> Option<String> {
        let mesh = || self.fields().integer_or(70, 0).is_ok_and(|flags| flags & MESH != 0);
        match self.kind.as_str() {
            "POLYLINE" if mesh() => Some("POLYLINE (mesh)".to_owned()),
            kind => (!DRAWN.contains(&kind)).then(|| kind.to_owned()),
        }
    }

    /// Its axes in the drawing: those of its normal.
    ///
    /// # Errors
    /// A number that is not finite.
    pub(super) fn axes(&self) -> Result<DMat3, PatternError> {
        Ok(axes(self.fields().point_if(210)?.unwrap_or(DVec3::Z)))
    }
}

/// The curve of an entity.
///
/// # Errors
/// A number that is missing or not finite, a spline that is none.
pub(super) fn drawn(entity: &Entity<'_>) -> Result<Drawn, PatternError> {
    match entity.kind.as_str() {
        "LINE" => line(&entity.fields()),
        "ARC" | "CIRCLE" => arc(entity),
        "ELLIPSE" => ellipse(entity),
        "LWPOLYLINE" => light_polyline(entity),
        "POLYLINE" => polyline(entity),
        "SPLINE" => spline::drawn(&entity.fields()),
        _ => Ok(Drawn::default()),
    }
}

fn line(fields: &Fields<'_>) -> Result<Drawn, PatternError> {
    let piece = Piece::Line([fields.point(10)?, fields.point(11)?]);
    Ok(Drawn::one(vec![piece], &Placement::IDENTITY))
}

/// The unit circle's arc, laid into space; angles in rad.
fn round(start: f64, end: f64, place: &Placement) -> Drawn {
    let sweep = (end - start).rem_euclid(TAU);
    let whole = sweep < NO_SWEEP_RAD || TAU - sweep < NO_SWEEP_RAD;
    let path = path::unit_arc(start, if whole { TAU } else { sweep });
    Drawn::one(curve::of_path(&path, |p| DVec3::new(p.x, p.y, 0.0)), place)
}

fn arc(entity: &Entity<'_>) -> Result<Drawn, PatternError> {
    let fields = entity.fields();
    let axes = entity.axes()?;
    let (centre, radius) = (fields.point(10)?, fields.required(40)?);
    if radius == 0.0 {
        return Ok(Drawn::none());
    }
    let angle = |code, default: f64| Ok(fields.real_or(code, default)?.to_radians());
    let (start, end) = match entity.kind.as_str() {
        "ARC" => (angle(50, 0.0)?, angle(51, 360.0)?),
        _ => (0.0, TAU),
    };
    let drawn = round(start, end, &Placement { linear: axes * radius.abs(), shift: axes * centre });
    Ok(Drawn { remark: (radius < 0.0).then_some(Remark::NegativeRadius), ..drawn })
}

fn ellipse(entity: &Entity<'_>) -> Result<Drawn, PatternError> {
    let fields = entity.fields();
    let normal = entity.axes()?.z_axis;
    let (centre, major) = (fields.point(10)?, fields.point(11)?);
    let minor = normal.cross(major) * fields.required(40)?;
    if major == DVec3::ZERO || minor == DVec3::ZERO {
        return Ok(Drawn::none());
    }
    let linear = DMat3::from_cols(major, minor, normal);
    Ok(round(fields.real_or(41, 0.0)?, fields.real_or(42, TAU)?, &Placement { linear, shift: centre }))
}

fn light_polyline(entity: &Entity<'_>) -> Result<Drawn, PatternError> {
    let fields = entity.fields();
    let closed = fields.integer_or(70, 0)? & CLOSED != 0;
    flat(entity, &fields.corners()?, closed, fields.real_or(38, 0.0)?)
}

fn polyline(entity: &Entity<'_>) -> Result<Drawn, PatternError> {
    let fields = entity.fields();
    let flags = fields.integer_or(70, 0)?;
    let mut corners: Vec<(DVec3, f64)> = Vec::new();
    for tags in &entity.vertices {
        let vertex = Fields { tags, ..fields };
        if vertex.integer_or(70, 0)? & FRAME == 0 {
            corners.push((vertex.point(10)?, vertex.real_or(42, 0.0)?));
        }
    }
    let closed = flags & CLOSED != 0;
    if flags & IN_SPACE != 0 {
        return Ok(in_space(&corners, closed));
    }
    let corners: Vec<(DVec2, f64)> = corners.iter().map(|(p, bulge)| (p.truncate(), *bulge)).collect();
    flat(entity, &corners, closed, fields.real_or(30, 0.0)?)
}

/// A polyline in the entity's own plane.
fn flat(entity: &Entity<'_>, corners: &[(DVec2, f64)], closed: bool, z: f64) -> Result<Drawn, PatternError> {
    if curve::polyline_pieces(corners) > curve::MAX_PIECES {
        let what = format!("the arcs of the polyline are more than {} curves", curve::MAX_PIECES);
        return Err(entity.fields().fault(what, None));
    }
    let place = Placement { linear: entity.axes()?, shift: DVec3::ZERO };
    Ok(Drawn::one(curve::polyline(corners, closed, z), &place))
}

fn in_space(corners: &[(DVec3, f64)], closed: bool) -> Drawn {
    let next = corners.iter().skip(1).chain(corners.first().filter(|_| closed && corners.len() > 1));
    let chain = corners.iter().zip(next).map(|(a, b)| Piece::Line([a.0, b.0])).collect();
    Drawn::one(chain, &Placement::IDENTITY)
}
