// OpenMesh's readers register themselves when MeshIO.hh comes before the mesh types.
#include <OpenMesh/Core/IO/MeshIO.hh>

#include "openmesh/read.h"

#include <stdexcept>

#include "openmesh/mesh.h"

namespace softfold::openmesh {

FlatMesh read(rust::Str path) {
  quiet();
  Mesh mesh;
  if (!OpenMesh::IO::read_mesh(mesh, std::string(path)))
    throw std::runtime_error("this is no PLY, OBJ, STL or OFF file OpenMesh can read");
  if (mesh.n_faces() == 0) throw std::runtime_error("the file has no triangles");
  return flat_mesh(mesh);
}

}  // namespace softfold::openmesh
