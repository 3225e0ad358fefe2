//! Closed-form states of `../shared/truth`: FOLD files with the flat sheet and its folded form.

#![allow(dead_code, reason = "each test binary uses its part")]

use serde_json::Value;
use softfold_geometry::{
    CreaseId, DVec2, DVec3, EdgeClass, FlatMesh, FoldedSheet, LoopId, Site, SolveRecord, VertexId, polygon,
};
use std::collections::BTreeMap;
use std::path::Path;

/// A closed-form state: the positions of the flat mesh's vertices; its folds carry the angles that the file tells.
pub(crate) struct Truth {
    pub(crate) name: String,
    pub(crate) exact: FoldedSheet,
    pub(crate) size_mm: f64,
    /// Corners of the facets, whose sides lie across the rulings and along them by turns.
    pub(crate) faces: Vec<Vec<u32>>,
}

impl Truth {
    pub(crate) fn read(file: &Path) -> Self {
        let text = std::fs::read_to_string(file).expect("a readable state");
        let flat: Value = serde_json::from_str(&text).expect("JSON");
        let points = |frame: &Value| -> Vec<Vec<f64>> { from(&frame["vertices_coords"]) };
        let folded = &flat["file_frames"][0];
        let mesh = flat_mesh(&flat, points(&flat).iter().map(|p| DVec2::new(p[0], p[1])).collect());
        mesh.check().expect("a sound mesh");
        let (low, high) = polygon::bounds(&mesh.vertices);
        let positions = points(folded).iter().map(|p| DVec3::new(p[0], p[1], p[2])).collect();
        let exact = FoldedSheet { mesh, positions, solve: SolveRecord::default() };
        exact.check().expect("a sound state");
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Self { name, exact, size_mm: (high - low).max_element(), faces: from(&flat["faces_vertices"]) }
    }

    /// The creases as chains of vertices.
    pub(crate) fn creases(&self) -> Vec<Vec<u32>> {
        let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for e in self.exact.mesh.edges.iter().filter(|e| matches!(e.class, EdgeClass::Fold { .. })) {
            let [a, b] = e.vertices.map(|v| v.0);
            next.entry(a).or_default().push(b);
            next.entry(b).or_default().push(a);
        }
        let mut chains = Vec::new();
        while let Some(start) = next.iter().find(|(_, n)| n.len() == 1).map(|(v, _)| *v) {
            let mut chain = vec![start];
            while let Some(v) = next.remove(chain.last().expect("a start")).and_then(|mut n| n.pop()) {
                next.get_mut(&v).expect("both ways").retain(|u| chain.last() != Some(u));
                chain.push(v);
            }
            chains.push(chain);
        }
        assert!(next.is_empty(), "{}: a crease that is no chain", self.name);
        chains
    }
}

fn from<T: serde::de::DeserializeOwned>(value: &Value) -> T {
    serde_json::from_value(value.clone()).expect("a list of the expected kind")
}

/// Faces as fans of triangles; edges that the file calls mountain or valley are folds by its angle.
fn flat_mesh(frame: &Value, vertices: Vec<DVec2>) -> FlatMesh {
    let ends: Vec<[u32; 2]> = from(&frame["edges_vertices"]);
    let letters: Vec<String> = from(&frame["edges_assignment"]);
    let angles_deg: Vec<Option<f64>> = from(&frame["edges_foldAngle"]);
    let folds: BTreeMap<[u32; 2], f64> = (0..ends.len())
        .filter(|&i| ["M", "V"].contains(&letters[i].as_str()))
        .map(|i| {
            let [a, b] = ends[i];
            ([a.min(b), a.max(b)], angles_deg[i].expect("a fold has its angle").to_radians())
        })
        .collect();
    let faces: Vec<Vec<u32>> = from(&frame["faces_vertices"]);
    let fan = |face: &Vec<u32>| {
        (2..face.len()).map(|k| [face[0], face[k - 1], face[k]].map(VertexId)).collect::<Vec<_>>()
    };
    let triangles = faces.iter().flat_map(fan).collect();
    let sites = vec![Site::Interior; vertices.len()]; // nothing here asks for them
    FlatMesh::new(vertices, sites, triangles, |[a, b], boundary| match folds.get(&[a.0, b.0]) {
        _ if boundary => EdgeClass::Boundary { loop_id: LoopId(0) },
        Some(&turn_rad) => EdgeClass::Fold { crease: CreaseId(0), line: 0, turn_rad },
        None => EdgeClass::Facet,
    })
}
