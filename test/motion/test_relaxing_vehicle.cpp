// The shipped vehicle with a memory of its material: loss in Q, which modulus is stated, resuming, refusals.
#include <gtest/gtest.h>

#include <cmath>

#include "restart.h"
#include "snapwing/common/error.h"
#include "snapwing/motion/axis_trial.h"
#include "snapwing/motion/trial_file.h"
#include "snapwing/motion/trial_record.h"
#include "snapwing/vehicle/table_origin.h"
#include "snapwing/vehicle/vehicle_parameters.h"
#include "support/paths.h"

namespace snapwing::motion {
namespace {

vehicle::Relaxation::Term branch(double share, double time) {
  vehicle::Relaxation::Term term;
  term.share.value = share, term.time.value = time;
  return term;
}

struct Relaxing {
  explicit Relaxing(std::vector<vehicle::Relaxation::Term> terms, bool fast = false) {
    vehicle.material.relaxation.terms = std::move(terms);
    vehicle.material.relaxation.modulus_is_fast = fast;
    boom.mount = vehicle::Mount::BOOM;
    boom.wings = false;
    boom.initial_thrust_fraction = 0.0;
    boom.horizon = 2;
    settings.cell_size = 0.0025;
  }
  AxisVehicle make() const { return {vehicle, parameters, boom, settings}; }
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  vehicle::VehicleParameters parameters = vehicle::realise(vehicle, table);
  vehicle::Trial boom;
  AxisSettings settings;
};

/// Ratio of damping of the travel that swings freely about Q, from the second and the third half swing.
double ratioInQ(Relaxing r) {
  r.boom.mount = vehicle::Mount::FREE;
  r.parameters.ring_drag = r.parameters.centre_drag = 0;
  const AxisVehicle vehicle = r.make();
  StepperSettings steps;
  steps.largest_step = 1e-3;
  Stepper stepper(vehicle.problem(), Scheme(SchemeKind::MIDPOINT), steps);
  MotionState state = vehicle.start(vehicle::Mode::QUADROTOR, 0.4);
  const ControlOf none = [](double, double) { return Eigen::VectorXd::Zero(1); };
  std::vector<double> turns;
  double before = 0;
  while (turns.size() < 4 && state.time < 1) {
    stepper.step(state, 2, none);
    const double now = vehicle.travelRate(state);
    if (before * now < 0) turns.push_back(vehicle.travel(state));
    before = now;
  }
  EXPECT_EQ(turns.size(), 4U);
  const double decrement = std::log((turns[0] - turns[1]) / (turns[2] - turns[1]));
  return decrement / std::hypot(M_PI, decrement);
}

/// Branches take their loss in Q off the viscous law: the ratio stays that of the file.
TEST(RelaxingVehicle, KeepsTheFilesDampingRatioInQ) {
  const double viscous = ratioInQ(Relaxing({}));
  EXPECT_NEAR(viscous, 0.18, 0.02) << "of small swings, where the curve's bend still counts";
  EXPECT_NEAR(ratioInQ(Relaxing({branch(0.1, 0.02)})), viscous, 0.05 * viscous);
  // Without the correction it would be a quarter more.
  Relaxing more({branch(0.1, 0.02)});
  more.parameters.damping *= 1.25;
  EXPECT_GT(ratioInQ(more), 1.1 * viscous);
}

TEST(RelaxingVehicle, RefusesMoreLossThanTheFileStates) {
  try {
    Relaxing({branch(0.6, 0.025)}).make();
    FAIL() << "a negative rest";
  } catch (const common::Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("material.relaxation"), std::string::npos) << text;
    EXPECT_NE(text.find("damping_ratio"), std::string::npos) << text;
  }
}

/// Slow: the static curve is the file's. Fast: it is softer by what relaxes.
TEST(RelaxingVehicle, StatesWhichModulusTheFileHas) {
  const std::vector<vehicle::Relaxation::Term> terms{branch(0.1, 0.02), branch(0.1, 300)};
  const AxisVehicle none = Relaxing({}).make(), slow = Relaxing(terms).make(), fast = Relaxing(terms, true).make();
  const double force = none.curve().forceAt(0.01);
  EXPECT_EQ(slow.curve().forceAt(0.01), force);
  EXPECT_NEAR(fast.curve().forceAt(0.01) / force, 0.8, 1e-4);
  EXPECT_EQ(none.leftOut().size(), slow.leftOut().size() + 1);
}

/// Half widths of shares and times are part of a trial's box: what they move is the series, and so the fast modulus.
TEST(RelaxingVehicle, LiesWhereTheTrialSaysInItsHalfWidths) {
  Relaxing r({branch(0.05, 0.02), branch(0.05, 300)}, true);
  for (auto& term : r.vehicle.material.relaxation.terms) {
    term.share.plus_minus = 0.4 * term.share.value, term.time.plus_minus = 0.5 * term.time.value;
  }
  const double nominal = r.make().curve().forceAt(0.01);
  r.settings.relaxation_share = 1;
  r.settings.relaxation_time = -1;
  const AxisVehicle edge = r.make();
  EXPECT_NEAR(edge.series().branches[0].share, 0.07, 1e-15);
  EXPECT_NEAR(edge.series().branches[1].time, 150, 1e-12);
  EXPECT_NEAR(edge.curve().forceAt(0.01) / nominal, 0.86 / 0.9, 1e-4) << "what is left after a long rest";
  r.settings.relaxation_share = 30;
  EXPECT_THROW(r.make(), common::Error) << "shares of more than the whole";
}

/// A seed draws both, and leaves the other numbers of the box what they are without.
TEST(RelaxingVehicle, ASeedDrawsItsHalfWidths) {
  TrialFile one, other;
  drawVehicle(3, one);
  drawVehicle(4, other);
  ASSERT_EQ(one.box.size(), vehicle::uncertainNames().size());
  for (const TrialFile* file : {&one, &other}) {
    for (const double place : {file->axis.relaxation_share, file->axis.relaxation_time}) EXPECT_LT(std::abs(place), 1);
  }
  EXPECT_NE(one.axis.relaxation_share, other.axis.relaxation_share);
  EXPECT_NE(one.axis.relaxation_time, one.axis.relaxation_share);
  one.repeats = 2;
  one.vary.vehicle = true;
  EXPECT_NE(repeatOf(one, 0).axis.relaxation_share, repeatOf(one, 1).axis.relaxation_share);
}

/// A branch that hardly relaxes within a trial makes a stiffer arm: the same pulse crosses later.
TEST(RelaxingVehicle, SwitchesAndItsAccountCloses) {
  std::vector<double> snaps;
  for (const auto& terms : {std::vector<vehicle::Relaxation::Term>{}, {branch(0.05, 0.02), branch(0.05, 300)}}) {
    const Relaxing r(terms);
    const AxisVehicle vehicle = r.make();
    Stepper stepper(vehicle.problem(), Scheme(SchemeKind::MIDPOINT), {});
    AxisRun run;
    ASSERT_TRUE(
        runTrial(vehicle, stepper, AxisTrial::of(vehicle::Mode::FIXED_WING, 0.5, 0.06, r.parameters, 0, r.boom), run));
    EXPECT_EQ(run.outcome.end_mode, vehicle::Mode::QUADROTOR);
    EXPECT_LT(run.outcome.largest_imbalance, 5e-4);
    for (std::size_t k = 1; k < run.samples.size(); ++k) EXPECT_GE(run.samples[k].loss, run.samples[k - 1].loss);
    snaps.push_back(run.outcome.snap_time);
  }
  EXPECT_GT(snaps[1], snaps[0] + 1e-3);
}

TEST(RelaxingVehicle, AStoppedRunGoesOnWithTheSameBits) {
  const Relaxing r({branch(0.05, 0.02), branch(0.05, 300)});
  const AxisVehicle vehicle = r.make();
  const AxisTrial trial = AxisTrial::of(vehicle::Mode::FIXED_WING, 0.5, 0.06, r.parameters, 0, r.boom);
  const test::Restarted runs = test::restarted(vehicle, trial, {}, 40, 137, "relaxing_checkpoint.bin", 200);
  EXPECT_EQ(runs.steps_of_checkpoint, 120);
  EXPECT_GT(loadTrialCheckpoint(runs.checkpoint, std::string(64, 'a')).state.history.norm(), 0);
  EXPECT_TRUE(runs.resumed.state.history == runs.whole.state.history);
}

}  // namespace
}  // namespace snapwing::motion
