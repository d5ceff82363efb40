#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/planning/pulse_planner.h"
#include "snapwing/standin/plant.h"
#include "support/example_wing.h"
#include "support/paths.h"

namespace snapwing::planning {
namespace {

using vehicle::Mode;

class PlannerTest : public ::testing::Test {
 protected:
  PlannerTest()
      : vehicle_(vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml")),
        table_(snapwing::testing::exampleTable()) {
    trial_.mount = vehicle::Mount::BOOM;
    quick_.search_samples = 16;
    quick_.verify_samples = 32;
    quick_.scan_throttles = quick_.scan_durations = 8;
    quick_.refine_evaluations = 15;
  }
  vehicle::Vehicle vehicle_;
  vehicle::ForceTable table_;
  vehicle::Trial trial_;
  PlannerSettings quick_;
};

TEST_F(PlannerTest, FindsBothDirectionsForTheShippedVehicle) {
  const PulsePlanner planner(vehicle_, table_);
  const TransitionPlan up = planner.plan(Mode::FIXED_WING, trial_);
  EXPECT_TRUE(up.accepted) << up.reason;
  EXPECT_EQ(up.share_switched, 1.0);
  EXPECT_GE(up.worst_margin, planner.settings().required_margin);
  EXPECT_GT(up.realisations, 512);
  EXPECT_TRUE(up.nominal.snapped);
  EXPECT_GE(up.nominal.energy_margin, up.worst_margin);
  EXPECT_LT(up.pulse.throttle, 0.9);  // short and mid-range, as in the paper
  EXPECT_LT(up.pulse.duration, 0.4);

  const TransitionPlan back = planner.plan(Mode::QUADROTOR, trial_);
  EXPECT_TRUE(back.accepted) << back.reason;
  EXPECT_GT(back.pulse.throttle, 0.9);  // long and full
  EXPECT_GT(back.pulse.duration, 0.5);
}

TEST_F(PlannerTest, PlansHoldForVehiclesThatThePlannerNeverSaw) {
  // The plant is other code with other integration; its vehicles are drawn from the same box.
  PlannerSettings settings;
  settings.verify_samples = 128;
  const std::optional<vehicle::WingTable> wing = snapwing::testing::exampleTableWing(vehicle_);
  const PulsePlanner planner(vehicle_, table_, settings, wing);
  const std::pair<Mode, vehicle::Mount> cases[] = {
      {Mode::FIXED_WING, vehicle::Mount::BOOM},  // wings act in flight only
      {Mode::QUADROTOR, vehicle::Mount::BOOM},
      {Mode::FIXED_WING, vehicle::Mount::FREE},
      {Mode::QUADROTOR, vehicle::Mount::FREE}};
  for (const auto& [start, mount] : cases) {
    trial_.mount = mount;
    standin::PlantSettings simulation;
    if (mount == vehicle::Mount::FREE) simulation.mount = vehicle::Mount::FREE;
    const TransitionPlan plan = planner.plan(start, trial_);
    ASSERT_TRUE(plan.accepted) << plan.reason;
    const double idle = vehicle::motorOutput(vehicle_.radio, 0.0);
    const double high = vehicle::motorOutput(vehicle_.radio, plan.pulse.throttle);
    int switched = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      standin::Plant plant(vehicle_, table_, standin::drawParameters(vehicle_, table_, seed), simulation, wing);
      plant.reset(start);
      plant.setMotorOutputs({high, high, high, high});
      plant.advanceTo(plan.pulse.duration);
      plant.setMotorOutputs({idle, idle, idle, idle});
      plant.advanceTo(plan.pulse.duration + 1.5);
      switched += plant.mode() == vehicle::otherMode(start);
    }
    EXPECT_EQ(switched, 40) << vehicle::modeName(start) << " " << vehicle::mountName(mount);
  }
}

TEST_F(PlannerTest, HoldFollowsPulsesToQOnly) {
  quick_.hold_throttle = 0.3;
  quick_.hold_duration = 0.8;
  const PulsePlanner planner(vehicle_, table_, quick_);
  const TransitionPlan up = planner.plan(Mode::FIXED_WING, trial_), back = planner.plan(Mode::QUADROTOR, trial_);
  ASSERT_TRUE(up.accepted) << up.reason;
  EXPECT_EQ(up.pulse.hold_throttle, 0.3);
  EXPECT_EQ(up.pulse.hold_duration, 0.8);
  EXPECT_NEAR(up.pulse.whole(), up.pulse.duration + 0.8, 1e-12);
  ASSERT_TRUE(back.accepted) << back.reason;
  EXPECT_EQ(back.pulse.hold_throttle, 0.0);
  EXPECT_EQ(back.pulse.hold_duration, 0.0);
  // The hold itself decides something: full thrust behind the pulse stretches the arms beyond what is allowed.
  quick_.hold_throttle = 1.0;
  EXPECT_FALSE(PulsePlanner(vehicle_, table_, quick_).plan(Mode::FIXED_WING, trial_).accepted);
}

TEST_F(PlannerTest, SameBitsForAnyNumberOfThreads) {
  quick_.threads = 1;
  const TransitionPlan one = PulsePlanner(vehicle_, table_, quick_).plan(Mode::FIXED_WING, trial_);
  quick_.threads = 3;
  const TransitionPlan three = PulsePlanner(vehicle_, table_, quick_).plan(Mode::FIXED_WING, trial_);
  EXPECT_EQ(one.pulse.throttle, three.pulse.throttle);
  EXPECT_EQ(one.pulse.duration, three.pulse.duration);
  EXPECT_EQ(one.worst_margin, three.worst_margin);
  EXPECT_EQ(one.evaluations, three.evaluations);
  const OutcomeMap a = PulsePlanner(vehicle_, table_, quick_).map(Mode::FIXED_WING, trial_, 5, 4);
  quick_.threads = 1;
  const OutcomeMap b = PulsePlanner(vehicle_, table_, quick_).map(Mode::FIXED_WING, trial_, 5, 4);
  ASSERT_EQ(a.cells.size(), 20u);
  for (std::size_t i = 0; i < a.cells.size(); ++i) EXPECT_EQ(a.cells[i].worst_margin, b.cells[i].worst_margin);
}

TEST_F(PlannerTest, RefusesATargetThatIsTheStart) {
  const TransitionPlan plan = PulsePlanner(vehicle_, table_, quick_).plan(Mode::QUADROTOR, Mode::QUADROTOR, trial_);
  EXPECT_FALSE(plan.accepted);
  EXPECT_NE(plan.reason.find("already"), std::string::npos) << plan.reason;
  EXPECT_EQ(plan.realisations, 0);
}

TEST_F(PlannerTest, RefusesUnknownModes) {
  const PulsePlanner planner(vehicle_, table_, quick_);
  EXPECT_FALSE(planner.plan(Mode::UNKNOWN, Mode::QUADROTOR, trial_).accepted);
  EXPECT_FALSE(planner.plan(Mode::FIXED_WING, Mode::UNKNOWN, trial_).accepted);
}

TEST_F(PlannerTest, RefusesACurveWithoutASecondMode) {
  for (std::size_t i = 0; i < table_.travel.size(); ++i) {
    table_.force[i] = 100.0 * table_.travel[i];
    table_.stiffness[i] = 100.0;
    table_.energy[i] = 50.0 * table_.travel[i] * table_.travel[i];
  }
  const TransitionPlan plan = PulsePlanner(vehicle_, table_, quick_).plan(Mode::FIXED_WING, trial_);
  EXPECT_FALSE(plan.accepted);
  EXPECT_NE(plan.reason.find("bistable"), std::string::npos) << plan.reason;
}

TEST_F(PlannerTest, RefusesWhenTheMotorsAreTooWeak) {
  vehicle_.rotors.max_thrust = {1.0, 0.05};  // 4 N in all: below the arms' peak force
  const TransitionPlan plan = PulsePlanner(vehicle_, table_, quick_).plan(Mode::FIXED_WING, trial_);
  EXPECT_FALSE(plan.accepted);
  EXPECT_EQ(plan.share_switched, 0.0);
  EXPECT_LT(plan.worst_margin, 0.0);
  EXPECT_NE(plan.reason.find("worst margin"), std::string::npos) << plan.reason;
}

TEST_F(PlannerTest, NamesTheParameterThatDefeatsIt) {
  vehicle_.drag.ring_cda = {0.02, 0.0195};  // hardly anything is known of the drag that the way back rests on
  const TransitionPlan plan = PulsePlanner(vehicle_, table_, quick_).plan(Mode::QUADROTOR, trial_);
  EXPECT_FALSE(plan.accepted);
  EXPECT_NE(plan.reason.find("drag.ring_cda low"), std::string::npos) << plan.reason;
  quick_.required_share = 0.5;  // a caller may accept less, knowingly
  const TransitionPlan lenient = PulsePlanner(vehicle_, table_, quick_).plan(Mode::QUADROTOR, trial_);
  EXPECT_TRUE(lenient.accepted) << lenient.reason;
  EXPECT_LT(lenient.share_switched, 1.0);
  EXPECT_GE(lenient.share_switched, 0.5);
  EXPECT_LT(lenient.worst_margin, 0.0);
}

TEST_F(PlannerTest, StopsWhenCancelled) {
  int polls = 0;
  const TransitionPlan plan =
      PulsePlanner(vehicle_, table_, quick_).plan(Mode::FIXED_WING, Mode::QUADROTOR, trial_, [&] {
        return ++polls > 3;
      });
  EXPECT_FALSE(plan.accepted);
  EXPECT_EQ(plan.reason, "cancelled");
}

TEST_F(PlannerTest, MapAgreesWithThePlan) {
  const OutcomeMap map = PulsePlanner(vehicle_, table_, quick_).map(Mode::FIXED_WING, trial_, 10, 6);
  double best = -INFINITY;
  int safe = 0, never = 0;
  for (const OutcomeCell& cell : map.cells) {
    best = std::max(best, cell.worst_margin);
    safe += cell.share == 1.0;
    never += cell.share == 0.0;
    if (cell.worst_margin > 0) {
      EXPECT_EQ(cell.share, 1.0) << cell.throttle << " " << cell.duration;
    }
  }
  EXPECT_GT(best, 0.2);
  EXPECT_GT(safe, 5);
  EXPECT_GT(never, 5);
}

TEST_F(PlannerTest, NamesTheUpperBoundWhereTwoBoundsCross) {
  const auto message = [this](double throttle_max, double duration_max) {
    PlannerSettings bad = quick_;
    bad.throttle_max = throttle_max;
    bad.duration_max = duration_max;
    try {
      bad.validate();
    } catch (const common::Error& e) {
      return std::string(e.what());
    }
    return std::string("taken");
  };
  EXPECT_EQ(message(0.8, 0.0), "planner: duration_max is 0; allowed: above duration_min (0.1 s), up to 10 s");
  EXPECT_EQ(message(0.1, 0.4), "planner: throttle_max is 0.1; allowed: above throttle_min (0.1), up to 1");
  EXPECT_EQ(message(0.8, 0.4), "taken");
}

TEST_F(PlannerTest, RefusesHalfAHold) {
  quick_.hold_duration = 0.5;
  EXPECT_THROW(PulsePlanner(vehicle_, table_, quick_), common::Error);
  quick_.hold_throttle = 0.3;
  EXPECT_NO_THROW(PulsePlanner(vehicle_, table_, quick_));
  quick_.hold_duration = -0.5;
  EXPECT_THROW(PulsePlanner(vehicle_, table_, quick_), common::Error);
}

TEST_F(PlannerTest, RefusesBadSettings) {
  quick_.duration_min = 2.0;
  EXPECT_THROW(PulsePlanner(vehicle_, table_, quick_), common::Error);
  quick_ = PlannerSettings{};
  quick_.required_margin = NAN;
  EXPECT_THROW(PulsePlanner(vehicle_, table_, quick_), common::Error);
  quick_ = PlannerSettings{};
  quick_.threads = 0;
  EXPECT_THROW(PulsePlanner(vehicle_, table_, quick_), common::Error);
}

}  // namespace
}  // namespace snapwing::planning
