#include "triangulation.h"

#include <algorithm>
#include <limits>

namespace snapwing::nodes {

namespace {

struct Corner {
  Point2 at;
  VertexId id;
};
using Polygon = std::vector<Corner>;

/// Twice the signed area of a triangle.
double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool inside(const Point2& p, const Loop& loop) {
  bool in = false;
  for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
    if ((loop[i][1] > p[1]) == (loop[j][1] > p[1])) continue;
    const double x = loop[i][0] + (p[1] - loop[i][1]) / (loop[j][1] - loop[i][1]) * (loop[j][0] - loop[i][0]);
    if (p[0] < x) in = !in;
  }
  return in;
}

Polygon corners(const Loop& loop, std::size_t index, bool counter_clockwise) {
  Polygon polygon;
  for (std::size_t i = 0; i < loop.size(); ++i) polygon.push_back({loop[i], {index, i}});
  if ((signedArea(loop) > 0) != counter_clockwise) std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

bool crosses(const Point2& a, const Point2& b, const Polygon& polygon) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& p = polygon[i].at;
    const Point2& q = polygon[(i + 1) % polygon.size()].at;
    if (turn(a, b, p) * turn(a, b, q) < 0 && turn(p, q, a) * turn(p, q, b) < 0) return true;
  }
  return false;
}

/// Joins a hole to its outer polygon by the shortest pair of corners that see each other.
void cutIn(Polygon& outer, const Polygon& hole) {
  double best = std::numeric_limits<double>::infinity();
  std::size_t from = 0, to = 0;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    for (std::size_t j = 0; j < hole.size(); ++j) {
      const double dx = outer[i].at[0] - hole[j].at[0], dy = outer[i].at[1] - hole[j].at[1];
      const double distance = dx * dx + dy * dy;
      if (distance < best && !crosses(outer[i].at, hole[j].at, outer) && !crosses(outer[i].at, hole[j].at, hole)) {
        best = distance;
        from = i;
        to = j;
      }
    }
  }
  Polygon bridge(hole.begin() + static_cast<std::ptrdiff_t>(to), hole.end());
  bridge.insert(bridge.end(), hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(to) + 1);
  bridge.push_back(outer[from]);
  outer.insert(outer.begin() + static_cast<std::ptrdiff_t>(from) + 1, bridge.begin(), bridge.end());
}

bool isEar(const Polygon& polygon, std::size_t i) {
  const std::size_t n = polygon.size();
  const Point2& a = polygon[(i + n - 1) % n].at;
  const Point2& b = polygon[i].at;
  const Point2& c = polygon[(i + 1) % n].at;
  if (turn(a, b, c) <= 0) return false;
  for (const Corner& corner : polygon) {
    const Point2& p = corner.at;
    if (p == a || p == b || p == c) continue;
    if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
  }
  return true;
}

/// Squared length of the edge that cutting corner i off would leave: short ones make well-shaped triangles.
double cutLength(const Polygon& polygon, std::size_t i) {
  const std::size_t n = polygon.size();
  const Point2& a = polygon[(i + n - 1) % n].at;
  const Point2& c = polygon[(i + 1) % n].at;
  return (a[0] - c[0]) * (a[0] - c[0]) + (a[1] - c[1]) * (a[1] - c[1]);
}

void clipEars(Polygon polygon, std::vector<std::array<VertexId, 3>>& triangles) {
  while (polygon.size() >= 3) {
    const std::size_t n = polygon.size();
    std::vector<std::size_t> order(n);
    for (std::size_t i = 0; i < n; ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&polygon](std::size_t a, std::size_t b) {
      return cutLength(polygon, a) < cutLength(polygon, b);
    });
    const auto ear = std::find_if(order.begin(), order.end(), [&polygon](std::size_t i) { return isEar(polygon, i); });
    const bool found = ear != order.end();
    const std::size_t i = found ? *ear : order.front();
    if (found) triangles.push_back({polygon[(i + n - 1) % n].id, polygon[i].id, polygon[(i + 1) % n].id});
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace

double signedArea(const Loop& loop) {
  double twice = 0;
  for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
    twice += loop[j][0] * loop[i][1] - loop[i][0] * loop[j][1];
  }
  return twice / 2;
}

std::vector<std::array<VertexId, 3>> triangulate(const std::vector<Loop>& loops) {
  // How many loops a loop lies in; the hole belongs to the innermost one around it.
  std::vector<std::vector<std::size_t>> around(loops.size());
  for (std::size_t i = 0; i < loops.size(); ++i) {
    for (std::size_t j = 0; j < loops.size(); ++j) {
      if (i != j && loops[i].size() >= 3 && loops[j].size() >= 3 && inside(loops[i].front(), loops[j])) {
        around[i].push_back(j);
      }
    }
  }
  std::vector<std::array<VertexId, 3>> triangles;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (around[i].size() % 2 != 0 || loops[i].size() < 3) continue;
    Polygon outer = corners(loops[i], i, true);
    for (std::size_t j = 0; j < loops.size(); ++j) {
      const bool hole = around[j].size() == around[i].size() + 1 &&
                        std::find(around[j].begin(), around[j].end(), i) != around[j].end();
      if (hole && loops[j].size() >= 3) cutIn(outer, corners(loops[j], j, false));
    }
    clipEars(std::move(outer), triangles);
  }
  return triangles;
}

}  // namespace snapwing::nodes
