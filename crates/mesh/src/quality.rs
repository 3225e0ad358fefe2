//! How good a mesh is: its angles, what the pattern itself makes sharp, and how near edges are to their curves.

use crate::draft::Draft;
use crate::planar::Planar;
use crate::refine::BAR_DEG;
use crate::sharp::{Excuse, Sharp};
use crate::tracks::Curve;
use crate::triangle::least_tangent;
use glam::DVec2;
use softfold_geometry::{FlatMesh, TriangleId};
use std::collections::BTreeMap;
use std::fmt;

/// Angles of a mesh, or of a part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Smallest angle, degrees.
    pub min_angle_deg: f64,
    /// Median over the triangles of their smallest angle, degrees.
    pub median_min_angle_deg: f64,
}

/// Measures a mesh; zeros if it has no triangle.
pub fn quality(mesh: &FlatMesh) -> Quality {
    let smallest = |t: usize| mesh.angles_rad(TriangleId::new(t)).into_iter().fold(f64::MAX, f64::min);
    let mut tangents: Vec<f64> = (0..mesh.triangles.len()).map(|t| smallest(t).tan()).collect();
    Quality::of(&mut tangents)
}

impl Quality {
    /// Of the tangents of smallest angles.
    fn of(tangents: &mut [f64]) -> Self {
        let least = tangents.iter().copied().fold(f64::MAX, f64::min);
        let Some(median) = median(tangents) else {
            return Self { min_angle_deg: 0.0, median_min_angle_deg: 0.0 };
        };
        let [min_angle_deg, median_min_angle_deg] = [least, median].map(|t| t.atan().to_degrees());
        Self { min_angle_deg, median_min_angle_deg }
    }
}

/// The median, the upper one of an even number; none of nothing. Changes the order.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// What a mesh is like, held against what its pattern allows.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// All triangles.
    pub all: Quality,
    /// Triangles but for those at [`Inspection::places`].
    pub free: Quality,
    /// Triangles below 20° among them: the mesher's own fault.
    pub small: usize,
    /// The smallest of those, degrees, with their places, worst first; ten at most.
    pub worst: Vec<(f64, DVec2)>,
    /// Triangles that lie at [`Inspection::places`].
    pub excused: usize,
    /// Where the pattern itself leaves no room for larger angles.
    pub places: Vec<SharpPlace>,
    /// Largest distance of a fold line from its edges, mm.
    pub fold_chord_mm: f64,
    /// Largest distance of outline, holes and slits from their edges, mm.
    pub boundary_chord_mm: f64,
}

/// A place that the pattern itself makes sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharpPlace {
    /// Where, (u, v) in mm: the corner, or where the gap is smallest among the triangles in it.
    pub at: DVec2,
    /// The two curves; one twice where it is a short piece, or a corner, of a single curve.
    pub curves: [Curve; 2],
    /// What they do.
    pub kind: Sharpness,
    /// Triangles that lie in it.
    pub triangles: usize,
}

/// Why no mesh has large angles at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sharpness {
    /// Two curves meet at a small angle, degrees.
    Corner {
        /// The angle between them.
        angle_deg: f64,
    },
    /// Two curves all but touch.
    Gap {
        /// Smallest distance, mm.
        gap_mm: f64,
    },
}

/// Most triangles that are named.
const WORST: usize = 10;

/// Inspects a mesh.
pub(crate) fn inspect(draft: &Draft<'_>) -> Inspection {
    let Draft { planar, sharp, .. } = draft;
    let mut places = Places { planar, sharp, corners: BTreeMap::new(), gaps: BTreeMap::new() };
    let bar = BAR_DEG.to_radians().tan();
    let count = draft.net.corners.len();
    let (mut free, mut excused, mut worst) = (Vec::with_capacity(count), Vec::new(), Vec::new());
    for t in 0..count {
        let corners = draft.places(t);
        let tangent = least_tangent(corners);
        match sharp.excuse(planar, &draft.net, t) {
            Some(excuse) => {
                excused.push(tangent);
                places.add(excuse);
            }
            None => {
                free.push(tangent);
                if tangent < bar {
                    let angle_deg = tangent.atan().to_degrees();
                    worst.push((angle_deg, (corners[0] + corners[1] + corners[2]) / 3.0));
                }
            }
        }
    }
    worst.sort_by(|a, b| a.0.total_cmp(&b.0));
    let small = worst.len();
    worst.truncate(WORST);
    let quality_of_free = Quality::of(&mut free);
    let all = if excused.is_empty() {
        quality_of_free
    } else {
        free.extend(&excused);
        Quality::of(&mut free)
    };
    let [fold_chord_mm, boundary_chord_mm] = chords_mm(planar);
    Inspection {
        excused: excused.len(),
        all,
        free: quality_of_free,
        small,
        worst,
        places: places.listed(),
        fold_chord_mm,
        boundary_chord_mm,
    }
}

fn chords_mm(planar: &Planar<'_>) -> [f64; 2] {
    let mut chords = [0.0_f64; 2];
    for ((edge, _), span) in planar.graph.constraints.iter().zip(&planar.spans) {
        let track = &planar.tracks[span.track as usize];
        let (error, _) = track.chord_error_mm(span, edge.map(|v| planar.graph.points[v.index()]));
        let which = usize::from(matches!(track.curve, Curve::Boundary(_)));
        chords[which] = chords[which].max(error);
    }
    chords
}

struct Places<'p, 'a> {
    planar: &'p Planar<'a>,
    sharp: &'p Sharp,
    corners: BTreeMap<usize, usize>,
    gaps: BTreeMap<[Curve; 2], SharpPlace>,
}

impl Places<'_, '_> {
    fn add(&mut self, excuse: Excuse) {
        match excuse {
            Excuse::Corner(number) => *self.corners.entry(number).or_default() += 1,
            Excuse::Gap { mut curves, gap_mm, at } => {
                curves.sort();
                let kind = Sharpness::Gap { gap_mm };
                let new = SharpPlace { at, curves, kind, triangles: 0 };
                let known = self.gaps.entry(curves).or_insert(new);
                if matches!(known.kind, Sharpness::Gap { gap_mm: least } if gap_mm < least) {
                    *known = SharpPlace { triangles: known.triangles, ..new };
                }
                known.triangles += 1;
            }
        }
    }

    fn listed(self) -> Vec<SharpPlace> {
        let corner = |(number, triangles): (usize, usize)| {
            let corner = &self.sharp.acute[number];
            SharpPlace {
                at: self.planar.graph.points[corner.vertex.index()],
                curves: corner.tracks.map(|t| self.planar.tracks[t as usize].curve),
                kind: Sharpness::Corner { angle_deg: corner.angle_rad.to_degrees() },
                triangles,
            }
        };
        self.corners.into_iter().map(corner).chain(self.gaps.into_values()).collect()
    }
}

impl fmt::Display for SharpPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, second] = self.curves;
        match self.kind {
            Sharpness::Corner { angle_deg } if first == second => {
                write!(f, "{first} has a corner of {angle_deg:.1}°")?
            }
            Sharpness::Corner { angle_deg } => write!(f, "{first} meets {second} at {angle_deg:.1}°")?,
            Sharpness::Gap { gap_mm } if first == second => {
                write!(f, "{first} has a piece of {gap_mm:.2e} mm")?
            }
            Sharpness::Gap { gap_mm } => write!(f, "{first} passes {second} at {gap_mm:.2e} mm")?,
        }
        write!(f, " near ({:.3}, {:.3}) mm", self.at.x, self.at.y)
    }
}
