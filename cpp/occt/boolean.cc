#include "occt/boolean.h"

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS_Iterator.hxx>

#include <sstream>
#include <stdexcept>

#include "boolean_operation.h"

namespace softfold::occt {
namespace {

std::unique_ptr<BRepAlgoAPI_BooleanOperation> algorithm(BooleanOperation operation) {
  switch (operation) {
    case BooleanOperation::Union: return std::make_unique<BRepAlgoAPI_Fuse>();
    case BooleanOperation::Intersection: return std::make_unique<BRepAlgoAPI_Common>();
    case BooleanOperation::Difference: return std::make_unique<BRepAlgoAPI_Cut>();
  }
  throw std::invalid_argument("no such boolean operation");
}

// What is inside of a compound of one.
TopoDS_Shape unwrapped(const TopoDS_Shape& shape) {
  if (shape.IsNull() || shape.ShapeType() != TopAbs_COMPOUND) return shape;
  TopoDS_Iterator parts(shape);
  if (!parts.More()) return shape;
  const TopoDS_Shape first = parts.Value();
  parts.Next();
  return parts.More() ? shape : unwrapped(first);
}

TopTools_ListOfShape list_of(const TopoDS_Shape& shape) {
  TopTools_ListOfShape list;
  list.Append(shape);
  return list;
}

}  // namespace

ShapePtr boolean(const TopoDS_Shape& a, const TopoDS_Shape& b, std::uint8_t operation) {
  const auto work = algorithm(BooleanOperation{operation});
  work->SetArguments(list_of(a));
  work->SetTools(list_of(b));
  work->SetNonDestructive(Standard_True);  // else tolerances inside of the arguments grow
  work->SetRunParallel(Standard_False);    // equal input, equal order of the result
  work->Build();
  if (!work->IsDone() || work->HasErrors()) {
    std::ostringstream report;
    work->DumpErrors(report);
    throw std::runtime_error(report.str());
  }
  return wrap(unwrapped(work->Shape()));
}

}  // namespace softfold::occt
