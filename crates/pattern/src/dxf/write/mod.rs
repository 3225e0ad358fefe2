//! DXF files: drawings of layers, polylines and text, and crease patterns as such drawings.
//!
//! A writer of our own: the crate `dxf` (0.6) leaves table heads without handles, which auditors repair,
//! and stamps every file with random ids and the time of day. Format: Autodesk, "DXF Reference", 2000, and
//! "AutoCAD Release 12 Customization Manual", appendix B.

mod bulges;
mod drawing;
mod r12;
mod r2000;
mod tags;

pub use drawing::{Drawing, DrawingError, DxfVersion, Entity, Layer, colour};

use softfold_geometry::text::number;
use softfold_geometry::{CreasePattern, PlanarCurve, Role};
use tags::Tags;

/// Digits after the point: 1e-6 mm, a thousandth of what a machine resolves.
const DECIMALS: usize = 6;
/// Digits of a bulge, which is no length: all of them count.
const BULGE_DECIMALS: usize = 12;
/// Chord error of curves that are no arcs, mm: what routers and CAM programs ask for.
const CHORD_MM: f64 = 0.02;

/// How a pattern is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DxfOptions {
    /// Which DXF.
    pub version: DxfVersion,
    /// Farthest that the drawing may lie from the pattern's curves, mm; at least the last digit that is written.
    pub chord_mm: f64,
}

impl Default for DxfOptions {
    /// R2000, within 0.02 mm.
    fn default() -> Self {
        Self { version: DxfVersion::default(), chord_mm: CHORD_MM }
    }
}

/// A pattern as DXF in mm, x = u and y = v: every curve one polyline with arcs, outline and holes closed, nothing
/// twice. What is an arc within [`DxfOptions::chord_mm`] stays one; other curves become chords.
///
/// | layer | what | colour |
/// |---|---|---|
/// | `CUT` | outline and holes | black (7) |
/// | `SLIT` | slits | green (3) |
/// | `MOUNTAIN` | | red (1) |
/// | `VALLEY` | | blue (5) |
/// | `FLAT` | | yellow (2) |
/// | `UNASSIGNED` | | magenta (6) |
///
/// Only layers on which something lies are there. Reading the file back gives the same roles. DXF has no place for
/// names and fold angles: use SVG or FOLD to keep them.
pub fn write_dxf(pattern: &CreasePattern, options: &DxfOptions) -> String {
    let outlines = pattern.loops().map(|(_, c)| (Role::Boundary, c));
    let slits = pattern.slits.iter().map(|c| (Role::Cut, c));
    let creases = pattern.creases.iter().map(|c| (c.role, &c.curve));
    let curves: Vec<(Role, &PlanarCurve)> = outlines.chain(slits).chain(creases).collect();
    let layers = LAYERS
        .iter()
        .filter(|(role, ..)| curves.iter().any(|(r, _)| r == role))
        .map(|(_, name, colour)| Layer::new(*name, *colour))
        .collect();
    let entities = curves.iter().map(|(role, curve)| Entity::Polyline {
        layer: layer_of(*role).to_owned(),
        closed: curve.is_closed(),
        vertices: bulges::vertices(curve, options.chord_mm),
    });
    Drawing { layers, entities: entities.collect() }.text(options.version)
}

/// The layers of a pattern.
const LAYERS: [(Role, &str, u8); 6] = [
    (Role::Boundary, "CUT", colour::BLACK),
    (Role::Cut, "SLIT", colour::GREEN),
    (Role::Mountain, "MOUNTAIN", colour::RED),
    (Role::Valley, "VALLEY", colour::BLUE),
    (Role::Flat, "FLAT", colour::YELLOW),
    (Role::Unassigned, "UNASSIGNED", colour::MAGENTA),
];

fn layer_of(role: Role) -> &'static str {
    LAYERS.iter().find(|(r, ..)| *r == role).map_or("0", |(_, name, _)| name)
}

/// x, y and bulge of a vertex.
fn vertex(tags: &mut Tags, [x, y, bulge]: &[f64; 3]) {
    tags.raw(10, &number(*x, DECIMALS)).raw(20, &number(*y, DECIMALS));
    if *bulge != 0.0 {
        tags.raw(42, &number(*bulge, BULGE_DECIMALS));
    }
}

/// Place, height, text and direction of a TEXT.
fn line_of_text(tags: &mut Tags, at: [f64; 2], [height, rotation]: [f64; 2], text: &str) {
    tags.raw(10, &number(at[0], DECIMALS)).raw(20, &number(at[1], DECIMALS)).raw(30, "0");
    tags.raw(40, &number(height, DECIMALS)).text(1, text).raw(50, &number(rotation, DECIMALS));
}
