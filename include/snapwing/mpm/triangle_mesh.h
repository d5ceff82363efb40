#pragma once
/// Watertight triangle meshes as shapes.

#include <array>
#include <string>
#include <vector>

#include "snapwing/mpm/shape.h"

namespace snapwing::mpm {

struct TriangleMesh {
  std::vector<Point3> vertices;  ///< [m], each place once
  std::vector<std::array<int, 3>> triangles;
};

/// What keeps a mesh from enclosing a volume, by number of edges.
struct MeshDefects {
  int open = 0;         ///< edges of one triangle
  int shared_more = 0;  ///< edges of more than two
  int turned = 0;       ///< edges whose two triangles disagree on the outside
  int degenerate = 0;   ///< triangles with a corner twice
};

/// Reads ASCII or binary STL; corners at the same place become one vertex. Several solids of one file become one mesh.
/// @param unit  [m] per unit of the file
/// @throws common::FileError if it is missing, truncated or no STL; in text it names the line and the word
TriangleMesh readStl(const std::string& path, double unit);
MeshDefects findDefects(const TriangleMesh& mesh);
/// Shells in shells: of equal sense they are their union; one turned inside out is a hole in the other. A mesh that is
/// turned inside out as a whole is the same body.
/// @throws common::Error naming the defects if the mesh is not closed and consistently turned, or if a shell turned
/// inside out lies in no other
ShapePtr makeMesh(TriangleMesh mesh, const std::string& name);
/// readStl and makeMesh. @throws common::FileError
ShapePtr loadStl(const std::string& path, double unit);

}  // namespace snapwing::mpm
