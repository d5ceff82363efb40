#pragma once
/// Watertight triangle meshes as shapes.

#include <array>
#include <string>
#include <vector>

#include "snapwing/mpm/shape.h"

namespace snapwing::mpm {

struct TriangleMesh {
  std::vector<Point3> vertices;               ///< [m], no duplicates
  std::vector<std::array<int, 3>> triangles;  ///< indices of vertices
};

/// Defects by which a mesh does not enclose a volume.
struct MeshDefects {
  int open = 0;         ///< edges of only one triangle
  int shared_more = 0;  ///< edges of more than two triangles
  int turned = 0;       ///< edges whose two triangles are oriented inconsistently
  int degenerate = 0;   ///< triangles with a repeated corner
};

/// Reads ASCII or binary STL. Corners at the same position are merged; several solids of one file become one mesh.
/// @param unit  [m] per unit of the file
/// @throws common::FileError if it is missing, truncated or no STL; in ASCII with the line and the word
TriangleMesh readStl(const std::string& path, double unit);
MeshDefects findDefects(const TriangleMesh& mesh);
/// The body enclosed by a mesh. Nested shells of equal orientation are united; a shell of opposite orientation inside
/// another is a hole. Reversing the orientation of the whole mesh gives the same body.
/// @param name  in messages. @throws common::Error naming the defects if the mesh is not closed and consistently
/// oriented, or if a shell of opposite orientation lies in no other
ShapePtr makeMesh(const TriangleMesh& mesh, const std::string& name);
/// readStl and makeMesh. @throws common::FileError
ShapePtr loadStl(const std::string& path, double unit);

}  // namespace snapwing::mpm
