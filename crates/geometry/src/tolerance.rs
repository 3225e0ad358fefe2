//! Every tolerance comes from here, derived from the size of the sheet.

/// Lengths below which two things are one, and above which they are not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Ends closer than this are joined, mm.
    pub join_mm: f64,
    /// Ends farther apart than this are refused, mm; between the two they are joined and reported.
    pub refuse_mm: f64,
    /// Largest distance between a curve and the polyline that stands for it, mm.
    pub chord_mm: f64,
    /// Points closer than this are one point of the mesh, mm.
    pub point_mm: f64,
}

impl Tolerance {
    /// Share of the sheet's size below which drawn ends are one: the rounding of drawing programs.
    const JOIN: f64 = 1e-5;
    /// Share above which a gap is meant: the worst gaps seen in designers' own curved files are near 1 %.
    const REFUSE: f64 = 1e-2;
    /// Chord error of flattened curves: a tenth of the 0.01 mm that offsets are held to, on a 1 m sheet.
    const CHORD: f64 = 1e-6;
    /// Mesh points: far above rounding (1e-16 of the size), far below any radius.
    const POINT: f64 = 1e-9;

    /// Tolerances of a sheet whose larger side is `size_mm`.
    pub fn for_size(size_mm: f64) -> Self {
        Self {
            join_mm: Self::JOIN * size_mm,
            refuse_mm: Self::REFUSE * size_mm,
            chord_mm: Self::CHORD * size_mm,
            point_mm: Self::POINT * size_mm,
        }
    }
}
