use glam::{DVec2, DVec3};
use softfold_geometry::CheckError;
use softfold_kernel::KernelError;

/// Why a board, a mold or a part could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MoldError {
    /// An option has a value that makes no sense.
    #[error("{option} is {value}; {mend}")]
    Option {
        /// The option, with its unit.
        option: &'static str,
        /// Table of the project file that sets it; empty if none does.
        table: &'static str,
        /// Key in that table; empty if none does.
        key: &'static str,
        /// What it was set to.
        value: f64,
        /// What it should be.
        mend: &'static str,
    },
    /// The sheet surface breaks its own contract.
    #[error(transparent)]
    Surface(#[from] CheckError),
    /// The trim has no outline, or the outline lies outside the surface's domain.
    #[error("the trim leaves nothing of the surface: {fault}; trim it by a closed outline inside its domain")]
    NoSheet {
        /// What is wrong.
        fault: String,
    },
    /// A skin would fold over: the offset passes the centre of curvature.
    #[error(
        "the board's skin at {offset_mm:.2} mm passes the centre of curvature at (u, v) = ({:.1}, {:.1}), where the \
         sheet's radius is {radius_mm:.2} mm; the thickest board that works is {largest_thickness_mm:.2} mm with this \
         placement, or make the folds there rounder", at.x, at.y
    )]
    OffsetTooThick {
        /// Place on the sheet, mm.
        at: DVec2,
        /// Signed distance of the skin from the sheet along its normal, mm.
        offset_mm: f64,
        /// Radius of the sheet there, mm.
        radius_mm: f64,
        /// Largest thickness whose skins stay clear of every centre of curvature, mm.
        largest_thickness_mm: f64,
    },
    /// The board would pass through itself: two parts of the sheet are nearer to each other than it is thick.
    #[error(
        "the board of {thickness_mm:.2} mm passes through itself: the sheet's parts at (u, v) = ({:.1}, {:.1}) and ({:.1}, {:.1}) \
         are nearer to each other than that; {}", at[0].x, at[0].y, at[1].x, at[1].y, thinner(*largest_thickness_mm)
    )]
    Crosses {
        /// Places of both on the sheet, mm.
        at: [DVec2; 2],
        /// The thickness asked for, mm.
        thickness_mm: f64,
        /// Largest thickness at which no parts meet, mm; next to nothing where the sheet itself passes through itself.
        largest_thickness_mm: f64,
    },
    /// A library could not do its part.
    #[error("{what}: {source}")]
    Kernel {
        /// What was being made, with the part's or board's name.
        what: String,
        /// The library's words.
        source: KernelError,
    },
    /// A solid came out with faults.
    #[error("{what} is no valid solid: {}", faults.join("; "))]
    Invalid {
        /// What was being made.
        what: String,
        /// The faults found.
        faults: Vec<String>,
    },
    /// A part is larger than the printer.
    #[error(
        "part {name} measures {:.1} x {:.1} x {:.1} mm and does not fit the printer of {:.0} x {:.0} x {:.0} mm; \
         choose smaller cells, about {smaller_mm:.0} mm instead of {cell_mm:.0} mm",
        size_mm.x, size_mm.y, size_mm.z, printer_mm[0], printer_mm[1], printer_mm[2]
    )]
    PartTooLarge {
        /// The part.
        name: String,
        /// Its box, mm.
        size_mm: DVec3,
        /// The printer's room, mm.
        printer_mm: [f64; 3],
        /// Side of the grid's squares, mm.
        cell_mm: f64,
        /// A side that would about do, mm.
        smaller_mm: f64,
    },
    /// A waffle board is larger than the stock sheet.
    #[error(
        "waffle board {name} measures {:.0} x {:.0} mm and does not fit a stock sheet of {:.0} x {:.0} mm with its \
         margin; use a larger sheet or turn the mold", size_mm.x, size_mm.y, stock_mm[0], stock_mm[1]
    )]
    BoardTooLarge {
        /// The board.
        name: String,
        /// Its box, mm.
        size_mm: DVec2,
        /// The stock sheet, mm.
        stock_mm: [f64; 2],
    },
}

impl MoldError {
    /// Table and key of the project file that the mend points at; empty where it points at none.
    pub fn place(&self) -> (&'static str, &'static str) {
        match self {
            Self::Option { table, key, .. } => (table, key),
            Self::OffsetTooThick { .. } | Self::Crosses { .. } => ("board", "thickness_mm"),
            Self::PartTooLarge { .. } => ("mold", "cell_mm"),
            Self::BoardTooLarge { .. } => ("waffle", "stock_mm"),
            Self::Surface(_) | Self::NoSheet { .. } | Self::Kernel { .. } | Self::Invalid { .. } => ("", ""),
        }
    }

    /// Whether softfold is at fault, not what the user asked for.
    pub fn is_defect(&self) -> bool {
        matches!(self, Self::Surface(_) | Self::NoSheet { .. } | Self::Kernel { .. })
    }
}

/// The mend of a board that passes through itself.
fn thinner(largest_mm: f64) -> String {
    /// Thinner than any sheet: what is left of halving nothing.
    const NOTHING_MM: f64 = 0.01;
    if largest_mm > NOTHING_MM {
        let least = (100.0 * largest_mm).floor() / 100.0;
        return format!("the thickest board that works is {least:.2} mm with this placement, or fold less");
    }
    "no board of it is thin enough; fold less".to_owned()
}

/// Names what was being made when a library failed.
pub(crate) trait During<T> {
    /// The same result, with `what` in its error.
    fn during(self, what: impl FnOnce() -> String) -> Result<T, MoldError>;
}

impl<T> During<T> for softfold_kernel::Result<T> {
    fn during(self, what: impl FnOnce() -> String) -> Result<T, MoldError> {
        self.map_err(|source| MoldError::Kernel { what: what(), source })
    }
}

/// An option: its name with its unit, and what sets it in the project file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting {
    option: &'static str,
    table: &'static str,
    key: &'static str,
}

impl Setting {
    /// An option that `key` of `table` sets.
    pub(crate) const fn of(table: &'static str, key: &'static str, option: &'static str) -> Self {
        Self { option, table, key }
    }

    /// An option that the project file does not set.
    pub(crate) const fn inner(option: &'static str) -> Self {
        Self::of("", "", option)
    }

    /// The error that this option has a value that makes no sense.
    pub(crate) fn refused(self, value: f64, mend: &'static str) -> MoldError {
        let Self { option, table, key } = self;
        MoldError::Option { option, table, key, value, mend }
    }

    /// Refuses what does not hold.
    pub(crate) fn require(self, holds: bool, value: f64, mend: &'static str) -> Result<(), MoldError> {
        if holds { Ok(()) } else { Err(self.refused(value, mend)) }
    }

    /// Refuses what is not a positive number.
    pub(crate) fn positive(self, value: f64) -> Result<(), MoldError> {
        self.require(value > 0.0 && value.is_finite(), value, "it must be a positive number")
    }

    /// Refuses what is negative or no number.
    pub(crate) fn not_negative(self, value: f64) -> Result<(), MoldError> {
        self.require(value >= 0.0 && value.is_finite(), value, "it must be zero or a positive number")
    }

    /// Refuses what is no number.
    pub(crate) fn finite(self, value: f64) -> Result<(), MoldError> {
        self.require(value.is_finite(), value, "it must be a number")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mend_points_at_its_line() {
        let option = Setting::of("waffle", "cutter_mm", "cutter (mm)").refused(9.0, "smaller");
        let thick = MoldError::OffsetTooThick {
            at: DVec2::ZERO,
            offset_mm: 4.0,
            radius_mm: 3.0,
            largest_thickness_mm: 6.0,
        };
        let part = MoldError::PartTooLarge {
            name: "A1".into(),
            size_mm: DVec3::splat(300.0),
            printer_mm: [256.0; 3],
            cell_mm: 300.0,
            smaller_mm: 250.0,
        };
        let board = MoldError::BoardTooLarge {
            name: "W1".into(),
            size_mm: DVec2::splat(3e3),
            stock_mm: [2440.0, 1220.0],
        };
        let places = [
            (&option, ("waffle", "cutter_mm")),
            (&thick, ("board", "thickness_mm")),
            (&part, ("mold", "cell_mm")),
            (&board, ("waffle", "stock_mm")),
        ];
        for (error, place) in places {
            assert_eq!(error.place(), place);
            assert!(!error.is_defect(), "{error}");
        }
        assert_eq!(MoldError::NoSheet { fault: String::new() }.place(), ("", ""));
        assert_eq!(Setting::inner("steps").refused(0.0, "more").place(), ("", ""));
    }
}
