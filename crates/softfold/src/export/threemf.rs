//! 3MF (core specification 1.3): named solid objects in millimetres, for slicers.

use super::{ExportError, escape_xml, number};
use softfold_geometry::{DVec3, TriMesh};
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use zip::{CompressionMethod, DateTime, ZipWriter, write::SimpleFileOptions};

/// Digits after the point: 1e-6 mm, a thousandth of what a printer resolves.
const DECIMALS: usize = 6;
const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
 <Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
 <Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"#;
const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
 <Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"#;

/// One object of the package.
#[derive(Clone, Copy, Debug)]
pub struct Object<'a> {
    /// The name that the slicer shows.
    pub name: &'a str,
    /// Closed, outward oriented mesh, mm.
    pub mesh: &'a TriMesh,
}

/// A 3MF package. Objects keep their places towards each other; together they are moved so that no
/// coordinate on the build plate is negative, as the standard asks.
///
/// # Errors
/// A triangle whose corners are not three different vertices, or a coordinate that is not finite.
pub fn package(title: &str, objects: &[Object<'_>]) -> Result<Vec<u8>, ExportError> {
    let model = model(title, objects)?;
    // A fixed time stamp: the same objects make the same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default());
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let files = [
        ("[Content_Types].xml", CONTENT_TYPES),
        ("_rels/.rels", RELATIONSHIPS),
        ("3D/3dmodel.model", model.as_str()),
    ];
    for (name, content) in files {
        zip.start_file(name, options)?;
        zip.write_all(content.as_bytes())?;
    }
    Ok(zip.finish()?.into_inner())
}

fn model(title: &str, objects: &[Object<'_>]) -> Result<String, ExportError> {
    let mut out = format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
 <metadata name="Title">{}</metadata>
 <metadata name="Application">softfold</metadata>
 <resources>
"#,
        escape_xml(title)
    );
    for (i, object) in objects.iter().enumerate() {
        check(object)?;
        write_object(&mut out, i + 1, object);
    }
    out.push_str(" </resources>\n <build>\n");
    let [x, y, z] = (-lowest(objects)).to_array().map(|c| number(c, DECIMALS));
    for i in 1..=objects.len() {
        // Writing to a string cannot fail.
        let _ = writeln!(out, r#"  <item objectid="{i}" transform="1 0 0 0 1 0 0 0 1 {x} {y} {z}"/>"#);
    }
    out.push_str(" </build>\n</model>\n");
    Ok(out)
}

fn write_object(out: &mut String, id: usize, object: &Object<'_>) {
    let _ = writeln!(out, r#"  <object id="{id}" type="model" name="{}">"#, escape_xml(object.name));
    out.push_str("   <mesh>\n    <vertices>\n");
    for p in &object.mesh.positions {
        let [x, y, z] = p.to_array().map(|c| number(c, DECIMALS));
        let _ = writeln!(out, r#"     <vertex x="{x}" y="{y}" z="{z}"/>"#);
    }
    out.push_str("    </vertices>\n    <triangles>\n");
    for [a, b, c] in &object.mesh.triangles {
        let _ = writeln!(out, r#"     <triangle v1="{a}" v2="{b}" v3="{c}"/>"#);
    }
    out.push_str("    </triangles>\n   </mesh>\n  </object>\n");
}

fn check(object: &Object<'_>) -> Result<(), ExportError> {
    if object.mesh.positions.iter().any(|p| !p.is_finite()) {
        return Err(ExportError::NotFinite { what: format!("the object \"{}\"", object.name) });
    }
    let count = object.mesh.positions.len();
    let bad = |&[a, b, c]: &[u32; 3]| a == b || b == c || c == a || a.max(b).max(c) as usize >= count;
    match object.mesh.triangles.iter().position(bad) {
        None => Ok(()),
        Some(triangle) => {
            let corners = object.mesh.triangles[triangle];
            Err(ExportError::BadTriangle { object: object.name.to_owned(), triangle, corners })
        }
    }
}

/// Lower corner of the box around all objects.
fn lowest(objects: &[Object<'_>]) -> DVec3 {
    objects.iter().map(|o| o.mesh.bounds().0).reduce(DVec3::min).unwrap_or(DVec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    fn tetrahedron() -> TriMesh {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p - DVec3::X * 5.0).to_vec();
        TriMesh { positions, triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] }
    }

    fn read(bytes: &[u8], name: &str) -> String {
        let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        let mut text = String::new();
        zip.by_name(name).unwrap().read_to_string(&mut text).unwrap();
        text
    }

    #[test]
    fn holds_two_named_objects_and_lifts_them_onto_the_plate() {
        let mesh = tetrahedron();
        let objects = [Object { name: "A1 <left>", mesh: &mesh }, Object { name: "A2", mesh: &mesh }];
        let bytes = package("mold", &objects).unwrap();
        let model = read(&bytes, "3D/3dmodel.model");
        assert_eq!(model.matches("<triangle ").count(), 8);
        assert!(model.contains(r#"name="A1 &lt;left&gt;""#) && model.contains(r#"name="A2""#));
        assert!(model.contains(r#"unit="millimeter""#));
        assert_eq!(model.matches(r#"0 0 1 5 0 0""#).count(), 2);
        assert!(read(&bytes, "_rels/.rels").contains("/3D/3dmodel.model"));
        assert!(read(&bytes, "[Content_Types].xml").contains("3dmanufacturing-3dmodel+xml"));
        assert_eq!(bytes, package("mold", &objects).unwrap());
    }

    #[test]
    fn a_folded_triangle_is_named() {
        let mut mesh = tetrahedron();
        mesh.triangles[2] = [0, 3, 3];
        let error = package("m", &[Object { name: "B7", mesh: &mesh }]).unwrap_err().to_string();
        assert!(error.contains("triangle 2 of \"B7\""), "{error}");
    }
}
