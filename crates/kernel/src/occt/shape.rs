use crate::bridge::occt as ffi;
use crate::error::{KernelError, Library, Result};
use cxx::{Exception, UniquePtr};
use opencascade_sys::top_abs::TopAbs_ShapeEnum;
use opencascade_sys::topo_ds::TopoDS_Shape;
use std::sync::OnceLock;

/// A shape of OpenCascade: a face, a solid, a compound of several.
///
/// It may move to another thread, but not be used by two at a time (`Send`, not `Sync`): checking, measuring and
/// booleans write caches into the geometry behind it. Give each thread its own [`Shape::try_clone`].
pub struct Shape(UniquePtr<TopoDS_Shape>);

/// What a [`Shape`] is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShapeKind {
    /// Several shapes, or none.
    Compound,
    /// Solids that share faces.
    CompSolid,
    /// A solid.
    Solid,
    /// Connected faces.
    Shell,
    /// A trimmed surface.
    Face,
    /// Connected edges.
    Wire,
    /// A piece of a curve.
    Edge,
    /// A point.
    Vertex,
}

impl Shape {
    /// A deep copy that shares nothing with this shape.
    ///
    /// # Errors
    /// Only if memory runs out.
    pub fn try_clone(&self) -> Result<Self> {
        Self::made_by("occt::Shape::try_clone", || ffi::copy(self.raw()))
    }

    /// What it is.
    pub fn kind(&self) -> ShapeKind {
        match self.raw().ShapeType() {
            TopAbs_ShapeEnum::TopAbs_COMPSOLID => ShapeKind::CompSolid,
            TopAbs_ShapeEnum::TopAbs_SOLID => ShapeKind::Solid,
            TopAbs_ShapeEnum::TopAbs_SHELL => ShapeKind::Shell,
            TopAbs_ShapeEnum::TopAbs_FACE => ShapeKind::Face,
            TopAbs_ShapeEnum::TopAbs_WIRE => ShapeKind::Wire,
            TopAbs_ShapeEnum::TopAbs_EDGE => ShapeKind::Edge,
            TopAbs_ShapeEnum::TopAbs_VERTEX => ShapeKind::Vertex,
            _ => ShapeKind::Compound,
        }
    }

    /// The shape as opencascade-sys sees it. Never null: `wrap` refuses that.
    pub(super) fn raw(&self) -> &TopoDS_Shape {
        &self.0
    }

    /// Runs `call` after OpenCascade has started and wraps its shape.
    pub(super) fn made_by(
        operation: &'static str,
        call: impl FnOnce() -> std::result::Result<UniquePtr<TopoDS_Shape>, Exception>,
    ) -> Result<Self> {
        run(operation, call).and_then(|pointer| Self::wrap(operation, pointer))
    }

    /// Takes over a shape from C++.
    pub(super) fn wrap(operation: &'static str, pointer: UniquePtr<TopoDS_Shape>) -> Result<Self> {
        if pointer.as_ref().is_none_or(TopoDS_Shape::IsNull) {
            let message = "OpenCascade gave no shape".to_owned();
            return Err(KernelError::Failed { library: Library::OpenCascade, operation, message });
        }
        Ok(Self(pointer))
    }
}

impl std::fmt::Debug for Shape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Shape").field(&self.kind()).finish()
    }
}

/// Runs one call of the bridge after OpenCascade has started.
pub(super) fn run<T>(
    operation: &'static str,
    call: impl FnOnce() -> std::result::Result<T, Exception>,
) -> Result<T> {
    start()?;
    call().map_err(Library::OpenCascade.failure(operation))
}

/// Once per process: silences OpenCascade and registers its STEP parameters.
fn start() -> Result<()> {
    static STARTED: OnceLock<Result<()>> = OnceLock::new();
    STARTED.get_or_init(|| ffi::start().map_err(Library::OpenCascade.failure("occt start"))).clone()
}

#[cfg(test)]
mod tests {
    use super::Shape;

    #[test]
    fn shapes_move_between_threads() {
        fn sendable<T: Send>() {}
        sendable::<Shape>();
    }
}
