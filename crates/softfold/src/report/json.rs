//! `report.json`. Lengths in mm, areas mm², volumes mm³, masses kg, angles in degrees unless the name
//! says `_rad`; strains and area errors are ratios (0.01 is 1 %). Positions `at` are (u, v) on the flat
//! sheet. Sections that a run did not reach are absent. Fields named `seconds` are the only ones that
//! may differ between two runs of the same project.

use serde::{Deserialize, Serialize};

/// Version of the layout; a field that changes its meaning or goes away changes the number.
pub const SCHEMA: &str = "softfold-report/1";

/// The whole report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Always [`SCHEMA`].
    pub schema: String,
    /// Version of softfold that made it.
    pub version: String,
    /// The pattern.
    pub pattern: Pattern,
    /// The flat mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<Mesh>,
    /// The folding simulation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fold: Option<Fold>,
    /// What the folded sheet asks of its material.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub analyse: Option<Analyse>,
    /// The NURBS surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<Surface>,
    /// The thick board.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub board: Option<Board>,
    /// How the board stands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    /// The mold.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mold: Option<Mold>,
    /// What was checked against a limit.
    pub verdicts: Vec<Verdict>,
    /// The files of this run.
    pub files: Vec<File>,
    /// How long each stage took.
    pub stages: Vec<Stage>,
}

/// The pattern and its soft creases.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pattern {
    /// Name of the pattern.
    pub name: String,
    /// Its creases.
    pub creases: Vec<Crease>,
    /// Area of the sheet, mm².
    pub area_mm2: f64,
    /// Remarks about the user's file.
    pub issues: Vec<Issue>,
}

/// One crease and its band.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Crease {
    /// Its name.
    pub name: String,
    /// FOLD's letter: M, V, F or U.
    pub role: String,
    /// Arc length, mm.
    pub length_mm: f64,
    /// Fold angle π − ρ, degrees, + valley, − mountain; the largest where it varies.
    pub fold_angle_deg: f64,
    /// Radius of the soft fold, mm; the largest where it varies.
    pub radius_mm: f64,
    /// Strips of the band.
    pub segments: u32,
    /// Width of one strip (a chord of the fold's arc), mm; this and what follows where the band is widest.
    pub chord_mm: f64,
    /// Width of the whole band, mm.
    pub band_width_mm: f64,
    /// Length of the arc that the band stands for, mm.
    pub arc_mm: f64,
    /// Radius and fold angle along the crease where they change; empty where they do not.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub profile: Vec<Softness>,
}

/// Radius and fold angle at one place of a crease.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Softness {
    /// Arc length along the crease, mm.
    pub s_mm: f64,
    /// Radius of the soft fold, mm.
    pub radius_mm: f64,
    /// Fold angle, degrees.
    pub fold_angle_deg: f64,
}

/// A remark about the user's file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Issue {
    /// `note`, `warning` or `error`.
    pub severity: String,
    /// What was found.
    pub message: String,
    /// The element of the file.
    pub element: Option<String>,
    /// Line of the file, from 1.
    pub line: Option<u32>,
    /// Place on the sheet, mm.
    pub position_mm: Option<[f64; 2]>,
    /// What to do.
    pub mend: String,
}

/// The flat mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Smallest angle of all triangles, degrees.
    pub min_angle_deg: f64,
    /// Median of the triangles' smallest angles, degrees.
    pub median_min_angle_deg: f64,
    /// Smallest angle but for places that the pattern itself makes sharp, degrees.
    #[serde(default)]
    pub own_min_angle_deg: f64,
    /// Places that the pattern itself makes sharp: acute corners, curves that all but touch.
    #[serde(default)]
    pub sharp_places: usize,
    /// Triangles that lie there.
    #[serde(default)]
    pub sharp_triangles: usize,
    /// Largest distance of fold lines and boundaries from their edges, mm.
    #[serde(default)]
    pub chord_mm: f64,
    /// `spade` or `cgal`.
    pub backend: String,
    /// Comparison of both triangulators, if asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crosscheck: Option<Crosscheck>,
}

/// Two triangulations of the same input.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Crosscheck {
    /// Whether both hold every constraint.
    pub constraints_held: bool,
    /// Difference of the areas, relative.
    pub area_relative_difference: f64,
    /// Edges that differ because four points lie on one circle.
    pub cocircular_differences: usize,
    /// Edges that differ without that excuse.
    pub other_differences: usize,
}

/// What `softfold crosscheck` tells: the lines of a pattern, cut where they meet, and the mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Crosschecks {
    /// The mesh.
    pub mesh: Crosscheck,
    /// The pieces of the lines.
    pub pieces: Crosscheck,
    /// Exact meetings of two lines.
    pub meetings: usize,
    /// Those that only the tolerance decides.
    pub marginal: usize,
    /// Those that one of the two does not see.
    pub missed: usize,
    /// Points of pieces off their line.
    pub astray: usize,
    /// Distance within which things are one, mm.
    pub tolerance_mm: f64,
    /// Where the two disagree, mm.
    pub places_mm: Vec<[f64; 2]>,
    /// What one refused that the other took.
    pub refusals: Vec<String>,
}

/// What one of the meshes of a multilevel solve took.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Its vertices.
    pub vertices: u32,
    /// Iterations on it.
    pub iterations: u32,
    /// Numeric factorisations.
    pub factorisations: u32,
}

/// The folding simulation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fold {
    /// `newton`, `lbfgs` or `relax`.
    pub solver: String,
    /// Iterations in all.
    pub iterations: u32,
    /// Numeric factorisations on the sheet's own mesh.
    #[serde(default)]
    pub factorisations: u32,
    /// The meshes of a multilevel solve, from the coarsest to the sheet's own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<Level>,
    /// Time it took, s.
    pub seconds: f64,
    /// Energy at the end.
    pub energy: f64,
    /// Gradient at the end, relative.
    pub relative_gradient: f64,
    /// Whether the stop criterion was met.
    pub converged: bool,
    /// Why it stopped.
    pub stop: String,
    /// Largest relative change of length of an edge, in size.
    pub max_edge_strain: f64,
    /// Smallest relative change of area.
    pub area_error_min: f64,
    /// Largest relative change of area.
    pub area_error_max: f64,
    /// Where the smallest is, mm.
    pub area_error_min_at: [f64; 2],
    /// Where the largest is, mm.
    pub area_error_max_at: [f64; 2],
    /// Largest difference between the turn of a fold line and the turn it should make, degrees.
    pub turn_error_max_deg: f64,
    /// Hoop strain ± δ/(2R) that soft rotational creases ask for when both sides share it, with
    /// δ = 2 r (sin α − α cos α); the largest over the creases; none where no crease is curved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hoop_estimate: Option<f64>,
    /// What each goal contributes.
    pub goals: Vec<Goal>,
    /// Pairs of triangles that pass through each other.
    pub self_intersections: usize,
    /// The states of folding in order, where there is more than one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub states: Vec<State>,
    /// What creases kept when they were let go.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spring_back: Vec<SpringBack>,
}

/// A state of folding.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Its name.
    pub name: String,
    /// Iterations from the state before.
    pub iterations: u32,
    /// Energy at its end.
    pub energy: f64,
    /// Whether it came to rest.
    pub converged: bool,
}

/// What a crease kept when it was let go; fold angles in degrees, + valley, - mountain.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpringBack {
    /// Its name.
    pub crease: String,
    /// Fold angle before.
    pub reached_deg: f64,
    /// Fold angle at which it is at rest by itself afterwards: its plastic share.
    pub rest_deg: f64,
    /// Fold angle afterwards.
    pub released_deg: f64,
}

/// One goal of the simulation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// Its name.
    pub name: String,
    /// Its kind, such as `Anchor`.
    pub kind: String,
    /// Its part of the energy.
    pub energy: f64,
    /// Largest distance from what it wants, mm; none for goals that are no positions.
    pub residual_mm: Option<f64>,
}

/// What the folded sheet asks of its material.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Analyse {
    /// Smallest bend radius, mm; none where nothing bends.
    pub min_bend_radius_mm: Option<f64>,
    /// Where it is, mm.
    pub min_bend_radius_at: [f64; 2],
    /// Largest strain of the outer fibre, t/(2r).
    pub max_fibre_strain: f64,
    /// Largest angle defect at an inner vertex, rad.
    pub max_angle_defect_rad: f64,
    /// Smallest principal strain.
    pub principal_strain_min: f64,
    /// Largest principal strain.
    pub principal_strain_max: f64,
    /// Smallest distance of the sheet from itself among places that are no neighbours, mm; none above a few thicknesses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_distance_mm: Option<f64>,
    /// Its two places, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_distance_at: Option<[[f64; 2]; 2]>,
}

/// The NURBS surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Number of faces.
    pub faces: usize,
    /// Poles along u and v.
    pub poles: [usize; 2],
    /// Spacing of the poles on the flat sheet, mm.
    pub spacing_mm: f64,
    /// Largest distance to the folded mesh, mm.
    pub max_deviation_mm: f64,
    /// Root mean square distance, mm.
    pub rms_deviation_mm: f64,
    /// Where the largest is, mm.
    pub max_deviation_at: [f64; 2],
    /// Largest distance of a folded vertex from triangles of the exported face, mm: OpenCascade's face, CGAL's distance.
    #[serde(default)]
    pub face_distance_mm: f64,
    /// Whether the CAD kernel finds it valid.
    pub valid: bool,
    /// How its faces fit together, where it has several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shell: Option<Shell>,
    /// How it bends and stretches the sheet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<SurfaceShape>,
    /// The cage that conforms to the outline, for `surface.form = "subd"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cage: Option<Cage>,
}

/// How the faces of a surface fit together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shell {
    /// Pieces of sharp creases on which two faces meet.
    pub creases: usize,
    /// Pieces of lines on which two faces go on as one smooth surface, behind the ends of creases and slits.
    pub smooth_edges: usize,
    /// Lips of slits.
    pub slit_lips: usize,
    /// Poles of all faces.
    pub poles: usize,
    /// Largest distance between two faces along an edge that they share, mm.
    pub gap_mm: f64,
    /// Where, mm.
    pub gap_at: [f64; 2],
    /// Largest tolerance of an edge or vertex in the CAD kernel, mm.
    pub edge_tolerance_mm: f64,
    /// Sharp creases and slits that bound no face, so that the surface is rounded there.
    pub rounded: Vec<String>,
}

/// How the surface bends and stretches the sheet. Shares are of the sheet's area.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SurfaceShape {
    /// Smallest radius of curvature, mm; none for a plane.
    pub min_radius_mm: Option<f64>,
    /// Where it is.
    pub min_radius_at: [f64; 2],
    /// Smallest radius of the board's lower skin, mm; none where it is plane.
    pub lower_skin_radius_mm: Option<f64>,
    /// Where it is.
    pub lower_skin_radius_at: [f64; 2],
    /// Smallest radius of the upper skin, mm; none where it is plane.
    pub upper_skin_radius_mm: Option<f64>,
    /// Where it is.
    pub upper_skin_radius_at: [f64; 2],
    /// Smallest radius that the material allows, mm, if it says one.
    pub radius_limit_mm: Option<f64>,
    /// Gaussian curvature of largest size, 1/mm².
    pub gaussian_curvature_per_mm2: f64,
    /// Where it is.
    pub gaussian_curvature_at: [f64; 2],
    /// Smallest principal strain of the map from the flat sheet.
    pub principal_strain_min: f64,
    /// Where it is.
    pub principal_strain_min_at: [f64; 2],
    /// Largest principal strain.
    pub principal_strain_max: f64,
    /// Where it is.
    pub principal_strain_max_at: [f64; 2],
    /// Share that is plane.
    pub plane_share: f64,
    /// Share that bends one way: it is developable and has rulings.
    pub developable_share: f64,
    /// Share that bends both ways.
    pub doubly_bent_share: f64,
    /// Largest ratio of the Gaussian curvature to the square of the larger curvature that counts as developable.
    pub developable_to: f64,
    /// Radius beyond which a place counts as plane, mm.
    pub plane_beyond_radius_mm: f64,
    /// Rulings that were traced.
    pub rulings: usize,
    /// Farthest that one of them leaves the line between its ends, share of its length, on the flat sheet: 0 for a true
    /// developable.
    pub ruling_bow_flat: f64,
    /// The same in space.
    pub ruling_bow_space: f64,
}

/// A quad cage that conforms to the outline, and the faces made of its limit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cage {
    /// Quads; there are no other faces.
    pub quads: usize,
    /// Vertices that are not on the border.
    pub inner_vertices: usize,
    /// Share of them with four edges.
    pub valence_4_share: f64,
    /// The others.
    pub irregular: Vec<Irregular>,
    /// Smallest angle in the flat sheet, but for the excused, degrees.
    pub min_angle_deg: f64,
    /// Where it is, mm.
    pub min_angle_at: [f64; 2],
    /// Smaller angles that the outline forces.
    pub excused: Vec<PlacedAngle>,
    /// Share of the lengthwise edges in bands that run within 5° of the fold lines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows_along_bands: Option<f64>,
    /// Length of a cell away from the bands, mm.
    pub cell_mm: f64,
    /// Cells across each strip of a band.
    pub cells_per_strip: u32,
    /// Largest distance of the outline from the border of the flat limit, mm.
    pub border_mm: f64,
    /// Patches before merging.
    pub patches: usize,
    /// Faces after merging.
    pub faces: usize,
    /// Largest distance between faces where they meet, mm.
    pub gap_mm: f64,
    /// Largest angle between faces away from irregular vertices, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub g1_regular_deg: Option<f64>,
    /// Largest angle between faces around irregular vertices, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub g1_irregular_deg: Option<f64>,
    /// Edges where faces meet at more than 0.1°.
    pub rough: Vec<PlacedAngle>,
}

/// A vertex of a cage with other than four edges.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Irregular {
    /// Where, mm.
    pub at: [f64; 2],
    /// Its edges.
    pub valence: u32,
}

/// An angle somewhere.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlacedAngle {
    /// Where, mm.
    pub at: [f64; 2],
    /// The angle, degrees.
    pub angle_deg: f64,
}

/// The thick board.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Board {
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Volume, mm³.
    pub volume_mm3: f64,
    /// Area of the sheet surface, mm².
    pub area_mm2: f64,
    /// Area times thickness, mm³: what the volume must be near to.
    pub area_times_thickness_mm3: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Barycenter, mm.
    pub barycenter_mm: [f64; 3],
    /// Rows of the inertia tensor about the barycenter, kg·mm²: `∫ y² + z²` and so on its diagonal, `−∫ x y` beside it.
    #[serde(default)]
    pub inertia_kg_mm2: [[f64; 3]; 3],
    /// Its principal moments, ascending, kg·mm².
    #[serde(default)]
    pub principal_moments_kg_mm2: [f64; 3],
    /// Their axes, unit vectors, right-handed.
    #[serde(default)]
    pub principal_axes: [[f64; 3]; 3],
    /// Volume between the true offsets of the sheet, mm³: its area and curvatures, integrated. This and the next are of the
    /// board before it is trimmed.
    #[serde(default)]
    pub offset_volume_mm3: f64,
    /// Volume of the board as triangles, by CGAL, mm³.
    #[serde(default)]
    pub mesh_volume_mm3: f64,
    /// What was cut off at the ground, mm³; none if nothing was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trimmed_mm3: Option<f64>,
    /// Smallest radius on either skin, mm; none where nothing bends.
    pub min_radius_mm: Option<f64>,
    /// Largest difference between the skins' distance and the thickness, mm.
    pub offset_error_mm: f64,
    /// Whether the CAD kernel finds the solid valid.
    pub valid: bool,
}

/// How the board stands on the ground.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stability {
    /// Whether it stands.
    pub stable: bool,
    /// Distance of the barycenter's projection from the nearest edge of the support, mm; negative outside.
    pub margin_mm: f64,
    /// Angle by which it can be tipped before it falls, degrees.
    pub tipping_angle_deg: f64,
    /// Horizontal push at the highest point that tips it over the nearest edge, N.
    #[serde(default)]
    pub tipping_push_n: f64,
    /// Barycenter as it stands, mm.
    pub barycenter_mm: [f64; 3],
    /// Convex hull of the contact points, counter-clockwise, mm.
    pub hull: Vec<[f64; 2]>,
    /// Number of contact points.
    pub contact_points: usize,
    /// Height as it stands, mm.
    pub height_mm: f64,
    /// The margin on the face on which the piece exactly rests, without the contact tolerance, mm; past it the piece
    /// rocks onto its next foot.
    #[serde(default)]
    pub support_margin_mm: f64,
    /// By how much it tips from the folded pose until it rests, degrees.
    #[serde(default)]
    pub tilt_deg: f64,
}

/// The mold.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mold {
    /// Volume of the whole mold, mm³.
    pub volume_mm3: f64,
    /// The same from triangles swept by CGAL, mm³.
    #[serde(default)]
    pub mesh_volume_mm3: f64,
    /// Rows of the rotation from the folded sheet's space to the mold's.
    pub pose_rotation: [[f64; 3]; 3],
    /// Translation after it, mm.
    pub pose_translation_mm: [f64; 3],
    /// Height of the mold's upper face, mm.
    pub height_mm: f64,
    /// Least angle between the face and the direction of pressing, degrees; negative undercuts.
    pub least_draft_deg: f64,
    /// Regions that undercut.
    pub undercuts: usize,
    /// The printed parts.
    pub parts: Vec<Part>,
    /// The boards of the waffle.
    pub boards: Vec<WaffleBoard>,
    /// Stock sheets needed for the boards.
    pub sheets: usize,
    /// Share of the stock that becomes boards, 0..=1.
    pub stock_use: f64,
}

/// One printed part.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Its name, as engraved.
    pub name: String,
    /// Volume, mm³.
    pub volume_mm3: f64,
    /// Volume of the exact solid before marks and grooves, mm³; 221² · 50 for an inner cell of the paper's grid.
    #[serde(default)]
    pub cell_volume_mm3: f64,
    /// Size of its box, mm.
    pub size_mm: [f64; 3],
    /// Whether it is closed, free of self-intersections and fits the printer.
    pub valid: bool,
    /// Whether it is an inner cell, a full square of the grid.
    pub inner: bool,
    /// What is wrong with it.
    pub faults: Vec<String>,
}

/// One board of the waffle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WaffleBoard {
    /// Its name, as engraved.
    pub name: String,
    /// Length, mm.
    pub length_mm: f64,
    /// Height, mm.
    pub height_mm: f64,
}

/// One thing that was checked against a limit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// What was checked, in a few words.
    pub name: String,
    /// Whether it holds.
    pub pass: bool,
    /// What was found; none for a plain yes or no.
    pub figure: Option<f64>,
    /// What is allowed.
    pub limit: Option<f64>,
    /// Unit of both; empty for counts, `%` for ratios already times 100.
    pub unit: String,
    /// A sentence: what it means, and what to do if it fails.
    pub message: String,
}

/// One file of the run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct File {
    /// Path inside the output folder.
    pub path: String,
    /// What it is for.
    pub purpose: String,
}

/// One stage of the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// Time it took, s.
    pub seconds: f64,
}

impl Report {
    /// A report that knows only its pattern.
    pub fn new(pattern: Pattern) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            pattern,
            mesh: None,
            fold: None,
            analyse: None,
            surface: None,
            board: None,
            stability: None,
            mold: None,
            verdicts: Vec::new(),
            files: Vec::new(),
            stages: Vec::new(),
        }
    }

    /// Whether every verdict holds.
    pub fn passes(&self) -> bool {
        self.verdicts.iter().all(|v| v.pass)
    }

    /// The report as JSON text, indented, with a line end.
    ///
    /// # Errors
    /// None: every field has a JSON form (a number that is not finite becomes null).
    pub fn to_json(&self) -> Result<String, crate::export::ExportError> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// A report from JSON text.
    ///
    /// # Errors
    /// Text that is no report.
    pub fn from_json(text: &str) -> Result<Self, crate::export::ExportError> {
        Ok(serde_json::from_str(text)?)
    }
}

impl From<&softfold_geometry::Issue> for Issue {
    fn from(issue: &softfold_geometry::Issue) -> Self {
        use softfold_geometry::Severity;
        let severity = match issue.severity {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        Self {
            severity: severity.to_owned(),
            message: issue.message.clone(),
            element: issue.element.clone(),
            line: issue.line,
            position_mm: issue.position.map(|p| p.to_array()),
            mend: issue.mend.clone(),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A report with every section, as of a small bench; a program that read such a file yesterday reads it
    /// tomorrow as long as the schema keeps its number.
    pub(crate) fn sample() -> Report {
        Report::from_json(SAMPLE).unwrap()
    }

    const SAMPLE: &str = include_str!("sample.json");

    #[test]
    fn comes_back_from_json() {
        let value = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
        assert_eq!(value(&sample().to_json().unwrap()), value(SAMPLE));
    }

    #[test]
    fn has_the_promised_keys() {
        let value = serde_json::to_value(sample()).unwrap();
        for path in [
            "/schema",
            "/pattern/creases/0/chord_mm",
            "/pattern/issues",
            "/mesh/vertices",
            "/mesh/min_angle_deg",
            "/mesh/backend",
            "/fold/solver",
            "/fold/seconds",
            "/fold/area_error_min",
            "/fold/turn_error_max_deg",
            "/surface/poles",
            "/surface/valid",
            "/board/mass_kg",
            "/board/min_radius_mm",
            "/stability/margin_mm",
            "/mold/parts/0/size_mm",
            "/mold/boards",
            "/stages/0/seconds",
        ] {
            assert!(value.pointer(path).is_some(), "{path}");
        }
        assert_eq!(value["schema"], SCHEMA);
    }

    #[test]
    fn a_run_that_stopped_early_leaves_sections_out() {
        let value = serde_json::to_value(Report::new(Pattern::default())).unwrap();
        assert!(value.get("mold").is_none());
    }
}
