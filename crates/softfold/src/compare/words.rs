//! A comparison in words.

use super::{Alignment, Comparison, Figures, Source};

/// A fit whose pairs are farther off than this share of the size is no fit.
const POOR: f64 = 5e-3;
/// As they lie, shapes whose median distance is above this share of the size were not meant to lie so.
const APART: f64 = 0.02;
/// A share of points that is worth a remark.
const MANY: f64 = 0.02;
/// Units that scans come in, mm, and how near a ratio of sizes must be to one.
const UNITS: [(&str, f64); 3] = [("metres", 1000.0), ("inches", 25.4), ("centimetres", 10.0)];
const UNIT_SLACK: f64 = 0.15;

/// What a user should know about a comparison; `size_mm` is the second's.
pub(super) fn remarks(c: &Comparison, size_mm: f64) -> Vec<String> {
    let mut remarks = Vec::new();
    remarks.extend(unit_remark(c));
    match &c.alignment {
        Some(a) => remarks.extend(alignment_remarks(a, size_mm)),
        None if c.forth.p50_mm > APART * size_mm => {
            remarks.push(
                "the two lie far apart as they are; --align rigid moves the first onto the second".to_owned(),
            );
        }
        None => {}
    }
    let f = &c.forth;
    if f.past_border as f64 > MANY * f.points as f64 {
        remarks.push(format!(
            "{:.0} % of the points lie past the border of the second, which may show a part only: compare the other way \
             round, or leave them out by --leave-out-mm",
            100.0 * f.past_border as f64 / f.points as f64
        ));
    }
    if !c.sources[1].oriented {
        remarks.push(
            "distances have no sign, because triangles of the second do not agree on their sides; `softfold scan` \
             turns them"
                .to_owned(),
        );
    }
    remarks
}

/// Shapes of one kind in two units.
fn unit_remark(c: &Comparison) -> Option<String> {
    let [a, b] = c.sources.each_ref().map(|s| s.area_mm2.sqrt());
    let near = |ratio: f64, unit: f64| (ratio / unit - 1.0).abs() < UNIT_SLACK;
    let (name, mm) = UNITS.iter().find(|(_, mm)| near(a / b, *mm) || near(b / a, *mm))?;
    let which = if a < b { "first" } else { "second" };
    Some(format!("the {which} is {mm} times smaller than the other: if it is in {name}, give --unit-mm {mm}"))
}

fn alignment_remarks(a: &Alignment, size_mm: f64) -> Vec<String> {
    let mut remarks = Vec::new();
    if a.mirror_fits {
        remarks.push(
            "the first does not fit, but its mirror image does: one of the two is mirrored; mirror the scan, or check the \
             axes it was exported with"
                .to_owned(),
        );
    } else if a.rms_mm > POOR * size_mm {
        remarks.push(
            "the two do not fit well in the pose that was found; give a coarse one by --pose".to_owned(),
        );
    }
    if a.free_motions > 0 {
        remarks.push(format!(
            "the shapes do not hold {} of the six motions, a part of a cylinder slides along itself for example; along \
             those the pose is that of the start",
            a.free_motions
        ));
    }
    if !a.converged {
        remarks.push("the alignment did not come to rest; give a coarse pose by --pose".to_owned());
    }
    remarks
}

impl Comparison {
    /// What came out, in a few lines.
    pub fn words(&self) -> String {
        let [a, b] = &self.sources;
        let mut lines = vec![format!("measured {}", source(a)), format!("against  {}", source(b))];
        lines.push(format!("placed   {}", self.placement()));
        lines.extend(figures(&self.forth));
        if let Some(back) = &self.back {
            lines.push("the other way round".to_owned());
            lines.extend(figures(back));
        }
        if let Some(limit) = self.limit_mm {
            let verdict = if self.passes() { "within" } else { "above" };
            lines.push(format!(
                "limit    {limit} mm: the largest distance, {:.4} mm, is {verdict} it",
                self.max_mm()
            ));
        }
        lines.extend(self.remarks.iter().map(|r| format!("note     {r}")));
        lines.join("\n")
    }

    /// How the first was placed, in words.
    pub(crate) fn placement(&self) -> String {
        let Some(motion) = &self.motion else { return "as they lie".to_owned() };
        let (axis, angle) = motion.axis_angle();
        let t = motion.translation;
        let moved = format!(
            "turned {:.3}° about ({:.3}, {:.3}, {:.3}), shifted by ({:.3}, {:.3}, {:.3}) mm",
            angle.to_degrees(),
            axis.x,
            axis.y,
            axis.z,
            t.x,
            t.y,
            t.z
        );
        match &self.alignment {
            Some(a) => format!(
                "{moved}; {} steps, {:.4} mm rms over the {:.1} % that count",
                a.iterations,
                a.rms_mm,
                100.0 * (1.0 - a.trimmed)
            ),
            None => format!("{moved}, as given"),
        }
    }
}

fn source(s: &Source) -> String {
    let chord = s.chord_mm.map(|c| format!(", for faces with a chord of {c} mm")).unwrap_or_default();
    format!("{}: {} vertices, {} triangles{chord}", s.path.display(), s.vertices, s.triangles)
}

fn figures(f: &Figures) -> Vec<String> {
    let from = if f.sampling == "spread" { "points spread over the area" } else { "vertices" };
    let left = if f.left_out > 0 { format!(", {} left out", f.left_out) } else { String::new() };
    let [x, y, z] = f.max_at_mm;
    let mut lines = vec![
        format!("points   {} {from}{left}", f.points),
        format!("largest  {:.4} mm at ({x:.1}, {y:.1}, {z:.1}) mm", f.max_mm),
        format!("rms      {:.4} mm, mean {:.4} mm", f.rms_mm, f.mean_mm),
        format!(
            "nearest  50 % within {:.4} mm, 90 % within {:.4} mm, 99 % within {:.4} mm",
            f.p50_mm, f.p90_mm, f.p99_mm
        ),
    ];
    lines.extend(f.signed.map(|s| {
        format!(
            "signed   {:+.4} to {:+.4} mm, mean {:+.4} mm, deviation {:.4} mm",
            s.min_mm, s.max_mm, s.mean_mm, s.deviation_mm
        )
    }));
    lines
}
