//! What an R2000 file needs around its entities: header, tables, blocks, dictionaries; and its entities.
//!
//! Handles below `FIRST_FREE` of `tags` belong to fixed objects, named here; layers and entities get theirs in order.

use super::DECIMALS;
use super::drawing::{Drawing, Entity, colour};
use super::tags::{NOBODY, Tags};
use softfold_geometry::DVec2;
use softfold_geometry::text::number;

/// Owner of everything in the drawing itself: the block record of model space.
const MODEL_SPACE: u32 = 0x10;
const PAPER_SPACE: u32 = 0x11;
const TABLE_VPORT: u32 = 0x1;
const TABLE_LTYPE: u32 = 0x2;
const TABLE_LAYER: u32 = 0x3;
const TABLE_STYLE: u32 = 0x4;
const TABLE_VIEW: u32 = 0x5;
const TABLE_UCS: u32 = 0x6;
const TABLE_APPID: u32 = 0x7;
const TABLE_DIMSTYLE: u32 = 0x8;
const TABLE_BLOCK_RECORD: u32 = 0x9;
const ROOT_DICTIONARY: u32 = 0xA;
const GROUPS: u32 = 0xB;
const LAYOUTS: u32 = 0xC;
const PLOT_STYLES: u32 = 0xD;
const PLOT_STYLE_NORMAL: u32 = 0xE;
const MODEL_LAYOUT: u32 = 0x12;
const PAPER_LAYOUT: u32 = 0x13;
/// Stands in for the handle seed until all handles are given; as long as any seed.
const SEED_PLACE: &str = "SEEDSEED";

/// The file.
pub(super) fn text(drawing: &Drawing) -> String {
    let layers: Vec<_> = drawing.layers.iter().map(|l| (layer_name(&l.name), l.colour)).collect();
    let bounds = drawing.bounds();
    let mut tags = Tags::new();
    tags.section("HEADER", |t| header(t, bounds));
    tags.section("CLASSES", |_| ());
    tags.section("TABLES", |t| tables(t, &layers, bounds));
    tags.section("BLOCKS", |t| {
        block(t, "*Model_Space", MODEL_SPACE);
        block(t, "*Paper_Space", PAPER_SPACE);
    });
    tags.section("ENTITIES", |t| drawing.entities.iter().for_each(|e| entity(t, e)));
    tags.section("OBJECTS", objects);
    let (text, seed) = tags.finish();
    // The header comes first: no name of the user's stands before it.
    text.replacen(SEED_PLACE, &format!("{seed:08X}"), 1)
}

/// A layer's name without the characters that DXF reserves.
pub(super) fn layer_name(name: &str) -> String {
    const RESERVED: &str = "<>/\\\":;?*|=,`'";
    name.chars().map(|c| if RESERVED.contains(c) || c.is_control() { '_' } else { c }).collect()
}

fn entity(tags: &mut Tags, entity: &Entity) {
    match entity {
        Entity::Polyline { layer, closed, vertices } => {
            tags.entity("LWPOLYLINE", &layer_name(layer), MODEL_SPACE);
            polyline(tags, *closed, vertices);
        }
        Entity::Text { layer, at, height_mm, rotation_deg, text } => {
            tags.entity("TEXT", &layer_name(layer), MODEL_SPACE);
            tags.text(100, "AcDbText");
            super::line_of_text(tags, *at, [*height_mm, *rotation_deg], text);
            tags.text(7, "Standard").text(100, "AcDbText");
        }
    }
}

fn polyline(tags: &mut Tags, closed: bool, vertices: &[[f64; 3]]) {
    tags.text(100, "AcDbPolyline").integer(90, vertices.len() as i64).integer(70, closed.into());
    for vertex in vertices {
        super::vertex(tags, vertex);
    }
}

fn header(t: &mut Tags, [lo, hi]: [DVec2; 2]) {
    t.all(&[(9, "$ACADVER"), (1, "AC1015"), (9, "$DWGCODEPAGE"), (3, "ANSI_1252")]);
    t.raw(9, "$EXTMIN");
    point(t, 10, lo).raw(30, "0");
    t.raw(9, "$EXTMAX");
    point(t, 10, hi).raw(30, "0");
    // 4: millimetres; 1: metric.
    t.all(&[(9, "$INSUNITS"), (70, "4"), (9, "$MEASUREMENT"), (70, "1"), (9, "$HANDSEED"), (5, SEED_PLACE)]);
}

fn point(t: &mut Tags, code: i32, p: DVec2) -> &mut Tags {
    t.raw(code, &number(p.x, DECIMALS)).raw(code + 10, &number(p.y, DECIMALS))
}

fn tables(t: &mut Tags, layers: &[(String, u8)], bounds: [DVec2; 2]) {
    t.table("VPORT", TABLE_VPORT, 1, |t| viewport(t, bounds));
    t.table("LTYPE", TABLE_LTYPE, 3, |t| {
        for name in ["ByBlock", "ByLayer", "Continuous"] {
            t.record("LTYPE", TABLE_LTYPE, "AcDbLinetypeTableRecord", name);
            t.all(&[(3, ""), (72, "65"), (73, "0"), (40, "0")]);
        }
    });
    t.table("LAYER", TABLE_LAYER, layers.len() + 1, |t| {
        layer(t, "0", colour::BLACK);
        layers.iter().for_each(|(name, colour)| layer(t, name, *colour));
    });
    t.table("STYLE", TABLE_STYLE, 1, |t| {
        t.record("STYLE", TABLE_STYLE, "AcDbTextStyleTableRecord", "Standard");
        t.all(&[(40, "0"), (41, "1"), (50, "0"), (71, "0"), (42, "2.5"), (3, "txt"), (4, "")]);
    });
    t.table("VIEW", TABLE_VIEW, 0, |_| ());
    t.table("UCS", TABLE_UCS, 0, |_| ());
    t.table("APPID", TABLE_APPID, 1, |t| {
        t.record("APPID", TABLE_APPID, "AcDbRegAppTableRecord", "ACAD");
    });
    dimension_styles(t);
    t.table("BLOCK_RECORD", TABLE_BLOCK_RECORD, 2, |t| {
        block_record(t, "*Model_Space", MODEL_SPACE, MODEL_LAYOUT);
        block_record(t, "*Paper_Space", PAPER_SPACE, PAPER_LAYOUT);
    });
}

/// The window shows the whole drawing with a margin.
fn viewport(t: &mut Tags, [lo, hi]: [DVec2; 2]) {
    const ASPECT: f64 = 1.5;
    const MARGIN: f64 = 1.1;
    let size = hi - lo;
    let height = (size.y.max(size.x / ASPECT) * MARGIN).max(1.0);
    t.record("VPORT", TABLE_VPORT, "AcDbViewportTableRecord", "*Active");
    t.all(&[(10, "0"), (20, "0"), (11, "1"), (21, "1")]);
    point(t, 12, 0.5 * (lo + hi));
    t.all(&[(13, "0"), (23, "0"), (14, "10"), (24, "10"), (15, "10"), (25, "10")]);
    t.all(&[(16, "0"), (26, "0"), (36, "1"), (17, "0"), (27, "0"), (37, "0")]);
    t.raw(40, &number(height, DECIMALS)).raw(41, &number(ASPECT, DECIMALS));
    t.all(&[(42, "50"), (43, "0"), (44, "0"), (50, "0"), (51, "0"), (71, "0"), (72, "1000"), (73, "1")]);
    t.all(&[(74, "3"), (75, "0"), (76, "0"), (77, "0"), (78, "0"), (281, "0"), (65, "0"), (146, "0")]);
}

fn layer(t: &mut Tags, name: &str, colour: u8) {
    t.record("LAYER", TABLE_LAYER, "AcDbLayerTableRecord", name).integer(62, colour.into());
    // -3: the default line weight.
    t.raw(6, "Continuous").raw(370, "-3").handle(390, PLOT_STYLE_NORMAL);
}

/// The one table whose records carry their handle under code 105.
fn dimension_styles(t: &mut Tags) {
    t.raw(0, "TABLE").raw(2, "DIMSTYLE").handle(5, TABLE_DIMSTYLE).handle(330, NOBODY);
    t.all(&[(100, "AcDbSymbolTable"), (70, "1"), (100, "AcDbDimStyleTable")]);
    let handle = t.fresh();
    t.raw(0, "DIMSTYLE").handle(105, handle).handle(330, TABLE_DIMSTYLE);
    t.all(&[(100, "AcDbSymbolTableRecord"), (100, "AcDbDimStyleTableRecord"), (2, "Standard"), (70, "0")]);
    t.raw(0, "ENDTAB");
}

fn block_record(t: &mut Tags, name: &str, handle: u32, layout: u32) {
    t.object("BLOCK_RECORD", handle, TABLE_BLOCK_RECORD);
    t.all(&[(100, "AcDbSymbolTableRecord"), (100, "AcDbBlockTableRecord"), (2, name)]).handle(340, layout);
}

fn block(t: &mut Tags, name: &str, record: u32) {
    t.entity("BLOCK", "0", record);
    t.all(&[
        (100, "AcDbBlockBegin"),
        (2, name),
        (70, "0"),
        (10, "0"),
        (20, "0"),
        (30, "0"),
        (3, name),
        (1, ""),
    ]);
    t.entity("ENDBLK", "0", record);
    t.raw(100, "AcDbBlockEnd");
}

fn objects(t: &mut Tags) {
    dictionary(
        t,
        ROOT_DICTIONARY,
        NOBODY,
        &[("ACAD_GROUP", GROUPS), ("ACAD_LAYOUT", LAYOUTS), ("ACAD_PLOTSTYLENAME", PLOT_STYLES)],
    );
    dictionary(t, GROUPS, ROOT_DICTIONARY, &[]);
    dictionary(t, LAYOUTS, ROOT_DICTIONARY, &[("Model", MODEL_LAYOUT), ("Layout1", PAPER_LAYOUT)]);
    t.object("ACDBDICTIONARYWDFLT", PLOT_STYLES, ROOT_DICTIONARY);
    t.all(&[(100, "AcDbDictionary"), (281, "1"), (3, "Normal")]).handle(350, PLOT_STYLE_NORMAL);
    t.raw(100, "AcDbDictionaryWithDefault").handle(340, PLOT_STYLE_NORMAL);
    t.object("ACDBPLACEHOLDER", PLOT_STYLE_NORMAL, PLOT_STYLES);
    layout(t, "Model", MODEL_LAYOUT, MODEL_SPACE, 0);
    layout(t, "Layout1", PAPER_LAYOUT, PAPER_SPACE, 1);
}

fn dictionary(t: &mut Tags, handle: u32, owner: u32, entries: &[(&str, u32)]) {
    t.object("DICTIONARY", handle, owner).all(&[(100, "AcDbDictionary"), (281, "1")]);
    entries.iter().for_each(|(name, target)| {
        t.raw(3, name).handle(350, *target);
    });
}

/// A layout on A3; `tab` 0 is model space.
fn layout(t: &mut Tags, name: &str, handle: u32, block_record: u32, tab: i64) {
    // 1024: the settings of the model tab.
    let flags = if tab == 0 { "1024" } else { "0" };
    t.object("LAYOUT", handle, LAYOUTS);
    t.all(&[(100, "AcDbPlotSettings"), (1, ""), (2, ""), (4, "A3"), (6, "")]);
    t.all(&[
        (40, "7.5"),
        (41, "20"),
        (42, "7.5"),
        (43, "20"),
        (44, "420"),
        (45, "297"),
        (46, "0"),
        (47, "0"),
    ]);
    t.all(&[(48, "0"), (49, "0"), (140, "0"), (141, "0"), (142, "1"), (143, "1"), (70, flags), (72, "1")]);
    t.all(&[(73, "0"), (74, "5"), (7, ""), (75, "16"), (147, "1"), (148, "0"), (149, "0")]);
    t.all(&[(100, "AcDbLayout"), (1, name), (70, "1")]).integer(71, tab);
    t.all(&[(10, "0"), (20, "0"), (11, "420"), (21, "297"), (12, "0"), (22, "0"), (32, "0")]);
    t.all(&[(14, "0"), (24, "0"), (34, "0"), (15, "420"), (25, "297"), (35, "0"), (146, "0")]);
    t.all(&[
        (13, "0"),
        (23, "0"),
        (33, "0"),
        (16, "1"),
        (26, "0"),
        (36, "0"),
        (17, "0"),
        (27, "1"),
        (37, "0"),
    ]);
    t.raw(76, "0").handle(330, block_record);
}
