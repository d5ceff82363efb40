#pragma once
/// Runs the trials of vehicles side by side. Private to the layer.

#include "ensemble_tables.h"
#include "snapwing/vehicle/mode.h"

namespace snapwing::rom {

/// Vehicles side by side.
constexpr int LANES = 16;
/// One number of each.
struct LaneReals {
  alignas(64) double lane[LANES];
};

/// What a vehicle is in one trial (with the boom's share, if there is one). Masses [kg]; all = ring + centre,
/// all_inverse is 0 if the ring is held; before, during, hold, after: steady thrust / full thrust; duration [s] of the
/// pulse, hold_duration of the level behind it.
#define SNAPWING_VEHICLE_NUMBERS(EACH) \
  EACH(ring_mass)                      \
  EACH(centre_mass)                    \
  EACH(all)                            \
  EACH(all_inverse)                    \
  EACH(force_scale)                    \
  EACH(damping)                        \
  EACH(max_thrust)                     \
  EACH(time_up)                        \
  EACH(time_down)                      \
  EACH(latency)                        \
  EACH(ring_drag)                      \
  EACH(centre_drag)                    \
  EACH(boom_friction)                  \
  EACH(wing_inertia)                   \
  EACH(wing_friction) EACH(before) EACH(during) EACH(hold) EACH(after) EACH(duration) EACH(hold_duration)

struct EnsembleBlock {
#define SNAPWING_NUMBER(name) LaneReals name;
  SNAPWING_VEHICLE_NUMBERS(SNAPWING_NUMBER)
#undef SNAPWING_NUMBER
};

/// UniformCurves and BranchTable as plain numbers and pointers.
struct CurvesView {
  const EightReals *force, *wings, *kinetic;
  double low, high, width;
  int cells;
  PotentialSample at_low, at_high;
  double growth_low, growth_high;
};
struct BranchView {
  const EightReals* rows;
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
  double step = 0;  ///< [s] the largest
};

struct EnsembleResult {
  double margin, peak_travel;
  bool snapped;
};

/// Runs a block, with a result for each lane. The same code for each width of the machine's vectors, with the same
/// bits.
using RunBlock = void (*)(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* results);
void runBlockWide(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* results);    ///< AVX-512
void runBlockMiddle(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* results);  ///< AVX2
void runBlockPlain(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* results);
/// The widest that this processor has.
RunBlock widestRunBlock();

}  // namespace snapwing::rom
