#include "occt/surface_at.h"

#include "occt/bspline.h"

namespace softfold::occt {

rust::Vec<double> surface_at(const FlatSurface& flat, Numbers uv) {
  const Handle(Geom_BSplineSurface) surface = clamped_surface(flat);
  rust::Vec<double> points;
  points.reserve(uv.size() / 2 * 3);
  for (std::size_t i = 0; i + 1 < uv.size(); i += 2) {
    const gp_Pnt p = surface->Value(uv[i], uv[i + 1]);
    append(points, p.X(), p.Y(), p.Z());
  }
  return points;
}

}  // namespace softfold::occt
