//! `softfold crosscheck`: both triangulations on the lines of a pattern, and on the mesh that is made of it.

use crate::progress::Progress;
use crate::report::json;
use crate::{Loaded, RunError, Stage};
use softfold_geometry::{CreasePattern, DVec2, Role, VertexId};
use softfold_mesh::{Crosscheck, CrossingCheck, MeshError, MeshOptions, crosscheck_crossing};
use softfold_soften::{CreaseSoftness, Segments};
use std::fmt::Write;
use std::path::Path;

/// Fold angle of creases of which a file says none, degrees: any would do, sharp folds take no room.
const ANGLE_DEG: f64 = 60.0;
/// Flat folds are taken for a little less: at 180° the two sides would be one.
const LARGEST_ANGLE_RAD: f64 = 3.0;
/// Edge length of the mesh of a pattern that comes without a project, share of its size.
const EDGE: f64 = 0.025;
/// Chord error of the pattern's lines, share of its size: a drawing's, not a tool's.
const CHORD: f64 = 1e-4;

/// What both comparisons found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The pattern's lines as they are drawn: they cross, touch and overlap.
    pub lines: CrossingCheck,
    /// The points and constraints of the mesh.
    pub mesh: Crosscheck,
}

impl Found {
    /// Whether the two libraries agree.
    pub fn agrees(&self) -> bool {
        self.lines.agrees() && self.mesh.agrees()
    }

    /// The places of all faults, mm.
    pub fn faults(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.lines.faults().chain(self.mesh.other_differences.iter().copied())
    }

    /// What was found, for people.
    pub fn words(&self) -> String {
        let l = &self.lines;
        let mut text = format!(
            "lines: {} meetings, {} at the tolerance of {:.1e} mm, {} missed, {} points astray, hulls differ by {:.2} of what \
             the tolerance allows\n",
            l.meetings,
            l.marginal,
            l.tolerance_mm,
            l.missed.len(),
            l.astray.len(),
            l.area_over_allowance
        );
        for (name, check) in [("their pieces", &l.pieces), ("mesh", &self.mesh)] {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{name}: constraints {}, areas differ by {:.1e}, {} edges differ on cocircular points, {} otherwise",
                if check.constraints_held { "held" } else { "BROKEN" },
                check.area_relative_difference,
                check.cocircular_differences.len(),
                check.other_differences.len()
            );
            check.refusal.iter().for_each(|r| {
                let _ = writeln!(text, "  {r}");
            });
        }
        self.faults().for_each(|p| {
            let _ = writeln!(text, "  at ({:.3}, {:.3}) mm", p.x, p.y);
        });
        text
    }
}

/// Both triangulations on the lines of a pattern: outline, holes, slits and creases, as polylines.
///
/// # Errors
/// A pattern without extent.
pub fn of_lines(pattern: &CreasePattern) -> Result<CrossingCheck, MeshError> {
    let chord_mm = CHORD * pattern.size_mm();
    let curves = pattern.boundaries().map(|(_, c)| c).chain(pattern.creases.iter().map(|c| &c.curve));
    let (mut points, mut constraints) = (Vec::new(), Vec::new());
    for curve in curves {
        let line = curve.flatten(chord_mm);
        let first = points.len();
        if curve.is_closed() {
            constraints.push([first + line.len() - 1, first].map(VertexId::new));
        }
        constraints.extend((1..line.len()).map(|i| [first + i - 1, first + i].map(VertexId::new)));
        points.extend(line);
    }
    crosscheck_crossing(&points, &constraints)
}

/// The same of a pattern that comes without a project, and of its mesh with all creases sharp.
///
/// # Errors
/// A pattern that cannot be meshed.
pub fn of_pattern(pattern: &CreasePattern, path: &Path) -> Result<Found, RunError> {
    let input = |e: &dyn std::fmt::Display| RunError::in_file(path, None, e);
    let lines = of_lines(pattern).map_err(|e| input(&e))?;
    let soft = softfold_soften::soften(pattern, &sharp(pattern)).map_err(|e| input(&e))?;
    let options = MeshOptions { target_edge_mm: EDGE * pattern.size_mm(), ..MeshOptions::default() };
    let meshed = softfold_mesh::mesh(&soft, &options).map_err(|e| input(&e))?;
    let mesh = softfold_mesh::crosscheck(&meshed.graph).map_err(|e| RunError::Defect(e.to_string()))?;
    Ok(Found { lines, mesh })
}

/// The same of a project, with its bands and its own options of the mesher.
///
/// # Errors
/// A project that cannot be meshed.
pub fn of_project(loaded: &Loaded, progress: &mut dyn Progress) -> Result<Found, RunError> {
    let results = crate::run(loaded, Stage::Mesh, progress)?;
    let unmade = || RunError::Defect("the mesh stage made no mesh".to_owned());
    let (pattern, mesh) = results.pattern.zip(results.mesh).ok_or_else(unmade)?;
    let lines = of_lines(&pattern).map_err(|e| RunError::in_file(&loaded.pattern_path, None, e))?;
    Ok(Found { lines, mesh: mesh.crosscheck })
}

fn sharp(pattern: &CreasePattern) -> Vec<CreaseSoftness> {
    let one = |c: &softfold_geometry::Crease| {
        let sign = if c.role == Role::Mountain { -1.0 } else { 1.0 };
        let known = c.fold_angle_rad.map(f64::abs).filter(|a| *a > 0.0);
        let size = known.unwrap_or(ANGLE_DEG.to_radians()).min(LARGEST_ANGLE_RAD);
        CreaseSoftness::constant(0.0, sign * size, Segments::Count(1))
    };
    pattern.creases.iter().map(one).collect()
}

impl From<&Found> for json::Crosschecks {
    fn from(found: &Found) -> Self {
        let l = &found.lines;
        Self {
            mesh: json::Crosscheck::from(&found.mesh),
            pieces: json::Crosscheck::from(&l.pieces),
            meetings: l.meetings,
            marginal: l.marginal,
            missed: l.missed.len(),
            astray: l.astray.len(),
            tolerance_mm: l.tolerance_mm,
            places_mm: found.faults().map(|p| p.to_array()).collect(),
            refusals: [&l.pieces, &found.mesh].into_iter().filter_map(|c| c.refusal.clone()).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Spoil = fn(&mut Found);

    fn agreed() -> Found {
        let mesh = Crosscheck {
            constraints_held: true,
            area_relative_difference: 0.0,
            cocircular_differences: vec![DVec2::new(9.0, 9.0)],
            other_differences: vec![],
            refusal: None,
        };
        let lines = CrossingCheck {
            pieces: mesh.clone(),
            meetings: 4,
            marginal: 0,
            missed: vec![],
            astray: vec![],
            area_over_allowance: 0.1,
            tolerance_mm: 1e-9,
        };
        Found { lines, mesh }
    }

    #[test]
    fn cocircular_points_are_no_fault() {
        assert!(agreed().agrees());
        assert_eq!(agreed().faults().count(), 0);
        assert!(!agreed().words().contains(" at ("), "{}", agreed().words());
    }

    #[test]
    fn every_fault_ends_agreement_and_is_told_with_its_place() {
        let at = DVec2::new(12.5, -3.25);
        let spoil: [fn(&mut Found, DVec2); 4] = [
            |f, at| f.mesh.other_differences.push(at),
            |f, at| f.lines.pieces.other_differences.push(at),
            |f, at| f.lines.missed.push(at),
            |f, at| f.lines.astray.push(at),
        ];
        for spoil in spoil {
            let mut found = agreed();
            spoil(&mut found, at);
            assert!(!found.agrees());
            assert!(found.words().contains("at (12.500, -3.250) mm"), "{}", found.words());
            assert_eq!(json::Crosschecks::from(&found).places_mm, [at.to_array()]);
        }
    }

    #[test]
    fn a_broken_constraint_a_lost_area_and_a_refusal_end_agreement() {
        let spoil: [(Spoil, &str); 4] = [
            (|f| f.mesh.constraints_held = false, "BROKEN"),
            (|f| f.lines.pieces.area_relative_difference = 1e-6, "1.0e-6"),
            (|f| f.lines.area_over_allowance = 2.0, "2.00 of what"),
            (
                |f| f.mesh.refusal = Some("spade alone refuses it: why".to_owned()),
                "spade alone refuses it: why",
            ),
        ];
        for (spoil, said) in spoil {
            let mut found = agreed();
            spoil(&mut found);
            assert!(!found.agrees());
            assert!(found.words().contains(said), "{}", found.words());
        }
    }
}
