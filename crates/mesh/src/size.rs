//! The sizing field: small triangles at bands and where lines come close, growing away from them.

use crate::rows::rows;
use crate::stretch::{Stretch, stretches};
use crate::{MeshOptions, gaps};
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use softfold_geometry::{LineEnd, SoftPattern};

/// A place with the edge length wished for there, mm.
pub(crate) type Source = GeomWithData<[f64; 2], f64>;

/// Wished edge length over the sheet: the least over all sources of their length and what it has grown by until here.
pub(crate) struct SizeField {
    target_mm: f64,
    growth: Growth,
    /// Sources of like length together, short ones first.
    classes: Vec<Class>,
}

/// How edges get longer away from a source.
struct Growth {
    /// Up to this length they grow faster.
    knee_mm: f64,
    faster: f64,
    slower: f64,
}

impl Growth {
    fn new(options: &MeshOptions) -> Self {
        let slower = options.grading;
        let faster = (FASTER * slower).min(FASTEST).max(slower);
        Self { knee_mm: SMALL * options.target_edge_mm, faster, slower }
    }

    /// Length at a distance from a source; it rises with both.
    fn grown_mm(&self, length_mm: f64, distance_mm: f64) -> f64 {
        let to_knee = ((self.knee_mm - length_mm) / self.faster).clamp(0.0, distance_mm);
        length_mm + self.faster * to_knee + self.slower * (distance_mm - to_knee)
    }
}

struct Class {
    least_mm: f64,
    most_mm: f64,
    sources: RTree<Source>,
}

/// Lengths of one class differ by less than this factor: the wider, the farther a look-up must search past the
/// nearest source.
const CLASS_RATIO: f64 = 1.25;

/// Below this share of the target, edges grow faster: by so many times the grading, and by no more than so much per mm.
/// Around a small feature the vertices are as many as the inverse square of the growth, wherever it starts.
const SMALL: f64 = 0.125;
const FASTER: f64 = 1.6;
const FASTEST: f64 = 0.4;

/// Shortest over longest length below which a field is steep.
const STEEP: f64 = 0.25;

impl SizeField {
    pub(crate) fn new(soft: &SoftPattern, options: &MeshOptions, pieces: &[gaps::Piece]) -> Self {
        let mut sources = gaps::sources(pieces, options.target_edge_mm);
        for stretch in soft.bands.iter().flat_map(stretches).filter(|s| !s.is_sharp()) {
            band_sources(&stretch, options, &mut sources);
        }
        let sizes = Self::from_sources(sources.clone(), options);
        let ends = row_ends(soft, options, &sizes);
        if ends.is_empty() {
            return sizes;
        }
        sources.extend(ends);
        Self::from_sources(sources, options)
    }

    /// The target's length everywhere.
    pub(crate) fn uniform(options: &MeshOptions) -> Self {
        Self::from_sources(Vec::new(), options)
    }

    /// From the lengths asked for at places; those beyond the target are none.
    pub(crate) fn from_sources(mut sources: Vec<Source>, options: &MeshOptions) -> Self {
        sources.retain(|s| s.data < options.target_edge_mm);
        sources.sort_by(|a, b| a.data.total_cmp(&b.data));
        let mut classes = Vec::new();
        while let Some(least_mm) = sources.first().map(|s| s.data) {
            let rest = sources.split_off(sources.partition_point(|s| s.data <= CLASS_RATIO * least_mm));
            let most_mm = sources.last().map_or(least_mm, |s| s.data);
            classes.push(Class { least_mm, most_mm, sources: RTree::bulk_load(sources) });
            sources = rest;
        }
        Self { target_mm: options.target_edge_mm, growth: Growth::new(options), classes }
    }

    /// Wished edge length at a point, mm. It grows by no more than [`Self::fastest`] per mm.
    pub(crate) fn at(&self, p: DVec2) -> f64 {
        self.below(p, self.target_mm)
    }

    /// No more than the least wished edge length within a distance, mm, and no less than the least of all.
    pub(crate) fn least_within(&self, p: DVec2, distance_mm: f64) -> f64 {
        let change_mm = self.growth.faster * distance_mm;
        let least = self.below(p, self.target_mm + change_mm) - change_mm;
        least.max(self.classes.first().map_or(self.target_mm, |c| c.least_mm))
    }

    /// Least length that any source asks for at a point, as far as it is below `size`.
    fn below(&self, p: DVec2, mut size: f64) -> f64 {
        for class in &self.classes {
            let apart_mm = class.sources.root().envelope().distance_2(&[p.x, p.y]).sqrt();
            if self.growth.grown_mm(class.least_mm, apart_mm) < size {
                size = size.min(self.within(class, p, size));
            }
        }
        size
    }

    /// Least length that a class asks for at a point, as far as it is below `size`.
    fn within(&self, class: &Class, p: DVec2, size: f64) -> f64 {
        let grown =
            |length_mm: f64, s: &Source| self.growth.grown_mm(length_mm, p.distance(DVec2::from(*s.geom())));
        let here = |s: &Source| grown(s.data, s);
        let query = [p.x, p.y];
        if class.least_mm == class.most_mm {
            return class.sources.nearest_neighbor(query).map_or(size, here);
        }
        let mut size = size;
        for s in class.sources.nearest_neighbor_iter(query) {
            if grown(class.least_mm, s) >= size {
                break;
            }
            size = size.min(here(s));
        }
        size
    }

    /// Whether lengths differ so much that points which spread evenly would leave the short ones.
    pub(crate) fn is_steep(&self) -> bool {
        self.classes.first().is_some_and(|c| c.least_mm < STEEP * self.target_mm)
    }

    /// How much longer edges may get per mm.
    pub(crate) fn fastest(&self) -> f64 {
        self.growth.faster
    }

    /// The longest edges, mm.
    pub(crate) fn target_mm(&self) -> f64 {
        self.target_mm
    }
}

/// Sources along a line are no farther apart than so many rows, so that edges grow by little between them.
const ROWS_PER_SOURCE: f64 = 2.0;

/// Rows so much shorter than the field asks for ask for short edges where they end; slanted and shifted ones are less so.
const SHORT_ROW: f64 = 0.5;

/// Ends of lines whose rows are short for the sake of another line of their stretch: what they end on must follow.
fn row_ends(soft: &SoftPattern, options: &MeshOptions, sizes: &SizeField) -> Vec<Source> {
    let mut ends = Vec::new();
    for stretch in soft.bands.iter().flat_map(stretches).filter(|s| !s.is_sharp()) {
        for line in rows(&stretch, options, sizes, 1) {
            let last = line.len() - 1;
            for (end, next) in [(line[0].0, line[1].0), (line[last].0, line[last - 1].0)] {
                let row_mm = end.distance(next);
                if row_mm < SHORT_ROW * sizes.at(end) {
                    ends.push(source(end, row_mm));
                }
            }
        }
    }
    ends
}

/// The points of the outer lines, and points between them where they are far apart.
fn band_sources(stretch: &Stretch<'_>, options: &MeshOptions, sources: &mut Vec<Source>) {
    for line in stretch.lines {
        // Along the border of a junction every line ends: short edges all along.
        for (end, i) in line.ends.iter().zip([0, line.points.len() - 1]) {
            if matches!(end, LineEnd::Junction(_)) {
                sources.push(source(line.points[i], stretch.edge_mm(line.s_mm[i], options)));
            }
        }
    }
    for line in stretch.outer_lines() {
        let edges = stretch.edges_mm(line, options);
        for i in 0..line.points.len() {
            sources.push(source(line.points[i], edges[i]));
            let Some(&next) = line.points.get(i + 1) else { break };
            let apart = line.points[i].distance(next) / edges[i].min(edges[i + 1]);
            let pieces = (apart / ROWS_PER_SOURCE).ceil() as usize;
            for k in 1..pieces {
                let t = k as f64 / pieces as f64;
                let s_mm = line.s_mm[i] + t * (line.s_mm[i + 1] - line.s_mm[i]);
                sources.push(source(line.points[i].lerp(next, t), stretch.edge_mm(s_mm, options)));
            }
        }
    }
}

pub(crate) fn source(at: DVec2, size_mm: f64) -> Source {
    GeomWithData::new([at.x, at.y], size_mm)
}
