#include "occt/tolerance.h"

#include <ShapeAnalysis_ShapeTolerance.hxx>

namespace softfold::occt {

double largest_tolerance(const TopoDS_Shape& shape) {
  constexpr int largest = 1;
  return ShapeAnalysis_ShapeTolerance().Tolerance(shape, largest);
}

}  // namespace softfold::occt
