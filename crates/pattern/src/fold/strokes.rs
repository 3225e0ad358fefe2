//! Edges in the plane as strokes, with the user's word on roles, and what is left out or mended.

use super::curves::{self, Curve};
use super::develop::Placed;
use super::frames::Frame;
use super::graph::{Assignment, Graph};
use super::json::told;
use crate::drawing::Stroke;
use crate::error::{Origin, issue, list};
use crate::{PatternError, ReadOptions};
use softfold_geometry::{DVec2, Issue, Role, Segment, Severity};
use std::collections::{BTreeMap, BTreeSet};

/// What was left out or mended, gathered so that it is said once.
#[derive(Default)]
struct Remarks {
    by_user: Vec<Origin>,
    joins: Vec<Origin>,
    points: Vec<Origin>,
    wrong_sign: Vec<Origin>,
    no_angle: Vec<Origin>,
    idle_angle: Vec<Origin>,
}

/// The strokes of a frame's edges, in file order; softfold's curves and the edges of one named crease become one
/// stroke each.
///
/// # Errors
/// Faults in softfold's own keys, or no edge is left.
pub(super) fn collect(
    graph: &Graph,
    frame: Frame<'_>,
    placed: &[Placed],
    unit_mm: f64,
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Stroke>, PatternError> {
    let names = curves::names(frame, graph.edges.len())?;
    let (curves, stale) = curves::read(frame, graph, placed)?;
    tell_stale(frame, &stale, issues);
    let mut remarks = Remarks::default();
    let mut found: Vec<(usize, Stroke)> = Vec::new();
    let curved: BTreeSet<usize> = curves.iter().flat_map(|c| c.edges.iter().copied()).collect();
    for curve in curves {
        let first = curve.edges.iter().min().copied().unwrap_or_default();
        let origin = origin(&curve.edges, names[first]);
        found.extend(curve_stroke(curve, origin, unit_mm, options, &mut remarks).map(|s| (first, s)));
    }
    let straight = placed.iter().filter(|p| !curved.contains(&p.edge));
    for run in runs(graph, &names, straight) {
        let first = run[0].edge;
        found.extend(
            edge_stroke(graph, &run, names[first], unit_mm, options, &mut remarks).map(|s| (first, s)),
        );
    }
    remarks.tell(issues);
    if found.is_empty() {
        let mend = "export the crease pattern with its edges";
        return Err(PatternError::Nothing(issue(Severity::Error, "no edge is part of the pattern", mend)));
    }
    found.sort_by_key(|(first, _)| *first);
    Ok(found.into_iter().map(|(_, stroke)| stroke).collect())
}

fn tell_stale(frame: Frame<'_>, stale: &[usize], issues: &mut Vec<Issue>) {
    if let Some(&first) = stale.first() {
        let what = format!(
            "{} of the kept curves no longer fit their edges, which were changed; the straight edges are read",
            stale.len()
        );
        let mend = "delete softfold's keys, or export the pattern again with softfold";
        issues.push(told(Severity::Warning, &frame.item(curves::EDGES_CURVE, first), what, mend));
    }
}

/// The name of a crease, or the edges it comes from.
fn origin(edges: &[usize], name: Option<&str>) -> Origin {
    let label = match (name, edges) {
        (Some(name), _) => name.to_owned(),
        (None, [edge]) => format!("edge {edge}"),
        (None, _) => {
            let low = edges.iter().min().copied().unwrap_or_default();
            format!("edges {low} to {}", edges.iter().max().copied().unwrap_or_default())
        }
    };
    Origin { label, id: name.map(str::to_owned), line: None }
}

/// Straight edges that are one stroke: those of one crease name, role and fold angle; every other edge alone.
fn runs<'p>(
    graph: &Graph,
    names: &[Option<&str>],
    placed: impl Iterator<Item = &'p Placed>,
) -> Vec<Vec<Placed>> {
    let mut runs: Vec<Vec<Placed>> = Vec::new();
    let mut named: BTreeMap<(&str, Option<Role>, Option<u64>), usize> = BTreeMap::new();
    for p in placed {
        let edge = graph.edges[p.edge];
        let role = if let Assignment::Role(role) = edge.assignment { Some(role) } else { None };
        let Some(name) = names[p.edge] else {
            runs.push(vec![*p]);
            continue;
        };
        let run = *named.entry((name, role, edge.angle_deg.map(f64::to_bits))).or_insert(runs.len());
        match runs.get_mut(run) {
            Some(edges) => edges.push(*p),
            None => runs.push(vec![*p]),
        }
    }
    runs
}

fn curve_stroke(
    curve: Curve,
    origin: Origin,
    unit_mm: f64,
    options: &ReadOptions,
    remarks: &mut Remarks,
) -> Option<Stroke> {
    let role = remarks.role(&origin, Some(curve.role), options)?;
    let fold_angle_rad = remarks.fold_angle(role, curve.angle_deg, &origin);
    let scale = |p: DVec2| p * unit_mm;
    let scaled = curve.segments.iter().map(|s| match *s {
        Segment::Line { from, to } => Segment::Line { from: scale(from), to: scale(to) },
        Segment::Cubic { from, c1, c2, to } => {
            Segment::Cubic { from: scale(from), c1: scale(c1), c2: scale(c2), to: scale(to) }
        }
    });
    Some(Stroke { role, fold_angle_rad, origin, pieces: vec![scaled.collect()] })
}

fn edge_stroke(
    graph: &Graph,
    run: &[Placed],
    name: Option<&str>,
    unit_mm: f64,
    options: &ReadOptions,
    remarks: &mut Remarks,
) -> Option<Stroke> {
    let edge = graph.edges[run[0].edge];
    let edges: Vec<usize> = run.iter().map(|p| p.edge).collect();
    let origin = origin(&edges, name);
    let written = if let Assignment::Role(role) = edge.assignment { Some(role) } else { None };
    let role = remarks.role(&origin, written, options)?;
    let pieces = chains(run, unit_mm);
    if pieces.is_empty() {
        remarks.points.push(origin);
        return None;
    }
    let fold_angle_rad = remarks.fold_angle(role, edge.angle_deg, &origin);
    Some(Stroke { role, fold_angle_rad, origin, pieces })
}

/// Edges of a run that follow each other become one piece; those without length are dropped.
fn chains(run: &[Placed], unit_mm: f64) -> Vec<Vec<Segment>> {
    let mut pieces: Vec<Vec<Segment>> = Vec::new();
    for p in run {
        let [a, b] = p.ends.map(|p| p * unit_mm);
        if a == b {
            continue;
        }
        let follows = |piece: &Vec<Segment>, p: DVec2| piece.last().is_some_and(|s| s.to() == p);
        match pieces.last_mut() {
            Some(piece) if follows(piece, a) => piece.push(Segment::Line { from: a, to: b }),
            Some(piece) if follows(piece, b) => piece.push(Segment::Line { from: b, to: a }),
            _ => pieces.push(vec![Segment::Line { from: a, to: b }]),
        }
    }
    pieces
}

impl Remarks {
    /// The role of an edge by the user's word, else by the file; none if it is left out.
    fn role(&mut self, origin: &Origin, written: Option<Role>, options: &ReadOptions) -> Option<Role> {
        let said = options.roles.of(Some(&origin.label), &[], None);
        let role = said.unwrap_or(written);
        if role.is_none() {
            let list = if said.is_some() { &mut self.by_user } else { &mut self.joins };
            list.push(origin.clone());
        }
        role
    }

    /// The fold angle of a crease, with the sign of its role.
    fn fold_angle(&mut self, role: Role, angle_deg: Option<f64>, origin: &Origin) -> Option<f64> {
        let degrees = angle_deg?;
        match role {
            Role::Mountain | Role::Valley if degrees == 0.0 => {
                self.no_angle.push(origin.clone());
                None
            }
            Role::Mountain | Role::Valley => {
                if degrees * role.sign() < 0.0 {
                    self.wrong_sign.push(origin.clone());
                }
                Some((degrees.abs() * role.sign()).to_radians())
            }
            _ if degrees == 0.0 => None,
            Role::Unassigned => Some(degrees.to_radians()),
            _ => {
                self.idle_angle.push(origin.clone());
                None
            }
        }
    }

    fn tell(self, issues: &mut Vec<Issue>) {
        let mut say = |severity: Severity, origins: &[Origin], what: &str, mend: &str| {
            if !origins.is_empty() {
                let what = format!("{what}, {} in all: {}", origins.len(), list(origins));
                issues.push(issue(severity, what, mend));
            }
        };
        say(Severity::Note, &self.by_user, "left out by the project's roles", "");
        say(Severity::Note, &self.joins, "edges of assignment J split faces and are left out", "");
        say(Severity::Warning, &self.points, "edges without length are left out", "delete them");
        let mend = "valleys are positive, mountains negative; the assignment was followed";
        say(
            Severity::Warning,
            &self.wrong_sign,
            "edges_foldAngle has the wrong sign for its assignment",
            mend,
        );
        let what = "a fold angle of 0 at a mountain or valley is read as not given";
        say(Severity::Note, &self.no_angle, what, "give the angle in edges_foldAngle");
        let what = "fold angles of edges that do not fold are ignored";
        say(Severity::Warning, &self.idle_angle, what, "assign M or V, or 0 degrees");
    }
}
