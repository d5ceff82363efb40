#include "snapwing/mpm/triangle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <utility>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::mpm {

namespace {

using common::FileError;

/// Gathers corners; equal places share a number.
class Welder {
 public:
  explicit Welder(double unit) : unit_(unit) {}
  int add(const std::array<float, 3>& corner) {
    // -0 and 0 are the same place.
    const std::array<float, 3> key = {corner[0] + 0.0f, corner[1] + 0.0f, corner[2] + 0.0f};
    const auto [entry, fresh] = numbers_.emplace(key, static_cast<int>(mesh.vertices.size()));
    if (fresh) mesh.vertices.push_back(unit_ * Point3(corner[0], corner[1], corner[2]));
    return entry->second;
  }
  TriangleMesh mesh;

 private:
  double unit_;
  std::map<std::array<float, 3>, int> numbers_;
};

bool finite(const std::array<float, 3>& p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

TriangleMesh readBinary(const std::string& path, const std::string& bytes, double unit) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  Welder welder(unit);
  for (std::uint32_t t = 0; t < count; ++t) {
    std::array<int, 3> triangle{};
    for (int k = 0; k < 3; ++k) {
      std::array<float, 3> corner{};
      std::memcpy(corner.data(), bytes.data() + 84 + 50 * static_cast<std::size_t>(t) + 12 + 12 * k, 12);
      if (!finite(corner)) throw FileError(path, "triangle " + std::to_string(t) + " has a corner that is not finite");
      triangle[k] = welder.add(corner);
    }
    welder.mesh.triangles.push_back(triangle);
  }
  return std::move(welder.mesh);
}

TriangleMesh readAscii(const std::string& path, const std::string& bytes, double unit) {
  Welder welder(unit);
  std::istringstream text(bytes);
  std::string line, word;
  std::vector<int> corners;
  for (int number = 1; std::getline(text, line); ++number) {
    std::istringstream words(line);
    if (!(words >> word)) continue;
    if (word == "vertex") {
      std::array<float, 3> p{};
      if (!(words >> p[0] >> p[1] >> p[2]) || !finite(p)) {
        throw FileError(path, "line " + std::to_string(number) + " is '" + line + "'; wanted vertex x y z");
      }
      corners.push_back(welder.add(p));
    } else if (word == "endfacet") {
      if (corners.size() != 3) {
        throw FileError(path, "the facet that ends in line " + std::to_string(number) + " has " +
                                  std::to_string(corners.size()) + " corners; allowed: 3");
      }
      welder.mesh.triangles.push_back({corners[0], corners[1], corners[2]});
      corners.clear();
    }
  }
  if (!corners.empty() || bytes.find("endsolid") == std::string::npos) {
    throw FileError(path, "ends in the middle: no 'endsolid'");
  }
  return std::move(welder.mesh);
}

/// Parity of the crossings above a point, looked up by column. Each triangle's shadow on the xy plane is a half-open
/// set whose edges are computed alike for both neighbours, so that shadows tile the plane without gaps or overlaps.
class MeshShape : public Shape {
 public:
  explicit MeshShape(TriangleMesh mesh) : mesh_(std::move(mesh)) {
    box_.low = box_.high = mesh_.vertices[0];
    for (const Point3& v : mesh_.vertices) {
      box_.low = box_.low.cwiseMin(v);
      box_.high = box_.high.cwiseMax(v);
    }
    columns_ = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(mesh_.triangles.size()))));
    bins_.resize(static_cast<std::size_t>(columns_) * columns_);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      Point3 low = corner(t, 0), high = low;
      for (int k = 1; k < 3; ++k) {
        low = low.cwiseMin(corner(t, k));
        high = high.cwiseMax(corner(t, k));
      }
      for (int j = bin(low(1), 1); j <= bin(high(1), 1); ++j) {
        for (int i = bin(low(0), 0); i <= bin(high(0), 0); ++i) {
          bins_[static_cast<std::size_t>(j) * columns_ + i].push_back(static_cast<int>(t));
        }
      }
    }
  }

  bool contains(const Point3& p) const override {
    if (!box_.contains(p)) return false;
    bool inside = false;
    for (const int t : bins_[static_cast<std::size_t>(bin(p(1), 1)) * columns_ + bin(p(0), 0)]) {
      if (shadows(t, p) && heightAt(t, p) > p(2)) inside = !inside;
    }
    return inside;
  }
  Box bounds() const override { return box_; }

 private:
  const Point3& corner(std::size_t triangle, int k) const { return mesh_.vertices[mesh_.triangles[triangle][k]]; }
  int bin(double x, int axis) const {
    const double width = box_.high(axis) - box_.low(axis);
    if (!(width > 0)) return 0;
    return std::min(columns_ - 1, std::max(0, static_cast<int>((x - box_.low(axis)) / width * columns_)));
  }
  bool shadows(std::size_t t, const Point3& p) const {
    bool inside = false;
    for (int k = 0; k < 3; ++k) {
      // In the order of the vertices, whichever triangle asks.
      const std::array<int, 3>& v = mesh_.triangles[t];
      const Point3& a = mesh_.vertices[std::min(v[k], v[(k + 1) % 3])];
      const Point3& b = mesh_.vertices[std::max(v[k], v[(k + 1) % 3])];
      if ((a(1) > p(1)) == (b(1) > p(1))) continue;
      if (p(0) < a(0) + (b(0) - a(0)) * (p(1) - a(1)) / (b(1) - a(1))) inside = !inside;
    }
    return inside;
  }
  double heightAt(std::size_t t, const Point3& p) const {
    const Point3 normal = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
    const Point3 d = p - corner(t, 0);
    return corner(t, 0)(2) - (normal(0) * d(0) + normal(1) * d(1)) / normal(2);
  }

  TriangleMesh mesh_;
  Box box_;
  int columns_ = 1;
  std::vector<std::vector<int>> bins_;
};

}  // namespace

TriangleMesh readStl(const std::string& path, double unit) {
  const std::string bytes = common::readFile(path);
  // Binary files may begin with "solid", too: their length decides.
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  TriangleMesh mesh;
  if (bytes.size() >= 84 && bytes.size() == 84 + 50 * static_cast<std::size_t>(count)) {
    mesh = readBinary(path, bytes, unit);
  } else if (bytes.compare(0, 5, "solid") == 0 && bytes.find("facet") != std::string::npos) {
    mesh = readAscii(path, bytes, unit);
  } else {
    throw FileError(path, "is no STL: neither 'solid' with facets, nor binary of the length that its header states");
  }
  if (mesh.triangles.empty()) throw FileError(path, "holds no triangles");
  return mesh;
}

MeshDefects findDefects(const TriangleMesh& mesh) {
  MeshDefects defects;
  std::map<std::pair<int, int>, std::pair<int, int>> edges;  // uses in either direction
  for (const std::array<int, 3>& t : mesh.triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      ++defects.degenerate;
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      auto& uses = edges[{std::min(a, b), std::max(a, b)}];
      ++(a < b ? uses.first : uses.second);
    }
  }
  for (const auto& [edge, uses] : edges) {
    const int total = uses.first + uses.second;
    if (total == 1) ++defects.open;
    if (total > 2) ++defects.shared_more;
    if (total == 2 && uses.first != 1) ++defects.turned;
  }
  return defects;
}

ShapePtr makeMesh(TriangleMesh mesh, const std::string& name) {
  const MeshDefects d = findDefects(mesh);
  if (mesh.triangles.empty() || d.open + d.shared_more + d.turned + d.degenerate > 0) {
    throw common::Error(name + " encloses no volume: " + std::to_string(d.open) + " open edges, " +
                        std::to_string(d.shared_more) + " edges with more than two triangles, " +
                        std::to_string(d.turned) + " edges between triangles turned against each other, " +
                        std::to_string(d.degenerate) + " triangles without area; allowed: none of them");
  }
  return std::make_shared<MeshShape>(std::move(mesh));
}

ShapePtr loadStl(const std::string& path, double unit) { return makeMesh(readStl(path, unit), path); }

}  // namespace snapwing::mpm
