//! Strokes to a pattern: what was drawn becomes a planar graph of curves, in which the outline, the holes, the slits
//! and the creases are found.
//!
//! | module | what it does |
//! |---|---|
//! | `clean` | strokes to segments of some length |
//! | `split`, `cluster`, `merge` | the planar graph: crossings, touches, ends that meet, repeated lines |
//! | `overlaps` | says which lines lie on each other |
//! | `gaps` | mends ends that miss or overshoot their aim by little |
//! | `contour`, `outline`, `open`, `hull` | the contour that is the sheet's outline |
//! | `sheet`, `region` | holes, slits, and what is on the sheet |
//! | `offsheet` | what is not |
//! | `creases`, `stretch` | runs of edges as creases |
//! | `model`, `segment`, `told` | the graph itself, single curves, and what is said |
//!
//! Geometry is computed in an order of its own, so that it does not depend on the order of the file; elements are
//! named and told in the order of the file.

mod clean;
mod cluster;
mod contour;
mod creases;
mod gaps;
mod hull;
mod merge;
mod model;
mod offsheet;
mod open;
mod outline;
mod overlaps;
mod region;
mod segment;
mod sheet;
mod split;
mod stretch;
mod told;

use crate::drawing::Stroke;
use crate::error::{Place, issue};
use crate::{PatternError, ReadOptions};
use model::{Drawing, Graph, Half};
use sheet::{Sheet, Where};
use softfold_geometry::{CreasePattern, Issue, PlanarCurve, Severity, Tolerance};
use told::Told;

/// The pattern that strokes make.
///
/// # Errors
/// No outline, or one that is open or crosses itself; creases that leave the sheet; coordinates out of range and
/// drawings beyond all measure. All that is found is among the issues.
pub(crate) fn pattern(
    strokes: Vec<Stroke>,
    name: &str,
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> Result<CreasePattern, PatternError> {
    clean::refuse(&strokes)?;
    let mut told = Told::new(issues);
    let tolerance = tolerances(&strokes, options, &mut told);
    let drawing = clean::drawing(&strokes, &tolerance, &mut told)?;
    let mut graph = arranged(&drawing, &tolerance, &mut told)?;
    overlaps::tell(&drawing, &graph, &tolerance, &mut told);
    let found = outline::find(&drawing, &mut graph, options, &tolerance, &mut told)?;
    let sheet = sheet::find(&drawing, &graph, found, &tolerance, &mut told);
    offsheet::tell(&drawing, &graph, &sheet, &tolerance, &mut told);
    let creases = creases::find(&drawing, &graph, &sheet, &tolerance, &mut told)?;
    told.verdict()?;
    let stops = stops(&graph, &sheet);
    let curve = |run: &[Half]| boundary(&drawing, &graph, run, &stops);
    let closed = |run: &[Half]| curve(&started(&drawing, &graph, run));
    Ok(CreasePattern {
        name: name.to_owned(),
        outline: closed(&sheet.outline)?,
        holes: sheet.holes.iter().map(|h| closed(h)).collect::<Result<_, _>>()?,
        slits: sheet.slits.iter().map(|s| curve(s)).collect::<Result<_, _>>()?,
        creases,
    })
}

/// The planar graph of a drawing, its small gaps mended.
fn arranged(
    drawing: &Drawing<'_>,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Result<Graph, PatternError> {
    let (mut graph, joined) = split::split(drawing, clean::edges(drawing), tolerance)?;
    if joined > 0 {
        let ends = if joined == 1 { "1 end was".to_owned() } else { format!("{joined} ends were") };
        told.note(format!("{ends} moved by less than {} mm to meet others", short(tolerance.join_mm)));
    }
    gaps::mend(drawing, &mut graph, tolerance, told)?;
    Ok(graph)
}

/// The user's tolerances, or those of the size of the sheet; both are told.
fn tolerances(strokes: &[Stroke], options: &ReadOptions, told: &mut Told<'_>) -> Tolerance {
    let own = Tolerance::for_size(clean::size_mm(strokes));
    let positive =
        |given: Option<f64>, usual: f64| given.filter(|g| g.is_finite() && *g > 0.0).unwrap_or(usual);
    let join_mm = positive(options.join_mm, own.join_mm).max(own.point_mm);
    let refuse_mm = positive(options.refuse_mm, own.refuse_mm.max(join_mm)).max(join_mm);
    let [join, refuse] = [join_mm, refuse_mm].map(short);
    told.note(format!("ends closer than {join} mm are one point, gaps up to {refuse} mm are closed"));
    Tolerance { join_mm, refuse_mm, ..own }
}

/// A length with the digits that matter.
fn short(mm: f64) -> String {
    /// Digits that tell one tolerance from another.
    const DIGITS: i32 = 3;
    let decimals = DIGITS - mm.abs().max(f64::MIN_POSITIVE).log10().ceil() as i32;
    softfold_geometry::text::number(mm, usize::try_from(decimals).unwrap_or(0))
}

/// A closed run from where its first element starts.
fn started(drawing: &Drawing<'_>, graph: &Graph, run: &[Half]) -> Vec<Half> {
    let mut run = run.to_vec();
    let source = |h: &Half| drawing.primary(&graph.edges[h.edge()]).map(|s| (s.subpath, s.begin()));
    let order = |a: &usize, b: &usize| {
        source(&run[*a]).partial_cmp(&source(&run[*b])).unwrap_or(std::cmp::Ordering::Equal)
    };
    let Some(first) = (0..run.len()).filter(|i| source(&run[*i]).is_some()).min_by(order) else { return run };
    let half = run[first];
    let backwards = drawing.primary(&graph.edges[half.edge()]).is_some_and(|s| s.range[0] > s.range[1]);
    // A loop that runs against its element ends with the element's first edge.
    let against = backwards != (half.side() == 1);
    let start = (first + usize::from(against)) % run.len();
    run.rotate_left(start);
    run
}

/// Nodes where more than one line of the sheet passes.
fn stops(graph: &Graph, sheet: &Sheet) -> Vec<bool> {
    let there = |h: &&Half| matches!(sheet.places[h.edge()], Where::Rim | Where::Inside);
    graph.leaving().iter().map(|halves| halves.iter().filter(there).count() != 2).collect()
}

/// Outline, holes and slits keep their nodes, where creases end.
fn boundary(
    drawing: &Drawing<'_>,
    graph: &Graph,
    run: &[Half],
    stops: &[bool],
) -> Result<PlanarCurve, PatternError> {
    PlanarCurve::new(stretch::boundary(graph, run, stops)).map_err(|e| {
        let found = issue(Severity::Error, e.to_string(), "redraw the element");
        PatternError::Outline(found.of(&outline::contour_origin(drawing, graph, run)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Origin;
    use softfold_geometry::{Role, Segment};

    fn stroke(role: Role, pieces: Vec<Vec<Segment>>) -> Stroke {
        let origin = Origin { label: "line 1".to_owned(), id: None, line: Some(7) };
        Stroke { role, fold_angle_rad: None, origin, pieces }
    }

    fn line(from: [f64; 2], to: [f64; 2]) -> Segment {
        Segment::Line { from: from.into(), to: to.into() }
    }

    fn made(strokes: Vec<Stroke>) -> (Result<CreasePattern, PatternError>, Vec<Issue>) {
        let mut issues = Vec::new();
        let made = pattern(strokes, "t", &ReadOptions::default(), &mut issues);
        (made, issues)
    }

    #[test]
    fn coordinates_that_are_no_numbers_are_refused_with_their_element() {
        for bad in [f64::NAN, f64::INFINITY, 1e12] {
            let (made, _) = made(vec![stroke(Role::Mountain, vec![vec![line([0.0, 0.0], [bad, 1.0])]])]);
            let error = made.unwrap_err();
            assert!(matches!(error, PatternError::Number(_)), "{error}");
            assert_eq!((error.issue().element.as_deref(), error.issue().line), (Some("line 1"), Some(7)));
        }
    }

    #[test]
    fn drawings_of_too_many_segments_are_refused() {
        let many = vec![line([0.0, 0.0], [1.0, 0.0]); 200_001];
        let (made, _) = made(vec![stroke(Role::Mountain, vec![many])]);
        assert!(matches!(made.unwrap_err(), PatternError::TooMuch(_)));
    }

    #[test]
    fn nothing_is_an_outline_that_is_missing_not_a_panic() {
        let dot = vec![line([1.0, 1.0], [1.0, 1.0])];
        for strokes in [vec![], vec![stroke(Role::Boundary, vec![dot])], vec![stroke(Role::Flat, vec![])]] {
            assert!(matches!(made(strokes).0, Err(PatternError::Outline(_))));
        }
    }

    #[test]
    fn twenty_thousand_lines_are_a_pattern() {
        let corners = [[0.0, 0.0], [700.0, 0.0], [700.0, 700.0], [0.0, 700.0], [0.0, 0.0]];
        let outline = corners.windows(2).map(|w| line(w[0], w[1])).collect();
        let mut strokes = vec![stroke(Role::Boundary, vec![outline])];
        for k in 1..70 {
            let at = 10.0 * f64::from(k);
            strokes.push(stroke(Role::Mountain, vec![vec![line([at, 0.0], [at, 700.0])]]));
            strokes.push(stroke(Role::Valley, vec![vec![line([0.0, at], [700.0, at])]]));
            strokes.push(stroke(Role::Valley, vec![vec![line([at, 0.0], [0.0, at])]]));
        }
        let (made, issues) = made(strokes);
        let pattern = made.unwrap();
        pattern.check().unwrap();
        // The diagonals pass through crossings of the grid, and start where its lines do.
        assert_eq!(pattern.junctions().len(), 69 * 69 + 2 * 69);
        assert_eq!(pattern.creases.len(), 2 * 69 * 70 + 69 * 70 / 2);
        assert_eq!(issues.iter().filter(|i| i.severity > Severity::Note).count(), 0);
    }

    #[test]
    fn tolerances_are_short_in_words() {
        for (mm, text) in
            [(0.002, "0.002"), (2.0, "2"), (16.0, "16"), (0.00105833, "0.00106"), (1234.6, "1235")]
        {
            assert_eq!(short(mm), text);
        }
    }
}
