//! The groups of one element by their codes.

use super::tags::Tag;
use crate::PatternError;
use crate::error::{Origin, Place, issue};
use glam::{DVec2, DVec3};
use softfold_geometry::Severity;

/// From the code of an x to that of its y, and again to its z.
const NEXT_COORDINATE: i32 = 10;

/// The groups of an element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fields<'a> {
    /// The groups.
    pub(super) tags: &'a [Tag<'a>],
    /// The element.
    pub(super) origin: &'a Origin,
}

impl<'a> Fields<'a> {
    /// The first group of a code.
    pub(super) fn tag(&self, code: i32) -> Option<&'a Tag<'a>> {
        self.tags.iter().find(|t| t.code == code)
    }

    /// A number, if the group is there.
    ///
    /// # Errors
    /// No finite number.
    pub(super) fn real(&self, code: i32) -> Result<Option<f64>, PatternError> {
        self.tag(code).map(|t| self.number(t)).transpose()
    }

    /// A number, or what stands for it where the group is missing.
    ///
    /// # Errors
    /// No finite number.
    pub(super) fn real_or(&self, code: i32, default: f64) -> Result<f64, PatternError> {
        Ok(self.real(code)?.unwrap_or(default))
    }

    /// A number that must be there.
    ///
    /// # Errors
    /// None, or no finite number.
    pub(super) fn required(&self, code: i32) -> Result<f64, PatternError> {
        self.real(code)?.ok_or_else(|| self.fault(format!("the group {code} is missing"), None))
    }

    /// A whole number, or what stands for it.
    ///
    /// # Errors
    /// No whole number.
    pub(super) fn integer_or(&self, code: i32, default: i64) -> Result<i64, PatternError> {
        let Some(tag) = self.tag(code) else { return Ok(default) };
        tag.integer().ok_or_else(|| self.no_number(tag, "whole"))
    }

    /// A point whose x and y must be there.
    ///
    /// # Errors
    /// A coordinate that is missing or not finite.
    pub(super) fn point(&self, code: i32) -> Result<DVec3, PatternError> {
        let [y, z] = [code + NEXT_COORDINATE, code + 2 * NEXT_COORDINATE];
        Ok(DVec3::new(self.required(code)?, self.required(y)?, self.real_or(z, 0.0)?))
    }

    /// A point, if its x is there.
    ///
    /// # Errors
    /// A coordinate that is not finite.
    pub(super) fn point_if(&self, code: i32) -> Result<Option<DVec3>, PatternError> {
        self.tag(code).map(|_| self.point(code)).transpose()
    }

    /// All numbers of a code, in order.
    ///
    /// # Errors
    /// No finite number.
    pub(super) fn reals(&self, code: i32) -> Result<Vec<f64>, PatternError> {
        self.tags.iter().filter(|t| t.code == code).map(|t| self.number(t)).collect()
    }

    /// All points whose x has this code, in order.
    ///
    /// # Errors
    /// A coordinate that is not finite.
    pub(super) fn points(&self, code: i32) -> Result<Vec<DVec3>, PatternError> {
        let mut points: Vec<DVec3> = Vec::new();
        for tag in self.tags {
            if tag.code == code {
                points.push(DVec3::new(self.number(tag)?, 0.0, 0.0));
            } else if let Some(last) = points.last_mut() {
                if tag.code == code + NEXT_COORDINATE {
                    last.y = self.number(tag)?;
                } else if tag.code == code + 2 * NEXT_COORDINATE {
                    last.z = self.number(tag)?;
                }
            }
        }
        Ok(points)
    }

    /// Corners with the bulges of the pieces that start there (LWPOLYLINE).
    ///
    /// # Errors
    /// A number that is not finite.
    pub(super) fn corners(&self) -> Result<Vec<(DVec2, f64)>, PatternError> {
        let mut corners: Vec<(DVec2, f64)> = Vec::new();
        for tag in self.tags {
            match (tag.code, corners.last_mut()) {
                (10, _) => corners.push((DVec2::new(self.number(tag)?, 0.0), 0.0)),
                (20, Some((at, _))) => at.y = self.number(tag)?,
                (42, Some((_, bulge))) => *bulge = self.number(tag)?,
                _ => {}
            }
        }
        Ok(corners)
    }

    fn number(&self, tag: &Tag<'_>) -> Result<f64, PatternError> {
        tag.real().ok_or_else(|| self.no_number(tag, "finite"))
    }

    fn no_number(&self, tag: &Tag<'_>, kind: &str) -> PatternError {
        self.fault(format!("the group {} is \"{}\", no {kind} number", tag.code, tag.shown()), tag.line)
    }

    /// A fault of this element; on its own line if there is no other.
    pub(super) fn fault(&self, what: String, line: Option<u32>) -> PatternError {
        let found = issue(Severity::Error, what, "correct the number, or delete the element").of(self.origin);
        PatternError::Number(found.of_line(line.or(self.origin.line)))
    }
}
