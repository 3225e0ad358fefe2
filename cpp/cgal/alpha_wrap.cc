#include "cgal/alpha_wrap.h"

#include <CGAL/alpha_wrap_3.h>

#include <array>
#include <vector>

#include "cgal/mesh.h"
#include "cgal/quiet.h"

namespace softfold::cgal {

FlatMesh alpha_wrap(Numbers positions, Indices triangles, double alpha, double offset) {
  quiet();
  std::vector<std::array<std::size_t, 3>> faces;
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3)
    faces.push_back({triangles[i], triangles[i + 1], triangles[i + 2]});
  Mesh wrap;
  CGAL::alpha_wrap_3(points_of(positions), faces, alpha, offset, wrap);
  return flat_mesh(wrap);
}

}  // namespace softfold::cgal
