#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snapwing/planning/accident_margins.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/example_table.h"
#include "support/example_wing.h"
#include "support/paths.h"

namespace snapwing::planning {
namespace {

const AccidentMargin& find(const std::vector<AccidentMargin>& list, const char* name) {
  for (const AccidentMargin& m : list) {
    if (m.name == name) return m;
  }
  throw std::runtime_error(std::string("no margin named ") + name);
}

TEST(AccidentMargins, AgreeWithTheFeasibilityStudy) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const auto list = accidentMargins(vehicle, snapwing::testing::exampleTable());
  // The feasibility study: F survives 8.0 N of sudden thrust (hover needs 7.68), holds 3.9 of 4 N, inverted Q does not
  // hold. Its masses and damping are its own.
  const AccidentMargin& thrust = find(list, "sudden thrust in F");
  EXPECT_NEAR(thrust.limit, 8.0, 0.8);
  EXPECT_NEAR(thrust.occurs, 7.68, 0.01);
  EXPECT_NEAR(find(list, "ring held upright in F").limit, 4.1, 0.05);
  EXPECT_TRUE(find(list, "ring held upright in F").holds);
  EXPECT_FALSE(find(list, "ring held inverted in Q").holds);
  // Below this speed the drag alone never takes Q away; above it the lag of the motors gives some time, in which drag
  // and gravity slow the climb.
  const vehicle::VehicleParameters p = vehicle::realise(vehicle, snapwing::testing::exampleTable());
  const double mass = p.ring_mass * p.centre_mass / (p.ring_mass + p.centre_mass);
  const double per_speed = mass * (p.ring_drag / p.ring_mass - p.centre_drag / p.centre_mass);
  const double still = std::sqrt(2.21 / per_speed);
  const AccidentMargin& climb = find(list, "thrust cut while climbing in Q");
  EXPECT_GT(climb.limit, still);
  EXPECT_LT(climb.limit, 1.5 * still);
  EXPECT_TRUE(find(list, "hover thrust cut in Q").holds);
  EXPECT_NEAR(find(list, "ring braked in Q").limit, 2.21 / p.centre_mass, 0.01);
}

TEST(AccidentMargins, FollowTheForceScale) {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const auto soft = accidentMargins(vehicle, snapwing::testing::exampleTable());
  vehicle.arm.force_scale.value = 2.0;
  const auto stiff = accidentMargins(vehicle, snapwing::testing::exampleTable());
  for (std::size_t i = 0; i < soft.size(); ++i) EXPECT_GE(stiff[i].limit, soft[i].limit) << soft[i].name;
  EXPECT_NEAR(find(stiff, "ring held inverted in Q").limit, 2.0 * find(soft, "ring held inverted in Q").limit, 1e-9);
}

TEST(AccidentMargins, WingsHoldFAgainstAccelerationAndDoLittleToQ) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::ForceTable table = snapwing::testing::exampleTable();
  const std::optional<vehicle::WingTable> wing = snapwing::testing::exampleTableWing(vehicle);
  const auto without = accidentMargins(vehicle, table), with = accidentMargins(vehicle, table, wing);
  EXPECT_GT(find(with, "sudden thrust in F").limit, 1.1 * find(without, "sudden thrust in F").limit);
  // Held upright, the wings' weight pulls the ring side down and the centre up: at the peak S g is carried too.
  const double gain = find(with, "ring held upright in F").limit - find(without, "ring held upright in F").limit;
  EXPECT_GT(gain, 0.5 * 9.81 * wing->coupled_mass.front());
  EXPECT_LT(gain, 9.81 * *std::max_element(wing->coupled_mass.begin(), wing->coupled_mass.end()));
  // In Q they hardly move with u: 0.040 m lies before the valley, where they move more than there.
  EXPECT_NEAR(find(with, "ring held inverted in Q").limit, find(without, "ring held inverted in Q").limit,
              9.81 * wing->at(wing->coupled_mass, 0.040));
}

TEST(AccidentMargins, GustsTakeAModeWhereTheirDragIsTheForceThatTakesIt) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::ForceTable table = snapwing::testing::exampleTable();
  const auto list = accidentMargins(vehicle, table);
  const vehicle::VehicleParameters p = vehicle::realise(vehicle, table);
  // From behind on F, motors at idle: the ring's drag pushes as thrust does. The gust is blown out as the vehicle gives
  // way, so that it may be stronger than a thrust that stays.
  const double pushes = std::sqrt(find(list, "sudden thrust in F").limit / p.ring_drag);
  const AccidentMargin& behind = find(list, "gust from behind in F");
  EXPECT_GT(behind.limit, 0.95 * pushes);
  EXPECT_LT(behind.limit, 1.6 * pushes);
  // On a hovering Q the thrust stays, so that it takes more wind than a climb whose thrust is cut.
  EXPECT_GT(find(list, "gust against the thrust in Q").limit, 10.0);
  for (const char* name : {"gust from behind in F", "gust against the thrust in Q"}) {
    EXPECT_TRUE(std::isnan(find(list, name).occurs)) << name;
  }
}

TEST(FaultMargins, AreWhereThePulseJustSwitches) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  AskedSwitch asked;
  asked.start = vehicle::Mode::FIXED_WING;
  asked.pulse.throttle = 0.577, asked.pulse.duration = 0.180;
  asked.trial.mount = vehicle::Mount::BOOM;
  const auto switches = [&](const char* fault, double share) {
    vehicle::VehicleParameters p = vehicle::realise(vehicle, table);
    if (std::string(fault) == "one weak motor") p.max_thrust *= 1 - share / vehicle.rotors.count;
    if (std::string(fault) == "one stiff arm") p.force_scale *= 1 + share / vehicle.arm.count;
    return rom::LumpedModel::fromVehicle(vehicle, table, p)
        .predict(asked.start, asked.pulse, vehicle.radio, asked.trial)
        .snapped;
  };
  const auto list = faultMargins(vehicle, table, {}, {asked});
  ASSERT_EQ(list.size(), 2U);
  // One motor may be missing here; a pulse that just switches has limits of both.
  EXPECT_TRUE(std::isinf(list[0].limit) && switches("one weak motor", 1));
  AskedSwitch shorter = asked;
  shorter.pulse.duration = 0.07;
  asked = shorter;
  const auto both = faultMargins(vehicle, table, {}, {shorter});
  for (const AccidentMargin& m : both) {
    ASSERT_TRUE(std::isfinite(m.limit)) << m.name;
    EXPECT_TRUE(switches(m.name.c_str(), 0.999 * m.limit)) << m.name;
    EXPECT_FALSE(switches(m.name.c_str(), 1.001 * m.limit + 1e-6)) << m.name;
    EXPECT_EQ(m.mode, vehicle::Mode::FIXED_WING);
    EXPECT_EQ(m.holds, m.occurs < m.limit);
    EXPECT_NE(m.explanation.find("left out"), std::string::npos);
  }
  // Of several switches the one that is lost first counts.
  AskedSwitch longer = asked;
  longer.pulse.duration = 0.180;
  const auto mixed = faultMargins(vehicle, table, {}, {longer, shorter});
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(mixed[i].limit, both[i].limit);
  // A pulse that does not switch at all has no margin, and does not hold.
  shorter.pulse.duration = 0.01;
  for (const AccidentMargin& m : faultMargins(vehicle, table, {}, {shorter})) {
    EXPECT_LT(m.limit, 1e-6) << m.name;
    EXPECT_FALSE(m.holds) << m.name;
  }
}

}  // namespace
}  // namespace snapwing::planning
