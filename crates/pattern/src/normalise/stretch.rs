//! Runs of edges as segments.

use super::model::{Drawing, Graph, Half, Source};
use super::segment;
use softfold_geometry::{Segment, Tolerance};

/// A crease or boundary that turns by as much has a corner there, rad (45°); curves are often drawn as rows of lines
/// that turn by up to 30° from one to the next.
pub(super) const CORNER_RAD: f64 = 0.785;
/// Share of the join tolerance by which a node may lie off a curve that is mended there.
const ON_CURVE: f64 = 1e-4;

/// The segments of a run; where an edge was cut but the run goes on, the drawn segment is whole again.
pub(super) fn segments(
    drawing: &Drawing<'_>,
    graph: &Graph,
    run: &[Half],
    tolerance: &Tolerance,
) -> Vec<Segment> {
    let mut segments: Vec<Segment> = Vec::with_capacity(run.len());
    let mut before: Vec<Source> = Vec::new();
    for half in run {
        let next = graph.run(*half);
        let sources = stretches(graph, *half);
        let pairs = before.iter().flat_map(|b| sources.iter().map(move |s| (*b, *s)));
        let whole = segments.last().and_then(|last| {
            pairs.into_iter().find_map(|(b, s)| mended(drawing, [last, &next], [b, s], tolerance))
        });
        match (whole, segments.last_mut()) {
            (Some((segment, stretch)), Some(last)) => {
                *last = segment;
                before = vec![stretch];
            }
            _ => {
                segments.push(next);
                before = sources;
            }
        }
    }
    segments
}

/// The parts of drawn segments that a half stands for.
fn stretches(graph: &Graph, half: Half) -> Vec<Source> {
    let turned = |s: &Source| if half.side() == 0 { *s } else { s.reversed() };
    graph.edges[half.edge()].sources.iter().map(turned).collect()
}

/// Two parts of one drawn segment as one, if they follow each other and are still as they were drawn.
fn mended(
    drawing: &Drawing<'_>,
    parts: [&Segment; 2],
    [before, after]: [Source; 2],
    tolerance: &Tolerance,
) -> Option<(Segment, Source)> {
    let (range, joint) = ([before.range[0], after.range[1]], before.range[1]);
    let number = range[0].min(range[1]).floor();
    let within = |p: f64| (number..=number + 1.0).contains(&p);
    let one = before.subpath == after.subpath
        && joint == after.range[0]
        && (range[1] - joint) * (joint - range[0]) > 0.0
        && range.into_iter().all(within);
    let drawn = drawing.subpaths.get(before.subpath as usize)?.segments.get(number as usize)?;
    // An edge that was drawn twice may have taken the other's curve.
    let as_drawn = |part: &Segment, [from, to]: [f64; 2]| {
        [0.0, 0.5, 1.0].into_iter().all(|t| {
            let on = segment::at(drawn, from + t * (to - from) - number);
            on.distance(segment::at(part, t)) <= ON_CURVE * tolerance.join_mm
        })
    };
    if !one || !as_drawn(parts[0], before.range) || !as_drawn(parts[1], after.range) {
        return None;
    }
    let [low, high] = [range[0].min(range[1]) - number, range[0].max(range[1]) - number];
    let part = segment::part(drawn, [low, high]);
    let part = if range[0] > range[1] { part.reversed() } else { part };
    Some((segment::with_ends(part, [parts[0].from(), parts[1].to()]), Source { range, ..before }))
}

/// A run as it is, or in two if it ends where it starts.
pub(super) fn open(mut segments: Vec<Segment>) -> Vec<Vec<Segment>> {
    let (Some(first), Some(last)) = (segments.first(), segments.last()) else { return Vec::new() };
    if first.from() != last.to() {
        return vec![segments];
    }
    if let [only] = segments[..] {
        return [[0.0, 0.5], [0.5, 1.0]].map(|range| vec![segment::part(&only, range)]).into();
    }
    let lengths: Vec<f64> = segments.iter().map(segment::length).collect();
    let half = 0.5 * lengths.iter().sum::<f64>();
    let mut passed = 0.0;
    let before = lengths.iter().take_while(|l| {
        passed += **l;
        passed <= half
    });
    let middle = before.count().clamp(1, segments.len() - 1);
    let rest = segments.split_off(middle);
    vec![segments, rest]
}

/// The segments of a boundary run; a closed one starts at a corner or at one of the `stops`, where something else meets
/// it, if it has any.
pub(super) fn boundary(graph: &Graph, run: &[Half], stops: &[bool]) -> Vec<Segment> {
    let mut run = run.to_vec();
    let ends = |before: Half, next: Half| {
        let [back, on] = [before.twin(), next].map(|h| segment::leaving(&graph.run(h), 0));
        stops[graph.node(next)] || (-back).angle_to(on).abs() >= CORNER_RAD
    };
    let closed = run.first().zip(run.last()).is_some_and(|(f, l)| graph.node(*f) == graph.node(l.twin()));
    let before = |i: usize| run[(i + run.len() - 1) % run.len()];
    let first = (0..run.len()).find(|&i| closed && ends(before(i), run[i]));
    run.rotate_left(first.unwrap_or_default());
    run.iter().map(|h| graph.run(*h)).collect()
}
