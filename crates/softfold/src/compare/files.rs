//! The files of a comparison: figures, coloured mesh, page.

use super::{Comparison as Compared, Figures, Source};
use crate::export::ply;
use crate::output::Staging;
use crate::report::compare_page::{self, Page};
use crate::report::html::Picture;
use crate::report::json::File;
use crate::report::picture::{Colours, Legend, Scale, Scene, SceneMesh, View, fitting_size, render};
use crate::{RunError, patterns};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the layout of compare.json; a field that changes its meaning or goes away changes the number.
pub const SCHEMA: &str = "softfold-compare/1";

/// compare.json. Lengths in mm; the frame is that of the second shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Always [`SCHEMA`].
    pub schema: String,
    /// Version of softfold that made it.
    pub version: String,
    /// The shape whose points are measured.
    pub measured: Source,
    /// The shape they are measured against.
    pub against: Source,
    /// How the first was moved; none where it was taken as it lies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alignment: Option<Motion>,
    /// Distances of the first's points from the second.
    pub distance: Figures,
    /// Distances of the second's points from the first, if asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_back: Option<Figures>,
    /// Largest distance allowed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit_mm: Option<f64>,
    /// Whether all distances are within it; true where there is none.
    pub passes: bool,
    /// What a user should know.
    pub remarks: Vec<String>,
    /// The files of this comparison.
    pub files: Vec<File>,
}

/// How the first shape was moved onto the second.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// `found` or `given`.
    pub start: String,
    /// Rows of the rotation.
    pub rotation: [[f64; 3]; 3],
    /// Shift after it, mm.
    pub translation_mm: [f64; 3],
    /// The same rotation as an angle, degrees.
    pub angle_deg: f64,
    /// About this unit axis.
    pub axis: [f64; 3],
    /// What closest points came to; none for a pose that was only taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closest_points: Option<ClosestPoints>,
}

/// How iterated closest points ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClosestPoints {
    /// Steps of the final round.
    pub iterations: usize,
    /// Whether they came to rest.
    pub converged: bool,
    /// Root mean square distance of the pairs that count, mm.
    pub rms_mm: f64,
    /// Share of pairs that do not count because they are too far apart.
    pub trimmed: f64,
    /// How many of the six motions nothing holds.
    pub free_motions: u8,
    /// Starts that were tried.
    pub starts: usize,
    /// Whether the mirror image fits where the shape itself does not.
    pub mirror_fits: bool,
}

impl From<&Compared> for Comparison {
    fn from(c: &Compared) -> Self {
        let [measured, against] = c.sources.clone();
        Self {
            schema: SCHEMA.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            measured,
            against,
            alignment: motion(c),
            distance: c.forth.clone(),
            distance_back: c.back.clone(),
            limit_mm: c.limit_mm,
            passes: c.passes(),
            remarks: c.remarks.clone(),
            files: Vec::new(),
        }
    }
}

fn motion(c: &Compared) -> Option<Motion> {
    let motion = c.motion.as_ref()?;
    let (axis, angle) = motion.axis_angle();
    let found = c.alignment.as_ref().is_some_and(|a| a.starts > 0);
    Some(Motion {
        start: if found { "found" } else { "given" }.to_owned(),
        rotation: motion.rows(),
        translation_mm: motion.translation.to_array(),
        angle_deg: angle.to_degrees(),
        axis: axis.to_array(),
        closest_points: c.alignment.as_ref().map(|a| ClosestPoints {
            iterations: a.iterations,
            converged: a.converged,
            rms_mm: a.rms_mm,
            trimmed: a.trimmed,
            free_motions: a.free_motions,
            starts: a.starts,
            mirror_fits: a.mirror_fits,
        }),
    })
}

/// Width of a picture, px, and the heights allowed.
const WIDTH_PX: u32 = 620;
const HEIGHTS_PX: std::ops::RangeInclusive<u32> = 320..=980;

/// Writes compare.json, compare.ply and compare.html into a folder and gives the first's content.
///
/// # Errors
/// A folder that cannot be written.
pub fn write(compared: &Compared, out: &Path) -> Result<Comparison, RunError> {
    let staging = Staging::recorded(out, "compare.json")?;
    let mut record = Comparison::from(compared);
    let file = |path: &str, purpose: &str| File { path: path.to_owned(), purpose: purpose.to_owned() };
    record.files = vec![
        file("compare.ply", "the measured shape in the other's frame, coloured by distance"),
        file("compare.json", "all figures"),
        file("compare.html", "figures, histogram and pictures on one page"),
    ];
    let (scale, legend) = scale(compared);
    let colours = scale.colours(&compared.shown_mm);
    let scalars = [ply::Scalar { name: "distance", values: &compared.shown_mm }];
    let shown = &compared.shown;
    let title = patterns::name_of(&record.measured.path);
    let mesh = ply::coloured(&title, &shown.positions, &shown.triangles, &colours, &scalars);
    staging.write("compare.ply", mesh)?;
    let views = views(compared, &colours, &legend)?;
    let placement = compared.placement();
    let page = Page { record: &record, placement: &placement, views: &views, scale: &scale };
    staging.write("compare.html", compare_page::html(&page))?;
    let text = serde_json::to_string_pretty(&record).map_err(super::defect)?;
    staging.write("compare.json", text + "\n")?;
    staging.publish()?;
    Ok(record)
}

/// Colours of distances: strongest at the 99th percentile, so that a few astray do not pale the rest.
fn scale(c: &Compared) -> (Scale, Legend) {
    /// Shapes that agree to this are shown without colour, mm.
    const NOTHING_MM: f64 = 1e-6;
    let limit = c.forth.p99_mm.max(NOTHING_MM);
    let word = |v: f64| crate::report::words::with_unit(v, "mm");
    if c.forth.signed.is_some() {
        let scale = Scale::diverging(limit);
        let legend = scale.legend("distance, with sign", [word(-limit), word(limit)]);
        (scale, legend)
    } else {
        let scale = Scale::sequential(0.0, limit);
        let legend = scale.legend("distance", [word(0.0), word(limit)]);
        (scale, legend)
    }
}

fn views(c: &Compared, colours: &[[u8; 3]], legend: &Legend) -> Result<Vec<Picture>, RunError> {
    let mesh = SceneMesh {
        positions: c.shown.positions.clone(),
        triangles: c.shown.triangles.clone(),
        colours: Colours::PerVertex(colours.to_vec()),
    };
    let scene = Scene { meshes: vec![mesh], ..Scene::default() };
    let shot = |view: View| {
        let size = fitting_size(&scene, &view, WIDTH_PX, HEIGHTS_PX);
        let png = render(&scene, &view, size).map_err(super::defect)?;
        Ok(Picture { title: format!("distance, {}", view.name), png, legend: Some(legend.clone()) })
    };
    View::standard().into_iter().map(shot).collect()
}
