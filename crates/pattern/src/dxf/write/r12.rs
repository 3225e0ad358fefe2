//! R12 (AC1009) files: short, without handles, read by every program that reads DXF at all.

use super::DECIMALS;
use super::drawing::{Drawing, Entity, colour};
use super::tags::Tags;
use softfold_geometry::DVec2;
use softfold_geometry::text::number;

/// POLYLINE flag; and VERTEX's "more follow" of it.
const VERTICES_FOLLOW: i64 = 1;
/// Longest layer name.
const NAME_LENGTH: usize = 31;

/// The file. R12 has no place for the unit, so a comment says it.
pub(super) fn text(drawing: &Drawing) -> String {
    let mut tags = Tags::new();
    tags.raw(999, "units: millimetres");
    tags.section("HEADER", |t| header(t, drawing.bounds()));
    tags.section("TABLES", |t| tables(t, drawing));
    tags.section("BLOCKS", |_| ());
    tags.section("ENTITIES", |t| drawing.entities.iter().for_each(|e| entity(t, e)));
    tags.finish().0
}

/// A layer's name as R12 allows it.
pub(super) fn layer_name(name: &str) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || "$-_".contains(c);
    let letter = |c: char| if allowed(c) { c.to_ascii_uppercase() } else { '_' };
    name.chars().map(letter).take(NAME_LENGTH).collect()
}

fn header(t: &mut Tags, [lo, hi]: [DVec2; 2]) {
    t.all(&[(9, "$ACADVER"), (1, "AC1009")]);
    for (name, p) in [("$EXTMIN", lo), ("$EXTMAX", hi)] {
        t.raw(9, name).raw(10, &number(p.x, DECIMALS)).raw(20, &number(p.y, DECIMALS)).raw(30, "0");
    }
}

fn tables(t: &mut Tags, drawing: &Drawing) {
    table(t, "LTYPE", 1, |t| {
        t.all(&[
            (0, "LTYPE"),
            (2, "CONTINUOUS"),
            (70, "0"),
            (3, "Solid line"),
            (72, "65"),
            (73, "0"),
            (40, "0"),
        ]);
    });
    table(t, "LAYER", drawing.layers.len() + 1, |t| {
        layer(t, "0", colour::BLACK);
        drawing.layers.iter().for_each(|l| layer(t, &layer_name(&l.name), l.colour));
    });
    table(t, "STYLE", 1, |t| {
        t.all(&[(0, "STYLE"), (2, "STANDARD"), (70, "0"), (40, "0"), (41, "1"), (50, "0"), (71, "0")]);
        t.all(&[(42, "2.5"), (3, "txt"), (4, "")]);
    });
}

fn table(t: &mut Tags, name: &str, count: usize, content: impl FnOnce(&mut Tags)) {
    t.raw(0, "TABLE").raw(2, name).integer(70, count as i64);
    content(t);
    t.raw(0, "ENDTAB");
}

fn layer(t: &mut Tags, name: &str, colour: u8) {
    t.raw(0, "LAYER").raw(2, name).raw(70, "0").integer(62, colour.into()).raw(6, "CONTINUOUS");
}

fn entity(t: &mut Tags, entity: &Entity) {
    let layer = layer_name(entity.layer());
    match entity {
        Entity::Polyline { closed, vertices, .. } => {
            t.raw(0, "POLYLINE").raw(8, &layer).integer(66, VERTICES_FOLLOW);
            t.all(&[(10, "0"), (20, "0"), (30, "0")]).integer(70, (*closed).into());
            for vertex in vertices {
                t.raw(0, "VERTEX").raw(8, &layer);
                super::vertex(t, vertex);
            }
            t.raw(0, "SEQEND").raw(8, &layer);
        }
        Entity::Text { at, height_mm, rotation_deg, text, .. } => {
            t.raw(0, "TEXT").raw(8, &layer);
            super::line_of_text(t, *at, [*height_mm, *rotation_deg], text);
        }
    }
}
