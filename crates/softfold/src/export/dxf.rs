//! DXF drawings for workshops: the writer of `softfold-pattern`, which writes patterns with it too.

pub use softfold_pattern::dxf::{Drawing, DrawingError, DxfVersion, Entity, Layer, colour};
