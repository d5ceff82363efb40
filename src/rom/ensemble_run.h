#pragma once
/// Runs the trials of eight vehicles in one vector. Private to the layer.

#include "ensemble_tables.h"
#include "snapwing/vehicle/mode.h"

namespace snapwing::rom {

constexpr int LANES = 8;
struct EightReals {
  alignas(64) double lane[LANES];
};

/// Parameters of eight vehicles as they count in one trial (with the boom's share, if there is one).
struct EnsembleBlock {
  EightReals ring_mass, centre_mass, all;  ///< [kg]; all = ring + centre
  EightReals all_inverse;                  ///< 1 / all, 0 if the ring is held
  EightReals force_scale, damping, max_thrust, time_up, time_down, latency;
  EightReals ring_drag, centre_drag, boom_friction;
  EightReals wing_inertia, wing_friction;
  EightReals before, during, hold, after;  ///< steady thrust / full thrust
  EightReals duration, hold_duration;      ///< [s] of the pulse, and of the level behind it
};

/// UniformCurves and BranchTable as plain numbers and pointers.
struct CurvesView {
  const double *force, *arms, *wings;
  double low, high, width;
  int cells;
  PotentialSample at_low, at_high;
  double growth_low, growth_high;
};
struct BranchView {
  const double* rows;
  double low, step, wing_low, wing_step;
  int count, wing_count;
};

/// What all vehicles of a trial have in common.
struct EnsembleScene {
  CurvesView curves;
  BranchView branches;
  Equilibria equilibria;  ///< of force scale 1
  vehicle::Mode start;
  bool held = false, on_boom = false, arms = false, wings = false;
  double gravity = 0, push = 0, initial_speed = 0, horizon = 0;
  double friction_speed = 0, settled_share = 0;
  static constexpr int PARTS = 4;
  int steps[PARTS] = {0, 0, 0, 0};  ///< before the pulse, during it, in its hold, and after
};

struct EnsembleResult {
  EightReals margin, peak_travel, snapped;  ///< snapped: 1 or 0
};

/// The same code for each width of the machine's vectors, with the same bits.
using RunBlock = void (*)(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* result);
void runBlockWide(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* result);    ///< AVX-512
void runBlockMiddle(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* result);  ///< AVX2
void runBlockPlain(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* result);
/// The widest that this processor has.
RunBlock widestRunBlock();

}  // namespace snapwing::rom
