// The vehicle in space: the same as along the axis where all is even, momenta, and what propellers and the boom do.
#include <gtest/gtest.h>

#include <cmath>

#include "one_mode.h"
#include "snapwing/common/error.h"
#include "snapwing/motion/axis_trial.h"
#include "snapwing/motion/space_vehicle.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace snapwing::motion {
namespace {

using Eigen::Vector3d;

struct Shipped {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::VehicleParameters parameters = vehicle::realise(vehicle, vehicle::armTableOf(vehicle));
  Shipped() { parameters.ring_drag = parameters.centre_drag = parameters.boom_drag = parameters.boom_friction = 0; }
};

vehicle::Trial trialOn(vehicle::Mount mount) {
  vehicle::Trial trial;
  trial.mount = mount;
  trial.wings = false;
  trial.initial_thrust_fraction = 0.0;
  return trial;
}

/// An arm is 2.5 cells of 4 mm thick: not the same on both sides of its middle, so that arms bend sideways.
AxisSettings cells(double size = 0.004) {
  AxisSettings settings;
  settings.dimension = 3;
  settings.cell_size = size;
  return settings;
}

SpaceVehicle vehicleOf(vehicle::Mount mount, const SpaceSettings& space = {}, double speed = 0) {
  const Shipped s;
  vehicle::Trial trial = trialOn(mount);
  trial.initial_speed = speed;
  return {s.vehicle, s.parameters, trial, cells(), space};
}

/// Steps under steady thrusts of the rotors [N].
MotionState flown(const SpaceVehicle& vehicle, const Stepper& like, MotionState state, double until,
                  const Eigen::VectorXd& thrusts, double h = 1e-3) {
  Stepper stepper(vehicle.problem(), like.scheme(), test::equalSteps(h));
  while (state.time < until) stepper.step(state, until, [&](double, double) { return thrusts; });
  return state;
}

Vector3d angularAbout(const SpaceVehicle& v, const Stepper& stepper, const MotionState& s, const Vector3d& point) {
  return v.angularMomentum(stepper, s) - point.cross(v.linearMomentum(stepper, s));
}

TEST(SpaceVehicle, AnEvenTrialIsThatAlongTheAxis) {
  Shipped s;
  s.parameters = vehicle::realise(s.vehicle, vehicle::armTableOf(s.vehicle));  // with drag
  for (const vehicle::Mount mount : {vehicle::Mount::FREE, vehicle::Mount::HELD}) {
    vehicle::Trial trial = trialOn(mount);
    trial.gravity = 3;
    AxisSettings half = cells(0.0025);
    half.in_space = true;
    const AxisVehicle axis(s.vehicle, s.parameters, trial, half);  // half of the thickness by symmetry
    const SpaceVehicle space(s.vehicle, s.parameters, trial, cells(0.0025), {});
    EXPECT_NEAR(space.armMass(), axis.armMass(), 1e-12);
    Stepper one(axis.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(2e-3)),
        other(space.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(2e-3));
    MotionState a = axis.start(vehicle::Mode::FIXED_WING, 0), b = space.start(vehicle::Mode::FIXED_WING, 0);
    const double thrust = 0.6 * s.parameters.max_thrust;
    double moved = 0;
    for (int k = 1; k <= 8; ++k) {
      const double until = 0.002 * k;
      one.step(a, until, [&](double from, double h) { return axis.controls(from, h, thrust); });
      other.step(b, until, [&](double from, double h) { return space.controls(from, h, thrust); });
      const AxisSample p = axis.sample(a), q = space.sample(b);
      moved = std::max(moved, std::abs(p.travel - axis.sample(axis.start(vehicle::Mode::FIXED_WING, 0)).travel));
      EXPECT_NEAR(q.travel, p.travel, 1e-8) << until;
      EXPECT_NEAR(q.ring_speed, p.ring_speed, 1e-6) << until;
      EXPECT_NEAR(q.arm_rotation, p.arm_rotation, 1e-3 * p.arm_rotation) << "nodes of half an arm weigh otherwise";
      EXPECT_NEAR(q.kinetic + q.stored, p.kinetic + p.stored, 1e-6 * (p.kinetic + p.stored)) << until;
      EXPECT_LT(q.tilt + q.housing_tilt + q.drift, 1e-7) << until;
    }
    EXPECT_GT(moved, mount == vehicle::Mount::FREE ? 2e-3 : 0) << "of the travel";
  }
}

/// Shaken and spun, with the loss of the travel on: both momenta stay.
TEST(SpaceVehicle, FreeItKeepsBothMomenta) {
  const SpaceVehicle v = vehicleOf(vehicle::Mount::FREE);
  Stepper stepper(v.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3, 1e-12));
  MotionState s = v.start(vehicle::Mode::FIXED_WING, 0);
  Eigen::VectorXd rates = v.rigidRates(s.y, Vector3d(0.3, -0.2, 0.1), Vector3d(3, 8, -2));
  rates.segment<3>(rates.size() - 21) += Vector3d(0.1, -0.5, 0.05);  // the housing goes its own way
  // Clamps and axles move with their bodies.
  const auto& linear = v.problem()->coordinates().linear();
  rates = linear.expandDirection(linear.freePart(rates), Eigen::VectorXd::Zero(4));
  s = stepper.start(s.z, Eigen::VectorXd::Zero(4), rates);
  const Vector3d p = v.linearMomentum(stepper, s), l = v.angularMomentum(stepper, s);
  double turned = 0, loss = 0;
  for (int k = 0; k < 40; ++k) {
    loss += stepper.step(s, s.time + 1e-3, [](double, double) { return Eigen::VectorXd::Zero(4); }).loss;
    turned += 1e-3 * v.ringTurning(s).norm();
    EXPECT_LT((v.linearMomentum(stepper, s) - p).norm(), 1e-10 * p.norm()) << k;
    EXPECT_LT((v.angularMomentum(stepper, s) - l).norm(), 1e-10 * l.norm()) << k;
  }
  EXPECT_GT(turned, 0.2);
  EXPECT_GT(loss, 1e-5);
}

TEST(SpaceVehicle, AWeakRotorTiltsItByTheTorqueOfTheOthers) {
  SpaceSettings space;
  space.rotor_scale = {1, 1, 1, 0.9};
  const SpaceVehicle v = vehicleOf(vehicle::Mount::FREE, space);
  const Stepper stepper(v.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3));
  const double time = 0.01, thrust = 16;
  const Eigen::VectorXd each = v.controls(0, 1e-3, thrust);
  EXPECT_NEAR(each(3), 0.9 * each(0), 1e-12);
  const MotionState s = flown(v, stepper, v.start(vehicle::Mode::FIXED_WING, 0), time, each);
  Vector3d torque = Vector3d::Zero();
  for (int rotor = 0; rotor < 4; ++rotor) torque += v.rotorPlace(rotor).cross(Vector3d(0, each(rotor), 0));
  EXPECT_NEAR((v.angularMomentum(stepper, s) - time * torque).norm(), 0, 1e-2 * time * torque.norm());
  EXPECT_NEAR(v.linearMomentum(stepper, s)(1), time * each.sum(), 1e-3 * time * each.sum());
  EXPECT_GT(v.sample(s).tilt, 1e-4);
  // Away from the three that are stronger.
  EXPECT_GT(v.ringTurning(s).dot(torque), 0.9 * v.ringTurning(s).norm() * torque.norm());
}

TEST(SpaceVehicle, PropellersTurnItAndLoseThrustWithSpeed) {
  const double time = 0.005;
  SpaceSettings space;
  space.rotor_scale = {1, 0, 1, 0};
  space.moment_per_thrust = 0.012;
  const SpaceVehicle yawing = vehicleOf(vehicle::Mount::FREE, space);
  const Stepper a(yawing.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3));
  Eigen::VectorXd each = yawing.controls(0, 1e-3, 16);
  const MotionState yawed = flown(yawing, a, yawing.start(vehicle::Mode::FIXED_WING, 0), time, each);
  const double wanted = time * 0.012 * each.sum();
  EXPECT_NEAR(yawing.angularMomentum(a, yawed)(1), wanted, 1e-4 * wanted);

  space = {};
  space.no_thrust_speed = 20;
  const SpaceVehicle fast = vehicleOf(vehicle::Mount::FREE, space, 15);
  const Stepper b(fast.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3));
  const MotionState start = fast.start(vehicle::Mode::FIXED_WING, 0);
  const double full = Shipped().parameters.max_thrust;
  each =
      fast.controls(0, 1e-3, 0.49 * full);  // falls by sqrt(T T_full) v / v_none = .7 * .75 T_full: less than nothing
  const double before = fast.linearMomentum(b, start)(1);
  const MotionState slower = flown(fast, b, start, time, each);
  EXPECT_NEAR(fast.linearMomentum(b, slower)(1) - before, time * (0.49 - 0.7 * 0.75) * full, 0.002 * time * full);
}

/// While the rotors' lag T = T_0 (1 - exp(-t / tau)) lasts the battery takes s T / T_full of it: the momentum is the
/// integral of T - s T^2 / T_full.
TEST(SpaceVehicle, ABatteryThatSagsTakesItsShareOfTheThrust) {
  const double sag = 0.3, tau = 0.02, until = 0.03, asked = 30;
  SpaceSettings space;
  space.sag = sag;
  const SpaceVehicle v = vehicleOf(vehicle::Mount::FREE, space);
  Stepper stepper(v.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3));
  ThrustHistory thrust(0, tau, tau);
  thrust.demand(0, asked);
  MotionState s = v.start(vehicle::Mode::FIXED_WING, 0);
  while (s.time < until) {
    stepper.step(s, until, [&](double from, double h) { return v.controls(from, h, thrust.mean(from, from + h)); });
  }
  const double x = until / tau, full = Shipped().parameters.max_thrust;
  const double once = asked * tau * (x - 1 + std::exp(-x));
  const double squared = asked * asked * tau * (x - 1.5 + 2 * std::exp(-x) - 0.5 * std::exp(-2 * x));
  const double wanted = once - sag * squared / full;
  EXPECT_GT(once - wanted, 0.05 * once) << "the sag counts";
  EXPECT_NEAR(v.linearMomentum(stepper, s)(1), wanted, 5e-4 * wanted);
}

TEST(SpaceVehicle, ABoomTurnsAndItsCentreIsPulledOutwards) {
  const double length = Shipped().vehicle.boom.length.value, speed = 6, time = 0.01;
  const SpaceVehicle v = vehicleOf(vehicle::Mount::BOOM, {}, speed);
  Stepper stepper(v.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3, 1e-12));
  const Vector3d pivot = v.ringCentre() - length * Vector3d::UnitX();
  MotionState s = v.start(vehicle::Mode::FIXED_WING, 0);
  EXPECT_NEAR(v.sample(s).ring_speed, speed, 1e-9);
  const double l = angularAbout(v, stepper, s, pivot)(2);
  const int housing = static_cast<int>(s.y.size()) - 21;
  for (int k = 0; k < 10; ++k) {
    stepper.step(s, s.time + 1e-3, [](double, double) { return Eigen::VectorXd::Zero(4); });
    EXPECT_NEAR(angularAbout(v, stepper, s, pivot)(2), l, 1e-10 * l);
  }
  EXPECT_NEAR(v.sample(s).ring_position, speed * time, 0.02 * speed * time);
  // Seen from the ring the centre moves as under a weight of speed^2 / length outwards.
  const auto outwards = [&](const SpaceVehicle& of, const MotionState& at) {
    const double angle = of.sample(at).ring_position / length;
    const double sine = std::sin(angle), c = std::cos(angle) - 1, above = 0.030 - v.ringCentre()(1);
    const Vector3d carried(length * c - above * sine, length * sine + above * c, 0);  // if it were a part of the ring
    return (at.y.segment<3>(housing) - carried).dot(Vector3d(1 + c, sine, 0));
  };
  SpaceSettings across;
  across.gravity_across = -speed * speed / length;
  const SpaceVehicle held = vehicleOf(vehicle::Mount::HELD, across);
  const Stepper other(held.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3));
  const MotionState pulled =
      flown(held, other, held.start(vehicle::Mode::FIXED_WING, 0), time, Eigen::VectorXd::Zero(4));
  const double wanted = pulled.y(housing);
  EXPECT_GT(wanted, 1e-5);
  // The arms' ends lie 10 % nearer to the pivot or farther from it, and the turning's Coriolis force is small.
  EXPECT_NEAR(outwards(v, s), wanted, 0.1 * wanted);

  // Steady thrust at its tip: T length t of angular momentum.
  const SpaceVehicle pushed = vehicleOf(vehicle::Mount::BOOM);
  const Stepper third(pushed.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3));
  const Eigen::VectorXd each = pushed.controls(0, 1e-3, 10);
  const MotionState turned = flown(pushed, third, pushed.start(vehicle::Mode::FIXED_WING, 0), time, each);
  EXPECT_NEAR(angularAbout(pushed, third, turned, pivot)(2), 10 * length * time, 1e-6 * 10 * length * time);
}

/// A boom goes round more than once in a trial; its angle alone would let the ring jump back by a turn.
TEST(SpaceVehicle, TheRingsWayOnABoomGoesOnOverTurns) {
  const double turn = vehicleOf(vehicle::Mount::BOOM).turnLength();
  EXPECT_NEAR(turn, 2 * EIGEN_PI * Shipped().vehicle.boom.length.value, 1e-12);
  EXPECT_EQ(vehicleOf(vehicle::Mount::FREE).turnLength(), 0);
  double way = 0;
  for (int k = 1; k <= 1000; ++k) {
    const double real = 0.02 * k, seen = std::remainder(real, turn);
    way = onward(way, seen, turn);
    ASSERT_NEAR(way, real, 1e-9);
  }
  EXPECT_EQ(onward(1, -5, 0), -5);
}

TEST(SpaceVehicle, RefusesWhatItHasNot) {
  const Shipped s;
  AxisSettings planar = cells(), lagged = cells(), moved = cells();
  planar.dimension = 2;
  lagged.damping = DampingLaw::RAYLEIGH;
  moved.hand.emplace();
  const vehicle::Trial free = trialOn(vehicle::Mount::FREE), held = trialOn(vehicle::Mount::HELD);
  EXPECT_THROW(SpaceVehicle(s.vehicle, s.parameters, free, planar, {}), common::Error);
  EXPECT_THROW(SpaceVehicle(s.vehicle, s.parameters, free, lagged, {}), common::Error);
  EXPECT_THROW(SpaceVehicle(s.vehicle, s.parameters, held, moved, {}), common::Error);
  SpaceSettings three;
  three.rotor_scale = {1, 1, 1};
  EXPECT_THROW(SpaceVehicle(s.vehicle, s.parameters, free, cells(), three), common::Error);
}

}  // namespace
}  // namespace snapwing::motion
