#include "occt/bspline.h"

#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>

#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

constexpr int degree = 3;

template <typename Array, typename Values>
Array array_of(const Values& values) {
  Array array(1, static_cast<int>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) array(static_cast<int>(i) + 1) = values[i];
  return array;
}

TColgp_Array2OfPnt poles_of(const FlatSurface& flat) {
  const int rows = static_cast<int>(flat.pole_count_u), columns = static_cast<int>(flat.pole_count_v);
  TColgp_Array2OfPnt poles(1, rows, 1, columns);
  const double* p = flat.poles.data();
  for (int row = 1; row <= rows; ++row)
    for (int column = 1; column <= columns; ++column, p += 3) poles(row, column) = gp_Pnt(p[0], p[1], p[2]);
  return poles;
}

}  // namespace

Handle(Geom_BSplineSurface) bspline_surface(const FlatSurface& flat) {
  return new Geom_BSplineSurface(poles_of(flat), array_of<TColStd_Array1OfReal>(flat.knots_u),
                                 array_of<TColStd_Array1OfReal>(flat.knots_v),
                                 array_of<TColStd_Array1OfInteger>(flat.multiplicities_u),
                                 array_of<TColStd_Array1OfInteger>(flat.multiplicities_v), degree, degree);
}

Handle(Geom_BSplineSurface) clamped_surface(const FlatSurface& flat) {
  Handle(Geom_BSplineSurface) surface = bspline_surface(flat);
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  surface->Segment(u0, u1, v0, v1);
  return surface;
}

}  // namespace softfold::occt
