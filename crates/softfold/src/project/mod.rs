//! The project file: what a run is asked for. TOML; every key is documented in `fixtures/sculpture/project.toml`.

mod course;
mod export;
mod fold;
mod number;
mod place;
mod read;
mod soften;

pub use course::{Release, SelfCollision, Step};
pub use export::{Export, Schema, ShapeFormat};
pub use fold::{
    Anchor, Band, CoPlanar, Collide, Floor, Fold, Glue, Load, Plane, Rail, Scan, Solver, Start, Weights,
};
pub use number::{line_of, line_of_entry, line_of_header};
pub use place::{OnCrease, OnOutline, Place, Region, Spot};
pub use read::{Outline, Read, Roles};
pub use soften::{Along, Compensation, Radius, SoftCrease, Soften};

use number::{Number, Range, fault_of, least};
use serde::Deserialize;
use softfold_mesh::MeshOptions;
use std::path::PathBuf;

/// A project as its file says it; lengths mm, angles degrees.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Project {
    /// Name for the report; the pattern's file name without its ending if absent.
    pub name: Option<String>,
    /// The pattern, relative to the project file.
    pub pattern: PathBuf,
    /// How the pattern is read.
    #[serde(default)]
    pub read: Read,
    /// Which line is what.
    #[serde(default)]
    pub roles: Roles,
    /// Bands.
    pub soften: Soften,
    /// Mesh.
    #[serde(default)]
    pub mesh: Mesh,
    /// Board material.
    #[serde(default)]
    pub material: Material,
    /// Folding.
    #[serde(default)]
    pub fold: Fold,
    /// Surface.
    #[serde(default)]
    pub surface: Surface,
    /// Board.
    pub board: Board,
    /// Standing.
    #[serde(default)]
    pub stability: Stability,
    /// Mold.
    #[serde(default)]
    pub mold: Mold,
    /// Waffle.
    #[serde(default)]
    pub waffle: Waffle,
    /// Verdicts.
    #[serde(default)]
    pub limits: Limits,
    /// Files of exact shapes.
    #[serde(default)]
    pub export: Export,
}

/// `mesh.backend`
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Backend {
    /// spade.
    #[default]
    Spade,
    /// CGAL.
    Cgal,
}

/// `mesh.method`
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Rows along bands, edges that grow away from them.
    #[default]
    Graded,
    /// The paper's steps as they are.
    Paper,
}

/// `[mesh]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Mesh {
    /// How points are placed.
    pub method: Method,
    /// Edge length away from bands, mm.
    pub target_edge_mm: f64,
    /// Length of a triangle along a band over its strip's width.
    pub band_aspect: f64,
    /// The same at most, in narrow strips.
    pub narrow_aspect: f64,
    /// Growth of the edge length per mm of distance from a band.
    pub grading: f64,
    /// Rounds of relaxation.
    pub relaxation_rounds: u32,
    /// How far fold lines and outline may leave their curves, share of the target.
    pub chord: f64,
    /// Triangulation.
    pub backend: Backend,
    /// Seed.
    pub seed: u64,
}

impl Default for Mesh {
    fn default() -> Self {
        let options = MeshOptions::default();
        Self {
            method: Method::Graded,
            target_edge_mm: options.target_edge_mm,
            band_aspect: options.band_aspect,
            narrow_aspect: options.narrow_aspect,
            grading: options.grading,
            relaxation_rounds: options.relaxation_rounds,
            chord: options.chord,
            backend: Backend::Spade,
            seed: options.seed,
        }
    }
}

impl Mesh {
    /// The mesher's options.
    pub fn options(&self) -> MeshOptions {
        MeshOptions {
            method: match self.method {
                Method::Graded => softfold_mesh::Method::Graded,
                Method::Paper => softfold_mesh::Method::Paper,
            },
            target_edge_mm: self.target_edge_mm,
            band_aspect: self.band_aspect,
            narrow_aspect: self.narrow_aspect,
            grading: self.grading,
            relaxation_rounds: self.relaxation_rounds,
            seed: self.seed,
            chord: self.chord,
            backend: match self.backend {
                Backend::Spade => softfold_mesh::Backend::Spade,
                Backend::Cgal => softfold_mesh::Backend::Cgal,
            },
        }
    }
}

/// `material.bending`
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Bending {
    /// A hinge at each edge of a face.
    #[default]
    Hinges,
    /// A plate's bending energy, which converges.
    Plate,
}

/// `[material]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Material {
    /// Its name, written into STEP files.
    pub name: String,
    /// E, MPa.
    pub youngs_modulus_mpa: f64,
    /// ν.
    pub poisson_ratio: f64,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Stiffness of fold lines over that of faces.
    pub fold_line_factor: f64,
    /// How faces resist bending.
    pub bending: Bending,
    /// Smallest radius of a skin, mm.
    pub min_radius_mm: Option<f64>,
    /// Largest strain of the outer fibre.
    pub strain_limit: Option<f64>,
}

impl Default for Material {
    /// Fiber cement.
    fn default() -> Self {
        Self {
            name: "fiber cement".to_owned(),
            youngs_modulus_mpa: 6000.0,
            poisson_ratio: 0.25,
            density_kg_m3: 1750.0,
            fold_line_factor: 10.0,
            bending: Bending::Hinges,
            min_radius_mm: None,
            strain_limit: None,
        }
    }
}

/// `surface.form`
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// One face over a lattice, trimmed by the outline.
    #[default]
    Lattice,
    /// A subdivision cage that conforms to the outline, converted to faces that share their edges.
    Subd,
}

/// `[surface]`
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Surface {
    /// What `sheet.step` and `cage.obj` hold; board and mold are made of the lattice either way.
    pub form: Form,
    /// Deviation aimed at, mm.
    pub tolerance_mm: Option<f64>,
    /// Spacing of the poles, mm; found if absent.
    pub spacing_mm: Option<f64>,
}

/// `board.placement`
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Placement {
    /// The sheet is the middle.
    #[default]
    Mid,
    /// The sheet is the lower skin.
    Lower,
    /// The sheet is the upper skin.
    Upper,
}

/// `[board]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Board {
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Where the sheet lies in it.
    #[serde(default)]
    pub placement: Placement,
    /// Height above the lowest point at which it is cut flat, mm.
    pub trim_ground_mm: Option<f64>,
}

/// `[stability]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Stability {
    /// Points this near to the ground touch it, mm.
    pub contact_mm: f64,
}

impl Default for Stability {
    fn default() -> Self {
        Self { contact_mm: 1.0 }
    }
}

/// `[mold]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Mold {
    /// Thickness along z, mm.
    pub thickness_mm: f64,
    /// Side of the parts, mm.
    pub cell_mm: f64,
    /// Room of the printer, mm.
    pub printer_mm: [f64; 3],
}

impl Default for Mold {
    fn default() -> Self {
        let options = softfold_mold::MoldOptions::default();
        let (thickness_mm, cell_mm) = (options.thickness_mm, options.cell_mm);
        Self { thickness_mm, cell_mm, printer_mm: options.printer_mm }
    }
}

/// `[waffle]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Waffle {
    /// Thickness of the boards, mm.
    pub board_mm: f64,
    /// Distance between boards, mm.
    pub pitch_mm: f64,
    /// Turned against the grid, degrees.
    pub angle_deg: f64,
    /// Slots are wider than boards by this, mm.
    pub clearance_mm: f64,
    /// Cutter, mm.
    pub cutter_mm: f64,
    /// Stock, mm.
    pub stock_mm: [f64; 2],
}

impl Default for Waffle {
    fn default() -> Self {
        let w = softfold_mold::WaffleOptions::default();
        Self {
            board_mm: w.board_mm,
            pitch_mm: w.pitch_mm,
            angle_deg: w.angle_deg,
            clearance_mm: w.clearance_mm,
            cutter_mm: w.cutter_mm,
            stock_mm: w.stock.size_mm,
        }
    }
}

/// `[limits]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Largest |area error|.
    pub area_error: f64,
    /// Largest deviation of the surface, mm.
    pub surface_deviation_mm: f64,
    /// Least stability margin, mm.
    pub stability_margin_mm: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { area_error: 0.015, surface_deviation_mm: 0.5, stability_margin_mm: 0.0 }
    }
}

/// What is wrong with a project file: the line where it is known, what, and the mend.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProjectFault {
    /// Line, from 1.
    pub line: Option<usize>,
    /// What is wrong and what to do.
    pub message: String,
}

impl Project {
    /// Reads a project's text.
    ///
    /// # Errors
    /// No TOML, unknown or missing keys, values of the wrong kind or out of their range.
    pub fn parse(text: &str) -> Result<Self, ProjectFault> {
        let project: Self = toml::from_str(text).map_err(|e| fault_of(text, &e))?;
        project.check(text)?;
        Ok(project)
    }

    fn check(&self, text: &str) -> Result<(), ProjectFault> {
        self.numbers().into_iter().try_for_each(|n| n.check(text))?;
        let w = &self.waffle;
        if w.pitch_mm <= w.board_mm + w.clearance_mm {
            let message = format!(
                "waffle.pitch_mm is {} but a board with its clearance is {} wide; give more",
                w.pitch_mm,
                w.board_mm + w.clearance_mm
            );
            return Err(ProjectFault { line: line_of(text, "waffle", "pitch_mm"), message });
        }
        self.roles.check(text)?;
        self.soften.check(text)?;
        self.check_strengths(text)?;
        self.check_names(text)?;
        self.fold.check(text)
    }

    /// What is written under a name needs one, and what is written a format.
    fn check_names(&self, text: &str) -> Result<(), ProjectFault> {
        let fault = |table: &str, key: &str, message: &str| {
            Err(ProjectFault { line: line_of(text, table, key), message: message.to_owned() })
        };
        if self.material.name.trim().is_empty() {
            return fault("material", "name", "material.name is empty; give a name, or leave it out");
        }
        if self.export.formats.is_empty() {
            return fault(
                "export",
                "formats",
                "export.formats is empty; give \"step\", \"iges\" or \"brep\"",
            );
        }
        Ok(())
    }

    /// Weights are of hinges alone.
    fn check_strengths(&self, text: &str) -> Result<(), ProjectFault> {
        if self.fold.weights.is_none() || self.material.bending == Bending::Hinges {
            return Ok(());
        }
        let message = "material.bending = \"plate\" needs the material, but [fold.weights] takes its place; give one of the two";
        Err(ProjectFault { line: line_of(text, "material", "bending"), message: message.to_owned() })
    }

    /// Every number that must lie in a range.
    fn numbers(&self) -> Vec<Number> {
        use Range::{Finite, Fraction, NotNegative, Positive, Rounds, Thick};
        let n = Number::new;
        let mut all = vec![
            n("mesh", "target_edge_mm", self.mesh.target_edge_mm, Positive),
            n("mesh", "band_aspect", self.mesh.band_aspect, Positive),
            n("mesh", "narrow_aspect", self.mesh.narrow_aspect, Positive),
            n("mesh", "grading", self.mesh.grading, Positive),
            n("mesh", "chord", self.mesh.chord, Positive),
            n("mesh", "relaxation_rounds", f64::from(self.mesh.relaxation_rounds), Rounds),
            n("material", "youngs_modulus_mpa", self.material.youngs_modulus_mpa, Positive),
            n("material", "poisson_ratio", self.material.poisson_ratio, Fraction),
            n("material", "density_kg_m3", self.material.density_kg_m3, Positive),
            n("material", "fold_line_factor", self.material.fold_line_factor, Positive),
            n("board", "thickness_mm", self.board.thickness_mm, Thick),
            n("stability", "contact_mm", self.stability.contact_mm, Positive),
            n("mold", "thickness_mm", self.mold.thickness_mm, Thick),
            n("mold", "cell_mm", self.mold.cell_mm, Positive),
            n("mold", "printer_mm", least(&self.mold.printer_mm), Positive),
            n("waffle", "angle_deg", self.waffle.angle_deg, Finite),
            n("waffle", "stock_mm", least(&self.waffle.stock_mm), Positive),
            n("waffle", "board_mm", self.waffle.board_mm, Positive),
            n("waffle", "pitch_mm", self.waffle.pitch_mm, Positive),
            n("waffle", "clearance_mm", self.waffle.clearance_mm, NotNegative),
            n("waffle", "cutter_mm", self.waffle.cutter_mm, Positive),
            n("limits", "area_error", self.limits.area_error, Positive),
            n("limits", "stability_margin_mm", self.limits.stability_margin_mm, Finite),
            n("limits", "surface_deviation_mm", self.limits.surface_deviation_mm, Positive),
        ];
        let optional = [
            ("material", "min_radius_mm", self.material.min_radius_mm),
            ("material", "strain_limit", self.material.strain_limit),
            ("board", "trim_ground_mm", self.board.trim_ground_mm),
            ("surface", "tolerance_mm", self.surface.tolerance_mm),
            ("surface", "spacing_mm", self.surface.spacing_mm),
        ];
        all.extend(optional.into_iter().filter_map(|(t, k, v)| v.map(|v| n(t, k, v, Positive))));
        all.extend(self.fold.numbers());
        all.extend(self.read.numbers());
        all.extend(self.soften.numbers());
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEAST: &str = "pattern = \"p.svg\"\n[soften]\nradius_mm = 30\n[board]\nthickness_mm = 10\n";

    #[test]
    fn the_least_project_has_defaults() {
        let p = Project::parse(LEAST).unwrap();
        assert_eq!((p.mold.cell_mm, p.soften.segments, p.fold.solver), (221.0, None, Solver::Newton));
    }

    #[test]
    fn every_option_of_the_mesher_has_its_key() {
        let text = "[mesh]\nmethod = \"paper\"\ntarget_edge_mm = 9\nband_aspect = 2\nnarrow_aspect = 6\ngrading = 0.3\n\
                    relaxation_rounds = 4\nchord = 0.02\nseed = 7\nbackend = \"cgal\"\n";
        let options = Project::parse(&format!("{LEAST}{text}")).unwrap().mesh.options();
        let wanted = MeshOptions {
            method: softfold_mesh::Method::Paper,
            target_edge_mm: 9.0,
            band_aspect: 2.0,
            narrow_aspect: 6.0,
            grading: 0.3,
            relaxation_rounds: 4,
            chord: 0.02,
            seed: 7,
            backend: softfold_mesh::Backend::Cgal,
        };
        assert_eq!(options, wanted);
        assert_eq!(Project::parse(LEAST).unwrap().mesh.options(), MeshOptions::default());
    }

    #[test]
    fn bad_options_of_the_mesher_are_named_with_their_line() {
        let bad = [
            ("method = \"random\"", "random"),
            ("band_aspect = 0", "mesh.band_aspect"),
            ("chord = 0", "mesh.chord"),
            ("narrow_aspect = nan", "mesh.narrow_aspect"),
            ("grading = -1", "mesh.grading"),
            ("relaxation_rounds = 100000", "mesh.relaxation_rounds"),
            ("relaxation_rounds = -1", "relaxation_rounds"),
            ("seed = 1.5", "seed"),
            ("backend = \"triangle\"", "triangle"),
        ];
        for (line, word) in bad {
            let fault = Project::parse(&format!("{LEAST}[mesh]\n{line}\n")).unwrap_err();
            assert_eq!(fault.line, Some(7), "{line}: {}", fault.message);
            assert!(fault.message.contains(word), "{line}: {}", fault.message);
        }
    }

    #[test]
    fn formats_and_schema_of_shapes_are_read_and_checked() {
        let p = Project::parse(LEAST).unwrap();
        assert_eq!(p.export, Export { formats: vec![ShapeFormat::Step], step_schema: Schema::Ap242 });
        let text = "[export]\nformats = [\"iges\", \"brep\"]\nstep_schema = \"ap214\"\n";
        let p = Project::parse(&format!("{LEAST}{text}")).unwrap();
        assert!(p.export.wants(ShapeFormat::Brep) && !p.export.wants(ShapeFormat::Step));
        assert_eq!(p.export.step_schema.step(), softfold_kernel::occt::StepSchema::Ap214);
        let bad = [
            ("[export]\nformats = []", "export.formats"),
            ("[export]\nformats = [\"stl\"]", "stl"),
            ("[export]\nstep_schema = \"ap203\"", "ap203"),
            ("[material]\nname = \" \"", "material.name"),
        ];
        for (text, word) in bad {
            let fault = Project::parse(&format!("{LEAST}{text}\n")).unwrap_err();
            assert_eq!(fault.line, Some(7), "{text}: {}", fault.message);
            assert!(fault.message.contains(word), "{text}: {}", fault.message);
        }
    }

    #[test]
    fn an_unknown_key_is_named_with_its_line() {
        let fault = Project::parse(&LEAST.replace("[board]\n", "[board]\ncolour = 1\n")).unwrap_err();
        assert_eq!(fault.line, Some(5));
        assert!(fault.message.contains("colour"), "{}", fault.message);
    }

    #[test]
    fn weights_are_numbers_and_have_no_plate_beside_them() {
        let weights = "[fold.weights]\nstretching = 5000\nbending = 1000\nfolding = 200\n";
        assert!(Project::parse(&format!("{LEAST}{weights}")).unwrap().fold.weights.is_some());
        let fault =
            Project::parse(&format!("{LEAST}[material]\nbending = \"plate\"\n{weights}")).unwrap_err();
        assert!(fault.line == Some(7) && fault.message.contains("[fold.weights]"), "{fault:?}");
        let fault = Project::parse(&format!("{LEAST}{}", weights.replace("200", "-1"))).unwrap_err();
        assert!(fault.line == Some(9) && fault.message.contains("folding"), "{fault:?}");
    }

    #[test]
    fn a_negative_thickness_is_named_with_its_line() {
        for bad in ["-10", "nan", "inf", "0"] {
            let fault = Project::parse(&LEAST.replace("= 10", &format!("= {bad}"))).unwrap_err();
            assert_eq!(fault.line, Some(5));
            assert!(fault.message.contains("board.thickness_mm") && fault.message.contains("positive"));
        }
    }

    #[test]
    fn a_fault_in_the_second_anchor_has_its_line() {
        let anchor =
            "[[fold.anchors]]\nname = \"A\"\nat = [1, 2]\ntarget = [0, 0, 0]\nstiffness = [1, 1, 1]\n";
        let text = format!("{LEAST}{anchor}{}", anchor.replace("[1, 2]", "[nan, 2]"));
        let fault = Project::parse(&text).unwrap_err();
        assert_eq!(fault.line, Some(11));
        assert!(fault.message.contains("[[fold.anchors]]"));
    }
}
