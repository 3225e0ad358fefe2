use std::fmt;
use std::path::PathBuf;

/// What every call of this crate returns.
pub type Result<T> = std::result::Result<T, KernelError>;

/// Why a call of this crate gave no result. Nothing of the input has been changed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum KernelError {
    /// The arguments were refused before any library saw them. The message names the element at fault.
    #[error("{operation}: {message}")]
    InvalidInput {
        /// The function that was called, `cgal::boolean` for example.
        operation: &'static str,
        /// What is wrong, and where.
        message: String,
    },
    /// The library could not do the operation on this input.
    #[error("{library} could not do {operation}: {message}")]
    Failed {
        /// The library that was at work.
        library: Library,
        /// The function that was called, `occt::boolean` for example.
        operation: &'static str,
        /// The library's own words, or what its result lacks.
        message: String,
    },
    /// A file could not be read or written.
    #[error("{}: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system or the library said.
        message: String,
    },
}

/// The C++ libraries behind this crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Library {
    /// CGAL 5.5: planar triangulations, meshes, exact predicates.
    Cgal,
    /// OpenSubdiv 3.5: Catmull-Clark limit surfaces.
    OpenSubdiv,
    /// OpenMesh 9: mesh files, cleaning, decimation.
    OpenMesh,
    /// OpenCascade 7.6: B-spline faces, solids, STEP.
    OpenCascade,
}

impl fmt::Display for Library {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Library::Cgal => "CGAL",
            Library::OpenSubdiv => "OpenSubdiv",
            Library::OpenMesh => "OpenMesh",
            Library::OpenCascade => "OpenCascade",
        })
    }
}

impl KernelError {
    pub(crate) fn input(operation: &'static str, message: impl Into<String>) -> Self {
        Self::InvalidInput { operation, message: message.into() }
    }

    pub(crate) fn file(path: &std::path::Path, message: impl ToString) -> Self {
        Self::File { path: path.to_path_buf(), message: message.to_string() }
    }
}

impl Library {
    /// Turns what C++ threw into an error of `operation`.
    pub(crate) fn failure(self, operation: &'static str) -> impl FnOnce(cxx::Exception) -> KernelError {
        move |exception| KernelError::Failed {
            library: self,
            operation,
            message: exception.what().to_owned(),
        }
    }
}
