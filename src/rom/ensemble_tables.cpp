#include "ensemble_tables.h"

#include <algorithm>
#include <cmath>

#include "ensemble_run.h"

namespace snapwing::rom {

namespace {

constexpr int CELLS = 512;  // .16 mm of the shipped table: the cubic's error is below rounding of the table
constexpr int LOADS = 401;
constexpr double REACH = 100;  // [m/s2] largest specific force over force scale; beyond it the last one counts
constexpr int WING_SCALES = 9;

/// Cubic in powers of the distance from the begin, from values and slopes at both ends.
void cubic(double y0, double y1, double m0, double m1, double h, double* c) {
  c[0] = y0;
  c[1] = m0;
  c[2] = (3 * (y1 - y0) / h - 2 * m0 - m1) / h;
  c[3] = (2 * (y0 - y1) / h + m0 + m1) / (h * h);
}

std::vector<double> inertiaRows(const UniformCurves& grid, const TravelInertia* moved) {
  if (!moved) return {};
  std::vector<double> rows(static_cast<std::size_t>(UniformCurves::INERTIA_ROW) * grid.cells, 0.0);
  for (int i = 0; i < grid.cells; ++i) {
    const InertiaSample a = moved->at(grid.low + i * grid.width), b = moved->at(grid.low + (i + 1) * grid.width);
    double* row = &rows[static_cast<std::size_t>(UniformCurves::INERTIA_ROW) * i];
    cubic(a.kinetic_mass, b.kinetic_mass, a.kinetic_slope, b.kinetic_slope, grid.width, row);
    cubic(a.coupled_mass, b.coupled_mass, a.coupled_slope, b.coupled_slope, grid.width, row + 4);
    row[8] = a.mass_moment;
    row[9] = a.friction;
    row[10] = (b.friction - a.friction) / grid.width;
  }
  return rows;
}

}  // namespace

UniformCurves::UniformCurves(const Potential& potential, double table_low, double table_high,
                             const TravelInertia* arm_inertia, const TravelInertia* wing_inertia)
    : low(table_low), high(table_high), width((table_high - table_low) / CELLS), cells(CELLS) {
  force.resize(static_cast<std::size_t>(FORCE_ROW) * cells, 0.0);
  for (int i = 0; i < cells; ++i) {
    const PotentialSample a = potential.at(low + i * width), b = potential.at(low + (i + 1) * width);
    double* row = &force[static_cast<std::size_t>(FORCE_ROW) * i];
    cubic(a.force, b.force, a.stiffness, b.stiffness, width, row);
    row[4] = a.energy;
  }
  at_low = potential.at(low);
  at_high = potential.at(high);
  growth_low = (at_low.stiffness - potential.at(low - 1e-3).stiffness) / 1e-3;
  growth_high = (potential.at(high + 1e-3).stiffness - at_high.stiffness) / 1e-3;
  arms = inertiaRows(*this, arm_inertia);
  wings = inertiaRows(*this, wing_inertia);
}

CurvesView UniformCurves::view() const {
  return {force.data(), arms.data(), wings.data(), low, high, width, cells, at_low, at_high, growth_low, growth_high};
}

BranchView BranchTable::view() const { return {rows.data(), low, step, wing_low, wing_step, count, wing_count}; }

namespace {

/// Values at the grid's points, for scans.
struct Points {
  std::vector<double> travel, force, arms, wings;
  Points(const UniformCurves& c, bool with_wings) {
    for (int i = 0; i < c.cells; ++i) {
      travel.push_back(c.low + i * c.width);
      force.push_back(c.force[static_cast<std::size_t>(UniformCurves::FORCE_ROW) * i]);
      const std::size_t at = static_cast<std::size_t>(UniformCurves::INERTIA_ROW) * i + 4;
      arms.push_back(c.arms.empty() ? 0.0 : c.arms[at]);
      wings.push_back(!with_wings ? 0.0 : c.wings[at]);
    }
  }
  double at(int i, double x, double wing) const { return force[i] + x * (arms[i] + wing * wings[i]); }
};

/// Largest value between two travels, by a parabola through the best point and its neighbours.
void extremum(const Points& points, double from, double to, double x, double wing, double sign, double* row) {
  const int n = static_cast<int>(points.travel.size());
  int first = 0, last = n - 1;
  while (first < n - 1 && points.travel[first] < from) ++first;
  while (last > 0 && points.travel[last] > to) --last;
  int best = first;
  for (int i = first; i <= last; ++i) {
    if (sign * points.at(i, x, wing) > sign * points.at(best, x, wing)) best = i;
  }
  row[0] = points.travel[best];
  row[1] = points.at(best, x, wing);
  if (best == first || best == last) return;
  const double left = points.at(best - 1, x, wing), right = points.at(best + 1, x, wing);
  const double bend = left - 2 * row[1] + right;
  if (bend == 0) return;
  const double shift = std::clamp(0.5 * (left - right) / bend, -1.0, 1.0);
  row[0] += shift * (points.travel[1] - points.travel[0]);
  row[1] += shift * (0.5 * (right - left) + 0.5 * shift * bend);
}

}  // namespace

BranchTable::BranchTable(const UniformCurves& curves, const Equilibria& e, bool wings, double wing_from,
                         double wing_to) {
  const bool moved = !curves.arms.empty() || wings;
  count = moved ? LOADS : 2;
  low = -REACH;
  step = 2 * REACH / (count - 1);
  wing_low = wing_from;
  wing_count = wings && wing_to > wing_from ? WING_SCALES : 1;
  wing_step = wing_count > 1 ? (wing_to - wing_from) / (wing_count - 1) : 1.0;
  rows.resize(static_cast<std::size_t>(ROW) * count * wing_count);
  const Points points(curves, wings);
  for (int j = 0; j < wing_count; ++j) {
    for (int i = 0; i < count; ++i) {
      double* row = &rows[static_cast<std::size_t>(ROW) * (static_cast<std::size_t>(j) * count + i)];
      if (!moved) {
        row[0] = e.peak_travel;
        row[1] = e.peak_force;
        row[2] = e.valley_travel;
        row[3] = e.valley_force;
        continue;
      }
      const double x = low + i * step, wing = wing_low + j * wing_step;
      extremum(points, e.first, e.barrier, x, wing, 1.0, row);
      extremum(points, e.barrier, e.second, x, wing, -1.0, row + 2);
    }
  }
}

}  // namespace snapwing::rom
