// Shapes on their way to Rust.
#pragma once

#include <TopoDS_Shape.hxx>

#include <memory>
#include <string>

namespace softfold::occt {

using ShapePtr = std::unique_ptr<TopoDS_Shape>;

// Throws if the shape is null.
ShapePtr wrap(const TopoDS_Shape& shape);

// Turns a solid outward; leaves anything else as it is. Throws if a solid is not closed.
TopoDS_Shape outward(const TopoDS_Shape& shape);

// Throws with the faults of BRepCheck unless the shape is valid.
void require_valid(const TopoDS_Shape& shape, const std::string& name);

}  // namespace softfold::occt
