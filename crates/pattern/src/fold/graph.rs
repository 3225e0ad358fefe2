//! Vertices, edges and faces of a frame: every index in range, every number finite, every list of its length.

use super::frames::Frame;
use super::json::{self, kind, malformed, number_fault, told};
use crate::error::{Origin, list};
use crate::{PatternError, colour};
use serde_json::Value;
use softfold_geometry::{DVec3, Issue, Role, Severity};
use std::collections::BTreeMap;

/// Degrees by which a fold angle may pass 180 through rounding.
const ANGLE_ROUNDING_DEG: f64 = 1e-6;

/// A frame as vertices, edges and faces.
pub(super) struct Graph {
    /// `vertices_coords`, z = 0 where the file gives two coordinates; file units.
    pub(super) vertices: Vec<DVec3>,
    /// The edges; those of the faces where the file has no `edges_vertices`.
    pub(super) edges: Vec<Edge>,
    /// `faces_vertices`; empty where the file has none.
    pub(super) faces: Vec<Vec<usize>>,
}

/// One edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    pub(super) vertices: [usize; 2],
    pub(super) assignment: Assignment,
    /// `edges_foldAngle`, degrees, as written; none for null.
    pub(super) angle_deg: Option<f64>,
}

/// What an edge is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Assignment {
    Role(Role),
    /// J: splits a face (triangulation), neither crease nor boundary.
    Join,
}

impl Graph {
    /// The graph of a frame.
    ///
    /// # Errors
    /// Wrong types, lengths, letters, numbers or indices, with key and index.
    pub(super) fn read(frame: Frame<'_>, issues: &mut Vec<Issue>) -> Result<Self, PatternError> {
        let vertices = vertices(frame)?;
        let faces = faces(frame, vertices.len())?;
        let ends = match frame.list("edges_vertices")? {
            Some(list) => edge_ends(frame, list, vertices.len())?,
            None => {
                let what = "edges_vertices is missing; the edges of the faces are read";
                issues.push(told(Severity::Note, &frame.entry("faces_vertices"), what, ""));
                sides(&faces).into_keys().collect()
            }
        };
        let assignments = assignments(frame, &ends, &faces, issues)?;
        let angles = fold_angles(frame, ends.len())?;
        let edge = |((vertices, assignment), angle_deg)| Edge { vertices, assignment, angle_deg };
        let edges = ends.into_iter().zip(assignments).zip(angles).map(edge).collect();
        Ok(Self { vertices, edges, faces })
    }
}

/// Vertices and faces alone.
///
/// # Errors
/// As [`Graph::read`].
pub(super) fn faces_in_space(frame: Frame<'_>) -> Result<(Vec<DVec3>, Vec<Vec<usize>>), PatternError> {
    let vertices = vertices(frame)?;
    let faces = faces(frame, vertices.len())?;
    Ok((vertices, faces))
}

/// A side of a face: the face, and the corner at which the side begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) face: usize,
    pub(super) corner: usize,
}

/// The sides of all faces, by their vertices in ascending order.
pub(super) fn sides(faces: &[Vec<usize>]) -> BTreeMap<[usize; 2], Vec<Side>> {
    let mut sides: BTreeMap<[usize; 2], Vec<Side>> = BTreeMap::new();
    for (face, corners) in faces.iter().enumerate() {
        for (corner, &from) in corners.iter().enumerate() {
            let to = corners[(corner + 1) % corners.len()];
            sides.entry(key([from, to])).or_default().push(Side { face, corner });
        }
    }
    sides
}

/// Two vertices in ascending order.
pub(super) fn key([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// The list must have an entry for each edge.
fn of_edges<'a>(frame: Frame<'a>, name: &str, edges: usize) -> Result<Option<&'a [Value]>, PatternError> {
    match frame.list(name)? {
        Some(list) if list.len() != edges => {
            let what = format!("it has {} entries for {edges} edges", list.len());
            Err(malformed(&frame.entry(name), what))
        }
        other => Ok(other),
    }
}

fn vertices(frame: Frame<'_>) -> Result<Vec<DVec3>, PatternError> {
    const KEY: &str = "vertices_coords";
    let list = frame.list(KEY)?.unwrap_or_default();
    let vertex = |(i, value): (usize, &Value)| {
        let coords = json::list(value, || frame.item(KEY, i))?;
        if !(2..=3).contains(&coords.len()) {
            let what = format!("it has {} coordinates, not 2 or 3", coords.len());
            return Err(malformed(&frame.item(KEY, i), what));
        }
        let mut xyz = [0.0; 3];
        for (x, c) in xyz.iter_mut().zip(coords) {
            *x = json::number(c, || frame.item(KEY, i))?;
        }
        Ok(DVec3::from_array(xyz))
    };
    list.iter().enumerate().map(vertex).collect()
}

fn indices(
    frame: Frame<'_>,
    name: &str,
    i: usize,
    value: &Value,
    count: usize,
) -> Result<Vec<usize>, PatternError> {
    let list = json::list(value, || frame.item(name, i))?;
    list.iter().map(|v| json::index(v, count, "vertex", || frame.item(name, i))).collect()
}

fn faces(frame: Frame<'_>, vertices: usize) -> Result<Vec<Vec<usize>>, PatternError> {
    const KEY: &str = "faces_vertices";
    let list = frame.list(KEY)?.unwrap_or_default();
    let face = |(i, value): (usize, &Value)| {
        let corners = indices(frame, KEY, i, value, vertices)?;
        match corners.len() {
            0..3 => Err(malformed(
                &frame.item(KEY, i),
                format!("it has {} vertices, not 3 or more", corners.len()),
            )),
            _ => Ok(corners),
        }
    };
    list.iter().enumerate().map(face).collect()
}

fn edge_ends(frame: Frame<'_>, list: &[Value], vertices: usize) -> Result<Vec<[usize; 2]>, PatternError> {
    const KEY: &str = "edges_vertices";
    let edge = |(i, value): (usize, &Value)| match indices(frame, KEY, i, value, vertices)?[..] {
        [a, b] => Ok([a, b]),
        ref other => Err(malformed(&frame.item(KEY, i), format!("it has {} vertices, not 2", other.len()))),
    };
    list.iter().enumerate().map(edge).collect()
}

fn assignments(
    frame: Frame<'_>,
    ends: &[[usize; 2]],
    faces: &[Vec<usize>],
    issues: &mut Vec<Issue>,
) -> Result<Vec<Assignment>, PatternError> {
    const KEY: &str = "edges_assignment";
    let sides = sides(faces);
    let listed = of_edges(frame, "edges_faces", ends.len())?;
    let neighbours = |e: usize| match listed.and_then(|l| l[e].as_array()) {
        Some(list) => list.iter().filter(|f| !f.is_null()).count(),
        None => sides.get(&key(ends[e])).map_or(0, Vec::len),
    };
    let missing =
        |e: usize| Assignment::Role(if neighbours(e) == 1 { Role::Boundary } else { Role::Unassigned });
    let Some(letters) = of_edges(frame, KEY, ends.len())? else {
        let what = "edges_assignment is missing; edges of one face are boundary, the others unassigned";
        issues.push(told(Severity::Note, &frame.entry(KEY), what, "assign mountains and valleys"));
        return Ok((0..ends.len()).map(missing).collect());
    };
    let letter = |(e, value): (usize, &Value)| {
        let role = match value {
            Value::Null => return Ok(missing(e)),
            Value::String(s) if s.trim().eq_ignore_ascii_case("J") => return Ok(Assignment::Join),
            Value::String(s) => colour::role_of_letter(s),
            _ => None,
        };
        let fault =
            || malformed(&frame.item(KEY, e), format!("it is {}, none of B, M, V, F, U, C, J", kind(value)));
        role.map(Assignment::Role).ok_or_else(fault)
    };
    let without: Vec<Origin> = (0..letters.len())
        .filter(|&e| letters[e].is_null())
        .map(|e| Origin { label: format!("edge {e}"), ..Origin::default() })
        .collect();
    if !without.is_empty() {
        let what =
            format!("without assignment, so boundary at one face, else unassigned: {}", list(&without));
        issues.push(told(Severity::Note, &frame.entry(KEY), what, "assign mountains and valleys"));
    }
    letters.iter().enumerate().map(letter).collect()
}

fn fold_angles(frame: Frame<'_>, edges: usize) -> Result<Vec<Option<f64>>, PatternError> {
    // FOLD 1.0 had the plural.
    let name = if frame.get("edges_foldAngle").is_some() { "edges_foldAngle" } else { "edges_foldAngles" };
    let Some(list) = of_edges(frame, name, edges)? else { return Ok(vec![None; edges]) };
    let angle = |(e, value): (usize, &Value)| {
        if value.is_null() {
            return Ok(None);
        }
        let degrees = json::number(value, || frame.item(name, e))?;
        if degrees.abs() > 180.0 + ANGLE_ROUNDING_DEG {
            return Err(number_fault(
                &frame.item(name, e),
                format!("{degrees} is not from -180 to 180 degrees"),
            ));
        }
        Ok(Some(degrees.clamp(-180.0, 180.0)))
    };
    list.iter().enumerate().map(angle).collect()
}
