//! Where the copies of a block come to lie.

use super::content::{Block, Entity};
use super::curve::Placement;
use crate::PatternError;
use crate::error::{Place, issue};
use glam::{DMat3, DVec3};
use softfold_geometry::Severity;

/// Copies in one array of rows and columns at most.
const MAX_COPIES: i64 = 1_000_000;

/// The copies that an INSERT makes of its block: rows times columns.
pub(super) struct Copies {
    first: Placement,
    /// Steps from column to column and from row to row.
    steps: [DVec3; 2],
    columns: i64,
    rows: i64,
}

impl Copies {
    /// Reads an INSERT.
    ///
    /// # Errors
    /// Numbers that are not finite, or too many copies.
    pub(super) fn read(insert: &Entity<'_>, block: &Block<'_>) -> Result<Self, PatternError> {
        let fields = insert.fields();
        let axes = insert.axes()?;
        let scale = DVec3::new(fields.real_or(41, 1.0)?, fields.real_or(42, 1.0)?, fields.real_or(43, 1.0)?);
        let turned = axes * DMat3::from_rotation_z(fields.real_or(50, 0.0)?.to_radians());
        let linear = turned * DMat3::from_diagonal(scale);
        let shift = axes * fields.point(10)? - linear * block.base;
        let [columns, rows] = [fields.integer_or(70, 1)?.max(1), fields.integer_or(71, 1)?.max(1)];
        if columns.saturating_mul(rows) > MAX_COPIES {
            let what = format!("the array has {columns} columns and {rows} rows");
            let found = issue(Severity::Error, what, "draw the lines of the pattern once, without arrays");
            return Err(PatternError::Malformed(found.of(&insert.origin)));
        }
        let steps = [turned.x_axis * fields.real_or(44, 0.0)?, turned.y_axis * fields.real_or(45, 0.0)?];
        Ok(Self { first: Placement { linear, shift }, steps, columns, rows })
    }

    /// All places of the block, row by row.
    pub(super) fn places(&self) -> impl Iterator<Item = Placement> + '_ {
        let place = |row: i64, column: i64| {
            let shift = self.steps[0] * column as f64 + self.steps[1] * row as f64;
            Placement { shift: self.first.shift + shift, ..self.first }
        };
        (0..self.rows).flat_map(move |row| (0..self.columns).map(move |column| place(row, column)))
    }

    /// Whether there is more than one.
    pub(super) fn many(&self) -> bool {
        self.columns * self.rows > 1
    }
}
