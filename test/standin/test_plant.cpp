#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/rom/energy_spline.h"
#include "snapwing/standin/plant.h"
#include "support/example_table.h"
#include "support/example_wing.h"
#include "support/paths.h"

namespace snapwing::standin {
namespace {

using vehicle::Mode;

class PlantTest : public ::testing::Test {
 protected:
  PlantTest()
      : vehicle_(vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml")),
        table_(snapwing::testing::exampleTable()),
        parameters_(vehicle::realise(vehicle_, table_)) {}
  Plant plant(const PlantSettings& settings = {}) const { return Plant(vehicle_, table_, parameters_, settings); }
  static std::vector<double> all(double s) { return {s, s, s, s}; }
  vehicle::Vehicle vehicle_;
  vehicle::ForceTable table_;
  vehicle::VehicleParameters parameters_;
};

TEST_F(PlantTest, RestsInBothModes) {
  for (const Mode mode : {Mode::FIXED_WING, Mode::QUADROTOR}) {
    Plant p = plant();
    p.reset(mode);
    p.advanceTo(2.0);
    EXPECT_EQ(p.mode(), mode);
    EXPECT_NEAR(p.state().ring_speed, 0.0, 1e-6);
    EXPECT_NEAR(p.state().travelRate(), 0.0, 1e-6);
    EXPECT_NEAR(p.centreSpecificForce(), 0.0, 1e-4);
  }
}

TEST_F(PlantTest, LagOfEachRotorIsExponential) {
  Plant p = plant();
  p.reset(Mode::FIXED_WING);
  p.setMotorOutputs({1.0, 0.5, 0.0, 2.0});  // clamped
  p.advanceTo(0.03);
  const double rise = 1.0 - std::exp(-0.03 / parameters_.time_constant_up);
  const double full = parameters_.max_thrust / 4.0, q = parameters_.quadratic_share;
  EXPECT_NEAR(p.state().rotor_thrust[0], full * rise, 1e-12);
  EXPECT_NEAR(p.state().rotor_thrust[1], full * (0.25 * q + 0.5 * (1 - q)) * rise, 1e-12);
  EXPECT_EQ(p.state().rotor_thrust[2], 0.0);
  EXPECT_NEAR(p.state().rotor_thrust[3], full * rise, 1e-12);
}

TEST_F(PlantTest, KeepsMomentumAndEnergyWithoutLosses) {
  parameters_.damping = parameters_.ring_drag = parameters_.centre_drag = 0.0;
  PlantSettings settings;
  settings.mount = vehicle::Mount::FREE;
  Plant p(vehicle_, table_, parameters_, settings);
  p.reset(Mode::FIXED_WING);
  // A kick by a short thrust, then nothing: thrust has died after a second.
  p.setMotorOutputs(all(0.5));
  p.advanceTo(0.05);
  p.setMotorOutputs(all(0.0));
  p.advanceTo(1.5);
  const auto momentum = [&] {
    return parameters_.ring_mass * p.state().ring_speed + parameters_.centre_mass * p.state().centre_speed;
  };
  const double before = momentum();
  double least = INFINITY, most = -INFINITY;
  for (double t = 1.5; t < 4.0; t += 0.001) {
    p.advanceTo(t);
    const double swing = std::abs(p.state().travel());
    least = std::min(least, swing);
    most = std::max(most, swing);
  }
  EXPECT_NEAR(momentum(), before, 1e-6);
  EXPECT_GT(most, 1e-3);
  EXPECT_LT(least, 1e-4);
  double later = 0;
  for (double t = 20.0; t < 22.0; t += 0.001) {
    p.advanceTo(t);
    later = std::max(later, std::abs(p.state().travel()));
  }
  EXPECT_NEAR(later, most, 1e-3 * most);  // the amplitude neither grows nor decays
}

TEST_F(PlantTest, HandBrakesGentlyAndHolds) {
  Plant p = plant();
  p.reset(Mode::QUADROTOR);
  p.setMotorOutputs(all(0.5));
  p.advanceTo(0.4);
  p.setMotorOutputs(all(0.07));
  p.advanceTo(0.8);
  const double speed = p.state().ring_speed;
  ASSERT_GT(speed, 2.0);
  p.grab();
  EXPECT_FALSE(p.atRest());
  double t = 0.8;
  while (!p.atRest() && t < 20.0) {
    p.advanceTo(t += 0.01);
    EXPECT_LE(p.state().ring_speed, speed + 1e-9);
  }
  EXPECT_GT(t - 0.8, 0.5 * speed / 2.5);  // not at once
  EXPECT_LT(t, 10.0);
  EXPECT_EQ(p.mode(), Mode::QUADROTOR);  // gentle enough not to flip it
  const double position = p.state().ring_position;
  p.advanceTo(t + 1.0);
  EXPECT_EQ(p.state().ring_position, position);
  p.release();
  p.advanceTo(t + 2.0);
  EXPECT_GT(p.state().ring_position, position);  // idle thrust moves it again
}

TEST_F(PlantTest, StopsTakeEnergyAndKeepMomentum) {
  vehicle_.limits.travel_max = 0.060;
  parameters_.ring_drag = parameters_.centre_drag = parameters_.boom_drag = parameters_.boom_friction = 0.0;
  Plant p = plant();
  p.reset(Mode::QUADROTOR);
  p.setMotorOutputs(all(1.0));
  double impulse = 0, most = 0;
  for (double t = 0; t < 0.3; t += 1e-4) {
    impulse += 1e-4 * p.state().thrust();
    p.advanceTo(t + 1e-4);
    most = std::max(most, p.state().travel());
  }
  EXPECT_LE(most, 0.060 + 1e-12);
  EXPECT_GT(most, 0.0599);
  const double momentum = (parameters_.ring_mass + parameters_.boom_mass) * p.state().ring_speed +
                          parameters_.centre_mass * p.state().centre_speed;
  EXPECT_NEAR(momentum, impulse, 0.01 * impulse);  // the sum above is a left-hand rule
}

TEST_F(PlantTest, HeldRingFeelsGravityOnly) {
  PlantSettings settings;
  settings.mount = vehicle::Mount::HELD;
  settings.gravity = 5.0;
  Plant p = plant(settings);
  p.reset(Mode::FIXED_WING);
  p.setMotorOutputs(all(1.0));
  p.advanceTo(3.0);
  EXPECT_EQ(p.state().ring_position, 0.0);
  EXPECT_NEAR(p.centreAcceleration(), 0.0, 1e-3);
  EXPECT_NEAR(p.centreSpecificForce(), 5.0, 1e-3);
  EXPECT_TRUE(p.atRest());
}

TEST_F(PlantTest, BadInputIsRefusedOrHarmless) {
  Plant p = plant();
  EXPECT_THROW(p.reset(Mode::UNKNOWN), common::Error);
  EXPECT_THROW(p.setMotorOutputs({1.0}), common::Error);
  p.reset(Mode::FIXED_WING);
  p.setMotorOutputs({NAN, NAN, NAN, NAN});
  p.advanceTo(0.5);
  EXPECT_EQ(p.state().thrust(), 0.0);
  p.advanceTo(0.1);  // the past does nothing
  p.advanceTo(NAN);
  EXPECT_EQ(p.state().time, 0.5);
  PlantSettings settings;
  settings.step = 0.0;
  EXPECT_THROW(plant(settings), common::Error);
}

TEST_F(PlantTest, DrawsAreReproducibleAndDiffer) {
  const vehicle::VehicleParameters a = drawParameters(vehicle_, table_, 5), b = drawParameters(vehicle_, table_, 5);
  const vehicle::VehicleParameters c = drawParameters(vehicle_, table_, 6);
  EXPECT_EQ(a.ring_drag, b.ring_drag);
  EXPECT_NE(a.ring_drag, c.ring_drag);
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const vehicle::VehicleParameters p = drawParameters(vehicle_, table_, seed);
    EXPECT_GE(p.centre_mass, vehicle_.masses.centre.low());
    EXPECT_LE(p.centre_mass, vehicle_.masses.centre.high());
  }
}

/// Arms with mass from so many points that no interpolation is seen.
vehicle::ForceTable fineTableWithMass() {
  namespace ex = snapwing::testing;
  const rom::EnergySpline all(ex::exampleTable());
  vehicle::ForceTable t;
  t.arm_count = 4;
  t.mass = ex::EXAMPLE_ARM_MASS;
  for (int i = -300; i <= 1600; ++i) {
    const double u = 5e-5 * i;
    const rom::PotentialSample s = all.at(u);
    t.travel.push_back(u), t.energy.push_back(s.energy / 4), t.force.push_back(s.force / 4);
    t.stiffness.push_back(s.stiffness / 4), t.rotation.push_back(0), t.min_det_f.push_back(1);
    t.stable.push_back(1), t.iterations.push_back(0);
    t.kinetic_mass.push_back(ex::exampleArmKinetic(u)), t.coupled_mass.push_back(ex::exampleArmCoupled(u));
  }
  return t;
}

TEST_F(PlantTest, KeepsMomentumAndEnergyWithHeavyArmsAndWings) {
  parameters_.damping = parameters_.ring_drag = parameters_.centre_drag = 0.0;
  const vehicle::ForceTable table = fineTableWithMass();
  const vehicle::WingTable wing = snapwing::testing::exampleWing(1.0, 0.0, 8001);  // so fine that straight lines serve
  const rom::EnergySpline arms(table, parameters_.force_scale);
  const double ring = parameters_.ring_mass, centre = parameters_.centre_mass;
  for (const bool wings : {true, false}) {
    PlantSettings settings;
    settings.mount = vehicle::Mount::FREE;
    settings.wings = wings;
    Plant p(vehicle_, table, parameters_, settings, wing);
    p.reset(Mode::FIXED_WING);
    p.setMotorOutputs(all(0.9));
    p.advanceTo(0.16);
    p.setMotorOutputs(all(0.0));
    p.advanceTo(1.5);  // the thrust has died
    const auto coupled = [&](double u) {
      return 4 * snapwing::testing::exampleArmCoupled(u) + (wings ? wing.at(wing.coupled_mass, u) : 0.0);
    };
    const auto kinetic = [&](double u) {
      return 4 * snapwing::testing::exampleArmKinetic(u) + (wings ? wing.at(wing.kinetic_mass, u) : 0.0);
    };
    const auto momentum = [&] {
      const PlantState& s = p.state();
      return ring * s.ring_speed + centre * s.centre_speed + coupled(s.travel()) * s.travelRate();
    };
    const auto energy = [&] {
      const PlantState& s = p.state();
      const double v = s.ring_speed, w = s.travelRate(), u = s.travel();
      return 0.5 * ring * v * v + 0.5 * centre * s.centre_speed * s.centre_speed + coupled(u) * v * w +
             0.5 * kinetic(u) * w * w + arms.energy(u);
    };
    const double momentum0 = momentum(), energy0 = energy();
    double most = -INFINITY, least = INFINITY, drift = 0;
    for (double t = 1.5; t < 4.0; t += 0.001) {
      p.advanceTo(t);
      most = std::max(most, p.state().travel());
      least = std::min(least, p.state().travel());
      drift = std::max(drift, std::abs(energy() - energy0));
    }
    EXPECT_NEAR(momentum(), momentum0, 1e-6) << wings;
    EXPECT_GT(most - least, 0.01);
    EXPECT_LT(drift, 1e-4) << wings;  // of 15 J; the plant's cubic force and this quintic energy differ a little
  }
}

TEST_F(PlantTest, RingInTheHandCarriesTheWeightOfArmsAndWings) {
  const vehicle::ForceTable table = snapwing::testing::exampleTableWithMass();
  const vehicle::WingTable wing = snapwing::testing::exampleWing();
  PlantSettings settings;
  settings.mount = vehicle::Mount::HELD;
  settings.gravity = 5.0;
  Plant p(vehicle_, table, parameters_, settings, wing);
  p.reset(Mode::FIXED_WING);
  p.advanceTo(10.0);
  // The centre's weight and that of the arms' share, less what the wings' weight pulls back, is what the arms carry.
  const double u = p.state().travel(), arms = 4 * snapwing::testing::exampleArmCoupled(u);
  const double pull = 5.0 * (parameters_.centre_mass - arms - wing.at(wing.coupled_mass, u));
  EXPECT_NEAR(p.centreSpecificForce(), 5.0, 1e-6);
  EXPECT_NEAR(rom::EnergySpline(table, parameters_.force_scale).at(u).force, pull, 2e-4);
}

TEST_F(PlantTest, WingsOnABoomOrWithoutATableAreRefused) {
  PlantSettings settings;
  settings.wings = true;
  settings.mount = vehicle::Mount::BOOM;
  EXPECT_THROW(Plant(vehicle_, table_, parameters_, settings, snapwing::testing::exampleWing()), common::Error);
  settings.mount = vehicle::Mount::FREE;
  EXPECT_THROW(Plant(vehicle_, table_, parameters_, settings), common::Error);
  vehicle::WingTable bare = snapwing::testing::exampleWing();
  bare.coupled_mass.clear();
  EXPECT_THROW(Plant(vehicle_, table_, parameters_, settings, bare), common::Error);
}

}  // namespace
}  // namespace snapwing::standin
