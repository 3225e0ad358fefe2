//! The file as XML: its shapes with line, id, exact geometry and FOLD attributes, its physical
//! scale, and the text as it is handed to usvg.
//!
//! usvg forgets lines and gives shapes without id none; so every shape is given an id of its own
//! in the text that usvg reads, and found again by it.

use crate::error::{Origin, Place, issue};
use crate::{PatternError, ReadOptions, colour, path};
use kurbo::{BezPath, Point, Vec2};
use roxmltree::Node;
use softfold_geometry::{Issue, Role, Severity};
use std::collections::{BTreeMap, BTreeSet};
use std::str::FromStr;
use svgtypes::{Length, LengthUnit, ViewBox};

/// Elements that draw lines.
const SHAPES: [&str; 7] = ["path", "line", "polyline", "polygon", "rect", "circle", "ellipse"];
/// Elements whose content is not drawn where it stands.
const TEMPLATES: [&str; 6] = ["defs", "symbol", "clipPath", "mask", "marker", "pattern"];
/// Drawn elements that no crease can come from.
const OTHER_DRAWN: [&str; 3] = ["text", "image", "foreignObject"];
/// Attributes that hide parts of an element on screen.
const CLIPS: [&str; 2] = ["clip-path", "mask"];
/// Attribute that carries a mark.
const MARK: &str = "data-softfold-mark";
/// Marks are miter limits that no drawing has, and whole numbers that `f32` holds.
const FIRST_MARK: u32 = 1_000_000;
/// CSS: 96 pixels an inch.
const PIXEL_MM: f64 = 25.4 / 96.0;
/// Relative difference of the scales of width and height that is more than rounding.
const SCALE_ROUNDING: f64 = 1e-3;

/// One shape of the file.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    /// Where it stands.
    pub(crate) origin: Origin,
    /// Its exact curve in its own coordinates; none where usvg must resolve its numbers (units).
    pub(crate) path: Option<BezPath>,
    /// Labels and ids of the groups around it, innermost first.
    pub(crate) layers: Vec<String>,
    /// From `data-assignment`.
    pub(crate) role: Option<Role>,
    /// From `data-foldAngle`, rad.
    pub(crate) fold_angle_rad: Option<f64>,
    /// Whether it is drawn where it stands (not a template).
    pub(crate) drawn: bool,
}

/// The file as XML.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    /// The text for usvg: one pixel of its tree is one user unit, and every shape has an id.
    pub(crate) text: String,
    /// Rules that mark the shapes that `use` may repeat: usvg drops their ids, so each gets a miter
    /// limit of its own, which no check here looks at.
    pub(crate) style_sheet: String,
    /// Ids of the marked shapes by their miter limits.
    pub(crate) marks: BTreeMap<u32, String>,
    /// The shapes by the ids in `text`.
    pub(crate) shapes: BTreeMap<String, Shape>,
    /// Corner of the view box that becomes (0, H), user units.
    pub(crate) corner: Vec2,
    /// Height H of the view box, user units.
    pub(crate) height: f64,
    /// Millimetres per user unit.
    pub(crate) unit_mm: f64,
    /// Line of the root element.
    pub(crate) root_line: u32,
}

impl Document {
    /// Reads the XML.
    ///
    /// # Errors
    /// No text, no XML, no SVG, no size, or a number that is none.
    pub(crate) fn parse(
        text: &str,
        options: &ReadOptions,
        issues: &mut Vec<Issue>,
    ) -> Result<Self, PatternError> {
        let xml = parse_xml(text)?;
        let root = xml.root_element();
        let lines = Lines::new(text);
        let root_line = lines.of(root.range().start);
        if root.tag_name().name() != "svg" {
            let what = format!("the root element is <{}>, not <svg>", root.tag_name().name());
            return Err(malformed(what).map(|i| i.line(root_line)));
        }
        let frame = Frame::read(&root, root_line, options, issues)?;
        let mut edits = frame.edits(&root);
        let shapes = read_shapes(&root, text, &lines, &mut edits)?;
        let marks = mark_repeated(&root, text, &shapes.by_start, &mut edits);
        let rule = |mark: &u32| format!("[{MARK}=\"{mark}\"]{{stroke-miterlimit:{mark}!important}}\n");
        let style_sheet = marks.keys().map(rule).collect();
        note_other_elements(&root, &lines, issues);
        let text = apply(text, edits);
        let Frame { corner, height, unit_mm, .. } = frame;
        Ok(Self { text, style_sheet, marks, shapes: shapes.by_id, corner, height, unit_mm, root_line })
    }
}

impl PatternError {
    fn map(self, f: impl FnOnce(Issue) -> Issue) -> Self {
        match self {
            Self::Malformed(i) => Self::Malformed(f(i)),
            other => other,
        }
    }
}

fn malformed(what: impl Into<String>) -> PatternError {
    PatternError::Malformed(issue(Severity::Error, what, "save the drawing as plain SVG"))
}

fn parse_xml(text: &str) -> Result<roxmltree::Document<'_>, PatternError> {
    if text.trim().is_empty() {
        return Err(malformed("the file is empty").map(|i| i.line(1)));
    }
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    roxmltree::Document::parse_with_options(text, options)
        .map_err(|e| malformed(format!("the file is not XML: {e}")).map(|i| i.line(e.pos().row)))
}

/// Starts of the lines of a text.
pub(crate) struct Lines(Vec<usize>);

impl Lines {
    /// Of this text.
    pub(crate) fn new(text: &str) -> Self {
        Self(std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect())
    }

    /// Line of a byte, from 1.
    pub(crate) fn of(&self, byte: usize) -> u32 {
        self.0.partition_point(|&start| start <= byte) as u32
    }
}

/// The page: what a user unit is, and where the page lies.
struct Frame {
    corner: Vec2,
    size: Vec2,
    height: f64,
    unit_mm: f64,
    has_view_box: bool,
}

impl Frame {
    fn read(
        root: &Node<'_, '_>,
        line: u32,
        options: &ReadOptions,
        issues: &mut Vec<Issue>,
    ) -> Result<Self, PatternError> {
        let [width, height] = ["width", "height"].map(|name| page_length(root, name));
        let view_box = root.attribute("viewBox").and_then(|v| ViewBox::from_str(v).ok());
        if let Some(v) = view_box {
            let unit_mm = unit_with_view_box([width, height], v, line, options, issues);
            let (corner, size) = (Vec2::new(v.x, v.y), Vec2::new(v.w, v.h));
            return Ok(Self { corner, size, height: v.h, unit_mm, has_view_box: true });
        }
        let (Some(w), Some(h)) = (width, height) else { return Err(no_size(root, line)) };
        let unit_mm = match w.physical && h.physical {
            true => PIXEL_MM,
            false => assumed_unit(line, PIXEL_MM, options, issues),
        };
        let size = Vec2::new(w.mm, h.mm) / PIXEL_MM;
        Ok(Self { corner: Vec2::ZERO, size, height: size.y, unit_mm, has_view_box: false })
    }

    /// What makes one pixel of usvg's tree one user unit: a view box at the origin, and as large
    /// a page; the rest is done here in `f64`.
    fn edits(&self, root: &Node<'_, '_>) -> Vec<Edit> {
        if !self.has_view_box {
            return Vec::new();
        }
        let replace = |name: &str, value: String| {
            root.attribute_node(name).map(|a| (a.range_value().start, a.range_value().end, value))
        };
        let view_box = format!("0 0 {} {}", self.size.x, self.size.y);
        let whole = || "100%".to_owned();
        [replace("viewBox", view_box), replace("width", whole()), replace("height", whole())]
            .into_iter()
            .flatten()
            .collect()
    }
}

/// Width or height of the page.
#[derive(Clone, Copy)]
struct PageLength {
    mm: f64,
    /// Given in a unit of length, not in pixels.
    physical: bool,
}

fn page_length(root: &Node<'_, '_>, name: &str) -> Option<PageLength> {
    let length = Length::from_str(root.attribute(name)?.trim()).ok()?;
    let unit_mm = match length.unit {
        LengthUnit::None | LengthUnit::Px => PIXEL_MM,
        LengthUnit::Mm => 1.0,
        LengthUnit::Cm => 10.0,
        LengthUnit::In => 25.4,
        LengthUnit::Pt => 25.4 / 72.0,
        LengthUnit::Pc => 25.4 / 6.0,
        LengthUnit::Percent | LengthUnit::Em | LengthUnit::Ex => return None,
    };
    let physical = !matches!(length.unit, LengthUnit::None | LengthUnit::Px);
    let mm = length.number * unit_mm;
    (mm.is_finite() && mm > 0.0).then_some(PageLength { mm, physical })
}

fn unit_with_view_box(
    page: [Option<PageLength>; 2],
    view_box: ViewBox,
    line: u32,
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> f64 {
    let scales: Vec<(f64, bool)> = page
        .iter()
        .zip([view_box.w, view_box.h])
        .filter_map(|(l, units)| l.map(|l| (l.mm / units, l.physical)))
        .collect();
    let smallest = scales.iter().map(|s| s.0).fold(f64::INFINITY, f64::min);
    if scales.is_empty() || scales.iter().any(|s| !s.1) {
        let drawn = if scales.is_empty() { PIXEL_MM } else { smallest };
        return assumed_unit(line, drawn, options, issues);
    }
    if scales.iter().any(|s| s.0 > smallest * (1.0 + SCALE_ROUNDING)) {
        let what = "width and height scale the view box differently; the smaller scale is used";
        let mend = "give width, height and viewBox the same proportions";
        issues.push(issue(Severity::Warning, what, mend).line(line));
    }
    smallest
}

/// The unit of a file that gives no physical size, and the note that says so.
fn assumed_unit(line: u32, drawn_mm: f64, options: &ReadOptions, issues: &mut Vec<Issue>) -> f64 {
    if let Some(unit_mm) = options.unit_mm {
        return unit_mm;
    }
    let what = format!("no physical size; 96 pixels an inch are assumed, so one unit is {drawn_mm:.6} mm");
    let mend = "write width and height in mm, or give the unit in the project file";
    issues.push(issue(Severity::Note, what, mend).line(line));
    drawn_mm
}

fn no_size(root: &Node<'_, '_>, line: u32) -> PatternError {
    let what = match root.attribute("viewBox") {
        Some(v) => format!("the drawing has no size: its viewBox \"{v}\" cannot be used"),
        None => "the drawing has no size: neither a viewBox nor width and height".to_owned(),
    };
    let mend = "give <svg> a width and height in mm and a viewBox";
    PatternError::NoSize(issue(Severity::Error, what, mend).line(line))
}

fn read_shapes(
    root: &Node<'_, '_>,
    text: &str,
    lines: &Lines,
    edits: &mut Vec<Edit>,
) -> Result<Shapes, PatternError> {
    let mut shapes = BTreeMap::new();
    let mut by_start = BTreeMap::new();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut places = BTreeSet::new();
    let taken: BTreeSet<&str> = root.descendants().filter_map(|n| n.attribute("id")).collect();
    let prefix = free_prefix(&taken);
    for node in root.descendants().filter(|n| SHAPES.contains(&n.tag_name().name())) {
        let kind = node.tag_name().name();
        let count = counts.entry(kind).or_default();
        *count += 1;
        let start = node.range().start;
        let id = node.attribute("id").filter(|i| !i.is_empty()).map(str::to_owned);
        let label = id.clone().unwrap_or_else(|| format!("{kind} {count}"));
        let origin = Origin { label, id, line: Some(lines.of(start)) };
        let shape = read_shape(&node, origin)?;
        let synthetic = format!("{prefix}{}", shapes.len());
        match shape.origin.id.clone() {
            Some(id) if !shapes.contains_key(&id) => {
                by_start.insert(start, id.clone());
                shapes.insert(id, shape);
            }
            _ if places.insert(start) => {
                edits.extend(id_edit(&node, text, &synthetic));
                by_start.insert(start, synthetic.clone());
                shapes.insert(synthetic, shape);
            }
            _ => {} // A second copy of an XML entity: usvg keeps no id for it.
        }
    }
    Ok(Shapes { by_id: shapes, by_start })
}

/// The shapes by id, and their ids by where they start in the text.
struct Shapes {
    by_id: BTreeMap<String, Shape>,
    by_start: BTreeMap<usize, String>,
}

/// Marks the shapes that a `use` refers to, alone or as part of something.
fn mark_repeated(
    root: &Node<'_, '_>,
    text: &str,
    by_start: &BTreeMap<usize, String>,
    edits: &mut Vec<Edit>,
) -> BTreeMap<u32, String> {
    let href = |n: Node<'_, '_>| n.attributes().find(|a| a.name() == "href").map(|a| a.value().to_owned());
    let links = root.descendants().filter(|n| n.tag_name().name() == "use").filter_map(href);
    let targets: BTreeSet<String> = links.filter_map(|l| l.strip_prefix('#').map(str::to_owned)).collect();
    let mut marks = BTreeMap::new();
    for node in root.descendants() {
        let Some(id) = by_start.get(&node.range().start) else { continue };
        let repeated = node.ancestors().any(|a| a.attribute("id").is_some_and(|i| targets.contains(i)));
        let mark = FIRST_MARK + marks.len() as u32;
        if let (true, Some(at)) = (repeated, name_end(&node, text)) {
            edits.push((at, at, format!(" {MARK}=\"{mark}\"")));
            marks.insert(mark, id.clone());
        }
    }
    marks
}

/// A prefix that no id of the file has.
fn free_prefix(taken: &BTreeSet<&str>) -> String {
    let mut prefix = "shape-".to_owned();
    while taken.iter().any(|id| id.starts_with(&prefix)) {
        prefix.push('-');
    }
    prefix
}

/// Replaces `text[from..to]`.
type Edit = (usize, usize, String);

/// Gives a shape an id, or replaces one that an earlier shape has too.
fn id_edit(node: &Node<'_, '_>, text: &str, id: &str) -> Option<Edit> {
    if let Some(old) = node.attribute_node("id") {
        return Some((old.range_value().start, old.range_value().end, id.to_owned()));
    }
    name_end(node, text).map(|end| (end, end, format!(" id=\"{id}\"")))
}

/// Where an element's name ends in the text.
fn name_end(node: &Node<'_, '_>, text: &str) -> Option<usize> {
    let start = node.range().start;
    let tag = text.get(start..)?.strip_prefix('<')?;
    let end = start + 1 + tag.find(|c: char| c.is_whitespace() || c == '/' || c == '>')?;
    text[..end].ends_with(node.tag_name().name()).then_some(end)
}

fn apply(text: &str, mut edits: Vec<Edit>) -> String {
    edits.sort();
    let mut out = String::with_capacity(text.len() + 32 * edits.len());
    let mut at = 0;
    for (from, to, new) in edits {
        out.push_str(&text[at..from]);
        out.push_str(&new);
        at = to;
    }
    out.push_str(&text[at..]);
    out
}

fn read_shape(node: &Node<'_, '_>, origin: Origin) -> Result<Shape, PatternError> {
    let drawn = !node
        .ancestors()
        .any(|a| TEMPLATES.contains(&a.tag_name().name()) || a.attribute("display") == Some("none"));
    let path = match read_path(node) {
        Ok(path) => path,
        Err(_) if !drawn => None,
        Err(what) => {
            let mend = "correct the number, or delete the element";
            return Err(PatternError::Number(issue(Severity::Error, what, mend).of(&origin)));
        }
    };
    let inherited = |name: &str| node.ancestors().find_map(|a| a.attribute(name));
    let role = match inherited("data-assignment") {
        Some(letter) => Some(colour::role_of_letter(letter).ok_or_else(|| unknown_letter(letter, &origin))?),
        None => None,
    };
    let angle = inherited("data-foldAngle").map(|a| fold_angle(a, &origin)).transpose()?;
    Ok(Shape { origin, path, layers: layers(node), role, fold_angle_rad: angle, drawn })
}

/// What drawing programs call layers: `inkscape:label`, Illustrator's `data-name` and id of the groups around an
/// element.
fn layers(node: &Node<'_, '_>) -> Vec<String> {
    let groups = node.ancestors().skip(1).filter(|a| a.tag_name().name() == "g");
    let names =
        groups.flat_map(|g| ["label", "data-name", "id"].map(|n| g.attributes().find(|a| a.name() == n)));
    names.flatten().map(|a| a.value().to_owned()).filter(|n| !n.trim().is_empty()).collect()
}

fn unknown_letter(letter: &str, origin: &Origin) -> PatternError {
    let what = format!("data-assignment is \"{letter}\"");
    let mend = "use one of FOLD's letters B, M, V, F, U, C";
    PatternError::Number(issue(Severity::Error, what, mend).of(origin))
}

fn fold_angle(text: &str, origin: &Origin) -> Result<f64, PatternError> {
    match text.trim().parse::<f64>() {
        Ok(degrees) if degrees.abs() <= 180.0 => Ok(degrees.to_radians()),
        _ => {
            let what = format!("data-foldAngle is \"{text}\"");
            let mend = "give degrees from -180 (mountain) to 180 (valley)";
            Err(PatternError::Number(issue(Severity::Error, what, mend).of(origin)))
        }
    }
}

/// The exact curve of a shape, none if a number has a unit.
fn read_path(node: &Node<'_, '_>) -> Result<Option<BezPath>, String> {
    match node.tag_name().name() {
        "path" => path_data(node.attribute("d").unwrap_or_default()).map(Some),
        "polyline" => points(node, false).map(Some),
        "polygon" => points(node, true).map(Some),
        "line" => Ok(numbers(node, ["x1", "y1", "x2", "y2"])?.map(|[x1, y1, x2, y2]| {
            let mut path = BezPath::new();
            path.move_to((x1, y1));
            path.line_to((x2, y2));
            path
        })),
        "rect" => rectangle(node),
        "circle" => Ok(numbers(node, ["cx", "cy", "r"])?
            .map(|[x, y, r]| path::ellipse(Point::new(x, y), Vec2::new(r, r)))),
        _ => Ok(match numbers(node, ["cx", "cy", "rx", "ry"])? {
            Some([x, y, rx, ry]) if node.has_attribute("rx") && node.has_attribute("ry") => {
                Some(path::ellipse(Point::new(x, y), Vec2::new(rx, ry)))
            }
            _ => None,
        }),
    }
}

fn path_data(d: &str) -> Result<BezPath, String> {
    let path = path::parse(d).map_err(|e| format!("the path data cannot be read: {e}"))?;
    match path.is_finite() {
        true => Ok(path),
        false => Err("the path data has a number that is not finite".to_owned()),
    }
}

fn points(node: &Node<'_, '_>, close: bool) -> Result<BezPath, String> {
    let numbers = node
        .attribute("points")
        .unwrap_or_default()
        .split([' ', ',', '\n', '\t', '\r'])
        .filter(|s| !s.is_empty())
        .map(|s| finite("points", s))
        .collect::<Result<Vec<f64>, String>>();
    // Numbers may also follow each other without a space ("1-2"); then the lenient parser reads them.
    let numbers = match numbers {
        Ok(n) => n,
        Err(e) => packed_points(node).ok_or(e)?,
    };
    let mut path = BezPath::new();
    for (i, p) in numbers.chunks_exact(2).enumerate() {
        if i == 0 { path.move_to((p[0], p[1])) } else { path.line_to((p[0], p[1])) }
    }
    if close && numbers.len() >= 4 {
        path.close_path();
    }
    Ok(path)
}

/// Points without separators; none if the text holds letters of no exponent.
fn packed_points(node: &Node<'_, '_>) -> Option<Vec<f64>> {
    let text = node.attribute("points")?;
    if text.contains(|c: char| c.is_alphabetic() && c != 'e' && c != 'E') {
        return None;
    }
    let all: Vec<f64> = svgtypes::PointsParser::from(text).flat_map(|(x, y)| [x, y]).collect();
    all.iter().all(|x| x.is_finite()).then_some(all)
}

fn rectangle(node: &Node<'_, '_>) -> Result<Option<BezPath>, String> {
    let Some([x, y, width, height, rx, ry]) = numbers(node, ["x", "y", "width", "height", "rx", "ry"])?
    else {
        return Ok(None);
    };
    let radii = match (node.has_attribute("rx"), node.has_attribute("ry")) {
        (true, false) => Vec2::new(rx, rx),
        (false, true) => Vec2::new(ry, ry),
        _ => Vec2::new(rx, ry),
    };
    Ok(Some(path::rectangle(Point::new(x, y), Vec2::new(width, height), radii)))
}

/// Attributes without unit, 0 where absent; none if any has a unit.
fn numbers<const N: usize>(node: &Node<'_, '_>, names: [&str; N]) -> Result<Option<[f64; N]>, String> {
    let mut values = [0.0; N];
    let mut plain = true;
    for (value, name) in values.iter_mut().zip(names) {
        let Some(text) = node.attribute(name) else { continue };
        if text.trim() == "auto" {
            plain = false;
            continue;
        }
        let length =
            Length::from_str(text.trim()).map_err(|_| format!("{name} is \"{text}\", not a length"))?;
        if !length.number.is_finite() {
            return Err(format!("{name} is \"{text}\", not a finite length"));
        }
        plain &= matches!(length.unit, LengthUnit::None | LengthUnit::Px);
        *value = length.number;
    }
    Ok(plain.then_some(values))
}

fn finite(name: &str, text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("{name} has \"{text}\", not a finite number")),
    }
}

/// Says which drawn elements can be no creases.
fn note_other_elements(root: &Node<'_, '_>, lines: &Lines, issues: &mut Vec<Issue>) {
    for kind in OTHER_DRAWN {
        let found: Vec<u32> = root
            .descendants()
            .filter(|n| n.tag_name().name() == kind)
            .map(|n| lines.of(n.range().start))
            .collect();
        if let Some(&first) = found.first() {
            let what = format!("{} <{kind}> ignored", found.len());
            issues.push(issue(Severity::Note, what, "").line(first));
        }
    }
    note_clipped(root, lines, issues);
}

/// Says that what a clip or mask hides is read all the same.
fn note_clipped(root: &Node<'_, '_>, lines: &Lines, issues: &mut Vec<Issue>) {
    let none = |value: &str| value.trim() == "none";
    let style = |n: &Node<'_, '_>| {
        n.attribute("style").is_some_and(|s| s.contains("clip-path") || s.contains("mask:"))
    };
    let clipped =
        |n: &Node<'_, '_>| CLIPS.iter().any(|c| n.attribute(*c).is_some_and(|v| !none(v))) || style(n);
    let found: Vec<u32> = root.descendants().filter(clipped).map(|n| lines.of(n.range().start)).collect();
    if let Some(&first) = found.first() {
        let what = format!("{} clipped or masked: what that hides is read as well", found.len());
        let mend = "release the clips, and cut the lines themselves if that matters";
        issues.push(issue(Severity::Note, what, mend).line(first));
    }
}
