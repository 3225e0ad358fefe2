// OpenCascade's surfaces from flat arrays.
#pragma once

#include <Geom_BSplineSurface.hxx>

namespace softfold::occt {

struct FlatSurface;

// Knots and poles as they are given. Rust has checked that they fit together.
Handle(Geom_BSplineSurface) bspline_surface(const FlatSurface& flat);

// The same surface on its domain, with clamped knots.
Handle(Geom_BSplineSurface) clamped_surface(const FlatSurface& flat);

}  // namespace softfold::occt
