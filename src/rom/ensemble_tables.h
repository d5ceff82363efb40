#pragma once
/// The curves of a vehicle on one uniform grid of travel, for look-ups in lanes. Private to the layer.

#include <vector>

#include "snapwing/rom/potential.h"
#include "snapwing/rom/travel_inertia.h"

namespace snapwing::rom {

/// Cubic pieces; beyond the grid the force stiffens as the potential does, inertia stays constant.
struct CurvesView;
struct BranchView;

struct UniformCurves {
  static constexpr int FORCE_ROW = 8;     ///< force c0 .. c3 in powers of [m], energy at the begin, padding
  static constexpr int INERTIA_ROW = 12;  ///< K c0 .. c3, S c0 .. c3, H at the begin, friction and its slope, padding

  double low = 0, high = 0, width = 0;  ///< [m]
  int cells = 0;
  std::vector<double> force;        ///< of force scale 1
  std::vector<double> arms, wings;  ///< rows of inertia; empty: weightless arms, no wings; scales 1
  PotentialSample at_low, at_high;
  double growth_low = 0, growth_high = 0;  ///< [N/m2] slope of the stiffness beyond the grid: below 0, above 0

  /// @param arms, wings  nullptr: none
  UniformCurves(const Potential& potential, double table_low, double table_high, const TravelInertia* arms,
                const TravelInertia* wings);
  CurvesView view() const;
};

/// Peak and valley of f(u) + x S(u), S of arms and wings, by the specific force over the force scale x and by the scale
/// of the wings.
struct BranchTable {
  static constexpr int ROW = 4;  ///< peak: travel, force; valley: travel, force (of force scale 1)
  double low = 0, step = 1;      ///< of x [m/s2]
  int count = 1;
  double wing_low = 1, wing_step = 1;
  int wing_count = 1;
  std::vector<double> rows;  ///< rows[(wing * count + x) * ROW]
  /// @param wings  they count; @param wing_low, wing_high  their scales that occur
  BranchTable(const UniformCurves& curves, const Equilibria& equilibria, bool wings, double wing_low, double wing_high);
  BranchView view() const;
};

}  // namespace snapwing::rom
