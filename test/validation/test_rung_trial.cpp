// What one pulse or one load does on the rungs, on the same body.
#include <gtest/gtest.h>

#include "shipped.h"
#include "snapwing/validation/validation.h"

namespace snapwing::validation {
namespace {

using motion::TrialRung;
using vehicle::Mode;

TEST(RungRunner, PlaneAndSolidOfTheSameCoarseCellsAreOneBody) {
  const Shipped shipped;
  RungTrial trial;
  trial.start = Mode::FIXED_WING;
  trial.pulse.throttle = 0.577, trial.pulse.duration = 0.180;
  trial.trial.mount = vehicle::Mount::BOOM;
  trial.cell_size = 2.5e-3;
  const RungRunner runner(shipped.vehicle, shipped.table, shipped.wing);
  trial.rung = TrialRung::PLANAR;
  const RungOutcome plane = runner.run(trial);
  trial.rung = TrialRung::VOLUMETRIC;
  trial.kernel = scene::SceneKernel::LINEAR_REDUCED;  // the linear one locks
  const RungOutcome solid = runner.run(trial);
  EXPECT_EQ(plane.failure + solid.failure, "");
  EXPECT_EQ(plane.end, solid.end);
  // Both are .015 s later than the limit of small cells. With rho averaged in the solid alone they are .021 s apart.
  EXPECT_NEAR(solid.snap_time, plane.snap_time, 0.008);
}

TEST(Carried, TheSoftArmCarriesWhatItsOwnCurveSays) {
  const Shipped shipped;
  RungTrial trial;
  trial.rung = TrialRung::PLANAR;
  trial.cell_size = 2.5e-3;
  trial.trial.mount = vehicle::Mount::HELD;
  trial.trial.gravity = 9.81;
  trial.trial.wings = false;
  const RungRunner runner(shipped.vehicle, shipped.table, shipped.wing);
  const RungOutcome soft = runner.carried(trial);
  EXPECT_EQ(soft.failure, "");
  trial.rung = TrialRung::LUMPED;
  const double tables = runner.carried(trial).threshold;
  for (const planning::AccidentMargin& a : planning::accidentMargins(shipped.vehicle, shipped.table)) {
    if (a.name == "ring held upright in F") {
      EXPECT_NEAR(tables, a.limit, 1e-9);
    }
  }
  // The arm of these cells has another peak than the table: 4.04 N with cells that keep its stiffness.
  const double peak = traceArm(shipped.vehicle, shipped.vehicle.arm.density_file, 2.5e-3).peak_force;
  const double stated = vehicle::curveFeatures(shipped.table).peak_force;
  EXPECT_NEAR(soft.threshold - tables, peak - stated, 0.1);
}

}  // namespace
}  // namespace snapwing::validation
