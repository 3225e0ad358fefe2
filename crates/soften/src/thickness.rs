//! Radii from the board: what its outer fibres and its material can bear, and which side of it the
//! sheet is.
//!
//! Radii here are those of bands, so of the pattern's face of the board. On a one-sided board the
//! valleys' inner skin is that face and the mountains' is the other one (paper eq. 5).

use crate::along::Extent;
use crate::{Along, CreaseSoftness, Fault, Segments};
use softfold_geometry::Role;
use std::f64::consts::PI;

/// Below this fold angle (1°) a band of constant width gets no larger radius and tapers off: the radius
/// would be that of a plane.
const LEAST_ANGLE_RAD: f64 = PI / 180.0;
/// A radius that follows the fold angle has an entry wherever the angle has grown by this factor: between
/// two of them `1/sin` is straight within `(f − 1)²/(4 f)`, 0.23 %.
const ANGLE_STEP: f64 = 1.1;
/// Where the fold angle changes its sign the radius jumps, over this share of the piece on either side.
const JUMP_SHARE: f64 = 1e-6;
/// The lists here are looked at from inside; where they end does not matter.
const ANY_EXTENT: Extent = Extent { length_mm: f64::INFINITY, closed: false };

/// The board's thickness and what its material bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Board {
    /// Thickness t, mm.
    pub thickness_mm: f64,
    /// Largest strain of the outer fibre, t/(2r) at the radius r of the middle of the board.
    pub strain_limit: f64,
    /// Smallest inside radius that the material can be bent to, mm.
    pub inside_radius_mm: f64,
}

/// How radii answer to the thickness of the board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compensation {
    /// As asked for.
    None,
    /// The thickness is on one side: mountains keep their radius, valleys lose the thickness
    /// (paper eq. 5: `r_m^t = r_m`, `r_v^t = r_v − t`).
    OneSided,
    /// Valleys get the thickness on top, so that both skins show the same radii (paper eq. 6:
    /// `r_v = r_m + t`).
    Equal,
    /// Bands of a constant width on the sheet: the radius follows the local fold angle,
    /// `r(s) = w/(2 n sin(|π−ρ(s)|/(2n)))` (within 0.23 % between entries), and is raised to the smallest that the board bears.
    PerPoint {
        /// Width w of the band on the sheet, mm.
        width_mm: f64,
    },
}

/// Why a board cannot be bent as asked.
#[derive(Clone, Debug, PartialEq)]
pub enum BoardFault {
    /// A figure of the board is negative, zero where it may not be, or no number.
    Figures,
    /// The thickness takes more than the radius.
    Thickness {
        /// The radius asked for, mm.
        radius_mm: f64,
        /// Thickness, mm.
        thickness_mm: f64,
    },
    /// Bands of constant width need a given number of strips and a positive width.
    Width,
}

/// A softness that answers to the board.
#[derive(Clone, Debug, PartialEq)]
pub struct Compensated {
    /// Radius and fold angle along the crease.
    pub softness: CreaseSoftness,
    /// Places along the crease (mm) at which the radius was raised to the smallest that the board
    /// bears; for a constant radius place 0.
    pub raised_mm: Vec<f64>,
    /// Places at which the radius was left although it is below that, sharp places among them.
    pub tight_mm: Vec<f64>,
}

impl BoardFault {
    pub(crate) fn message(&self) -> String {
        match self {
            Self::Figures => "the board's thickness, strain limit or inside radius is none".to_owned(),
            Self::Thickness { radius_mm, thickness_mm } => {
                format!("the board of {thickness_mm} mm leaves nothing of the radius {radius_mm} mm")
            }
            Self::Width => {
                "a band of constant width needs a positive width and a number of strips".to_owned()
            }
        }
    }

    pub(crate) fn mend(&self) -> String {
        match self {
            Self::Figures => "give a thickness and an inside radius of 0 or more, and a limit above 0",
            Self::Thickness { .. } => "give a larger radius or a thinner board",
            Self::Width => "give the width in mm and the number of strips",
        }
        .to_owned()
    }
}

impl Board {
    /// # Errors
    /// Figures that are none.
    pub fn check(&self) -> Result<(), Fault> {
        let length = |x: f64| x >= 0.0 && x.is_finite();
        let good = length(self.thickness_mm) && length(self.inside_radius_mm) && self.strain_limit > 0.0;
        if good { Ok(()) } else { Err(Fault::Board { why: BoardFault::Figures }) }
    }

    /// Smallest radius of the middle of the board, mm: the outer fibre's strain `t/(2r)` keeps the limit ε, and
    /// the inner skin keeps the material's radius: `max(t/(2ε), r_material + t/2)`.
    pub fn smallest_radius_mm(&self) -> f64 {
        (self.thickness_mm / (2.0 * self.strain_limit)).max(self.inside_radius_mm + 0.5 * self.thickness_mm)
    }

    /// Strain of the outer fibre where the middle of the board is bent to a radius: `t/(2r)`.
    pub fn outer_strain(&self, radius_mm: f64) -> f64 {
        self.thickness_mm / (2.0 * radius_mm)
    }
}

/// The radius on the board of a radius on the sheet, one side of it thickened (paper eq. 5): mountains
/// keep theirs, valleys lose the thickness. `sign` is that of the fold angle.
pub fn one_sided_radius_mm(radius_mm: f64, sign: f64, thickness_mm: f64) -> f64 {
    if sign > 0.0 { radius_mm - thickness_mm } else { radius_mm }
}

/// The radius on the sheet with which both skins of a board thickened on one side show the same radii
/// (paper eq. 6): mountains keep theirs, valleys gain the thickness.
pub fn equal_radius_mm(radius_mm: f64, sign: f64, thickness_mm: f64) -> f64 {
    if sign > 0.0 { radius_mm + thickness_mm } else { radius_mm }
}

/// The radius at which a band of `segments` strips is `width_mm` wide (paper eq. 1 solved for r), mm;
/// infinite for a fold angle of 0.
pub fn radius_of_width_mm(width_mm: f64, fold_angle_rad: f64, segments: u32) -> f64 {
    let n = f64::from(segments);
    width_mm / (2.0 * n * (fold_angle_rad.abs() / (2.0 * n)).sin())
}

/// The softness of a crease on a board.
///
/// The sign that tells valleys from mountains is that of the fold angle at the place; on a crease with none it
/// is that of the role. Sharp places (radius 0) stay sharp except with [`Compensation::PerPoint`].
///
/// # Errors
/// A board that is none, or whose thickness takes more than a radius; bands of constant width without a
/// number of strips.
pub fn compensated(
    softness: &CreaseSoftness,
    role: Role,
    board: &Board,
    mode: Compensation,
) -> Result<Compensated, Fault> {
    board.check()?;
    let t = board.thickness_mm;
    let kept =
        |softness| Compensated { tight_mm: tight_places(&softness, board), softness, raised_mm: vec![] };
    match mode {
        Compensation::None => Ok(kept(softness.clone())),
        Compensation::OneSided => with_radii(softness, role, t, one_sided_radius_mm).map(kept),
        Compensation::Equal => with_radii(softness, role, t, equal_radius_mm).map(kept),
        Compensation::PerPoint { width_mm } => per_point(softness, board, width_mm),
    }
}

/// Places of the radius' list that are below what the board bears.
fn tight_places(softness: &CreaseSoftness, board: &Board) -> Vec<f64> {
    let least = board.smallest_radius_mm();
    match &softness.radius_mm {
        Along::Constant(r) => {
            if *r < least {
                vec![0.0]
            } else {
                Vec::new()
            }
        }
        Along::Places(p) => p.iter().filter(|(_, r)| *r < least).map(|(s, _)| *s).collect(),
    }
}

/// A softness whose radii answer to the sign of the fold angle where they are.
fn with_radii(
    softness: &CreaseSoftness,
    role: Role,
    thickness_mm: f64,
    answer: fn(f64, f64, f64) -> f64,
) -> Result<CreaseSoftness, Fault> {
    let changed = |r: f64, sign: f64| match answer(r, sign, thickness_mm) {
        _ if r == 0.0 => Ok(0.0),
        changed if changed >= 0.0 || r.is_nan() || r < 0.0 => Ok(changed),
        _ => Err(Fault::Board { why: BoardFault::Thickness { radius_mm: r, thickness_mm } }),
    };
    let pieces = pieces_of_one_sign(&softness.fold_angle_rad);
    let sign = |angle: f64| if angle == 0.0 || angle.is_nan() { role.sign() } else { angle.signum() };
    let signs: Vec<f64> = softness.fold_angle_rad.values().into_iter().map(sign).collect();
    let [first, ..] = signs[..] else { return Ok(softness.clone()) };
    if signs.iter().all(|s| *s == first) {
        let radius_mm = match &softness.radius_mm {
            Along::Constant(r) => Along::Constant(changed(*r, first)?),
            Along::Places(p) => Along::Places(
                p.iter().map(|&(s, r)| Ok((s, changed(r, first)?))).collect::<Result<_, Fault>>()?,
            ),
        };
        return Ok(CreaseSoftness { radius_mm, ..softness.clone() });
    }
    let mut places: Vec<(f64, f64)> = Vec::new();
    for [a, b] in pieces {
        let sign = sign(if a.1 == 0.0 { b.1 } else { a.1 });
        let inset = JUMP_SHARE * (b.0 - a.0);
        for s in places_inside(&softness.radius_mm, [a.0, b.0], inset) {
            places.push((s, changed(softness.radius_mm.at(s, ANY_EXTENT), sign)?));
        }
    }
    Ok(CreaseSoftness { radius_mm: Along::Places(places), ..softness.clone() })
}

/// Ends of a piece, drawn in a little, and the places of a list between them.
fn places_inside(list: &Along, [a, b]: [f64; 2], inset: f64) -> Vec<f64> {
    let own = match list {
        Along::Constant(_) => &[][..],
        Along::Places(p) => p,
    };
    let between = own.iter().map(|p| p.0).filter(|s| *s > a + 2.0 * inset && *s < b - 2.0 * inset);
    [a + inset].into_iter().chain(between).chain([b - inset]).collect()
}

/// The pieces of a list of fold angles (place and angle of both ends), cut where the sign changes.
fn pieces_of_one_sign(angle: &Along) -> Vec<[(f64, f64); 2]> {
    let Along::Places(places) = angle else { return Vec::new() };
    let mut pieces = Vec::new();
    for w in places.windows(2) {
        let (a, b) = (w[0], w[1]);
        if a.1 * b.1 < 0.0 {
            let zero = (a.0 + a.1 / (a.1 - b.1) * (b.0 - a.0), 0.0);
            pieces.extend([[a, zero], [zero, b]]);
        } else {
            pieces.push([a, b]);
        }
    }
    pieces
}

/// Bands of constant width.
fn per_point(softness: &CreaseSoftness, board: &Board, width_mm: f64) -> Result<Compensated, Fault> {
    let Segments::Count(n) = softness.segments else {
        return Err(Fault::Board { why: BoardFault::Width });
    };
    if !(width_mm > 0.0 && width_mm.is_finite() && n > 0) {
        return Err(Fault::Board { why: BoardFault::Width });
    }
    let wanted = |angle: f64| radius_of_width_mm(width_mm, angle.abs().max(LEAST_ANGLE_RAD), n);
    let least = board.smallest_radius_mm();
    let mut raised_mm = Vec::new();
    let mut radius = |s: f64, angle: f64| {
        if wanted(angle) < least {
            raised_mm.push(s);
        }
        wanted(angle).max(least)
    };
    let radius_mm = match &softness.fold_angle_rad {
        Along::Constant(angle) => Along::Constant(radius(0.0, *angle)),
        angles => Along::Places(angle_steps(angles).into_iter().map(|(s, a)| (s, radius(s, a))).collect()),
    };
    let softness = CreaseSoftness { radius_mm, ..softness.clone() };
    Ok(Compensated { softness, raised_mm, tight_mm: Vec::new() })
}

/// Places at which a fold angle has grown or shrunk by [`ANGLE_STEP`], with the angle.
fn angle_steps(angles: &Along) -> Vec<(f64, f64)> {
    let Along::Places(places) = angles else { return Vec::new() };
    let mut steps: Vec<(f64, f64)> = places.first().copied().into_iter().collect();
    for [a, b] in pieces_of_one_sign(angles) {
        let [x, y] = [a.1.abs(), b.1.abs()].map(|v| v.max(LEAST_ANGLE_RAD));
        let count = ((y / x).ln().abs() / ANGLE_STEP.ln()).ceil() as usize;
        let mut inner: Vec<(f64, f64)> = Vec::new();
        for k in 0..=count {
            let level = x * (y / x).powf(k as f64 / count.max(1) as f64) * (a.1 + b.1).signum();
            let share = (level - a.1) / (b.1 - a.1);
            if share > JUMP_SHARE && share < 1.0 - JUMP_SHARE {
                inner.push((a.0 + share * (b.0 - a.0), level));
            }
        }
        steps.extend(inner);
        steps.push(b);
    }
    steps
}
