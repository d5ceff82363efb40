#include "ensemble_tables.h"

#include <algorithm>
#include <cmath>

#include "ensemble_run.h"
#include "snapwing/common/bisection.h"

namespace snapwing::rom {

namespace {

constexpr int CELLS = 1024;  // .09 mm of the shipped table
constexpr int LOADS = 400;
constexpr double REACH = 100;  // [m/s2] largest specific force over force scale; beyond it the last one counts
constexpr int WING_SCALES = 9;
constexpr int COARSE = 8;  // cells between the points that are compared first

/// Cubic in powers of the distance from the begin, from values and slopes at both ends.
void cubic(double y0, double y1, double m0, double m1, double h, double* c) {
  c[0] = y0;
  c[1] = m0;
  c[2] = (3 * (y1 - y0) / h - 2 * m0 - m1) / h;
  c[3] = (2 * (y0 - y1) / h + m0 + m1) / (h * h);
}

/// Quadratic through both values; its slopes are off by the same at both ends, a twelfth of the third derivative h^2.
void quadratic(double y0, double y1, double m0, double m1, double h, double* c) {
  c[0] = y0;
  c[1] = (y1 - y0) / h - 0.5 * (m1 - m0);
  c[2] = 0.5 * (m1 - m0) / h;
}

InertiaSample inertiaAt(const TravelInertia* moved, double u) { return moved ? moved->at(u) : InertiaSample{}; }

}  // namespace

UniformCurves::UniformCurves(const Potential& potential, double table_low, double table_high,
                             const TravelInertia* arm_inertia, const TravelInertia* wing_inertia)
    : low(table_low),
      high(table_high),
      width((table_high - table_low) / CELLS),
      cells(CELLS),
      force(CELLS),
      wings(CELLS),
      kinetic(CELLS),
      has_arms(arm_inertia != nullptr) {
  for (int i = 0; i < cells; ++i) {
    const double u0 = low + i * width, u1 = low + (i + 1) * width;
    const PotentialSample f0 = potential.at(u0), f1 = potential.at(u1);
    const InertiaSample a0 = inertiaAt(arm_inertia, u0), a1 = inertiaAt(arm_inertia, u1);
    const InertiaSample w0 = inertiaAt(wing_inertia, u0), w1 = inertiaAt(wing_inertia, u1);
    double* row = force[i].at;
    cubic(f0.force, f1.force, f0.stiffness, f1.stiffness, width, row);
    quadratic(a0.coupled_mass, a1.coupled_mass, a0.coupled_slope, a1.coupled_slope, width, row + 4);
    row[7] = f0.energy;
    row = wings[i].at;
    quadratic(w0.coupled_mass, w1.coupled_mass, w0.coupled_slope, w1.coupled_slope, width, row);
    row[3] = w0.friction;
    row[4] = (w1.friction - w0.friction) / width;
    row[5] = a0.mass_moment;
    row[6] = w0.mass_moment;
    row[7] = 0;
    row = kinetic[i].at;
    quadratic(a0.kinetic_mass, a1.kinetic_mass, a0.kinetic_slope, a1.kinetic_slope, width, row);
    quadratic(w0.kinetic_mass, w1.kinetic_mass, w0.kinetic_slope, w1.kinetic_slope, width, row + 3);
    row[6] = row[7] = 0;
  }
  at_low = potential.at(low);
  at_high = potential.at(high);
  growth_low = (at_low.stiffness - potential.at(low - 1e-3).stiffness) / 1e-3;
  growth_high = (potential.at(high + 1e-3).stiffness - at_high.stiffness) / 1e-3;
}

CurvesView UniformCurves::view() const {
  return {force.data(), wings.data(), kinetic.data(), low,        high,       width,
          cells,        at_low,       at_high,        growth_low, growth_high};
}

BranchView BranchTable::view() const { return {rows.data(), low, step, wing_low, wing_step, count, wing_count}; }

namespace {

/// Force under one specific force and one scale of the wings.
struct Felt {
  const UniformCurves& curves;
  double x, wing;  ///< 0: wings do not act
  double travel(int i) const { return curves.low + i * curves.width; }
  double atPoint(int i) const {
    const double *f = curves.force[i].at, *w = curves.wings[i].at;
    return f[0] + x * (f[4] + wing * w[0]);
  }
  double within(int i, double d) const {
    const double *f = curves.force[i].at, *w = curves.wings[i].at;
    return f[0] + d * (f[1] + d * (f[2] + d * f[3])) +
           x * (f[4] + d * (f[5] + d * f[6]) + wing * (w[0] + d * (w[1] + d * w[2])));
  }
  double slope(int i, double d) const {
    const double *f = curves.force[i].at, *w = curves.wings[i].at;
    return f[1] + d * (2 * f[2] + d * 3 * f[3]) + x * (f[5] + 2 * d * f[6] + wing * (w[1] + 2 * d * w[2]));
  }
};

/// Largest (sign 1) or smallest (-1) force between two travels: the best point, and where the force is level beside it.
void extremum(const Felt& felt, double from, double to, double sign, double* travel, double* force) {
  const int n = felt.curves.cells;
  const auto cellOf = [&](double u) {
    return std::clamp(static_cast<int>((u - felt.curves.low) / felt.curves.width), 0, n - 1);
  };
  const int first = std::min(cellOf(from) + 1, n - 1), last = cellOf(to);
  int best = first;
  const auto search = [&](int begin, int end, int by) {
    for (int i = begin; i <= end; i += by) {
      if (sign * felt.atPoint(i) > sign * felt.atPoint(best)) best = i;
    }
  };
  search(first, last, COARSE);
  search(std::max(first, best - COARSE), std::min(last, best + COARSE), 1);
  *travel = felt.travel(best);
  *force = felt.atPoint(best);
  if (best == first || best == last) return;
  const int cell = sign * felt.slope(best, 0.0) > 0 ? best : best - 1;
  const auto slope = [&](double d) { return sign * felt.slope(cell, d); };
  if (!(slope(0.0) > 0 && slope(felt.curves.width) < 0)) return;
  const double d = common::bisect(slope, 0.0, felt.curves.width, 40);
  *travel = felt.travel(cell) + d;
  *force = felt.within(cell, d);
}

}  // namespace

BranchTable::BranchTable(const UniformCurves& curves, const Equilibria& e, bool wings, double wing_from,
                         double wing_to) {
  const bool moved = curves.has_arms || wings;
  count = moved ? LOADS : 1;
  low = -REACH;
  step = 2 * REACH / count;
  wing_low = wing_from;
  wing_count = wings && wing_to > wing_from ? WING_SCALES : 1;
  wing_step = wing_count > 1 ? (wing_to - wing_from) / (wing_count - 1) : 1.0;
  rows.resize(static_cast<std::size_t>(count) * wing_count);
  const auto valuesAt = [&](double x, double wing, double* v) {
    v[0] = e.peak_travel, v[1] = e.peak_force, v[2] = e.valley_travel, v[3] = e.valley_force;
    if (!moved || x == 0) return;
    const Felt felt{curves, x, wings ? wing : 0.0};
    extremum(felt, e.first, e.barrier, 1.0, v, v + 1);
    extremum(felt, e.barrier, e.second, -1.0, v + 2, v + 3);
  };
  for (int j = 0; j < wing_count; ++j) {
    double next[4];
    valuesAt(low, wing_low + j * wing_step, next);
    for (int i = 0; i < count; ++i) {
      double* row = rows[static_cast<std::size_t>(j) * count + i].at;
      std::copy(next, next + 4, row);
      valuesAt(low + (i + 1) * step, wing_low + j * wing_step, next);
      for (int k = 0; k < 4; ++k) row[4 + k] = next[k] - row[k];
    }
  }
}

}  // namespace snapwing::rom
