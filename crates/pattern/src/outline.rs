//! The sheet: the outline and its holes from boundary pieces and closed cuts.

use crate::PatternError;
use crate::chain::{self, Chain, Piece};
use crate::document::Document;
use crate::error::{Origin, Place, issue};
use crate::polyline::{CHECK_SLACK, Polyline};
use crate::strokes::Stroke;
use softfold_geometry::{DVec2, Issue, PlanarCurve, Role, Severity, Tolerance, polygon};

/// Outline and holes, with their polylines for the checks.
pub(crate) struct Sheet {
    pub(crate) outline: PlanarCurve,
    pub(crate) holes: Vec<PlanarCurve>,
    /// Polylines of the outline and the holes, the outline first.
    pub(crate) polylines: Vec<Polyline>,
    pub(crate) tolerance: Tolerance,
}

/// A closed boundary.
struct Loop {
    curve: PlanarCurve,
    polyline: Polyline,
    origin: Origin,
}

impl Sheet {
    /// Outline and holes.
    pub(crate) fn loops(&self) -> impl Iterator<Item = &PlanarCurve> {
        std::iter::once(&self.outline).chain(&self.holes)
    }

    /// Whether a point is on the sheet: inside the outline, outside the holes.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        let inside = |l: &Polyline| l.contains(p);
        inside(&self.polylines[0]) && !self.polylines[1..].iter().any(inside)
    }

    /// Distance of a point from the boundary, to the chord tolerance of the checks.
    pub(crate) fn boundary_distance(&self, p: DVec2) -> f64 {
        self.polylines.iter().map(|l| l.distance(p)).fold(f64::INFINITY, f64::min)
    }
}

/// Finds the outline (the largest closed boundary) and the holes (the others inside it).
///
/// # Errors
/// No boundary, an open one, or one that crosses itself or a hole.
pub(crate) fn find(
    strokes: &[Stroke],
    document: &Document,
    issues: &mut Vec<Issue>,
) -> Result<Sheet, PatternError> {
    let role = match strokes.iter().any(|s| s.role == Role::Boundary) {
        true => Role::Boundary,
        false => Role::Cut, // Packaging files draw the outline as a cut.
    };
    let pieces = pieces_of(strokes, role);
    if pieces.is_empty() {
        let what = "the pattern has no outline";
        let mend = "draw a closed outline with a black stroke (#000000)";
        return Err(PatternError::Outline(issue(Severity::Error, what, mend).line(document.root_line)));
    }
    let tolerance = Tolerance::for_size(size_mm(&pieces));
    let (mut loops, open) = close_loops(&pieces, &tolerance, "outline", issues)?;
    refuse_open(&loops, &open)?;
    ignore_open(&open, "a boundary line that closes no loop", issues);
    if role == Role::Boundary {
        let cuts = pieces_of(strokes, Role::Cut);
        let (holes, slits) = close_loops(&cuts, &tolerance, "cut", issues)?;
        ignore_open(&slits, "a slit", issues);
        loops.extend(holes);
    }
    assemble(loops, issues)
}

fn pieces_of(strokes: &[Stroke], role: Role) -> Vec<Piece> {
    let of_role = strokes.iter().filter(|s| s.role == role);
    of_role
        .flat_map(|s| {
            let piece = |segments: &Vec<_>| Piece { segments: segments.clone(), origin: s.origin.clone() };
            s.pieces.iter().map(piece)
        })
        .collect()
}

fn size_mm(pieces: &[Piece]) -> f64 {
    let points: Vec<DVec2> =
        pieces.iter().flat_map(|p| &p.segments).flat_map(|s| s.control_points()).collect();
    let (low, high) = polygon::bounds(&points);
    (high - low).max_element()
}

/// Chains the pieces; closed chains become loops.
fn close_loops(
    pieces: &[Piece],
    tolerance: &Tolerance,
    what: &str,
    issues: &mut Vec<Issue>,
) -> Result<(Vec<Loop>, Vec<Chain>), PatternError> {
    let chains = chain::join(pieces, tolerance.join_mm, tolerance.refuse_mm, what, issues);
    let (closed, open): (Vec<_>, Vec<_>) = chains.into_iter().partition(|c| c.closed);
    let loops = closed.into_iter().map(|c| close_loop(c, tolerance)).collect::<Result<_, _>>()?;
    Ok((loops, open))
}

fn close_loop(chain: Chain, tolerance: &Tolerance) -> Result<Loop, PatternError> {
    let origin = chain.origins[0].clone();
    let curve = PlanarCurve::new(chain.segments).map_err(|e| {
        let mend = "redraw the element";
        PatternError::Outline(issue(Severity::Error, e.to_string(), mend).of(&origin))
    })?;
    let polyline = Polyline::new(&curve, tolerance.join_mm);
    Ok(Loop { curve, polyline, origin })
}

/// An open chain larger than every closed loop is the outline, not closed.
fn refuse_open(loops: &[Loop], open: &[Chain]) -> Result<(), PatternError> {
    let extent = |points: &[DVec2]| {
        let (low, high) = polygon::bounds(points);
        (high - low).max_element()
    };
    let largest = loops.iter().map(|l| extent(&l.polyline.points)).fold(0.0, f64::max);
    let reach = |c: &Chain| extent(&c.segments.iter().flat_map(|s| s.control_points()).collect::<Vec<_>>());
    let Some(widest) = open.iter().max_by(|a, b| reach(a).total_cmp(&reach(b))) else { return Ok(()) };
    if reach(widest) <= largest {
        return Ok(());
    }
    let [start, end] = widest.ends();
    let (first, last) = (&widest.origins[0], &widest.origins[widest.origins.len() - 1]);
    let what = format!(
        "the outline is open: it starts at ({:.3}, {:.3}) in {first} and ends at ({:.3}, {:.3}) in {last}, a gap of {:.3} mm",
        start.x,
        start.y,
        end.x,
        end.y,
        start.distance(end)
    );
    let mend = "close the path, or make these two ends meet";
    Err(PatternError::Outline(issue(Severity::Error, what, mend).of(last).at(end)))
}

fn ignore_open(open: &[Chain], what: &str, issues: &mut Vec<Issue>) {
    for chain in open {
        let message = format!("{what} is ignored");
        let mend = "close it to make a hole, or delete it";
        issues.push(issue(Severity::Warning, message, mend).of(&chain.origins[0]).at(chain.ends()[0]));
    }
}

/// Sorts the loops into the outline and its holes.
fn assemble(mut loops: Vec<Loop>, issues: &mut Vec<Issue>) -> Result<Sheet, PatternError> {
    let area = |l: &Loop| l.curve.signed_area_mm2().abs();
    let outer = (0..loops.len())
        .fold(None, |best: Option<usize>, i| match best {
            Some(b) if area(&loops[b]) >= area(&loops[i]) => Some(b),
            _ => Some(i),
        })
        .unwrap_or_default();
    let outline = loops.remove(outer);
    let size = polygon::bounds(&outline.polyline.points);
    let tolerance = Tolerance::for_size((size.1 - size.0).max_element());
    refuse_self_crossing(&outline)?;
    let mut holes: Vec<Loop> = Vec::new();
    for hole in loops {
        if is_hole(&hole, &outline, &holes, &tolerance, issues)? {
            refuse_self_crossing(&hole)?;
            holes.push(hole);
        }
    }
    let polylines = std::iter::once(&outline).chain(&holes).map(|l| l.polyline.clone()).collect();
    let turned = |c: PlanarCurve, sign: f64| if c.signed_area_mm2() * sign < 0.0 { c.reversed() } else { c };
    let holes = holes.into_iter().map(|h| turned(h.curve, -1.0)).collect();
    Ok(Sheet { outline: turned(outline.curve, 1.0), holes, polylines, tolerance })
}

/// Whether a loop is a hole of the sheet; loops outside, inside a hole, or drawn twice are ignored
/// and told.
fn is_hole(
    hole: &Loop,
    outline: &Loop,
    holes: &[Loop],
    tolerance: &Tolerance,
    issues: &mut Vec<Issue>,
) -> Result<bool, PatternError> {
    let mut ignore = |why: &str| {
        let message = format!("a closed boundary {why} is ignored");
        let at = hole.polyline.points[0];
        issues
            .push(issue(Severity::Warning, message, "delete it if it is not meant").of(&hole.origin).at(at));
    };
    for other in std::iter::once(outline).chain(holes) {
        let drawn_twice = hole
            .polyline
            .points
            .iter()
            .all(|&p| other.polyline.distance(p) <= CHECK_SLACK * tolerance.join_mm);
        if drawn_twice {
            ignore("that is drawn twice");
            return Ok(false);
        }
        if let Some(c) = hole.polyline.crossings(&other.polyline).first() {
            let what = format!("it crosses the boundary {}", other.origin);
            let mend = "keep outline and holes apart";
            return Err(PatternError::Outline(issue(Severity::Error, what, mend).of(&hole.origin).at(c.at)));
        }
    }
    let start = hole.polyline.points[0];
    if !outline.polyline.contains(start) {
        ignore("outside the sheet");
        return Ok(false);
    }
    if holes.iter().any(|h| h.polyline.contains(start)) {
        ignore("inside a hole");
        return Ok(false);
    }
    Ok(true)
}

fn refuse_self_crossing(l: &Loop) -> Result<(), PatternError> {
    match l.polyline.self_crossing() {
        None => Ok(()),
        Some(at) => {
            let mend = "redraw it without the crossing";
            let what = "the boundary crosses itself";
            Err(PatternError::Outline(issue(Severity::Error, what, mend).of(&l.origin).at(at)))
        }
    }
}
