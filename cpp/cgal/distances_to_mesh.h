// Distance of each point to the nearest triangle.
#pragma once

#include "arrays.h"

namespace softfold::cgal {
rust::Vec<double> distances_to_mesh(Numbers points, Numbers positions, Indices triangles);
}
