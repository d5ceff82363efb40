#pragma once
/// Triangles that fill an outline with holes, for markers only.

#include <array>
#include <cstddef>
#include <vector>

namespace snapwing::nodes {

using Point2 = std::array<double, 2>;
using Loop = std::vector<Point2>;
/// A vertex of an outline: loop and place in it.
struct VertexId {
  std::size_t loop;
  std::size_t point;
};

/// Fills closed loops by ear clipping; a loop within an odd number of others is a hole. The last point must not repeat
/// the first. Where the outline crosses itself the triangles may overlap, but there is always an answer.
/// @return triples of vertices, each triangle counter-clockwise
std::vector<std::array<VertexId, 3>> triangulate(const std::vector<Loop>& loops);

/// Signed area of a closed loop, positive if counter-clockwise. [unit of the points, squared]
double signedArea(const Loop& loop);

}  // namespace snapwing::nodes
