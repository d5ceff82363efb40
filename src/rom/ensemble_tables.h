#pragma once
/// The curves of a vehicle on one uniform grid of travel, for look-ups in lanes. Private to the layer.

#include <vector>

#include "snapwing/rom/potential.h"
#include "snapwing/rom/travel_inertia.h"

namespace snapwing::rom {

/// A row of a table.
struct EightReals {
  alignas(64) double at[8];
};

struct CurvesView;
struct BranchView;

/// In powers of the distance from the cell's begin [m]: the force is cubic, K, S quadratic with the values of their
/// curves at the grid's points, friction linear. Beyond the grid the force stiffens as the potential does, K and S stay
/// constant. What is used together lies together: each row is one line of the cache.
struct UniformCurves {
  double low = 0, high = 0, width = 0;  ///< [m]
  int cells = 0;
  std::vector<EightReals> force;  ///< c0 .. c3 of force scale 1, S of the arms c0 .. c2, energy at the begin
  std::vector<EightReals> wings;  ///< S of the wings c0 .. c2, their friction c0, c1, H of arms, of wings at the begin
  std::vector<EightReals> kinetic;  ///< K of the arms c0 .. c2, of the wings c0 .. c2
  bool has_arms = false;            ///< arms have mass
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
  double low = 0, step = 1;  ///< of x [m/s2]
  int count = 1;             ///< cells along x
  double wing_low = 1, wing_step = 1;
  int wing_count = 1;
  /// rows[wing * count + x]: travel and force of the peak, travel and force of the valley (of force scale 1), then what
  /// these four gain within the cell.
  std::vector<EightReals> rows;
  /// @param wings  they count; @param wing_low, wing_high  their scales that occur
  BranchTable(const UniformCurves& curves, const Equilibria& equilibria, bool wings, double wing_low, double wing_high);
  BranchView view() const;
};

}  // namespace snapwing::rom
