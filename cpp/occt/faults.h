// What BRepCheck finds wrong with a shape, in words; nothing if it is valid.
#pragma once

#include <TopoDS_Shape.hxx>

#include <string>
#include <vector>

namespace softfold::occt {
std::vector<std::string> faults(const TopoDS_Shape& shape);
}
