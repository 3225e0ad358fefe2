//! A graph whose constraints know the curves that they follow.

use crate::cdt::{Constraint, PlanarGraph};
use crate::tracks::{Span, Track};
use softfold_geometry::{LoopId, Site, VertexId};

/// Points, and constraints that know the parts of curves that they stand for.
pub(crate) struct Planar<'a> {
    pub(crate) graph: PlanarGraph,
    pub(crate) sites: Vec<Site>,
    /// One a constraint.
    pub(crate) spans: Vec<Span>,
    pub(crate) tracks: Vec<Track<'a>>,
}

impl Planar<'_> {
    /// Splits a constraint where its curve is at a length; the new constraint comes last, and leads on from there.
    pub(crate) fn split(&mut self, constraint: usize, at_mm: f64) {
        let [before, after] = self.spans[constraint].split(at_mm);
        let track = &self.tracks[before.track as usize];
        let new = VertexId::new(self.graph.points.len());
        self.graph.points.push(track.point(at_mm));
        let (edge, what) = self.graph.constraints[constraint];
        self.sites.push(self.site(before.track, at_mm, &what));
        self.graph.constraints[constraint].0 = [edge[0], new];
        self.graph.constraints.push(([new, edge[1]], what));
        self.spans[constraint] = before;
        self.spans.push(after);
        self.turn(constraint);
        self.turn(self.spans.len() - 1);
    }

    /// Where a vertex on a track sits.
    pub(crate) fn site(&self, track: u32, s_mm: f64, constraint: &Constraint) -> Site {
        let on_boundary = self.tracks[track as usize].on_boundary_mm(s_mm);
        match (*constraint, on_boundary) {
            (Constraint::Fold { crease, line, .. }, _) => Site::FoldLine { crease, line },
            (_, Some(s_mm)) => Site::Boundary { loop_id: LoopId(track), s_mm },
            _ => Site::Interior,
        }
    }

    /// A piece of a fold line turns by the mean of what its ends do.
    pub(crate) fn turn(&mut self, constraint: usize) {
        let span = self.spans[constraint];
        let track = &self.tracks[span.track as usize];
        let turns = [span.from_mm, span.to_mm].map(|s| track.turn_rad(s));
        if let (Constraint::Fold { turn_rad, .. }, [Some(a), Some(b)]) =
            (&mut self.graph.constraints[constraint].1, turns)
        {
            *turn_rad = 0.5 * (a + b);
        }
    }
}
