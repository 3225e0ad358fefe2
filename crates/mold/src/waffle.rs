//! The waffle: crossing boards that carry the mold.

use crate::contour::{Contour, Pen};
use crate::error::{MoldError, Setting};
use crate::glyphs;
use crate::height::HeightField;
use crate::nest::{Nest, StockOptions, nest};
use crate::tool::Region;
use glam::{DMat3, DVec2, DVec3};
use softfold_geometry::{RigidTransform, polygon};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Step along a board at which the mold's underside is looked at, mm: a twentieth of the board's own thickness.
const STEP_MM: f64 = 1.0;
/// Upper edges are simplified to lines within this, mm: what a router keeps.
const EDGE_ERROR_MM: f64 = 0.05;
/// Chord error at which contours are tested against themselves, mm.
const TEST_CHORD_MM: f64 = 0.01;
/// Places across a board's thickness where its cover is looked at, in half thicknesses.
const ACROSS: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
/// Names keep this far from slots and edges, mm.
const NAME_MARGIN_MM: f64 = 10.0;
/// Names are at most this share of the board's least height.
const NAME_SHARE: f64 = 0.4;

/// Two boards do not touch if the gap between them is short of the wanted one by no more than this, mm: rounding.
const CLEAR_SLACK_MM: f64 = 1e-6;
/// More boards each way than any mold needs: 260 m at the usual pitch.
const MOST_BOARDS: f64 = 1000.0;
/// The pitch as an option.
const PITCH: Setting = Setting::of("waffle", "pitch_mm", "pitch of the waffle (mm)");

/// How the waffle is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaffleOptions {
    /// Thickness of the boards, mm.
    pub board_mm: f64,
    /// Distance between the middles of neighbouring boards, mm.
    pub pitch_mm: f64,
    /// Direction of the W boards against the grid, degrees; the X boards stand square to them.
    pub angle_deg: f64,
    /// How deep a board's upper edge is sunk into the mold's underside, at its middle, mm.
    pub sink_mm: f64,
    /// Least material of the mold above a board, mm: on steep slopes boards are sunk less to keep it.
    pub cover_mm: f64,
    /// The floor is this far below the mold's lowest point, mm.
    pub floor_below_mm: f64,
    /// Slots and grooves are wider than a board by this, mm; slots are as much deeper.
    pub clearance_mm: f64,
    /// Diameter of the router's cutter, mm: the corners of slots get a relief of this size.
    pub cutter_mm: f64,
    /// Boards end this far inside the mold's edge, mm.
    pub inset_mm: f64,
    /// Shorter boards are dropped, mm.
    pub least_length_mm: f64,
    /// Least material between a slot and a board's end, mm; a board that would have less ends before the crossing.
    pub least_land_mm: f64,
    /// Height of the names on the boards, mm.
    pub text_mm: f64,
    /// What the boards are cut from.
    pub stock: StockOptions,
}

impl Default for WaffleOptions {
    /// 19 mm boards at 260 mm, diagonal to the grid: every part of 221 mm lies on two or more.
    fn default() -> Self {
        Self {
            board_mm: 19.0,
            pitch_mm: 260.0,
            angle_deg: 45.0,
            sink_mm: 10.0,
            cover_mm: 12.0,
            floor_below_mm: 80.0,
            clearance_mm: 0.5,
            cutter_mm: 6.0,
            inset_mm: 15.0,
            least_length_mm: 120.0,
            least_land_mm: 20.0,
            text_mm: 30.0,
            stock: StockOptions::default(),
        }
    }
}

/// The boards that carry the mold, and the sheets they are cut from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waffle {
    /// W boards, slotted from above, then X boards, slotted from below.
    pub boards: Vec<WaffleBoard>,
    /// What was left out.
    pub dropped: Vec<DroppedBoard>,
    /// Where on the stock the boards are cut, by their number in `boards`.
    pub nest: Nest,
}

/// A flat board with its upper edge along the mold's underside.
#[derive(Clone, Debug, PartialEq)]
pub struct WaffleBoard {
    /// `W1`, `W2`… and `X1`, `X2`….
    pub name: String,
    /// Closed contours, mm: x along the board from its end, y up from the floor.
    pub profile: Vec<Contour>,
    /// Strokes of the name on the face.
    pub engrave: Vec<Vec<DVec2>>,
    /// Width and height of its box, mm.
    pub size_mm: DVec2,
    /// Where its slots are, along x, mm.
    pub slots_mm: Vec<f64>,
    /// From board coordinates (z through the thickness, 0 in its middle) to the mold's.
    pub placement: RigidTransform,
}

/// A board that would have been too short, or would have crossed no other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DroppedBoard {
    /// The middle of its upper edge in plan, mm.
    pub at_mm: DVec2,
    /// Its length, mm.
    pub length_mm: f64,
}

/// What a board cuts into the mold's underside.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Groove {
    run: Run,
    half_mm: f64,
    beyond_mm: f64,
}

/// A board while it is being laid out: its upper edge over the position along its line.
#[derive(Clone, Debug, PartialEq)]
struct Run {
    /// Unit direction of the line in plan; `along.perp()·p = offset_mm` on it.
    along: DVec2,
    offset_mm: f64,
    /// (position along the line, height), ascending.
    edge: Vec<DVec2>,
}

/// A crossing of two boards: positions along both, and the height at which they are halved.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    at: [f64; 2],
    runs: [usize; 2],
    middle_mm: f64,
}

/// Lays out the waffle under a sheet whose mold is `thickness_mm` thick and stands on z = 0.
///
/// # Errors
/// Options that make no sense, a board larger than the stock, a contour that meets itself.
pub(crate) fn design(
    sheet: &HeightField<'_>,
    thickness_mm: f64,
    options: &WaffleOptions,
) -> Result<(Waffle, Vec<Groove>), MoldError> {
    options.check()?;
    let direction = DVec2::from_angle(options.angle_deg.to_radians());
    let mut families = [
        family(sheet, direction, thickness_mm, options)?,
        family(sheet, direction.perp(), thickness_mm, options)?,
    ];
    end_before_shallow_crossings(&mut families, options);
    let mut dropped = drop_short(&mut families, options.least_length_mm);
    dropped.extend(drop_loose(&mut families, options));
    families.iter_mut().flatten().for_each(|run| run.edge = simplified(&run.edge));
    let crossings = crossings(&families, options);
    let mut boards = Vec::new();
    for (side, runs) in families.iter().enumerate() {
        for (number, run) in runs.iter().enumerate() {
            let own = crossings.iter().filter(|c| c.runs[side] == number);
            let slots: Vec<_> = own.map(|c| DVec2::new(c.at[side], c.middle_mm)).collect();
            boards.push(board(run, side, number, slots, options)?);
        }
    }
    let sizes: Vec<_> = boards.iter().map(|b| (b.name.clone(), b.size_mm)).collect();
    let nest = nest(&sizes, &options.stock)?;
    let half_mm = 0.5 * options.slot_mm();
    let groove = |run: Run| Groove { run, half_mm, beyond_mm: options.clearance_mm };
    let grooves = families.into_iter().flatten().map(groove).collect();
    Ok((Waffle { boards, dropped, nest }, grooves))
}

impl WaffleOptions {
    pub(crate) fn check(&self) -> Result<(), MoldError> {
        Setting::of("waffle", "board_mm", "thickness of the waffle boards (mm)").positive(self.board_mm)?;
        Setting::of("waffle", "angle_deg", "direction of the waffle (degrees)").finite(self.angle_deg)?;
        Setting::of("waffle", "clearance_mm", "clearance of the slots (mm)")
            .not_negative(self.clearance_mm)?;
        Setting::inner("sink of the waffle boards (mm)").positive(self.sink_mm)?;
        Setting::inner("floor below the mold (mm)").positive(self.floor_below_mm)?;
        Setting::inner("height of the board names (mm)").positive(self.text_mm)?;
        Setting::inner("cover above the waffle boards (mm)").not_negative(self.cover_mm)?;
        Setting::inner("inset of the waffle boards (mm)").not_negative(self.inset_mm)?;
        Setting::inner("least length of the waffle boards (mm)").not_negative(self.least_length_mm)?;
        Setting::inner("least land of the waffle boards (mm)").not_negative(self.least_land_mm)?;
        PITCH.positive(self.pitch_mm)?;
        PITCH.require(
            self.pitch_mm > self.slot_mm(),
            self.pitch_mm,
            "neighbouring boards would meet: it must be more than a board and its clearance",
        )?;
        let cutter = Setting::of("waffle", "cutter_mm", "diameter of the cutter (mm)");
        cutter.not_negative(self.cutter_mm)?;
        cutter.require(
            SQRT_2 * self.cutter_mm <= self.slot_mm(),
            self.cutter_mm,
            "two reliefs must fit into a slot: cutter < slot/√2",
        )?;
        self.stock.check()
    }

    fn slot_mm(&self) -> f64 {
        self.board_mm + self.clearance_mm
    }
}

/// All boards of one direction, evenly spread over the sheet and centred on it.
fn family(
    sheet: &HeightField<'_>,
    along: DVec2,
    thickness_mm: f64,
    options: &WaffleOptions,
) -> Result<Vec<Run>, MoldError> {
    let plan = sheet.plan();
    let extent = |d: DVec2| {
        let values = || plan.iter().map(|p| d.dot(*p));
        [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
    };
    let ([from, to], across) = (extent(along), extent(along.perp()));
    let width = across[1] - across[0] - 2.0 * options.inset_mm;
    let count = (width / options.pitch_mm).floor().max(0.0);
    let mend = "it asks for more than 1000 boards each way; make it larger";
    PITCH.require(count < MOST_BOARDS, options.pitch_mm, mend)?;
    let first = 0.5 * (across[0] + across[1] - count * options.pitch_mm);
    let runs = (0..=count as usize)
        .flat_map(|k| {
            let offset_mm = first + k as f64 * options.pitch_mm;
            let line = Run { along, offset_mm, edge: Vec::new() };
            let heights = line.heights(sheet, [from, to], thickness_mm, options);
            line.split(&heights, options.inset_mm)
        })
        .collect();
    Ok(runs)
}

impl Run {
    fn plan(&self, s: f64) -> DVec2 {
        self.along * s + self.along.perp() * self.offset_mm
    }

    fn ends(&self) -> [f64; 2] {
        match (self.edge.first(), self.edge.last()) {
            (Some(a), Some(b)) => [a.x, b.x],
            _ => [0.0; 2],
        }
    }

    fn length_mm(&self) -> f64 {
        self.ends()[1] - self.ends()[0]
    }

    /// Height of the upper edge, step by step; none where the board's whole thickness is not under the sheet.
    fn heights(
        &self,
        sheet: &HeightField<'_>,
        [from, to]: [f64; 2],
        thickness_mm: f64,
        options: &WaffleOptions,
    ) -> Vec<(f64, Option<f64>)> {
        let half = 0.5 * options.slot_mm() * self.along.perp();
        let edge = |s: f64| {
            let tops = ACROSS.map(|a| sheet.at(self.plan(s) + a * half));
            let least = tops.into_iter().try_fold(f64::INFINITY, |least, z| Some(least.min(z?)))?;
            Some((tops[ACROSS.len() / 2]? - thickness_mm + options.sink_mm).min(least - options.cover_mm))
        };
        let count = ((to - from) / STEP_MM).floor() as usize;
        (0..=count).map(|k| from + k as f64 * STEP_MM).map(|s| (s, edge(s))).collect()
    }

    /// The boards between the places without a height, each shortened by the inset at both ends.
    fn split(&self, heights: &[(f64, Option<f64>)], inset_mm: f64) -> Vec<Run> {
        let pieces = heights.split(|(_, z)| z.is_none());
        let run = |piece: &[(f64, Option<f64>)]| {
            let (from, to) = (piece.first()?.0 + inset_mm, piece.last()?.0 - inset_mm);
            let inside = piece.iter().filter(|(s, _)| *s >= from && *s <= to);
            let edge: Vec<_> = inside.filter_map(|&(s, z)| Some(DVec2::new(s, z?))).collect();
            (edge.len() > 1).then(|| Run { edge, ..self.clone() })
        };
        pieces.filter_map(run).collect()
    }

    /// Height of the upper edge at a position; the end's beyond the ends.
    fn height_mm(&self, s: f64) -> f64 {
        let i = self.edge.partition_point(|p| p.x < s).clamp(1, self.edge.len() - 1);
        let (a, b) = (self.edge[i - 1], self.edge[i]);
        a.y + (b.y - a.y) * ((s - a.x) / (b.x - a.x)).clamp(0.0, 1.0)
    }

    /// Cuts the board off beyond two positions.
    fn keep(&mut self, from: f64, to: f64) {
        let ends = [from, to].map(|s| DVec2::new(s, self.height_mm(s)));
        self.edge.retain(|p| p.x > from && p.x < to);
        self.edge.insert(0, ends[0]);
        self.edge.push(ends[1]);
    }

    /// Where on this line another crosses it.
    fn crossing(&self, other: &Run) -> f64 {
        self.along.dot(other.along.perp()) * other.offset_mm
    }
}

/// How a crossing lies on a board.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Clear,
    Shallow,
    Deep,
}

fn place(run: &Run, s: f64, options: &WaffleOptions) -> Place {
    let [from, to] = run.ends();
    let gap = 0.5 * options.board_mm + options.clearance_mm;
    let land = 0.5 * options.slot_mm() + options.least_land_mm;
    let near = gap - CLEAR_SLACK_MM;
    if run.length_mm() <= 0.0 || s <= from - near || s >= to + near {
        Place::Clear
    } else if s >= from + land && s <= to - land {
        Place::Deep
    } else {
        Place::Shallow
    }
}

/// Shortens boards that another one crosses too near to their end, until none is left; of two such the X board. A cut
/// takes a board away from a crossing for good, so that there are at most as many rounds as crossings, and one.
fn end_before_shallow_crossings(families: &mut [Vec<Run>; 2], options: &WaffleOptions) {
    let gap = 0.5 * options.board_mm + options.clearance_mm;
    for _ in 0..=families[0].len() * families[1].len() {
        let mut changed = false;
        for w in 0..families[0].len() {
            for x in 0..families[1].len() {
                let (a, b) = (&families[0][w], &families[1][x]);
                let at = [a.crossing(b), b.crossing(a)];
                let places = [place(a, at[0], options), place(b, at[1], options)];
                if places.contains(&Place::Clear) || places == [Place::Deep; 2] {
                    continue;
                }
                let (side, number) = if places[1] == Place::Shallow { (1, x) } else { (0, w) };
                let run = &mut families[side][number];
                let ends = run.ends();
                end_before(run, at[side], gap);
                changed |= run.ends() != ends;
            }
        }
        if !changed {
            break;
        }
    }
}

/// Ends a board before the crossing nearest to one of its ends.
fn end_before(run: &mut Run, s: f64, gap_mm: f64) {
    let [from, to] = run.ends();
    let (from, to) = if s - from < to - s { (s + gap_mm, to) } else { (from, s - gap_mm) };
    if to > from { run.keep(from, to) } else { run.edge.clear() }
}

fn drop_short(families: &mut [Vec<Run>; 2], least_mm: f64) -> Vec<DroppedBoard> {
    let mut dropped = Vec::new();
    for run in families
        .iter_mut()
        .flat_map(|f| f.extract_if(.., |run| run.edge.len() < 2 || run.length_mm() < least_mm))
    {
        dropped.push(dropped_board(&run));
    }
    dropped
}

/// A board that crosses no other cannot stand. To take one away leaves the others' crossings as they are.
fn drop_loose(families: &mut [Vec<Run>; 2], options: &WaffleOptions) -> Vec<DroppedBoard> {
    let crossings = crossings(families, options);
    let mut dropped = Vec::new();
    for (side, runs) in families.iter_mut().enumerate() {
        let mut number = 0;
        runs.retain(|run| {
            let crosses = crossings.iter().any(|c| c.runs[side] == number);
            number += 1;
            if !crosses {
                dropped.push(dropped_board(run));
            }
            crosses
        });
    }
    dropped
}

fn dropped_board(run: &Run) -> DroppedBoard {
    let [from, to] = run.ends();
    DroppedBoard { at_mm: run.plan(0.5 * (from + to)), length_mm: run.length_mm() }
}

/// Fewest points of a polyline that stay within [`EDGE_ERROR_MM`] of it (Douglas and Peucker, 1973).
fn simplified(points: &[DVec2]) -> Vec<DVec2> {
    let [first, .., last] = points else { return points.to_vec() };
    let off = |p: &DVec2| polygon::segment_distance(*p, *first, *last);
    let worst = (1..points.len() - 1).max_by(|&a, &b| off(&points[a]).total_cmp(&off(&points[b])));
    match worst.filter(|&k| off(&points[k]) > EDGE_ERROR_MM) {
        Some(k) => {
            let mut kept = simplified(&points[..=k]);
            kept.pop();
            kept.extend(simplified(&points[k..]));
            kept
        }
        None => vec![*first, *last],
    }
}

fn crossings(families: &[Vec<Run>; 2], options: &WaffleOptions) -> Vec<Crossing> {
    let floor = -options.floor_below_mm;
    let mut found = Vec::new();
    for (w, a) in families[0].iter().enumerate() {
        for (x, b) in families[1].iter().enumerate() {
            let at = [a.crossing(b), b.crossing(a)];
            if place(a, at[0], options) == Place::Deep && place(b, at[1], options) == Place::Deep {
                let top = a.height_mm(at[0]).min(b.height_mm(at[1]));
                found.push(Crossing { at, runs: [w, x], middle_mm: 0.5 * (floor + top) });
            }
        }
    }
    found
}

/// Draws a board; `slots` are positions along its line and heights of the middle of the crossing.
fn board(
    run: &Run,
    side: usize,
    number: usize,
    mut slots: Vec<DVec2>,
    options: &WaffleOptions,
) -> Result<WaffleBoard, MoldError> {
    let name = format!("{}{}", ["W", "X"][side], number + 1);
    let [from, to] = run.ends();
    let corner = DVec2::new(from, -options.floor_below_mm);
    slots.sort_by(|a, b| a.x.total_cmp(&b.x));
    let slots: Vec<_> = slots.iter().map(|s| *s - corner).collect();
    let edge: Vec<_> = run.edge.iter().map(|p| *p - corner).collect();
    let contour = outline(&edge, &slots, side == 0, options);
    if let Some(at) = contour.self_crossing(TEST_CHORD_MM) {
        let faults = vec![format!("its contour meets itself at ({:.1}, {:.1}) mm", at.x, at.y)];
        return Err(MoldError::Invalid { what: format!("waffle board {name}"), faults });
    }
    let along = run.along.extend(0.0);
    let rotation = DMat3::from_cols(along, DVec3::Z, along.cross(DVec3::Z));
    let translation = run.plan(from).extend(corner.y);
    let height = edge.iter().map(|p| p.y).fold(0.0, f64::max);
    Ok(WaffleBoard {
        engrave: engraving(&name, &edge, &slots, options),
        name,
        profile: vec![contour],
        size_mm: DVec2::new(to - from, height),
        slots_mm: slots.iter().map(|s| s.x).collect(),
        placement: RigidTransform { rotation, translation },
    })
}

/// The contour of a board, counter-clockwise from its lower left corner; slots reach half the clearance past the middle.
fn outline(edge: &[DVec2], slots: &[DVec2], from_above: bool, options: &WaffleOptions) -> Contour {
    let half = 0.5 * options.slot_mm();
    let beyond = 0.5 * options.clearance_mm;
    let line = Run { along: DVec2::X, offset_mm: 0.0, edge: edge.to_vec() };
    let [left, right] = line.ends();
    let mut pen = Pen::at(DVec2::new(left, 0.0));
    for s in slots.iter().filter(|_| !from_above) {
        pen.line_to(DVec2::new(s.x - half, 0.0));
        slot(&mut pen, s.x, s.y + beyond, -half, options.cutter_mm);
        pen.line_to(DVec2::new(s.x + half, 0.0));
    }
    pen.line_to(DVec2::new(right, 0.0));
    let mut reached = right;
    let along_edge = |pen: &mut Pen, from: f64, to: f64| {
        pen.line_to(DVec2::new(from, line.height_mm(from)));
        edge.iter().rev().filter(|p| p.x < from && p.x > to).for_each(|p| pen.line_to(*p));
        pen.line_to(DVec2::new(to, line.height_mm(to)));
    };
    for s in slots.iter().rev().filter(|_| from_above) {
        along_edge(&mut pen, reached, s.x + half);
        slot(&mut pen, s.x, s.y - beyond, half, options.cutter_mm);
        reached = s.x - half;
    }
    along_edge(&mut pen, reached, left);
    pen.close()
}

/// Draws a slot's walls and end with a half circle of the cutter's radius through each corner ("dog bone"), from the
/// wall at `x + half` to the one at `x − half`; upwards into the board if `half` is negative, downwards otherwise.
fn slot(pen: &mut Pen, x: f64, end: f64, half: f64, cutter_mm: f64) {
    let radius = 0.5 * cutter_mm;
    let forward = DVec2::new(-half.signum(), 0.0);
    let inward = DVec2::new(0.0, -half.signum());
    let corners = [DVec2::new(x + half, end), DVec2::new(x - half, end)];
    let (reach, shift) = (SQRT_2 * radius, FRAC_1_SQRT_2 * radius);
    pen.line_to(corners[0] - reach * inward);
    if radius > 0.0 {
        pen.arc_to(corners[0] + reach * forward, corners[0] + shift * (forward - inward), false);
        pen.line_to(corners[1] - reach * forward);
        pen.arc_to(corners[1] - reach * inward, corners[1] - shift * (forward + inward), false);
    } else {
        pen.line_to(corners[1]);
    }
}

/// The name in the middle of the widest land between slots.
fn engraving(name: &str, edge: &[DVec2], slots: &[DVec2], options: &WaffleOptions) -> Vec<Vec<DVec2>> {
    let ends = [edge[0].x, edge[edge.len() - 1].x];
    let mut stops = vec![ends[0]];
    stops.extend(slots.iter().flat_map(|s| [s.x - 0.5 * options.slot_mm(), s.x + 0.5 * options.slot_mm()]));
    stops.push(ends[1]);
    let lands = stops.chunks(2).map(|w| (w[1] - w[0], 0.5 * (w[0] + w[1])));
    let (width, middle) = lands.fold((0.0, 0.0), |best, l| if l.0 > best.0 { l } else { best });
    let least = edge.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let room = (width - 2.0 * NAME_MARGIN_MM).max(0.0);
    let wanted = options.text_mm.min(NAME_SHARE * least);
    let text_mm = wanted * (room / glyphs::width_mm(name, wanted)).min(1.0);
    let corner = DVec2::new(middle - 0.5 * glyphs::width_mm(name, text_mm), NAME_MARGIN_MM);
    glyphs::text(name, text_mm).into_iter().map(|line| line.iter().map(|p| *p + corner).collect()).collect()
}

impl Groove {
    /// Whether the groove comes within `wall_mm` of a rectangle in plan.
    pub(crate) fn meets(&self, center: DVec2, half: DVec2, wall_mm: f64) -> bool {
        let [from, to] = self.run.ends();
        let (along, across) = (self.run.along, self.run.along.perp());
        let reach = |d: DVec2| d.abs().dot(half) + wall_mm;
        let (s, t) = (along.dot(center), across.dot(center) - self.run.offset_mm);
        let along_reach = reach(along) + self.beyond_mm;
        t.abs() < self.half_mm + reach(across) && s > from - along_reach && s < to + along_reach
    }

    /// The regions of the groove that come near a rectangle in plan.
    pub(crate) fn regions(&self, center: DVec2, half: DVec2, near_mm: f64) -> Vec<Region> {
        let edge = &self.run.edge;
        let last = edge.len() - 2;
        let piece = |(k, w): (usize, &[DVec2])| {
            let steep = (w[1].y - w[0].y) / (w[1].x - w[0].x);
            let from = w[0].x - if k == 0 { self.beyond_mm } else { 0.0 };
            let to = w[1].x + if k == last { self.beyond_mm } else { 0.0 };
            let (a, b) = (self.run.plan(from), self.run.plan(to));
            Region {
                corners: Region::around(a, b, self.half_mm, 0.0),
                at: self.run.plan(w[0].x),
                height_mm: w[0].y,
                slope: steep * self.run.along,
            }
        };
        let near = |r: &Region| {
            let (lower, upper) = polygon::bounds(&r.corners);
            let apart = (lower - center - half).max(center - half - upper);
            apart.max_element() < near_mm
        };
        edge.windows(2).enumerate().map(piece).filter(near).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::TrimIndex;
    use crate::shapes;
    use crate::top::{Patch, triangulate};
    use softfold_geometry::SheetSurface;

    const THICKNESS_MM: f64 = 50.0;

    fn patch(sheet: &SheetSurface) -> Patch {
        triangulate(sheet, &TrimIndex::new(sheet).unwrap(), 0.05).unwrap()
    }

    fn waffle(patch: &Patch) -> (Waffle, Vec<Groove>) {
        design(&HeightField::new(patch), THICKNESS_MM, &WaffleOptions::default()).unwrap()
    }

    fn wavy() -> Patch {
        patch(&shapes::corrugation(shapes::ellipse(600.0, 350.0)))
    }

    /// Heights at which a board has material above a place along it, as (from, to).
    fn material(board: &WaffleBoard, x: f64) -> Vec<f64> {
        let polygon = board.profile[0].flatten(0.01);
        let at = |(a, b): (DVec2, DVec2)| {
            ((a.x > x) != (b.x > x)).then(|| a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x))
        };
        let mut heights: Vec<f64> = polygon::edges(&polygon).filter_map(at).collect();
        heights.sort_by(f64::total_cmp);
        heights
    }

    #[test]
    fn slots_of_crossing_boards_meet_with_their_clearance() {
        let (waffle, _) = waffle(&wavy());
        let (w, x): (Vec<_>, Vec<_>) = waffle.boards.iter().partition(|b| b.name.starts_with('W'));
        let mut met = 0;
        for (a, sa) in w.iter().flat_map(|b| b.slots_mm.iter().map(move |s| (b, *s))) {
            let plan = |b: &WaffleBoard, s: f64| b.placement.point(DVec3::X * s);
            let partner = x.iter().flat_map(|b| b.slots_mm.iter().map(move |s| (b, *s)));
            let (b, sb) = { partner }.find(|(b, s)| plan(b, *s).distance(plan(a, sa)) < 1e-6).unwrap();
            let (below, above) = (material(a, sa), material(b, sb));
            assert!(below[0].abs() < 1e-9 && below.len() == 2 && above.len() == 2);
            assert!((above[0] - below[1] - 0.5).abs() < 1e-6, "{below:?} {above:?}");
            met += 1;
        }
        assert_eq!(met, x.iter().map(|b| b.slots_mm.len()).sum::<usize>());
        assert!(met > 5);
    }

    #[test]
    fn upper_edges_follow_the_underside() {
        let patch = wavy();
        let field = HeightField::new(&patch);
        let (waffle, _) = waffle(&patch);
        for board in &waffle.boards {
            for k in 1..40 {
                let x = board.size_mm.x * k as f64 / 40.0;
                if board.slots_mm.iter().any(|s| (s - x).abs() < 15.0) {
                    continue;
                }
                let top = board.placement.point(DVec3::new(x, *material(board, x).last().unwrap(), 0.0));
                let sunk = top.z - (field.at(top.truncate()).unwrap() - THICKNESS_MM);
                assert!((sunk - 10.0).abs() < 0.15, "{} at {x}: {sunk}", board.name);
            }
        }
    }

    #[test]
    fn boards_stand_on_one_floor_inside_the_outline() {
        let patch = wavy();
        let field = HeightField::new(&patch);
        for board in waffle(&patch).0.boards {
            assert_eq!(board.placement.translation.z, -80.0);
            for x in [0.0, board.size_mm.x] {
                assert!([-9.5, 9.5].iter().all(|&z| {
                    field.at(board.placement.point(DVec3::new(x, 0.0, z)).truncate()).is_some()
                }));
            }
            let up = board.placement.rotation * DVec3::Y;
            assert!(
                up.distance(DVec3::Z) < 1e-12 && (board.placement.rotation.determinant() - 1.0).abs() < 1e-12
            );
        }
    }

    #[test]
    fn every_square_of_221_lies_on_a_board_of_each_family() {
        let patch = patch(&shapes::flat(shapes::rectangle(1400.0, 900.0)));
        let (_, grooves) = waffle(&patch);
        for k in 0..200 {
            let center = DVec2::new(((k * 53) % 900) as f64 - 450.0, ((k * 97) % 400) as f64 - 200.0);
            let under = |w: bool| {
                let along = |g: &&Groove| (g.run.along.x * g.run.along.y > 0.0) == w;
                grooves.iter().filter(along).any(|g| g.meets(center, DVec2::splat(110.5), 0.0))
            };
            assert!(under(true) && under(false), "{center}");
        }
    }

    #[test]
    fn a_steep_sheet_keeps_its_cover() {
        // A ridge of 55° to both sides: the board's width falls by 28 mm.
        let steep = |p: DVec2| DVec3::new(p.x, p.y, 300.0 - 1.43 * p.x.abs());
        let patch = patch(&shapes::sheet(shapes::rectangle(360.0, 700.0), steep));
        let field = HeightField::new(&patch);
        let thin = 22.0;
        let (_, grooves) = design(&field, thin, &WaffleOptions::default()).unwrap();
        let mut seen = 0;
        for region in grooves.iter().flat_map(|g| g.regions(DVec2::ZERO, DVec2::splat(1e3), 0.0)) {
            let cover = field.at(region.at).unwrap() - region.height_mm;
            assert!(cover >= 11.9, "{cover}");
            seen += 1;
        }
        assert!(seen > 5);
    }

    #[test]
    fn boards_that_cross_no_other_are_dropped_with_their_grooves() {
        let patch = patch(&shapes::flat(shapes::ellipse(420.0, 80.0)));
        let options = WaffleOptions { least_length_mm: 20.0, ..Default::default() };
        let (waffle, grooves) = design(&HeightField::new(&patch), THICKNESS_MM, &options).unwrap();
        assert!(waffle.boards.len() > 1 && waffle.boards.iter().all(|b| !b.slots_mm.is_empty()));
        assert!(!waffle.dropped.is_empty(), "so narrow a sheet has boards that cross none");
        assert_eq!(grooves.len(), waffle.boards.len());
    }

    #[test]
    fn short_boards_are_dropped_and_told() {
        let patch = patch(&shapes::flat(shapes::ellipse(300.0, 110.0)));
        let options = WaffleOptions { least_length_mm: 200.0, ..Default::default() };
        let (waffle, _) = design(&HeightField::new(&patch), THICKNESS_MM, &options).unwrap();
        assert!(!waffle.dropped.is_empty());
        assert!(waffle.dropped.iter().all(|d| d.length_mm < 200.0));
        assert!(waffle.boards.iter().all(|b| b.size_mm.x >= 200.0));
    }

    #[test]
    fn a_cutter_too_thick_for_its_slots_is_refused() {
        let patch = patch(&shapes::flat(shapes::rectangle(600.0, 400.0)));
        let options = WaffleOptions { cutter_mm: 16.0, ..Default::default() };
        let refused = design(&HeightField::new(&patch), THICKNESS_MM, &options);
        assert!(matches!(
            refused,
            Err(MoldError::Option { table: "waffle", key: "cutter_mm", value: 16.0, .. })
        ));
    }

    fn run(along: DVec2, offset_mm: f64, [from, to]: [f64; 2]) -> Run {
        Run { along, offset_mm, edge: vec![DVec2::new(from, 40.0), DVec2::new(to, 40.0)] }
    }

    #[test]
    fn a_cut_board_is_clear_of_its_crossing_whatever_the_rounding() {
        // 0.1 + 10 − 10 is a little less than 0.1: this went on for ever.
        let w = run(DVec2::X, 0.1, [-500.0, 500.0]);
        let x = run(DVec2::Y, 0.0, [0.0, 500.0]);
        let mut families = [vec![w.clone()], vec![x]];
        end_before_shallow_crossings(&mut families, &WaffleOptions::default());
        assert_eq!(families[0], [w]);
        assert_eq!(families[1][0].ends(), [10.1, 500.0]);
    }

    #[test]
    fn a_cut_leaves_no_shallow_crossing() {
        let options = WaffleOptions::default();
        for k in 0..2000 {
            let s = 0.013 * k as f64;
            let mut left = run(DVec2::X, 0.0, [0.0, 500.0]);
            end_before(&mut left, s, 10.0);
            assert!(place(&left, s, &options) == Place::Clear, "{s}");
            let mut right = run(DVec2::X, 0.0, [0.0, 500.0]);
            end_before(&mut right, 500.0 - s, 10.0);
            assert!(place(&right, 500.0 - s, &options) == Place::Clear, "{s}");
        }
    }

    #[test]
    fn a_pitch_that_asks_for_countless_boards_is_refused() {
        let patch = patch(&shapes::flat(shapes::rectangle(600.0, 400.0)));
        for options in [
            WaffleOptions { pitch_mm: 19.0, ..Default::default() },
            WaffleOptions {
                pitch_mm: 1e-9,
                board_mm: 1e-10,
                clearance_mm: 0.0,
                cutter_mm: 0.0,
                ..Default::default()
            },
        ] {
            let refused = design(&HeightField::new(&patch), THICKNESS_MM, &options).unwrap_err();
            assert_eq!(refused.place(), ("waffle", "pitch_mm"), "{refused}");
        }
    }

    #[test]
    fn reliefs_have_the_cutters_radius_and_pass_the_corners() {
        let (waffle, _) = waffle(&patch(&shapes::flat(shapes::rectangle(700.0, 600.0))));
        let board = waffle.boards.iter().find(|b| b.name.starts_with('X')).unwrap();
        let half = 0.5 * 19.5;
        let mut arcs = 0;
        for segment in &board.profile[0].segments {
            if let crate::ProfileSegment::Arc { from, to, center, .. } = *segment {
                assert!(
                    (from.distance(center) - 3.0).abs() < 1e-9 && (to.distance(center) - 3.0).abs() < 1e-9
                );
                let corner_x = |s: &f64| [s - half, s + half];
                let near = board.slots_mm.iter().flat_map(corner_x).map(|x| (x - center.x).abs());
                assert!((near.fold(f64::MAX, f64::min) - 3.0 * FRAC_1_SQRT_2).abs() < 1e-9);
                arcs += 1;
            }
        }
        assert_eq!(arcs, 2 * board.slots_mm.len());
    }
}
