//! A folded form laid out flat: every face is moved rigidly into the plane beside a neighbour, breadth first.
//!
//! The sheet is isometric to its pattern, so the faces close up around every inner vertex. Files hold rounded or
//! slightly stretched coordinates; so a face is fitted to all of its corners that have a place already, a place
//! is the mean of what its faces say, and the largest misfit of a face says how well the form closes. Faces run
//! counter-clockwise on the front, so the front comes out facing the onlooker.

use super::frames::Frame;
use super::graph::{Assignment, Edge, Graph, Side, key, sides};
use super::json::told;
use super::plane::bounds;
use crate::PatternError;
use softfold_geometry::{DVec2, DVec3, Issue, Role, Severity, polygon};
use std::collections::{BTreeMap, VecDeque};

/// Largest misfit of a developed face, as a share of its own half perimeter. Simulators stop at edges stretched
/// by less (1e-3 in Origami Simulator's files); a form of stretched or torn faces misses by far more.
const CLOSES: f64 = 1e-2;
/// Misfit, likewise, that is said as a warning: more than the rounding of single precision.
const EXACT: f64 = 1e-5;
/// Area of a face, as a share of its perimeter squared, below which it has no direction.
const SLIVER: f64 = 1e-9;
/// Sweeps that spread the misfits evenly over the faces.
const SWEEPS: usize = 20;
/// Space between developed parts, as a share of the size of all.
const SPACING: f64 = 0.05;

/// One edge in the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// Its number.
    pub(super) edge: usize,
    /// Where its two vertices lie, file units.
    pub(super) ends: [DVec2; 2],
}

/// The edges of a folded form in the plane; an edge along which two faces are not joined comes twice.
///
/// # Errors
/// No faces, faces that are no plane polygons, that branch or are turned against each other, or that do not
/// close up.
pub(super) fn develop(
    graph: &Graph,
    frame: Frame<'_>,
    unit_mm: f64,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Placed>, PatternError> {
    if graph.faces.is_empty() {
        let what = "the frame is folded and has no faces_vertices, so it cannot be laid out flat";
        let mend = "export the crease pattern, or the folded form with its faces";
        return Err(PatternError::Malformed(told(
            Severity::Error,
            &frame.entry("vertices_coords"),
            what,
            mend,
        )));
    }
    let mut layout = Layout::new(graph, frame)?;
    layout.place_all();
    layout.settle();
    let worst = layout.worst();
    if worst.share > CLOSES {
        let vertex = graph.faces[worst.at.face][worst.at.corner];
        let what = format!(
            "laid out flat, the face misses vertex {vertex} by {:.6} mm ({:.3} % of its half perimeter)",
            worst.misfit * unit_mm,
            100.0 * worst.share
        );
        let mend = "the form is no sheet folded without stretching: export the crease pattern";
        let entry = frame.item("faces_vertices", worst.at.face);
        return Err(PatternError::Malformed(told(Severity::Error, &entry, what, mend)));
    }
    layout.tell(&worst, unit_mm, issues);
    Ok(layout.edges(issues))
}

/// The faces on their way into the plane.
struct Layout<'a> {
    graph: &'a Graph,
    frame: Frame<'a>,
    sides: BTreeMap<[usize; 2], Vec<Side>>,
    /// Whether two faces hang together along these vertices.
    joined: BTreeMap<[usize; 2], bool>,
    /// Corners of the faces in planes of their own.
    local: Vec<Vec<DVec2>>,
    /// Number of the first corner of each face.
    first_corner: Vec<usize>,
    /// Corners that are one point of the sheet, by one of them.
    point_of: Vec<usize>,
    /// Where the points lie.
    at: Vec<Mean>,
    /// Which connected part each face belongs to.
    part: Vec<usize>,
    parts: usize,
}

/// How far a corner is from its place.
struct Misfit {
    /// File units.
    misfit: f64,
    /// Share of the face's half perimeter.
    share: f64,
    at: Side,
}

/// A mean that grows.
#[derive(Clone, Copy, Default)]
struct Mean {
    sum: DVec2,
    count: f64,
}

impl Mean {
    fn value(&self) -> Option<DVec2> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}

impl<'a> Layout<'a> {
    fn new(graph: &'a Graph, frame: Frame<'a>) -> Result<Self, PatternError> {
        let (low, high) = bounds(&graph.vertices);
        let flat = |(i, f): (usize, &Vec<usize>)| own_plane(graph, frame, i, f, (high - low).max_element());
        let local = graph.faces.iter().enumerate().map(flat).collect::<Result<_, _>>()?;
        let mut first_corner = vec![0];
        for f in &graph.faces {
            first_corner.push(first_corner[first_corner.len() - 1] + f.len());
        }
        let corners = first_corner[graph.faces.len()];
        let sides = sides(&graph.faces);
        let assigned: BTreeMap<_, _> = graph.edges.iter().map(|e| (key(e.vertices), e.assignment)).collect();
        let open = [Assignment::Role(Role::Boundary), Assignment::Role(Role::Cut)];
        let holds = |k: &[usize; 2], s: &Vec<Side>| {
            s.len() == 2 && !assigned.get(k).is_some_and(|a| open.contains(a))
        };
        let joined = sides.iter().map(|(k, s)| (*k, holds(k, s))).collect();
        let part = vec![usize::MAX; graph.faces.len()];
        let at = vec![Mean::default(); corners];
        let point_of = (0..corners).collect();
        let mut layout =
            Self { graph, frame, sides, joined, local, first_corner, point_of, at, part, parts: 0 };
        layout.unite()?;
        Ok(layout)
    }

    /// Makes one point of the corners that meet along joined sides.
    fn unite(&mut self) -> Result<(), PatternError> {
        for (vertices, sides) in &self.sides {
            let named = || self.frame.item("faces_vertices", sides[0].face);
            let fault = |what: String, mend: &str| {
                Err(PatternError::Malformed(told(Severity::Error, &named(), what, mend)))
            };
            let [a, b] = vertices;
            if sides.len() > 2 {
                let what = format!("{} faces meet along vertices {a} and {b}", sides.len());
                return fault(what, "a sheet has at most two faces along an edge");
            }
            if !self.joined[vertices] {
                continue;
            }
            let [s, t] = [sides[0], sides[1]];
            let start = |s: Side| self.graph.faces[s.face][s.corner];
            if start(s) == start(t) {
                let what =
                    format!("faces {} and {} run the same way along vertices {a} and {b}", s.face, t.face);
                return fault(what, "turn all faces counter-clockwise as seen from the front");
            }
            let [[s0, s1], [t0, t1]] = [s, t].map(|s| self.corners_of(s));
            join(&mut self.point_of, s0, t1);
            join(&mut self.point_of, s1, t0);
        }
        for c in 0..self.point_of.len() {
            self.point_of[c] = root(&mut self.point_of, c);
        }
        Ok(())
    }

    /// Numbers of the corners at which a side begins and ends.
    fn corners_of(&self, side: Side) -> [usize; 2] {
        let first = self.first_corner[side.face];
        [first + side.corner, first + (side.corner + 1) % self.graph.faces[side.face].len()]
    }

    fn place_all(&mut self) {
        for seed in 0..self.graph.faces.len() {
            if self.part[seed] != usize::MAX {
                continue;
            }
            self.part[seed] = self.parts;
            let mut queue = VecDeque::from([seed]);
            while let Some(face) = queue.pop_front() {
                self.place(face);
                for next in self.neighbours(face) {
                    if self.part[next] == usize::MAX {
                        self.part[next] = self.parts;
                        queue.push_back(next);
                    }
                }
            }
            self.parts += 1;
        }
    }

    fn neighbours(&self, face: usize) -> Vec<usize> {
        let corners = &self.graph.faces[face];
        let sides = (0..corners.len()).map(|k| key([corners[k], corners[(k + 1) % corners.len()]]));
        let joined = sides.filter(|k| self.joined[k]);
        joined.flat_map(|k| self.sides[&k].iter().map(|s| s.face)).filter(|&f| f != face).collect()
    }

    fn place(&mut self, face: usize) {
        let placed = self.fitted(face);
        for (corner, p) in placed.into_iter().enumerate() {
            let mean = &mut self.at[self.point_of[self.first_corner[face] + corner]];
            mean.sum += p;
            mean.count += 1.0;
        }
    }

    /// Corners of a face, moved rigidly so that those with a place come nearest to it.
    fn fitted(&self, face: usize) -> Vec<DVec2> {
        let local = &self.local[face];
        let place = |k: usize| self.at[self.point_of[self.first_corner[face] + k]].value();
        let pairs: Vec<(DVec2, DVec2)> =
            (0..local.len()).filter_map(|k| Some((local[k], place(k)?))).collect();
        let motion = Motion::between(&pairs);
        local.iter().map(|&p| motion.apply(p)).collect()
    }

    /// Spreads the misfits.
    fn settle(&mut self) {
        for _ in 0..SWEEPS {
            let placed: Vec<Vec<DVec2>> = (0..self.local.len()).map(|f| self.fitted(f)).collect();
            self.at.fill(Mean::default());
            for (face, corners) in placed.iter().enumerate() {
                for (k, &p) in corners.iter().enumerate() {
                    let mean = &mut self.at[self.point_of[self.first_corner[face] + k]];
                    mean.sum += p;
                    mean.count += 1.0;
                }
            }
        }
    }

    /// The corner that misses its place most, measured by its face.
    fn worst(&self) -> Misfit {
        let mut worst = Misfit { misfit: 0.0, share: 0.0, at: Side { face: 0, corner: 0 } };
        for (face, local) in self.local.iter().enumerate() {
            let half_perimeter = 0.5 * polygon::edges(local).map(|(a, b)| a.distance(b)).sum::<f64>();
            for (corner, p) in self.fitted(face).into_iter().enumerate() {
                let misfit = self.place_of(Side { face, corner }).distance(p);
                let share = misfit / half_perimeter;
                if share > worst.share {
                    worst = Misfit { misfit, share, at: Side { face, corner } };
                }
            }
        }
        worst
    }

    fn place_of(&self, s: Side) -> DVec2 {
        self.at[self.point_of[self.first_corner[s.face] + s.corner]].value().unwrap_or_default()
    }

    /// Larger side of the largest part.
    fn size(&self) -> f64 {
        self.part_bounds().iter().map(|(low, high)| (*high - *low).max_element()).fold(0.0, f64::max)
    }

    fn part_bounds(&self) -> Vec<(DVec2, DVec2)> {
        let mut points: Vec<Vec<DVec2>> = vec![Vec::new(); self.parts];
        for face in 0..self.local.len() {
            let corners = (0..self.local[face].len()).map(|corner| self.place_of(Side { face, corner }));
            points[self.part[face]].extend(corners);
        }
        points.iter().map(|p| polygon::bounds(p)).collect()
    }

    /// How far each part is moved so that all lie beside each other.
    fn shifts(&self) -> Vec<DVec2> {
        let bounds = self.part_bounds();
        let gap = SPACING * self.size();
        let mut right = bounds.first().map_or(0.0, |b| b.0.x);
        let mut shift = |&(low, high): &(DVec2, DVec2)| {
            let by = DVec2::new(right - low.x, bounds[0].0.y - low.y);
            right += high.x - low.x + gap;
            by
        };
        bounds.iter().map(&mut shift).collect()
    }

    fn tell(&self, worst: &Misfit, unit_mm: f64, issues: &mut Vec<Issue>) {
        let entry = self.frame.entry("vertices_coords");
        let mut what = format!(
            "the folded form is laid out flat, {} faces; it closes within {:.6} mm",
            self.local.len(),
            worst.misfit * unit_mm
        );
        if self.parts > 1 {
            what.push_str(&format!(", in {} parts", self.parts));
        }
        let severity = if worst.share > EXACT { Severity::Warning } else { Severity::Note };
        issues.push(told(severity, &entry, what, "export the crease pattern for exact lines"));
    }

    /// All edges in the plane; those of no face are told.
    fn edges(&self, issues: &mut Vec<Issue>) -> Vec<Placed> {
        let shifts = self.shifts();
        let mut placed = Vec::new();
        let mut lost = Vec::new();
        for (edge, e) in self.graph.edges.iter().enumerate() {
            let Some(sides) = self.sides.get(&key(e.vertices)) else {
                lost.push(edge);
                continue;
            };
            let once = if self.joined[&key(e.vertices)] { 1 } else { sides.len() };
            placed.extend(sides[..once].iter().map(|&s| self.placed(edge, e, s, &shifts)));
        }
        if let Some(first) = lost.first() {
            let what = format!("{} edges belong to no face and are left out", lost.len());
            let entry = self.frame.item("edges_vertices", *first);
            issues.push(told(Severity::Warning, &entry, what, "give them faces, or delete them"));
        }
        placed
    }

    fn placed(&self, edge: usize, e: &Edge, side: Side, shifts: &[DVec2]) -> Placed {
        let corners = self.graph.faces[side.face].len();
        let ends = [side, Side { corner: (side.corner + 1) % corners, ..side }];
        let mut ends = ends.map(|s| self.place_of(s) + shifts[self.part[side.face]]);
        if self.graph.faces[side.face][side.corner] != e.vertices[0] {
            ends.swap(0, 1);
        }
        Placed { edge, ends }
    }
}

/// A rotation followed by a translation.
struct Motion {
    from: DVec2,
    turn: DVec2,
    to: DVec2,
}

impl Motion {
    /// The motion that brings the first of each pair nearest to the second, in the sense of least squares.
    fn between(pairs: &[(DVec2, DVec2)]) -> Self {
        if pairs.is_empty() {
            return Self { from: DVec2::ZERO, turn: DVec2::X, to: DVec2::ZERO };
        }
        let n = pairs.len() as f64;
        let from = pairs.iter().map(|p| p.0).sum::<DVec2>() / n;
        let to = pairs.iter().map(|p| p.1).sum::<DVec2>() / n;
        let spin = |(p, q): &(DVec2, DVec2)| {
            let (p, q) = (*p - from, *q - to);
            DVec2::new(p.dot(q), p.perp_dot(q))
        };
        let turn = pairs.iter().map(spin).sum::<DVec2>().try_normalize().unwrap_or(DVec2::X);
        Self { from, turn, to }
    }

    fn apply(&self, p: DVec2) -> DVec2 {
        self.turn.rotate(p - self.from) + self.to
    }
}

/// The corners of a face in its own plane: x along the world's x seen in that plane, counter-clockwise.
fn own_plane(
    graph: &Graph,
    frame: Frame<'_>,
    face: usize,
    corners: &[usize],
    size: f64,
) -> Result<Vec<DVec2>, PatternError> {
    let fault = |what: String, mend: &str| {
        Err(PatternError::Malformed(told(Severity::Error, &frame.item("faces_vertices", face), what, mend)))
    };
    let points: Vec<DVec3> = corners.iter().map(|&v| graph.vertices[v]).collect();
    let rim = || points.iter().zip(points.iter().cycle().skip(1));
    let normal: DVec3 = rim().map(|(a, b)| (*a - points[0]).cross(*b - points[0])).sum::<DVec3>() * 0.5;
    let perimeter: f64 = rim().map(|(a, b)| a.distance(*b)).sum();
    if normal.length() <= SLIVER * perimeter * perimeter {
        return fault("the face has no area, so it cannot be laid out flat".to_owned(), "delete the face");
    }
    let n = normal.normalize();
    let off = points.iter().map(|p| (*p - points[0]).dot(n).abs()).fold(0.0, f64::max);
    if off > CLOSES * size {
        let what = format!("the face is not flat: {:.3} % of the size off its plane", 100.0 * off / size);
        return fault(what, "split it into triangles (edges J or F)");
    }
    let along = DVec3::X - n * n.x;
    let along = if along.length() > 0.5 { along } else { DVec3::Y - n * n.y };
    let (x, y) = (along.normalize(), n.cross(along.normalize()));
    Ok(points.iter().map(|p| DVec2::new(p.dot(x), p.dot(y))).collect())
}

/// Representative of a set of corners.
fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

fn join(parent: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b)] = a.min(b);
}
