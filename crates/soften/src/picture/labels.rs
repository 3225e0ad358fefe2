//! Labels beside the middles of the bands, where they hide least.

use super::{View, colour, number, range};
use softfold_geometry::{Band, DVec2, SoftPattern, polygon, text};
use std::fmt::Write;

/// Height of the letters as a share of the sheet's size.
const LETTER_SHARE: f64 = 0.014;
/// With more labels than this the letters shrink, so that together they cover the same area.
const AT_FULL_SIZE: f64 = 24.0;
/// Mean width of a letter and distance of lines, in heights of letters.
const LETTER_WIDTH: f64 = 0.54;
const LINE_HEIGHT: f64 = 1.2;
/// Places along a band that are tried, as shares of its middle line.
const TRIED: [f64; 7] = [0.5, 0.35, 0.65, 0.2, 0.8, 0.08, 0.92];
/// An overlapped label counts as much as so many hidden pieces of lines.
const OVERLAP_COST: usize = 1000;
/// With more labels than this each is put at the middle of its band without a look at the others.
const MOST_SEARCHED: usize = 200;

/// What a label says, and where it may be.
pub(super) struct Label {
    lines: Vec<String>,
    colour: &'static str,
    /// Points on the band with the direction to its left and its half width.
    places: Vec<(DVec2, DVec2, f64)>,
}

impl Label {
    pub(super) fn of(name: &str, band: &Band) -> Self {
        let radius = range(band.profile.iter().map(|e| e.radius_mm), " mm");
        let angle = range(band.profile.iter().map(|e| e.fold_angle_rad.to_degrees()), "°");
        let soft = band.fold_lines.iter().any(|l| l.rank.is_some());
        let strips = if band.segments == 1 { "strip" } else { "strips" };
        let lines = match soft {
            true => vec![
                format!("{name}: r {radius}, {angle}"),
                format!("{} {strips}, {}", band.segments, turns(band)),
            ],
            false => vec![format!("{name}: sharp, {angle}")],
        };
        let colour = band.fold_lines.first().map_or(super::INK, colour);
        Self { lines, colour, places: places(band) }
    }
}

/// The turns of a band's inner and outer lines.
fn turns(band: &Band) -> String {
    let n = f64::from(band.segments);
    let turn = |share: f64| range(band.profile.iter().map(|e| (share * e.fold_angle_rad).to_degrees()), "°");
    match band.segments {
        1 => format!("turns {}", turn(0.5)),
        _ => format!("turns {}, outer {}", turn(1.0 / n), turn(0.5 / n)),
    }
}

fn places(band: &Band) -> Vec<(DVec2, DVec2, f64)> {
    let longest = band.fold_lines.iter().filter(|l| l.rank.is_none_or(|k| k == band.segments / 2));
    let length = |l: &&softfold_geometry::FoldLine| polygon::length_mm(&l.points);
    let Some(line) = longest.max_by(|a, b| length(a).total_cmp(&length(b))) else { return Vec::new() };
    TRIED.iter().map(|share| along(&line.points, *share * length(&line), band.half_width_mm())).collect()
}

fn along(points: &[DVec2], mut rest: f64, half_width: f64) -> (DVec2, DVec2, f64) {
    for w in points.windows(2) {
        let step = w[0].distance(w[1]);
        if rest <= step && step > 0.0 {
            return (w[0].lerp(w[1], rest / step), (w[1] - w[0]).normalize_or_zero().perp(), half_width);
        }
        rest -= step;
    }
    (points[points.len() - 1], DVec2::Y, half_width)
}

/// A box on the sheet.
type Rect = (DVec2, DVec2);

/// Where a label may be: its box, and the place of the band that it speaks of.
#[derive(Clone, Copy)]
struct Spot {
    rect: Rect,
    at: DVec2,
}

/// Puts labels on the drawing.
pub(super) struct Labels<'a> {
    view: &'a View,
    soft: &'a SoftPattern,
    letter: f64,
    search: bool,
}

impl<'a> Labels<'a> {
    pub(super) fn new(view: &'a View, soft: &'a SoftPattern, count: usize) -> Self {
        let shrink = (AT_FULL_SIZE / count.max(1) as f64).sqrt().min(1.0);
        Self { view, soft, letter: LETTER_SHARE * view.scale * shrink, search: count <= MOST_SEARCHED }
    }

    pub(super) fn write(&self, out: &mut String, labels: &[Label]) {
        let _ = writeln!(
            out,
            "<g font-size=\"{}\" text-anchor=\"middle\" stroke=\"#ffffff\" stroke-width=\"{}\" \
             stroke-linejoin=\"round\" paint-order=\"stroke\">",
            number(self.letter),
            number(0.25 * self.letter)
        );
        let mut taken: Vec<Rect> = Vec::new();
        for label in labels {
            let spots = self.candidates(label);
            let overlaps = |s: &Spot| taken.iter().filter(|t| overlap(&s.rect, t)).count();
            let cost = |s: &&Spot| OVERLAP_COST * overlaps(s) + self.hidden(&s.rect);
            let best = if self.search { spots.iter().min_by_key(cost) } else { spots.first() };
            if let Some(spot) = best {
                self.label(out, label, spot);
                taken.push(spot.rect);
            }
        }
        out.push_str("</g>\n");
    }

    fn size(&self, label: &Label) -> DVec2 {
        let letters = label.lines.iter().map(|l| l.chars().count()).max().unwrap_or(0);
        self.letter * DVec2::new(LETTER_WIDTH * letters as f64, LINE_HEIGHT * label.lines.len() as f64)
    }

    /// Boxes beside the band, on both sides, kept on the page.
    fn candidates(&self, label: &Label) -> Vec<Spot> {
        let size = self.size(label);
        let low = self.view.low + 0.5 * size;
        let high = (self.view.high - 0.5 * size).max(low);
        let mut spots = Vec::new();
        for (at, left, half_width) in &label.places {
            for side in [1.0, -1.0] {
                let normal = side * *left;
                // The box just clears the band: its support in the direction of the normal.
                let support = 0.5 * (size.x * normal.x.abs() + size.y * normal.y.abs());
                let middle = (*at + (half_width + support + 0.4 * self.letter) * normal).clamp(low, high);
                spots.push(Spot { rect: (middle - 0.5 * size, middle + 0.5 * size), at: *at });
            }
        }
        spots
    }

    /// How many pieces of fold lines and outlines a box hides.
    fn hidden(&self, rect: &Rect) -> usize {
        let lines = self.soft.bands.iter().flat_map(|b| &b.fold_lines).map(|l| &l.points);
        lines.map(|l| l.windows(2).filter(|w| crosses(rect, w[0], w[1])).count()).sum::<usize>()
    }

    /// The lines of a label, and one that leads from it to its band.
    fn label(&self, out: &mut String, label: &Label, spot: &Spot) {
        let (low, high) = spot.rect;
        let colour = label.colour;
        let leader = self.view.polyline(&[spot.at, spot.at.clamp(low, high)]);
        let _ = writeln!(
            out,
            "<path d=\"{leader}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"/>",
            number(self.view.stroke())
        );
        let top = DVec2::new(0.5 * (low.x + high.x), high.y);
        for (i, line) in label.lines.iter().enumerate() {
            let base = top - DVec2::new(0.0, (LINE_HEIGHT * i as f64 + 0.9) * self.letter);
            let place = self.view.point(base).replacen(' ', "\" y=\"", 1);
            let _ = writeln!(out, "<text x=\"{place}\" fill=\"{colour}\">{}</text>", text::escape_xml(line));
        }
    }
}

fn overlap(a: &Rect, b: &Rect) -> bool {
    a.0.cmplt(b.1).all() && b.0.cmplt(a.1).all()
}

/// Whether a straight piece meets a box: its part within the box's slabs is not empty.
fn crosses((low, high): &Rect, a: DVec2, b: DVec2) -> bool {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (start, step) = (a[axis], b[axis] - a[axis]);
        if step == 0.0 {
            if start < low[axis] || start > high[axis] {
                return false;
            }
            continue;
        }
        let [x, y] = [(low[axis] - start) / step, (high[axis] - start) / step];
        (from, to) = (from.max(x.min(y)), to.min(x.max(y)));
    }
    from <= to
}
