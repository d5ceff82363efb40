// The arm as a closed surface: marching squares in the plane, faces and walls from shared vertices.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "snapwing/design/arm/arm_parts.h"

namespace snapwing::design {

namespace {

/// Corner of a grid (axis 2) or crossing of its edge towards +x (0) or +y (1); with a height.
struct Key {
  int i, j, axis, level;
  bool operator<(const Key& o) const { return std::tie(i, j, axis, level) < std::tie(o.i, o.j, o.axis, o.level); }
};

class Builder {
 public:
  Builder(const vehicle::ArmSettings& arm, const ArmShape& shape, double cell);
  SolidMesh build();

 private:
  double value(int i, int j) const { return values_[static_cast<std::size_t>(j + 1) * columns_ + (i + 1)]; }
  bool inside(int i, int j) const { return value(i, j) < 0; }
  bool legColumn(int i) const { return i < split_; }
  /// Levels -2, -1, 1, 2: bottom of bar, bottom of leg, top of leg, top of bar.
  double height(int level) const {
    return (level < 0 ? -0.5 : 0.5) * (std::abs(level) == 1 ? leg_thickness_ : bar_thickness_);
  }
  int vertex(const Key& key);
  void cellFaces(int i, int j);
  void wall(const Key& from, const Key& to, int i);
  void step(int j);
  void triangle(const Key& a, const Key& b, const Key& c);
  void polygon(const std::vector<Key>& corners);
  bool onSplit(const Key& k) const { return k.i == split_ && k.axis != 0; }

  double cell_, leg_thickness_, bar_thickness_;
  int split_, columns_, rows_;
  std::vector<double> values_;
  std::map<Key, int> number_;
  SolidMesh mesh_;
};

Builder::Builder(const vehicle::ArmSettings& arm, const ArmShape& shape, double cell)
    : cell_(cell), leg_thickness_(arm.leg_thickness), bar_thickness_(arm.bar_thickness) {
  split_ = static_cast<int>(std::lround(arm.leg_width / cell));
  columns_ = static_cast<int>(std::ceil(arm.domain_length / cell)) + 3;
  rows_ = static_cast<int>(std::ceil(arm.domain_height / cell)) + 3;
  const double least = 1e-4 * cell;  // no crossing exactly on a corner
  for (int j = -1; j < rows_ - 1; ++j) {
    for (int i = -1; i < columns_ - 1; ++i) {
      const double d = shape.signedDistance(i * cell, j * cell);
      values_.push_back(std::abs(d) < least ? least : d);
    }
  }
}

int Builder::vertex(const Key& key) {
  const auto [found, fresh] = number_.try_emplace(key, static_cast<int>(mesh_.vertices.size()));
  if (fresh) {
    double x = key.i * cell_, y = key.j * cell_;
    if (key.axis != 2) {
      const double a = value(key.i, key.j), b = value(key.i + (key.axis == 0), key.j + (key.axis == 1));
      (key.axis == 0 ? x : y) += a / (a - b) * cell_;
    }
    mesh_.vertices.push_back({x, y, height(key.level)});
  }
  return found->second;
}

void Builder::triangle(const Key& a, const Key& b, const Key& c) {
  mesh_.triangles.push_back({vertex(a), vertex(b), vertex(c)});
}

void Builder::polygon(const std::vector<Key>& corners) {
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) triangle(corners[0], corners[k], corners[k + 1]);
}

/// Wall over the outline's piece from -> to (material on the left) of a cell in column i.
void Builder::wall(const Key& from, const Key& to, int i) {
  const int top = legColumn(i) ? 1 : 2;
  const auto at = [](Key k, int level) {
    k.level = level;
    return k;
  };
  // Round the wall, seen from outside: bottom from -> to, up at `to`, back on top, down at `from`. Where the bar ends
  // at the leg the vertical edge has the leg's heights as well.
  std::vector<Key> round{at(from, -top)};
  std::vector<int> between;
  if (top == 2) between = {-1, 1};
  round.push_back(at(to, -top));
  if (onSplit(to)) {
    for (const int level : between) round.push_back(at(to, level));
  }
  round.push_back(at(to, top));
  round.push_back(at(from, top));
  if (onSplit(from)) {
    for (auto level = between.rbegin(); level != between.rend(); ++level) round.push_back(at(from, *level));
  }
  // A fan from a corner must not start on an edge that is split.
  if (onSplit(from) && !between.empty()) std::rotate(round.begin(), round.begin() + 1, round.end());
  polygon(round);
}

void Builder::cellFaces(int i, int j) {
  const Key corner[4] = {{i, j, 2, 0}, {i + 1, j, 2, 0}, {i + 1, j + 1, 2, 0}, {i, j + 1, 2, 0}};
  const Key edge[4] = {{i, j, 0, 0}, {i + 1, j, 1, 0}, {i, j + 1, 0, 0}, {i, j, 1, 0}};
  const bool in[4] = {inside(i, j), inside(i + 1, j), inside(i + 1, j + 1), inside(i, j + 1)};
  const int top = legColumn(i) ? 1 : 2;
  const auto faces = [&](std::vector<Key> p) {
    for (Key& k : p) k.level = top;
    polygon(p);
    std::reverse(p.begin(), p.end());
    for (Key& k : p) k.level = -top;
    polygon(p);
  };
  const bool saddle = in[0] == in[2] && in[1] == in[3] && in[0] != in[1];
  if (saddle) {  // two separate corners
    for (int k = 0; k < 4; ++k) {
      if (!in[k]) continue;
      faces({corner[k], edge[k], edge[(k + 3) % 4]});
      wall(edge[k], edge[(k + 3) % 4], i);
    }
    return;
  }
  std::vector<Key> p;
  int leave = -1, enter = -1;
  for (int k = 0; k < 4; ++k) {
    if (in[k]) p.push_back(corner[k]);
    if (in[k] != in[(k + 1) % 4]) {
      p.push_back(edge[k]);
      (in[k] ? leave : enter) = k;
    }
  }
  if (p.empty()) return;
  faces(p);
  if (leave >= 0) wall(edge[leave], edge[enter], i);
}

/// Between leg and bar: the bar's end faces above and below the leg, on the part of the line that is inside.
void Builder::step(int j) {
  const bool a = inside(split_, j), b = inside(split_, j + 1);
  if (!a && !b) return;
  const Key low = a ? Key{split_, j, 2, 0} : Key{split_, j, 1, 0};
  const Key high = b ? Key{split_, j + 1, 2, 0} : Key{split_, j, 1, 0};
  const auto at = [](Key k, int level) {
    k.level = level;
    return k;
  };
  for (const auto& [from, to] : {std::pair{1, 2}, {-2, -1}}) {
    std::vector<Key> p{at(low, from), at(low, to), at(high, to), at(high, from)};  // seen from -x
    polygon(p);
  }
}

SolidMesh Builder::build() {
  for (int j = -1; j < rows_ - 2; ++j) {
    for (int i = -1; i < columns_ - 2; ++i) cellFaces(i, j);
    step(j);
  }
  return mesh_;
}

}  // namespace

SolidMesh extrudeArm(const vehicle::ArmSettings& arm, const ArmShape& shape, double cell) {
  return Builder(arm, shape, cell).build();
}

double SolidMesh::volume() const {
  double six = 0;
  for (const auto& t : triangles) {
    const auto &a = vertices[t[0]], &b = vertices[t[1]], &c = vertices[t[2]];
    six += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return six / 6;
}

bool SolidMesh::watertight() const {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      if (t[k] == t[(k + 1) % 3] || ++edges[{t[k], t[(k + 1) % 3]}] > 1) return false;
    }
  }
  return !edges.empty() && std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
    return edges.count({e.first.second, e.first.first}) == 1;
  });
}

std::array<double, 3> SolidMesh::extent() const {
  std::array<double, 3> result{};
  for (int a = 0; a < 3; ++a) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& v : vertices) low = std::min(low, v[a]), high = std::max(high, v[a]);
    result[a] = vertices.empty() ? 0 : high - low;
  }
  return result;
}

}  // namespace snapwing::design
