// Volume of a scene's bodies by samples far finer than those of the cells: what the cells' volume is compared with.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "scene_cells.h"
#include "snapwing/common/elementary.h"

namespace snapwing::scene {

using mpm::Vector;

namespace {

constexpr double MOST_SAMPLES = 5e6;  // a second

/// Share of a box [low, low + edge] that a shape fills, by so many samples per axis; `axes` 2: in the plane only.
/// @param depth  what a sample counts, by its place
template <class Depth>
double sampled(const mpm::Shape& shape, const Point3& low, double edge, int axes, int per_axis, const Depth& depth) {
  int count = 1;
  for (int a = 0; a < axes; ++a) count *= per_axis;
  double total = 0;
  for (int s = 0; s < count; ++s) {
    Point3 p = low;
    for (int a = 0, rest = s; a < axes; ++a, rest /= per_axis) p(a) += edge * (rest % per_axis + 0.5) / per_axis;
    if (shape.contains(p)) total += depth(p);
  }
  return total / count;
}

}  // namespace

/// Whether a cell and all cells at its faces are full; else whether any of them is there at all.
template <int D>
int SceneCells<D>::fillAround(int body, const mpm::Index<D>& at) const {
  bool full = true, any = false;
  for (int k = 0; k <= 2 * D; ++k) {
    mpm::Index<D> other = at;
    if (k > 0) other[(k - 1) / 2] += k % 2 == 1 ? -1 : 1;
    const int cell = solid_->findCell(body, other);
    any = any || cell >= 0;
    if (cell < 0) {
      full = false;
      continue;
    }
    const std::vector<double>& weight = solid_->rule(cell_rule_[cell]).weight;
    full = full && std::accumulate(weight.begin(), weight.end(), 0.0) > 1 - 1e-9;
  }
  return full ? 2 : any ? 1 : 0;
}

/// Solids: what lies in the midst of full cells is full, what is near to cells is sampled finely.
template <int D>
double SceneCells<D>::volumeOfSolid(int number) const {
  const mpm::Grid<D>& grid = solid_->grid(number);
  const double h = grid.cell_size;
  std::vector<Point3> cut;
  double cells = 0;
  for (int c = 0; c < grid.cellCount(); ++c) {
    const mpm::Index<D> at = grid.cellIndex(c);
    const int fill = fillAround(number, at);
    if (fill == 2) cells += 1;
    if (fill != 1) continue;
    cut.emplace_back(Point3::Zero());
    cut.back().template head<D>() = grid.cellCentre(at) - Vector<D>::Constant(0.5 * h);
  }
  int fine = 12;
  while (fine > 4 && common::pow(fine, D) * static_cast<double>(cut.size()) > MOST_SAMPLES) --fine;
  for (const Point3& low : cut) {
    cells += sampled(*scene_.bodies[number].shape, low, h, D, fine, [](const Point3&) { return 1.0; });
  }
  return cells * common::pow(h, D);
}

/// Slices and extrusions: by columns along z.
template <int D>
double SceneCells<D>::volumeOfSlice(int number) const {
  const SceneBody& body = scene_.bodies[number];
  const mpm::Grid<D>& grid = solid_->grid(number);
  const double h = grid.cell_size, bottom = D == 3 ? grid.origin(D - 1) : 0;
  const auto depth = [&](const Point3& p) {
    const double half = 0.5 * body.thicknessAt(p(0), p(1));
    return D == 2 ? 2 * half : std::max(0.0, half - std::max(-half, bottom));
  };
  int fine = 40;
  while (fine > 4 && fine * fine * static_cast<double>(grid.cells[0]) * grid.cells[1] > MOST_SAMPLES) --fine;
  double area_depth = 0;
  for (int j = 0; j < grid.cells[1]; ++j) {
    for (int i = 0; i < grid.cells[0]; ++i) {
      const Point3 low(grid.origin(0) + h * i, grid.origin(1) + h * j, 0);
      area_depth += h * h * sampled(*body.shape, low, h, 2, fine, depth);
    }
  }
  return area_depth;
}

template <int D>
double SceneCells<D>::volumeOfDensity(int number) const {
  const SceneBody& body = scene_.bodies[number];
  const mpm::DensityField& field = body.density;
  const double bottom = D == 3 ? solid_->grid(number).origin(D - 1) : 0;
  double volume = 0;
  for (int j = 0; j < field.cells[1]; ++j) {
    for (int i = 0; i < field.cells[0]; ++i) {
      const double x = (i + 0.5) * field.cell_size, y = (j + 0.5) * field.cell_size;
      const bool built = !(mirror_.has(0) && x < mirror_.at[0]) && !(mirror_.has(1) && y < mirror_.at[1]);
      if (!built || !field.present(i, j)) continue;
      const double half = 0.5 * body.thicknessAt(x, y);
      const double high = D == 2 ? 2 * half : std::max(0.0, half - std::max(-half, bottom));
      volume += field.at(i, j) * field.cell_size * field.cell_size * high;
    }
  }
  return volume;
}

template <int D>
double SceneCells<D>::bodyVolume() const {
  double volume = 0;
  for (int body = 0; body < static_cast<int>(scene_.bodies.size()); ++body) {
    if (!scene_.bodies[body].hasCells()) continue;
    const bool slice = D == 2 || scene_.bodies[body].extruded;
    volume += !scene_.bodies[body].shape ? volumeOfDensity(body) : slice ? volumeOfSlice(body) : volumeOfSolid(body);
  }
  return volume;
}

template double SceneCells<2>::bodyVolume() const;
template double SceneCells<3>::bodyVolume() const;

}  // namespace snapwing::scene
