// The lumped model with arms that have mass, and wings: invariants, limits, and Lagrange's equations integrated by
// another method.
#include <gtest/gtest.h>

#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>

#include "plain_vehicle.h"
#include "snapwing/common/error.h"
#include "snapwing/rom/energy_spline.h"
#include "snapwing/rom/lumped_model.h"
#include "support/example_table.h"
#include "support/example_wing.h"

namespace snapwing::rom {
namespace {

using testing::inMotion;
using testing::plainParameters;

/// Arms that have mass, from a table with a point every quarter of a millimetre: its forces do not matter here.
std::shared_ptr<const TravelInertia> heavyArms() {
  vehicle::ForceTable table;
  table.arm_count = 4;
  table.mass = snapwing::testing::EXAMPLE_ARM_MASS;
  for (int i = -60; i <= 320; ++i) {
    table.travel.push_back(0.25e-3 * i);
    table.kinetic_mass.push_back(snapwing::testing::exampleArmKinetic(table.travel.back()));
    table.coupled_mass.push_back(snapwing::testing::exampleArmCoupled(table.travel.back()));
  }
  const std::size_t n = table.travel.size();
  for (auto* column : {&table.force, &table.stiffness, &table.energy, &table.rotation, &table.min_det_f}) {
    column->assign(n, 0.0);
  }
  table.stable.assign(n, 1);
  table.iterations.assign(n, 0);
  return std::make_shared<TravelInertia>(table);
}

LumpedModel winged(const vehicle::VehicleParameters& p, const vehicle::WingTable& wing,
                   std::shared_ptr<const TravelInertia> arms = heavyArms()) {
  return LumpedModel(std::make_shared<EnergySpline>(snapwing::testing::exampleTable()), p, 0.0, LumpedSettings{},
                     std::make_shared<TravelInertia>(wing, p.wing_inertia, p.wing_friction), std::move(arms));
}

LumpedModel wingless(const vehicle::VehicleParameters& p) {
  return LumpedModel(std::make_shared<EnergySpline>(snapwing::testing::exampleTable()), p, 0.0, LumpedSettings{},
                     nullptr, heavyArms());
}

TEST(TravelInertia, InterpolatesWithinItsTableAndIsTheSlopeOfItsMoment) {
  const TravelInertia wing(snapwing::testing::exampleWing(), 2.0, 0.5);
  for (double u = -0.01; u < 0.09; u += 0.00037) {
    const InertiaSample s = wing.at(u);
    const double inside = std::min(std::max(u, 0.0), 0.08);
    // Flat at the knot next to an extremum: h^2 / 8 of the largest curvature there.
    EXPECT_NEAR(s.kinetic_mass, 2 * snapwing::testing::exampleWingKinetic(inside), 4.7e-4);
    EXPECT_NEAR(s.coupled_mass, 2 * snapwing::testing::exampleWingCoupled(inside), 7.8e-5);
    double worst_k = INFINITY, worst_s = INFINITY, worst_h = INFINITY;
    for (const double h : {1e-5, 1e-6, 1e-7}) {
      const InertiaSample a = wing.at(u - h), b = wing.at(u + h);
      worst_k = std::min(worst_k, std::abs((b.kinetic_mass - a.kinetic_mass) / (2 * h) - s.kinetic_slope));
      worst_s = std::min(worst_s, std::abs((b.coupled_mass - a.coupled_mass) / (2 * h) - s.coupled_slope));
      worst_h = std::min(worst_h, std::abs((b.mass_moment - a.mass_moment) / (2 * h) - s.coupled_mass));
    }
    EXPECT_LT(worst_k, 2e-5 * 187) << u;  // of the largest slope, 187 kg/m
    EXPECT_LT(worst_s, 2e-5 * 31) << u;
    EXPECT_LT(worst_h, 1e-8) << u;
  }
}

TEST(TravelInertia, RefusesATableWithoutABladeAndBadScales) {
  vehicle::WingTable bare = snapwing::testing::exampleWing();
  bare.kinetic_mass.clear();
  EXPECT_THROW(TravelInertia{bare}, common::Error);
  vehicle::WingTable negative = snapwing::testing::exampleWing();
  negative.kinetic_mass[3] = -1e-3;
  EXPECT_THROW(TravelInertia{negative}, common::Error);
  EXPECT_THROW(TravelInertia(snapwing::testing::exampleWing(), 0.0, 1.0), common::Error);
  EXPECT_THROW(TravelInertia(snapwing::testing::exampleWing(), 1.0, -0.1), common::Error);
}

TEST(TravelInertia, OfArmsIsThatOfAllAndAddsToTheWings) {
  namespace ex = snapwing::testing;
  const TravelInertia arms = *heavyArms(), wings(ex::exampleWing(), 2.0, 0.5), both = arms + wings;
  for (double u = -0.02; u < 0.09; u += 0.00041) {
    const double inside = std::min(std::max(u, -0.015), 0.08);
    const InertiaSample a = arms.at(u), w = wings.at(u), sum = both.at(u);
    // Flat at the extremum and at both ends, where the constant goes on.
    EXPECT_NEAR(a.kinetic_mass, 4 * ex::exampleArmKinetic(inside), 3e-5);
    EXPECT_NEAR(a.coupled_mass, 4 * ex::exampleArmCoupled(inside), 3e-5);
    EXPECT_EQ(sum.kinetic_mass, a.kinetic_mass + w.kinetic_mass);
    EXPECT_EQ(sum.coupled_slope, a.coupled_slope + w.coupled_slope);
    EXPECT_EQ(sum.mass_moment, a.mass_moment + w.mass_moment);
    EXPECT_EQ(sum.friction, w.friction);
    const double h = 1e-6;
    EXPECT_NEAR((arms.at(u + h).mass_moment - arms.at(u - h).mass_moment) / (2 * h), a.coupled_mass, 1e-8) << u;
    EXPECT_NEAR((arms.at(u + h).kinetic_mass - arms.at(u - h).kinetic_mass) / (2 * h), a.kinetic_slope, 1e-2) << u;
  }
  EXPECT_LT(arms.at(0.012).coupled_mass, -0.04);  // with the centre: 94 % of 44 g
}

TEST(Winged, KeepsEnergyAndMomentumWithoutLoadsAndLosses) {
  testing::expectInvariantsKept(winged(plainParameters(), snapwing::testing::exampleWing()));
  testing::expectInvariantsKept(wingless(plainParameters()));
}

TEST(Winged, KeepsEnergyWithTheRingHeldAgainstGravity) {
  const LumpedModel model = winged(plainParameters(), snapwing::testing::exampleWing());
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::HELD;
  trial.gravity = 9.81;
  LumpedState state;
  state.travel = 0.020;
  state.centre_speed = -0.5;
  const TravelInertia moved = *heavyArms() + TravelInertia(snapwing::testing::exampleWing());
  const auto energy = [&](const LumpedState& s) {
    return model.relativeEnergy(s, trial) - 9.81 * (0.40 * s.travel - moved.at(s.travel).mass_moment);
  };
  const double before = energy(state);
  for (int i = 0; i < 20000; ++i) {
    state = model.step(state, 0.0, 1e-3, trial);
    ASSERT_NEAR(energy(state), before, 1e-10);
  }
}

TEST(Winged, RunsBackwardsTheWayItCame) {
  const LumpedModel model = winged(plainParameters(), snapwing::testing::exampleWing());
  LumpedState state = inMotion();
  const LumpedState begin = state;
  for (int i = 0; i < 300; ++i) state = model.step(state, 0.0, 1e-3, vehicle::Trial{});
  state.ring_speed = -state.ring_speed;
  state.centre_speed = -state.centre_speed;
  for (int i = 0; i < 300; ++i) state = model.step(state, 0.0, 1e-3, vehicle::Trial{});
  EXPECT_NEAR(state.travel, begin.travel, 1e-9);
  EXPECT_NEAR(state.ring_speed, -begin.ring_speed, 1e-7);
}

TEST(Winged, SecondOrderInTime) {
  vehicle::VehicleParameters p = plainParameters();
  p.damping = 3.0;
  p.ring_drag = 0.02;
  p.centre_drag = 0.005;
  const auto travelAfter = [&](int count) {
    const LumpedModel model = winged(p, snapwing::testing::exampleWing(1.0, 0.05));
    LumpedState state;
    state.travel = 0.002;
    for (int i = 0; i < count; ++i) state = model.step(state, 0.4, 0.12 / count, vehicle::Trial{});
    return state.travel;
  };
  const double exact = travelAfter(25600);
  const double coarse = std::abs(travelAfter(200) - exact), fine = std::abs(travelAfter(400) - exact);
  EXPECT_GT(coarse, 1e-9);
  EXPECT_NEAR(coarse / fine, 4.0, 0.6);
}

TEST(Winged, WithoutAnyMassIsThePlainModel) {
  vehicle::VehicleParameters p = plainParameters();
  p.damping = 3.0;
  p.ring_drag = 0.02;
  p.centre_drag = 0.005;
  const LumpedModel weightless = winged(p, snapwing::testing::exampleWing(0.0), nullptr);
  vehicle::Trial with, without;
  without.wings = false;
  with.gravity = without.gravity = 9.81;
  for (const vehicle::Mount mount : {vehicle::Mount::FREE, vehicle::Mount::HELD}) {
    with.mount = without.mount = mount;
    LumpedState a = inMotion(), b = inMotion();
    if (mount == vehicle::Mount::HELD) a.ring_speed = b.ring_speed = 0.0;
    for (int i = 0; i < 400; ++i) {
      a = weightless.step(a, 0.3, 1e-3, with);
      b = weightless.step(b, 0.3, 1e-3, without);
    }
    EXPECT_NEAR(a.travel, b.travel, 1e-10);
    EXPECT_NEAR(a.ring_speed, b.ring_speed, 1e-9);
    EXPECT_NEAR(a.position, b.position, 1e-9);
    EXPECT_NEAR(weightless.centreSpecificForce(a, with), weightless.centreSpecificForce(a, without), 1e-9);
    EXPECT_NEAR(weightless.relativeMass(with, 0.01), weightless.relativeMass(without, 0.01), 1e-15);
  }
}

/// Lagrange's equations in ring position and travel, written down anew, without the reduction to one coordinate.
struct Lagrange {
  vehicle::VehicleParameters p;
  double gravity = 0, friction = 0, thrust = 0, width = 0.02, wings = 1;
  EnergySpline arms{snapwing::testing::exampleTable()};
  using State = std::array<double, 4>;  // z, u, z', u'
  std::array<double, 2> accelerations(const State& x) const {
    namespace ex = snapwing::testing;
    const double u = x[1], v = x[2], w = x[3], h = 1e-6;
    const auto kinetic = [&](double at) { return 4 * ex::exampleArmKinetic(at) + wings * ex::exampleWingKinetic(at); };
    const auto coupled = [&](double at) { return 4 * ex::exampleArmCoupled(at) + wings * ex::exampleWingCoupled(at); };
    const double k = kinetic(u), s = coupled(u);
    const double dk = (kinetic(u + h) - kinetic(u - h)) / (2 * h), ds = (coupled(u + h) - coupled(u - h)) / (2 * h);
    const double centre_drag = p.centre_drag * std::abs(v - w) * (v - w);
    const double all = p.ring_mass + p.centre_mass;
    const double f1 = thrust - p.ring_drag * std::abs(v) * v - centre_drag - all * gravity - ds * w * w;
    const double f2 = -arms.at(u).force - p.damping * w - friction * w / std::sqrt(w * w + width * width) +
                      centre_drag + (p.centre_mass - s) * gravity - 0.5 * dk * w * w;
    const double m12 = s - p.centre_mass, m22 = p.centre_mass + k, det = all * m22 - m12 * m12;
    return {(m22 * f1 - m12 * f2) / det, (all * f2 - m12 * f1) / det};
  }
  void operator()(const State& x, State& rate, double) const {
    const auto a = accelerations(x);
    rate = {x[2], x[3], a[0], a[1]};
  }
};

/// Follows the model and Lagrange's equations side by side. @param travel  how close [m]
void expectLagrange(const Lagrange& truth, const LumpedModel& model, double travel) {
  const double demand = truth.thrust / truth.p.max_thrust;
  vehicle::Trial trial;
  trial.gravity = truth.gravity;
  LumpedState state;
  state.travel = 0.001;
  state.thrust = truth.thrust;
  Lagrange::State x = {0.0, 0.001, 0.0, 0.0};
  namespace odeint = boost::numeric::odeint;
  auto stepper = odeint::make_controlled<odeint::runge_kutta_dopri5<Lagrange::State>>(1e-12, 1e-12);
  double largest = 0;
  for (int i = 0; i < 150; ++i) {
    odeint::integrate_adaptive(stepper, std::cref(truth), x, 1e-3 * i, 1e-3 * (i + 1), 1e-5);
    for (int k = 0; k < 20; ++k) state = model.step(state, demand, 5e-5, trial);
    ASSERT_NEAR(state.travel, x[1], travel) << i;
    ASSERT_NEAR(state.position, x[0], travel) << i;
    ASSERT_NEAR(state.ring_speed, x[2], 100 * travel) << i;
    const auto a = truth.accelerations({state.position, state.travel, state.ring_speed, state.travelRate()});
    ASSERT_NEAR(model.centreSpecificForce(state, trial), a[0] - a[1] + truth.gravity, 0.02) << i;
    largest = std::max(largest, state.travel);
  }
  EXPECT_GT(largest, 0.03);  // over the hump and the barrier
}

TEST(Winged, AgreesWithLagrangesEquationsInTwoCoordinates) {
  Lagrange truth;
  truth.p = plainParameters();
  truth.p.damping = 3.0;
  truth.p.ring_drag = 0.02;
  truth.p.centre_drag = 0.005;
  truth.gravity = 9.81;
  truth.friction = 0.05;
  truth.thrust = 20.0;
  expectLagrange(truth, winged(truth.p, snapwing::testing::exampleWing(1.0, 0.05, 1281)), 1e-6);
  truth.wings = truth.friction = 0;
  expectLagrange(truth, wingless(truth.p), 1e-6);
}

TEST(Winged, ActWhereTheTrialSaysSo) {
  const LumpedModel with = winged(plainParameters(), snapwing::testing::exampleWing());
  const LumpedModel without(std::make_shared<EnergySpline>(snapwing::testing::exampleTable()), plainParameters(), 0.0);
  vehicle::Trial trial;
  EXPECT_TRUE(with.wingsAct(trial));
  EXPECT_FALSE(without.wingsAct(trial));
  EXPECT_EQ(without.inertiaOf(trial), nullptr);
  trial.wings = false;
  EXPECT_FALSE(with.wingsAct(trial));
  EXPECT_NE(with.inertiaOf(trial), nullptr);  // the arms
  trial.wings = true;
  EXPECT_THROW(without.inertiaOf(trial), common::Error);
  trial.mount = vehicle::Mount::BOOM;
  EXPECT_THROW(trial.validate(), common::Error);
  trial.wings.reset();
  EXPECT_FALSE(with.wingsAct(trial));
  EXPECT_EQ(vehicle::wingsName(vehicle::wingsFromName("auto")), "auto");
  EXPECT_EQ(vehicle::wingsName(vehicle::wingsFromName("on")), "on");
  EXPECT_THROW(vehicle::wingsFromName("yes"), common::Error);
}

TEST(WingedBasins, LieWhereTheLoadedForceVanishes) {
  const EnergySpline arms(snapwing::testing::exampleTable());
  const TravelInertia moved = *heavyArms() + TravelInertia(snapwing::testing::exampleWing());
  const LoadedBasins basins(arms, &moved);
  for (const double specific_force : {-9.81, 0.0, 9.81, 30.0}) {
    for (const double force : {-1.0, 0.5, 2.0, 4.0}) {
      const RelativeLoad load{force, specific_force};
      const auto balance = [&](double u) {
        return arms.at(u).force + specific_force * moved.at(u).coupled_mass - force;
      };
      const LoadedBarrier barrier = basins.barrierUnder(load);
      double f = 0, q = 0;
      ASSERT_TRUE(basins.equilibrium(vehicle::Mode::QUADROTOR, load, &q));
      EXPECT_NEAR(balance(q), 0.0, 1e-9);
      ASSERT_EQ(basins.equilibrium(vehicle::Mode::FIXED_WING, load, &f), barrier.exists);
      EXPECT_EQ(force < basins.limit(vehicle::Mode::FIXED_WING, specific_force), barrier.exists);
      if (!barrier.exists) {
        EXPECT_GT(barrier.excess, 0.0);
        continue;
      }
      EXPECT_NEAR(balance(f), 0.0, 1e-9);
      EXPECT_NEAR(balance(barrier.travel), 0.0, 1e-9);
      EXPECT_LT(f, barrier.travel);
      EXPECT_LT(barrier.travel, q);
      EXPECT_GT(balance(barrier.travel - 1e-4), 0.0);  // falls through zero
      EXPECT_EQ(barrier.sideOf(barrier.travel - 1e-6), vehicle::Mode::FIXED_WING);
      EXPECT_EQ(barrier.sideOf(barrier.travel + 1e-6), vehicle::Mode::QUADROTOR);
      EXPECT_NEAR(basins.barrierUnder(load, barrier.travel + 1e-3).travel, barrier.travel, 1e-12);
    }
  }
}

}  // namespace
}  // namespace snapwing::rom
