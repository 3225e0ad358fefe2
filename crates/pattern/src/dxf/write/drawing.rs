//! DXF drawings in millimetres: layers, polylines with arcs, text.

use super::{r12, r2000};
use softfold_geometry::DVec2;

/// AutoCAD colour numbers of the layers.
pub mod colour {
    /// Red.
    pub const RED: u8 = 1;
    /// Yellow.
    pub const YELLOW: u8 = 2;
    /// Green.
    pub const GREEN: u8 = 3;
    /// Blue.
    pub const BLUE: u8 = 5;
    /// Magenta.
    pub const MAGENTA: u8 = 6;
    /// White on a dark screen, black on a light one.
    pub const BLACK: u8 = 7;
    /// Grey.
    pub const GREY: u8 = 8;
}

/// One layer: one operation of the machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Its name; characters that DXF does not allow become `_`.
    pub name: String,
    /// AutoCAD colour number, 1..=255; see [`colour`].
    pub colour: u8,
}

/// One thing that is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Entity {
    /// Straight lines and arcs.
    Polyline {
        /// Its layer.
        layer: String,
        /// Whether the last vertex is joined to the first; do not repeat the first one then.
        closed: bool,
        /// x and y in mm, and the bulge of the piece that starts here: the tangent of a quarter of the
        /// arc's angle, positive counter-clockwise, 0 for a straight line, 1 for a half circle.
        vertices: Vec<[f64; 3]>,
    },
    /// A line of text, in the drawing program's stroke font.
    Text {
        /// Its layer.
        layer: String,
        /// Left end of the base line, mm.
        at: [f64; 2],
        /// Height of capitals, mm.
        height_mm: f64,
        /// Direction of the base line, degrees counter-clockwise from x.
        rotation_deg: f64,
        /// The text.
        text: String,
    },
}

/// A drawing in millimetres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Its layers; layer `0` is always there.
    pub layers: Vec<Layer>,
    /// What is drawn, in this order.
    pub entities: Vec<Entity>,
}

impl Layer {
    /// A layer.
    pub fn new(name: impl Into<String>, colour: u8) -> Self {
        Self { name: name.into(), colour }
    }
}

impl Entity {
    /// A polyline of straight lines.
    pub fn lines(layer: impl Into<String>, closed: bool, points: &[DVec2]) -> Self {
        let vertices = points.iter().map(|p| [p.x, p.y, 0.0]).collect();
        Entity::Polyline { layer: layer.into(), closed, vertices }
    }

    /// A full circle, as two half arcs.
    pub fn circle(layer: impl Into<String>, centre: DVec2, radius_mm: f64) -> Self {
        let vertices = vec![[centre.x + radius_mm, centre.y, 1.0], [centre.x - radius_mm, centre.y, 1.0]];
        Entity::Polyline { layer: layer.into(), closed: true, vertices }
    }

    /// The layer it lies on.
    pub fn layer(&self) -> &str {
        match self {
            Entity::Polyline { layer, .. } | Entity::Text { layer, .. } => layer,
        }
    }

    fn points(&self) -> Vec<DVec2> {
        match self {
            Entity::Polyline { vertices, .. } => vertices.iter().map(|v| DVec2::new(v[0], v[1])).collect(),
            Entity::Text { at, .. } => vec![DVec2::from(*at)],
        }
    }

    fn is_finite(&self) -> bool {
        match self {
            Entity::Polyline { vertices, .. } => vertices.iter().flatten().all(|c| c.is_finite()),
            Entity::Text { at, height_mm, rotation_deg, .. } => {
                [at[0], at[1], *height_mm, *rotation_deg].iter().all(|c| c.is_finite())
            }
        }
    }
}

/// Which DXF.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DxfVersion {
    /// R12 (AC1009): read by everything; says no unit.
    R12,
    /// R2000 (AC1015): says that its unit is the millimetre.
    #[default]
    R2000,
}

/// A drawing that cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DrawingError {
    /// An entity lies on a layer that the drawing does not declare.
    #[error(
        "DXF entity {entity} lies on the layer \"{layer}\", which the drawing does not declare; add it to the layers"
    )]
    UnknownLayer {
        /// Number of the entity, from 0.
        entity: usize,
        /// The layer's name.
        layer: String,
    },
    /// Two layers have one name, as the file holds it.
    #[error("the DXF layer \"{layer}\" is declared twice; declare it once")]
    DoubleLayer {
        /// The layer's name.
        layer: String,
    },
    /// A polyline with fewer points than it needs.
    #[error("DXF polyline {entity} on layer \"{layer}\" has {vertices} vertices; it needs two or more")]
    ShortPolyline {
        /// Number of the entity, from 0.
        entity: usize,
        /// The layer's name.
        layer: String,
        /// Vertices it has.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("DXF entity {entity} on layer \"{layer}\" has a coordinate that is no finite number")]
    NotFinite {
        /// Number of the entity, from 0.
        entity: usize,
        /// The layer's name.
        layer: String,
    },
}

impl Drawing {
    /// The drawing as an R2000 file: [`Drawing::to_text`].
    ///
    /// # Errors
    /// As [`Drawing::to_text`].
    pub fn to_dxf(&self) -> Result<String, DrawingError> {
        self.to_text(DxfVersion::R2000)
    }

    /// The drawing as a DXF file, in ASCII with CRLF line ends; the same for the same drawing, to the last byte.
    /// R12 knows no layer names but of 31 characters out of A to Z, digits, `$`, `-` and `_`: others are changed.
    ///
    /// # Errors
    /// A layer that is not declared or declared twice, a polyline of less than two vertices, a coordinate
    /// that is not finite.
    pub fn to_text(&self, version: DxfVersion) -> Result<String, DrawingError> {
        self.check(version)?;
        Ok(self.text(version))
    }

    /// As [`Drawing::to_text`], of a drawing that is known to be sound.
    pub(super) fn text(&self, version: DxfVersion) -> String {
        match version {
            DxfVersion::R12 => r12::text(self),
            DxfVersion::R2000 => r2000::text(self),
        }
    }

    fn check(&self, version: DxfVersion) -> Result<(), DrawingError> {
        let written = |l: &Layer| match version {
            DxfVersion::R12 => r12::layer_name(&l.name),
            DxfVersion::R2000 => r2000::layer_name(&l.name),
        };
        for (i, layer) in self.layers.iter().enumerate() {
            let same = |l: &Layer| written(l).eq_ignore_ascii_case(&written(layer));
            if self.layers.iter().take(i).any(same) {
                return Err(DrawingError::DoubleLayer { layer: layer.name.clone() });
            }
        }
        self.entities.iter().enumerate().try_for_each(|(i, e)| self.check_entity(i, e))
    }

    fn check_entity(&self, number: usize, entity: &Entity) -> Result<(), DrawingError> {
        let layer = entity.layer().to_owned();
        if layer != "0" && !self.layers.iter().any(|l| l.name == layer) {
            return Err(DrawingError::UnknownLayer { entity: number, layer });
        }
        if !entity.is_finite() {
            return Err(DrawingError::NotFinite { entity: number, layer });
        }
        match entity {
            Entity::Polyline { vertices, .. } if vertices.len() < 2 => {
                Err(DrawingError::ShortPolyline { entity: number, layer, vertices: vertices.len() })
            }
            _ => Ok(()),
        }
    }

    /// Box around all vertices (arcs may reach past it).
    pub(super) fn bounds(&self) -> [DVec2; 2] {
        let points: Vec<_> = self.entities.iter().flat_map(Entity::points).collect();
        let (lo, hi) = softfold_geometry::polygon::bounds(&points);
        [lo, hi]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing() -> Drawing {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(|p| p * 100.0);
        Drawing {
            layers: vec![Layer::new("CUT", colour::RED), Layer::new("mark/ä", colour::GREEN)],
            entities: vec![
                Entity::lines("CUT", true, &square),
                Entity::circle("CUT", DVec2::new(50., 50.), 10.0),
                Entity::Text {
                    layer: "mark/ä".into(),
                    at: [5., 5.],
                    height_mm: 8.0,
                    rotation_deg: 45.0,
                    text: "A1 Ø\n2".into(),
                },
            ],
        }
    }

    /// Group codes and values.
    fn pairs(text: &str) -> Vec<(i32, String)> {
        let lines: Vec<_> = text.split("\r\n").collect();
        lines.chunks_exact(2).map(|c| (c[0].trim().parse().unwrap(), c[1].to_owned())).collect()
    }

    #[test]
    fn says_its_version_and_its_unit() {
        let tags = pairs(&drawing().to_dxf().unwrap());
        let after = |name: &str| tags[tags.iter().position(|t| t.1 == name).unwrap() + 1].clone();
        assert_eq!(after("$ACADVER"), (1, "AC1015".into()));
        assert_eq!(after("$INSUNITS"), (70, "4".into()));
        assert_eq!(tags.last().unwrap(), &(0, "EOF".into()));
    }

    #[test]
    fn polylines_are_closed_and_bulged() {
        let tags = pairs(&drawing().to_dxf().unwrap());
        assert_eq!(tags.iter().filter(|t| **t == (0, "LWPOLYLINE".into())).count(), 2);
        let start = tags.iter().rposition(|t| *t == (0, "LWPOLYLINE".into())).unwrap();
        let circle = &tags[start..start + 14];
        assert!(circle.contains(&(70, "1".into())) && circle.contains(&(90, "2".into())));
        assert_eq!(circle.iter().filter(|t| **t == (42, "1".into())).count(), 2);
    }

    #[test]
    fn handles_are_all_different_and_below_the_seed() {
        let tags = pairs(&drawing().to_dxf().unwrap());
        let seed_at = tags.iter().position(|t| t.1 == "$HANDSEED").unwrap() + 1;
        let hex = |s: &str| u64::from_str_radix(s, 16).unwrap();
        let mut handles: Vec<_> = tags
            .iter()
            .enumerate()
            .filter(|(i, t)| *i != seed_at && (t.0 == 5 || t.0 == 105))
            .map(|(_, t)| hex(&t.1))
            .collect();
        let count = handles.len();
        handles.sort_unstable();
        handles.dedup();
        assert_eq!(handles.len(), count);
        assert!(handles.last().unwrap() < &hex(&tags[seed_at].1));
    }

    #[test]
    fn the_file_is_ascii_and_the_same_every_time() {
        let text = drawing().to_dxf().unwrap();
        assert!(text.is_ascii());
        assert!(text.contains("A1 \\U+00D8 2\r\n") && text.contains("mark_\\U+00E4\r\n"));
        assert_eq!(text, drawing().to_dxf().unwrap());
    }

    #[test]
    fn faults_name_the_entity() {
        let mut d = drawing();
        d.entities.push(Entity::lines("BEND", false, &[DVec2::ZERO, DVec2::X]));
        assert!(d.to_dxf().unwrap_err().to_string().contains("entity 3 lies on the layer \"BEND\""));
        let mut d = drawing();
        d.entities[0] = Entity::lines("CUT", true, &[DVec2::ZERO]);
        assert!(matches!(d.to_dxf(), Err(DrawingError::ShortPolyline { entity: 0, vertices: 1, .. })));
        let mut d = drawing();
        d.layers.push(Layer::new("cut", colour::BLUE));
        assert!(matches!(d.to_dxf(), Err(DrawingError::DoubleLayer { .. })));
    }
}
