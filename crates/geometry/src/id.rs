//! Typed ids: a vertex is never mistaken for an edge.

macro_rules! define_id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);

        impl $name {
            /// The id of the element at `index` of its array (arrays here stay far below 2³²).
            pub fn new(index: usize) -> Self {
                Self(index as u32)
            }

            /// Position in the array that holds the elements.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

define_id!(
    /// A vertex of a mesh.
    VertexId
);
define_id!(
    /// A triangle of a mesh.
    TriangleId
);
define_id!(
    /// An edge of a mesh.
    EdgeId
);
define_id!(
    /// A crease of the pattern.
    CreaseId
);
define_id!(
    /// A closed boundary curve of the sheet: 0 is the outline, the others are holes.
    LoopId
);
