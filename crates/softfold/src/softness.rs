//! What the project asks of each crease: radius, fold angle, strips, and what the board's thickness does to them.

use crate::project::{self, SoftCrease, line_of, line_of_header};
use crate::{Loaded, RunError};
use softfold_geometry::{Crease, CreasePattern, Issue, Role, Severity};
use softfold_soften::{Along, Board, Compensation, CreaseSoftness, Segments, compensated};

/// Softness of each crease: its table, else the pattern, else the common values. What the board cannot bear is told.
///
/// # Errors
/// Tables of creases that the pattern does not have, angles that are missing or none, a board that bears nothing.
pub(crate) fn of_all(
    loaded: &Loaded,
    pattern: &CreasePattern,
    issues: &mut Vec<Issue>,
) -> Result<Vec<CreaseSoftness>, RunError> {
    let soften = &loaded.project.soften;
    if let Some(unknown) = soften.creases.keys().find(|n| pattern.creases.iter().all(|c| c.name != **n)) {
        let known = softfold_fold::address::listed(&pattern.creases);
        let message = format!("[soften.creases.{unknown}]: the pattern has no such crease; it has {known}");
        let line = line_of_header(&loaded.text, &format!("soften.creases.{unknown}"));
        return Err(RunError::in_file(&loaded.path, line, message));
    }
    let asking = Asking { loaded, board: board(&loaded.project) };
    pattern.creases.iter().map(|c| asking.of(c, issues)).collect()
}

/// The board as its bands feel it; what the project does not limit is free.
fn board(project: &project::Project) -> Board {
    Board {
        thickness_mm: project.board.thickness_mm,
        strain_limit: project.material.strain_limit.unwrap_or(f64::INFINITY),
        inside_radius_mm: project.material.min_radius_mm.unwrap_or(0.0),
    }
}

struct Asking<'a> {
    loaded: &'a Loaded,
    board: Board,
}

impl Asking<'_> {
    fn of(&self, crease: &Crease, issues: &mut Vec<Issue>) -> Result<CreaseSoftness, RunError> {
        let soften = &self.loaded.project.soften;
        let own = soften.creases.get(&crease.name).cloned().unwrap_or_default();
        let angle_deg = self.angle_deg(crease, &own)?;
        let share = soften.fold_percent / 100.0;
        let asked = CreaseSoftness {
            radius_mm: self.radius_mm(own.radius_mm.as_ref().unwrap_or(&soften.radius_mm))?,
            fold_angle_rad: angle_deg.mapped(|a| (share * a).to_radians()),
            segments: self.segments(&own),
        };
        if crease.role == Role::Flat {
            return Ok(asked);
        }
        let mode = match (soften.compensation, soften.band_width_mm) {
            (project::Compensation::OneSided, _) => Compensation::OneSided,
            (project::Compensation::Equal, _) => Compensation::Equal,
            (project::Compensation::PerPoint, Some(width_mm)) => Compensation::PerPoint { width_mm },
            _ => Compensation::None,
        };
        let found = compensated(&asked, crease.role, &self.board, mode).map_err(|fault| {
            self.loaded.fault("soften", "compensation", format!("crease '{}': {fault}", crease.name))
        })?;
        self.tell(crease, &found.raised_mm, "was raised to", issues);
        let soft: Vec<f64> =
            found.tight_mm.iter().copied().filter(|s| !is_sharp(&found.softness, *s)).collect();
        self.tell(crease, &soft, "is below", issues);
        Ok(found.softness)
    }

    /// Says where the radius meets the smallest that the board bears.
    fn tell(&self, crease: &Crease, places_mm: &[f64], what: &str, issues: &mut Vec<Issue>) {
        let Some(&first) = places_mm.first() else { return };
        let least = self.board.smallest_radius_mm();
        issues.push(Issue {
            severity: if what == "is below" { Severity::Warning } else { Severity::Note },
            message: format!(
                "the radius {what} the {least:.3} mm that a board of {} mm of this material bears, first {first:.1} mm along",
                self.board.thickness_mm
            ),
            element: Some(format!("crease '{}'", crease.name)),
            line: crease.source.line,
            position: Some(crease.curve.point(first)),
            mend: "give a larger radius_mm, a thinner board, or radius_mm = \"material\"".to_owned(),
        });
    }

    fn radius_mm(&self, radius: &project::Radius) -> Result<Along, RunError> {
        let project::Radius::Given(given) = radius else {
            let least = self.board.smallest_radius_mm();
            let limits = &self.loaded.project.material;
            if limits.strain_limit.is_none() && limits.min_radius_mm.is_none() {
                let what = "radius_mm = \"material\" needs material.strain_limit or material.min_radius_mm; give one";
                return Err(self.loaded.fault("soften", "radius_mm", what));
            }
            return Ok(least.into());
        };
        Ok(along(given))
    }

    fn segments(&self, own: &SoftCrease) -> Segments {
        let soften = &self.loaded.project.soften;
        let chord = |tolerance_mm| Segments::Chord { tolerance_mm };
        let of = |n: Option<u32>, c: Option<f64>| n.map(Segments::Count).or(c.map(chord));
        of(own.segments, own.chord_mm)
            .or(of(soften.segments, soften.chord_mm))
            .unwrap_or(Segments::Count(project::Soften::SEGMENTS))
    }

    /// The fold angle as it is asked for, degrees; 0 for creases that stay flat.
    fn angle_deg(&self, crease: &Crease, own: &SoftCrease) -> Result<Along, RunError> {
        if crease.role == Role::Flat {
            return Ok(0.0.into());
        }
        let common = self.loaded.project.soften.fold_angle_deg.map(|a| a.abs() * crease.role.sign());
        let from_file = crease.fold_angle_rad.map(f64::to_degrees);
        let given = own.fold_angle_deg.as_ref().map(along);
        let angle = given.or(from_file.map(Along::from)).or(common.map(Along::from));
        let Some(angle) = angle else { return Err(self.no_angle(crease)) };
        angle.values().into_iter().try_for_each(|a| self.check_angle(crease, a))?;
        if angle.values().iter().all(|a| *a == 0.0) {
            return Err(self.bad_angle(crease, 0.0));
        }
        Ok(angle)
    }

    fn mend(crease: &Crease) -> String {
        format!(
            "give fold_angle_deg in [soften.creases.{}], or in [soften] for all, between -180 and 180 and not 0",
            crease.name
        )
    }

    fn no_angle(&self, crease: &Crease) -> RunError {
        let line = crease.source.line;
        let at = line.map_or_else(String::new, |l| format!(" ({}:{l})", self.loaded.pattern_path.display()));
        let message = format!("crease '{}'{at} has no fold angle; {}", crease.name, Self::mend(crease));
        RunError::in_file(&self.loaded.path, line_of_header(&self.loaded.text, "soften"), message)
    }

    fn bad_angle(&self, crease: &Crease, angle: f64) -> RunError {
        let text = &self.loaded.text;
        let own = line_of(text, &format!("soften.creases.{}", crease.name), "fold_angle_deg");
        let line = own.or_else(|| line_of(text, "soften", "fold_angle_deg"));
        let flat = " (folded flat: soften.fold_percent folds all creases less far)";
        let more = if angle.abs() == 180.0 { flat } else { "" };
        let message =
            format!("crease '{}' has the fold angle {angle}°{more}; {}", crease.name, Self::mend(crease));
        RunError::in_file(&self.loaded.path, line, message)
    }

    fn check_angle(&self, crease: &Crease, angle: f64) -> Result<(), RunError> {
        let folded = self.loaded.project.soften.fold_percent / 100.0 * angle;
        if !angle.is_finite() || angle.abs() > 180.0 || folded.abs() >= 180.0 {
            return Err(self.bad_angle(crease, angle));
        }
        if angle * crease.role.sign() < 0.0 {
            let drawn = if crease.role == Role::Mountain { "mountain (-)" } else { "valley (+)" };
            let message = format!(
                "crease '{}' is drawn as {drawn} but its fold angle is {angle}°; change the sign or the drawing",
                crease.name
            );
            let table = format!("soften.creases.{}", crease.name);
            return Err(self.loaded.fault(&table, "fold_angle_deg", message));
        }
        Ok(())
    }
}

fn along(given: &project::Along) -> Along {
    match given {
        project::Along::Constant(v) => Along::Constant(*v),
        project::Along::Points(points) => Along::Places(points.iter().map(|p| (p[0], p[1])).collect()),
    }
}

/// Whether a place's radius is 0: meant to be sharp.
fn is_sharp(softness: &CreaseSoftness, s_mm: f64) -> bool {
    match &softness.radius_mm {
        Along::Constant(r) => *r == 0.0,
        Along::Places(places) => places.iter().any(|(s, r)| *s == s_mm && *r == 0.0),
    }
}
