#include "snapwing/mpm/triangle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::mpm {

namespace {

/// Signed volume of the cone from a triangle to the first vertex; they add up to that of a closed surface.
double coneVolume(const TriangleMesh& mesh, const std::array<int, 3>& t) {
  const Point3 a = mesh.vertices[t[0]] - mesh.vertices[0], b = mesh.vertices[t[1]] - mesh.vertices[0],
               c = mesh.vertices[t[2]] - mesh.vertices[0];
  return a.dot(b.cross(c)) / 6;
}

double volumeOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (const std::array<int, 3>& t : mesh.triangles) sum += coneVolume(mesh, t);
  return sum;
}

/// Number of the shell of each triangle: shells share no vertex.
std::vector<int> shellsOf(const TriangleMesh& mesh, int* count) {
  std::vector<int> root(mesh.vertices.size());
  for (std::size_t v = 0; v < root.size(); ++v) root[v] = static_cast<int>(v);
  const auto find = [&](int v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const std::array<int, 3>& t : mesh.triangles) {
    root[find(t[0])] = find(t[1]);
    root[find(t[1])] = find(t[2]);
  }
  std::map<int, int> numbers;
  std::vector<int> shell;
  for (const std::array<int, 3>& t : mesh.triangles) {
    shell.push_back(numbers.emplace(find(t[0]), static_cast<int>(numbers.size())).first->second);
  }
  *count = static_cast<int>(numbers.size());
  return shell;
}

/// A point is inside if the surface winds around it, counted by the crossings above it and looked up by column: shells
/// in shells of equal sense are their union, one turned inside out is a hole. Each triangle's shadow on the xy plane is
/// a half-open set whose edges are computed alike for both neighbours, so that shadows tile the plane without gaps or
/// overlaps.
class MeshShape : public Shape {
 public:
  explicit MeshShape(TriangleMesh mesh) : mesh_(std::move(mesh)), outward_(volumeOf(mesh_) < 0 ? -1 : 1) {
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

  bool contains(const Point3& p) const override { return winding(p, {}, -1) > 0; }
  /// How often the surface winds around a point. @param shell  of each triangle; the shell `skipped` does not count
  int winding(const Point3& p, const std::vector<int>& shell, int skipped) const {
    if (!box_.contains(p)) return 0;
    int turns = 0;
    for (const int t : bins_[static_cast<std::size_t>(bin(p(1), 1)) * columns_ + bin(p(0), 0)]) {
      if (!shell.empty() && shell[t] == skipped) continue;
      if (shadows(t, p) && heightAt(t, p) > p(2)) turns += turnsUp(t) ? 1 : -1;
    }
    return outward_ * turns;
  }
  /// 1, or -1 if the mesh as a whole is turned inside out.
  int outward() const { return outward_; }
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

  bool turnsUp(std::size_t t) const {
    const Point3 a = corner(t, 1) - corner(t, 0), b = corner(t, 2) - corner(t, 0);
    return a(0) * b(1) - a(1) * b(0) > 0;
  }

  TriangleMesh mesh_;
  int outward_ = 1;
  Box box_;
  int columns_ = 1;
  std::vector<std::vector<int>> bins_;
};

}  // namespace

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

namespace {

/// A shell turned inside out is a hole, and there must be something to take it from.
void requireHolesInSolids(const TriangleMesh& mesh, const MeshShape& shape, const std::string& name) {
  int count = 0;
  const std::vector<int> shell = shellsOf(mesh, &count);
  if (count == 1) return;
  std::vector<double> volume(count, 0.0);
  std::vector<int> corner(count, -1);
  for (std::size_t t = 0; t < shell.size(); ++t) {
    volume[shell[t]] += shape.outward() * coneVolume(mesh, mesh.triangles[t]);
    if (corner[shell[t]] < 0) corner[shell[t]] = mesh.triangles[t][0];
  }
  for (int k = 0; k < count; ++k) {
    const Point3& place = mesh.vertices[corner[k]];
    if (volume[k] >= 0 || shape.winding(place, shell, k) > 0) continue;
    throw common::Error(name + ": the shell with a corner at (" + common::toText(place(0)) + ", " +
                        common::toText(place(1)) + ", " + common::toText(place(2)) +
                        ") m is turned inside out and lies in no other; allowed: holes within solids");
  }
}

}  // namespace

ShapePtr makeMesh(const TriangleMesh& mesh, const std::string& name) {
  const MeshDefects d = findDefects(mesh);
  if (mesh.triangles.empty() || d.open + d.shared_more + d.turned + d.degenerate > 0) {
    throw common::Error(name + " encloses no volume: " + std::to_string(d.open) + " open edges, " +
                        std::to_string(d.shared_more) + " edges with more than two triangles, " +
                        std::to_string(d.turned) + " edges between triangles turned against each other, " +
                        std::to_string(d.degenerate) + " triangles without area; allowed: none of them");
  }
  const auto shape = std::make_shared<MeshShape>(mesh);
  requireHolesInSolids(mesh, *shape, name);
  return shape;
}

ShapePtr loadStl(const std::string& path, double unit) { return makeMesh(readStl(path, unit), path); }

}  // namespace snapwing::mpm
