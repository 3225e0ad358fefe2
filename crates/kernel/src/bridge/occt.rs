pub(crate) use ffi::*;

#[cxx::bridge(namespace = "softfold::occt")]
mod ffi {
    #[namespace = "softfold"]
    unsafe extern "C++" {
        include!("softfold-kernel/src/bridge/common.rs.h");
        type FlatMesh = crate::bridge::common::FlatMesh;
    }

    #[namespace = ""]
    unsafe extern "C++" {
        include!("occt/trycatch.h");
        include!("occt/messages.h");
        include!("occt/version.h");
        include!("occt/copy.h");
        include!("occt/surface_at.h");
        include!("occt/trimmed_face.h");
        include!("occt/sheet_shell.h");
        include!("occt/board_solid.h");
        include!("occt/shell.h");
        include!("occt/prism.h");
        include!("occt/extruded_polygon.h");
        include!("occt/boolean.h");
        include!("occt/transformed.h");
        include!("occt/check.h");
        include!("occt/mass_properties.h");
        include!("occt/area.h");
        include!("occt/tolerance.h");
        include!("occt/triangulate.h");
        include!("occt/write_step.h");
        include!("occt/read_step.h");
        include!("occt/iges.h");
        include!("occt/brep_file.h");
        include!("occt/faceted.h");
        type TopoDS_Shape = opencascade_sys::topo_ds::TopoDS_Shape;
    }

    /// A bicubic surface: poles in rows (u outer, v inner), distinct knots.
    struct FlatSurface {
        poles: Vec<f64>,
        pole_count_u: u32,
        pole_count_v: u32,
        knots_u: Vec<f64>,
        knots_v: Vec<f64>,
        multiplicities_u: Vec<u32>,
        multiplicities_v: Vec<u32>,
    }

    /// Bezier curves in (u, v), end to end: `curve_sizes` poles per curve, `loop_sizes` curves per loop.
    struct FlatLoops {
        poles: Vec<f64>,
        curve_sizes: Vec<u32>,
        loop_sizes: Vec<u32>,
    }

    /// Edges and the loops of faces along them: `edge_sizes` Bezier poles and two of `edge_corners` per edge, `face_sizes`
    /// loops per face, `loop_sizes` uses per loop. A use is twice the edge's number, and one more if it runs backwards.
    struct FlatSheetShell {
        poles: Vec<f64>,
        edge_sizes: Vec<u32>,
        edge_corners: Vec<u32>,
        corner_count: u32,
        face_sizes: Vec<u32>,
        loop_sizes: Vec<u32>,
        uses: Vec<u32>,
    }

    /// Faces that share edges. Edge `e` has the next `edge_uses[e]` entries of `use_faces` and of `use_lines`: u, v of its
    /// start in the face and its unit direction there. Face `f` has the next `border_sizes[f]` entries of `border_edges`.
    struct FlatShell {
        surfaces: Vec<FlatSurface>,
        vertices: Vec<f64>,
        edge_vertices: Vec<u32>,
        edge_lengths: Vec<f64>,
        edge_uses: Vec<u32>,
        use_faces: Vec<u32>,
        use_lines: Vec<f64>,
        border_sizes: Vec<u32>,
        border_edges: Vec<u32>,
        border_forward: Vec<u8>,
    }

    struct SewnShell {
        shape: UniquePtr<TopoDS_Shape>,
        gap: f64,
    }

    struct Mass {
        volume: f64,
        center: [f64; 3],
    }

    struct Inertia {
        volume: f64,
        center: [f64; 3],
        rows: [f64; 9],
    }

    struct StepPart {
        name: String,
        color: [f32; 3],
        /// Empty if there is none.
        material: String,
        density_g_cm3: f64,
        shape: UniquePtr<TopoDS_Shape>,
    }

    struct StepHeader {
        schema: String,
        product: String,
        time_stamp: String,
        author: String,
        organization: String,
        system: String,
    }

    unsafe extern "C++" {
        fn start() -> Result<()>;
        fn version() -> Result<String>;
        fn copy(shape: &TopoDS_Shape) -> Result<UniquePtr<TopoDS_Shape>>;
        fn surface_at(surface: &FlatSurface, uv: &[f64]) -> Result<Vec<f64>>;
        fn trimmed_face(surface: &FlatSurface, loops: &FlatLoops) -> Result<UniquePtr<TopoDS_Shape>>;
        fn sheet_shell(
            surfaces: &Vec<FlatSurface>,
            shell: &FlatSheetShell,
        ) -> Result<UniquePtr<TopoDS_Shape>>;
        fn board_solid(
            lower: &FlatSurface,
            upper: &FlatSurface,
            loops: &FlatLoops,
        ) -> Result<UniquePtr<TopoDS_Shape>>;
        fn faceted(positions: &[f64], triangles: &[u32]) -> Result<UniquePtr<TopoDS_Shape>>;
        fn shell(flat: &FlatShell) -> Result<SewnShell>;
        fn prism(shape: &TopoDS_Shape, vector: [f64; 3]) -> Result<UniquePtr<TopoDS_Shape>>;
        fn extruded_polygon(outline: &[f64], z0: f64, z1: f64) -> Result<UniquePtr<TopoDS_Shape>>;
        fn boolean(a: &TopoDS_Shape, b: &TopoDS_Shape, operation: u8) -> Result<UniquePtr<TopoDS_Shape>>;
        fn transformed(
            shape: &TopoDS_Shape,
            rotation: [f64; 9],
            translation: [f64; 3],
        ) -> Result<UniquePtr<TopoDS_Shape>>;
        fn check(shape: &TopoDS_Shape) -> Result<Vec<String>>;
        fn mass_properties(shape: &TopoDS_Shape, relative: f64) -> Result<Mass>;
        fn largest_tolerance(shape: &TopoDS_Shape) -> Result<f64>;
        fn inertia(shape: &TopoDS_Shape, relative: f64) -> Result<Inertia>;
        fn area(shape: &TopoDS_Shape) -> Result<f64>;
        fn triangulate(shape: &TopoDS_Shape, linear: f64, angular: f64) -> Result<FlatMesh>;
        fn write_step(path: &str, parts: &Vec<StepPart>, header: &StepHeader) -> Result<()>;
        fn read_step(path: &str) -> Result<Vec<StepPart>>;
        fn write_iges(path: &str, parts: &Vec<StepPart>, header: &StepHeader) -> Result<()>;
        fn read_iges(path: &str) -> Result<Vec<StepPart>>;
        fn write_brep(path: &str, shape: &TopoDS_Shape) -> Result<()>;
        fn read_brep(path: &str) -> Result<UniquePtr<TopoDS_Shape>>;
    }
}
