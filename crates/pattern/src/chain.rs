//! Joining pieces end to end into chains.

use crate::error::{Origin, Place, issue};
use softfold_geometry::{DVec2, Issue, Segment, Severity};

/// A gap may be closed within one chain only if the chain is so many times longer: a short stroke
/// is not bent into a loop.
const LOOP_LENGTH_PER_GAP: f64 = 4.0;

/// A run of segments from one element.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) segments: Vec<Segment>,
    pub(crate) origin: Origin,
}

/// Pieces joined end to end.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    pub(crate) segments: Vec<Segment>,
    /// Elements in the order of the chain.
    pub(crate) origins: Vec<Origin>,
    pub(crate) closed: bool,
}

impl Piece {
    /// Start (side 0) or end (side 1).
    pub(crate) fn end(&self, side: usize) -> DVec2 {
        match side {
            0 => self.segments[0].from(),
            _ => self.segments[self.segments.len() - 1].to(),
        }
    }

    fn length_mm(&self) -> f64 {
        self.segments.iter().map(|s| s.from().distance(s.to())).sum()
    }

    fn run(&self, backwards: bool) -> Vec<Segment> {
        match backwards {
            false => self.segments.clone(),
            true => self.segments.iter().rev().map(Segment::reversed).collect(),
        }
    }
}

impl Chain {
    /// First and last point.
    pub(crate) fn ends(&self) -> [DVec2; 2] {
        [self.segments[0].from(), self.segments[self.segments.len() - 1].to()]
    }
}

/// Two ends and the gap between them.
#[derive(Clone, Copy)]
struct Pair {
    gap: f64,
    ends: [usize; 2],
}

/// Joins the nearest ends first, each end once, as long as the gap is at most `refuse_mm`. Gaps up
/// to `join_mm` are closed by moving an end; larger ones by a straight piece, and told.
pub(crate) fn join(
    pieces: &[Piece],
    join_mm: f64,
    refuse_mm: f64,
    what: &str,
    issues: &mut Vec<Issue>,
) -> Vec<Chain> {
    run(pieces, &mates(pieces, refuse_mm), join_mm, what, issues)
}

/// Chains of pieces whose ends are mated (ends numbered 2·piece for the start, 2·piece + 1 for the
/// end; mates are mutual).
pub(crate) fn run(
    pieces: &[Piece],
    mates: &[Option<usize>],
    join_mm: f64,
    what: &str,
    issues: &mut Vec<Issue>,
) -> Vec<Chain> {
    let mut used = vec![false; pieces.len()];
    let mut chains = Vec::new();
    // Open chains begin at ends without a mate; what is left are loops.
    let open = (0..2 * pieces.len()).filter(|&e| mates[e].is_none());
    for end in open.chain((0..pieces.len()).map(|i| 2 * i)) {
        if !used[end / 2] {
            chains.push(walk(pieces, mates, end, &mut used, join_mm, what, issues));
        }
    }
    chains
}

fn mates(pieces: &[Piece], refuse_mm: f64) -> Vec<Option<usize>> {
    let ends: Vec<DVec2> = pieces.iter().flat_map(|p| [p.end(0), p.end(1)]).collect();
    let mut pairs = Vec::new();
    for a in 0..ends.len() {
        for b in a + 1..ends.len() {
            let gap = ends[a].distance(ends[b]);
            if gap <= refuse_mm {
                pairs.push(Pair { gap, ends: [a, b] });
            }
        }
    }
    pairs.sort_by(|p, q| p.gap.total_cmp(&q.gap).then(p.ends.cmp(&q.ends)));
    let mut groups = Groups::new(pieces);
    let mut mates = vec![None; ends.len()];
    for Pair { gap, ends: [a, b] } in pairs {
        if mates[a].is_none() && mates[b].is_none() && groups.unite(a / 2, b / 2, gap) {
            (mates[a], mates[b]) = (Some(b), Some(a));
        }
    }
    mates
}

/// Which pieces hang together so far, and how long each chain is.
struct Groups {
    parent: Vec<usize>,
    length_mm: Vec<f64>,
}

impl Groups {
    fn new(pieces: &[Piece]) -> Self {
        Self { parent: (0..pieces.len()).collect(), length_mm: pieces.iter().map(Piece::length_mm).collect() }
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    /// Unites two pieces; false if that would bend a chain onto itself over too wide a gap.
    fn unite(&mut self, a: usize, b: usize, gap: f64) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        if a == b {
            return self.length_mm[a] > LOOP_LENGTH_PER_GAP * gap;
        }
        self.parent[b] = a;
        self.length_mm[a] += self.length_mm[b];
        true
    }
}

fn walk(
    pieces: &[Piece],
    mates: &[Option<usize>],
    start: usize,
    used: &mut [bool],
    join_mm: f64,
    what: &str,
    issues: &mut Vec<Issue>,
) -> Chain {
    let mut chain = Chain { segments: Vec::new(), origins: Vec::new(), closed: false };
    let mut end = start;
    loop {
        let (piece, backwards) = (end / 2, end % 2 == 1);
        used[piece] = true;
        let origin = pieces[piece].origin.clone();
        link(&mut chain, pieces[piece].run(backwards), &origin, join_mm, what, issues);
        chain.origins.push(origin);
        let Some(next) = mates[end ^ 1] else { return chain };
        if next == start {
            close(&mut chain, join_mm, what, issues);
            return chain;
        }
        end = next;
    }
}

/// Appends a run of segments.
fn link(
    chain: &mut Chain,
    mut run: Vec<Segment>,
    origin: &Origin,
    join_mm: f64,
    what: &str,
    issues: &mut Vec<Issue>,
) {
    if let (Some(last), Some(before)) = (chain.segments.last().copied(), chain.origins.last()) {
        let gap = last.to().distance(run[0].from());
        if gap > join_mm {
            told(what, [before, origin], gap, last.to(), issues);
            chain.segments.push(Segment::Line { from: last.to(), to: run[0].from() });
        } else {
            run[0] = with_start(run[0], last.to());
        }
    }
    chain.segments.append(&mut run);
}

fn close(chain: &mut Chain, join_mm: f64, what: &str, issues: &mut Vec<Issue>) {
    chain.closed = true;
    let [start, end] = chain.ends();
    let gap = start.distance(end);
    let last = chain.segments.len() - 1;
    if gap > join_mm {
        told(what, [&chain.origins[chain.origins.len() - 1], &chain.origins[0]], gap, end, issues);
        chain.segments.push(Segment::Line { from: end, to: start });
    } else {
        chain.segments[last] = with_end(chain.segments[last], start);
    }
}

fn told(what: &str, [a, b]: [&Origin; 2], gap: f64, at: DVec2, issues: &mut Vec<Issue>) {
    let message =
        format!("the {what} has a gap of {gap:.3} mm between {a} and {b}; a straight piece closes it");
    let mend = "make the ends meet";
    issues.push(issue(Severity::Warning, message, mend).of(a).at(at));
}

/// The segment with its start moved, its direction there kept.
pub(crate) fn with_start(segment: Segment, start: DVec2) -> Segment {
    match segment {
        Segment::Line { to, .. } => Segment::Line { from: start, to },
        Segment::Cubic { from, c1, c2, to } => {
            Segment::Cubic { from: start, c1: c1 + (start - from), c2, to }
        }
    }
}

/// The segment with its end moved.
pub(crate) fn with_end(segment: Segment, end: DVec2) -> Segment {
    with_start(segment.reversed(), end).reversed()
}
