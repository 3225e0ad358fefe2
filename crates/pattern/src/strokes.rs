//! The drawn lines with their roles, in mm with v up: transforms, styles and `use` by usvg.

use crate::colour;
use crate::document::{Document, Shape};
use crate::drawing::Stroke;
use crate::error::{Origin, Place, issue, list};
use crate::roles::{RoleMap, role_of_layer};
use crate::{PatternError, ReadOptions};
use kurbo::{Affine, BezPath, PathEl, Point};
use softfold_geometry::{DVec2, Issue, Role, Segment, Severity};
use std::collections::{BTreeMap, BTreeSet};
use usvg::tiny_skia_path::PathSegment;

/// All strokes with a role, in the order of the file; what is ignored is said.
///
/// # Errors
/// usvg finds no SVG, or nothing is drawn.
pub(crate) fn collect(
    document: &Document,
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Stroke>, PatternError> {
    // Some values (an infinite miter limit, say) meet assertions of usvg's, which a user's file must not trip.
    let tree = std::panic::catch_unwind(|| usvg::Tree::from_str(&document.text, &parse_options(document)));
    let tree =
        tree.map_or_else(|_| Err("a value is out of its range".to_owned()), |t| t.map_err(|e| e.to_string()));
    let tree = tree.map_err(|e| {
        let what = format!("the drawing cannot be resolved: {e}");
        let mend = "save the drawing as plain SVG";
        PatternError::Malformed(issue(Severity::Error, what, mend).line(document.root_line))
    })?;
    let mut walk = Walk::new(document, &options.roles);
    walk.group(tree.root(), 1.0);
    walk.finish(issues);
    if walk.strokes.is_empty() {
        let what = "nothing is drawn in a colour of a crease pattern";
        let mend = "draw the outline black, mountains red, valleys blue";
        return Err(PatternError::Nothing(issue(Severity::Error, what, mend).line(document.root_line)));
    }
    Ok(walk.strokes)
}

/// usvg's defaults, but no file is ever opened.
fn parse_options(document: &Document) -> usvg::Options<'static> {
    usvg::Options {
        style_sheet: Some(document.style_sheet.clone()),
        image_href_resolver: usvg::ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..usvg::Options::default()
    }
}

struct Walk<'a> {
    document: &'a Document,
    strokes: Vec<Stroke>,
    seen: BTreeMap<&'a str, usize>,
    roles: &'a RoleMap,
    /// Stroke colours that are none of ours, each with its elements.
    unknown: BTreeMap<String, Vec<Origin>>,
    /// What the user leaves out.
    left_out: Vec<Origin>,
    /// How roles were found that neither the user nor the file says, each with its elements.
    taken: BTreeMap<String, Vec<Origin>>,
    issues: Vec<Issue>,
}

impl<'a> Walk<'a> {
    fn new(document: &'a Document, roles: &'a RoleMap) -> Self {
        Self {
            document,
            roles,
            strokes: Vec::new(),
            seen: BTreeMap::new(),
            unknown: BTreeMap::new(),
            left_out: Vec::new(),
            taken: BTreeMap::new(),
            issues: Vec::new(),
        }
    }

    fn group(&mut self, group: &usvg::Group, opacity: f64) {
        let opacity = opacity * f64::from(group.opacity().get());
        for node in group.children() {
            match node {
                usvg::Node::Group(g) => self.group(g, opacity),
                usvg::Node::Path(p) => self.path(p, opacity),
                _ => {}
            }
        }
    }

    fn path(&mut self, path: &usvg::Path, opacity: f64) {
        let (Some(stroke), true) = (path.stroke(), path.is_visible()) else { return };
        let mark = stroke.miterlimit().get() as u32;
        let marked = self.document.marks.get(&mark).map_or("", String::as_str);
        let id = if path.id().is_empty() { marked } else { path.id() };
        let Some((id, shape)) = self.document.shapes.get_key_value(id) else { return };
        let uses = self.seen.entry(id).or_default();
        *uses += 1;
        let origin = instance(&shape.origin, *uses);
        let Some(role) = self.role(shape, stroke.paint(), &origin) else { return };
        let pieces = self.pieces(shape, path);
        if pieces.is_empty() {
            let what = "the line has no length; it is ignored";
            self.issues.push(issue(Severity::Warning, what, "delete the element").of(&origin));
            return;
        }
        let opacity = opacity * f64::from(stroke.opacity().get());
        let fold_angle_rad = self.fold_angle(shape, role, opacity, &origin);
        self.strokes.push(Stroke { role, fold_angle_rad, origin, pieces });
    }

    /// The user's word, else `data-assignment`, else the nearest colour; where no colour is near, a layer's name.
    /// None if the line is left out.
    fn role(&mut self, shape: &Shape, paint: &usvg::Paint, origin: &Origin) -> Option<Role> {
        let rgb = match paint {
            usvg::Paint::Color(c) => Some([c.red, c.green, c.blue]),
            _ => None,
        };
        let layers: Vec<&str> = shape.layers.iter().map(String::as_str).collect();
        if let Some(said) = self.roles.of(origin.id.as_deref(), &layers, rgb) {
            if said.is_none() {
                self.left_out.push(origin.clone());
            }
            return said;
        }
        if shape.role.is_some() {
            return shape.role;
        }
        if let Some((role, distance)) = rgb.and_then(colour::nearest) {
            if distance > 0.0 {
                let reach = colour::REACH;
                let how = format!("distance {distance:.0} of at most {reach:.0}");
                self.take(&format!("stroke {}", paint_name(paint)), role, &how, origin);
            }
            return Some(role);
        }
        match layers.iter().find_map(|l| Some((*l, role_of_layer(l)?))) {
            Some((layer, role)) => {
                self.take(&format!("what is drawn in layer '{layer}'"), role, "by the layer's name", origin);
                Some(role)
            }
            None => {
                self.unknown.entry(paint_name(paint)).or_default().push(origin.clone());
                None
            }
        }
    }

    fn take(&mut self, what: &str, role: Role, how: &str, origin: &Origin) {
        let said = format!("{what} is taken as {} ({how})", role_name(role));
        self.taken.entry(said).or_default().push(origin.clone());
    }

    /// The attribute wins; an opacity below 1 is the angle by 180°; else the file does not say.
    fn fold_angle(&mut self, shape: &Shape, role: Role, opacity: f64, origin: &Origin) -> Option<f64> {
        if let Some(angle) = shape.fold_angle_rad {
            if angle * role.sign() < 0.0 {
                let what = format!("data-foldAngle {} has the wrong sign for its role", angle.to_degrees());
                let mend = "valleys are positive, mountains negative; the role was followed";
                self.issues.push(issue(Severity::Warning, what, mend).of(origin));
                return Some(-angle);
            }
            return matches!(role, Role::Mountain | Role::Valley | Role::Unassigned).then_some(angle);
        }
        (role.sign() != 0.0 && opacity < 1.0).then(|| role.sign() * opacity * std::f64::consts::PI)
    }

    fn pieces(&self, shape: &Shape, path: &usvg::Path) -> Vec<Vec<Segment>> {
        let t = path.abs_transform();
        let user = Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from));
        let to_sheet = |p: Point| {
            let q = user * p - self.document.corner;
            DVec2::new(q.x, self.document.height - q.y) * self.document.unit_mm
        };
        match &shape.path {
            Some(exact) => subpaths(exact, to_sheet),
            None => subpaths(&resolved(path), to_sheet),
        }
    }

    /// Says what was left out.
    fn finish(&mut self, issues: &mut Vec<Issue>) {
        issues.append(&mut self.issues);
        for (what, origins) in &self.taken {
            let what = format!("{what}: {}", list(origins));
            let mend = "give another role in the project file if this is not meant";
            issues.push(issue(Severity::Note, what, mend).of_line(origins[0].line));
        }
        if let Some(first) = self.left_out.first() {
            let what = format!("left out by the project's roles: {}", list(&self.left_out));
            issues.push(issue(Severity::Note, what, "").of_line(first.line));
        }
        for (colour, origins) in &self.unknown {
            let what = format!("stroke {colour} is no role; ignored: {}", list(origins));
            let mend = "use black, red, blue, yellow, green or magenta, or data-assignment";
            issues.push(issue(Severity::Note, what, mend).of_line(origins[0].line));
        }
        let drawn: BTreeSet<&str> = self.seen.keys().copied().collect();
        let hidden: Vec<Origin> = self
            .document
            .shapes
            .iter()
            .filter(|(id, s)| s.drawn && !drawn.contains(id.as_str()))
            .map(|(_, s)| s.origin.clone())
            .collect();
        if !hidden.is_empty() {
            let mut hidden = hidden;
            hidden.sort_by_key(|o| o.line);
            let what = format!("without a visible stroke, ignored: {}", list(&hidden));
            issues.push(
                issue(Severity::Note, what, "give them a stroke if they matter").of_line(hidden[0].line),
            );
        }
    }
}

/// The origin of the n-th drawing of an element that `use` repeats.
fn instance(origin: &Origin, uses: usize) -> Origin {
    match uses {
        1 => origin.clone(),
        n => Origin { label: format!("{} (use {n})", origin.label), ..origin.clone() },
    }
}

/// What a role is called in messages.
fn role_name(role: Role) -> &'static str {
    match role {
        Role::Boundary => "boundary",
        Role::Mountain => "mountain",
        Role::Valley => "valley",
        Role::Flat => "flat",
        Role::Cut => "cut",
        Role::Unassigned => "unassigned",
    }
}

fn paint_name(paint: &usvg::Paint) -> String {
    match paint {
        usvg::Paint::Color(c) => format!("#{:02x}{:02x}{:02x}", c.red, c.green, c.blue),
        _ => "gradient or pattern".to_owned(),
    }
}

/// The curve that usvg resolved (units, percentages).
fn resolved(path: &usvg::Path) -> BezPath {
    let point = |p: usvg::tiny_skia_path::Point| Point::new(f64::from(p.x), f64::from(p.y));
    path.data()
        .segments()
        .map(|s| match s {
            PathSegment::MoveTo(p) => PathEl::MoveTo(point(p)),
            PathSegment::LineTo(p) => PathEl::LineTo(point(p)),
            PathSegment::QuadTo(c, p) => PathEl::QuadTo(point(c), point(p)),
            PathSegment::CubicTo(a, b, p) => PathEl::CurveTo(point(a), point(b), point(p)),
            PathSegment::Close => PathEl::ClosePath,
        })
        .collect()
}

/// Subpaths of positive length as segments.
fn subpaths(path: &BezPath, map: impl Fn(Point) -> DVec2) -> Vec<Vec<Segment>> {
    let mut pieces: Vec<Vec<Segment>> = Vec::new();
    let (mut at, mut start) = (DVec2::ZERO, DVec2::ZERO);
    for element in path.elements() {
        let segment = match *element {
            PathEl::MoveTo(p) => {
                (at, start) = (map(p), map(p));
                pieces.push(Vec::new());
                continue;
            }
            PathEl::LineTo(p) => Segment::Line { from: at, to: map(p) },
            PathEl::QuadTo(c, p) => {
                let (c, to) = (map(c), map(p));
                Segment::Cubic { from: at, c1: at.lerp(c, 2.0 / 3.0), c2: to.lerp(c, 2.0 / 3.0), to }
            }
            PathEl::CurveTo(a, b, p) => Segment::Cubic { from: at, c1: map(a), c2: map(b), to: map(p) },
            PathEl::ClosePath => Segment::Line { from: at, to: start },
        };
        at = segment.to();
        let degenerate = segment.control_points().iter().all(|&p| p == segment.from());
        if let (Some(piece), false) = (pieces.last_mut(), degenerate) {
            piece.push(segment);
        }
    }
    pieces.retain(|p| !p.is_empty());
    pieces
}
