// Wings whose bars turn in space with a free ring: the vehicle in free flight.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "one_mode.h"
#include "ring_with_linkage.h"
#include "snapwing/common/error.h"
#include "snapwing/motion/space_vehicle.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace snapwing::motion {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::RingWithLinkage;

/// Without drag and friction.
struct Smooth {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  vehicle::WingTable wing = *vehicle::wingTableOf(vehicle, table);
  vehicle::VehicleParameters parameters = vehicle::realise(vehicle, table);
  Smooth() {
    parameters.ring_drag = parameters.centre_drag = 0;
    parameters.wing_friction = 0;
  }
  vehicle::Trial trial(bool wings = true) const {
    vehicle::Trial out;
    out.mount = vehicle::Mount::FREE;
    out.wings = wings;
    out.initial_thrust_fraction = 0.0;
    return out;
  }
  SpaceVehicle inSpace(const AxisSettings& settings, const SpaceSettings& space = {}, bool wings = true) const {
    return {vehicle, parameters, trial(wings), settings, space, wing};
  }
};

AxisSettings cells(double size = 0.004) {
  AxisSettings settings;
  settings.dimension = 3;
  settings.cell_size = size;
  settings.wing_stop = 0;
  return settings;
}

Stepper stepperOf(const TrialVehicle& v, double h, double tolerance = 1e-9) {
  return {v.problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(h, tolerance)};
}

/// Steps of h under a steady thrust. @return what the scheme fed or ate [J]
double run(const TrialVehicle& v, Stepper& stepper, MotionState& s, double until, double h, double thrust) {
  double imbalance = 0;
  while (s.time < until - 1e-9) {
    imbalance +=
        stepper.step(s, s.time + h, [&](double from, double length) { return v.controls(from, length, thrust); })
            .imbalance;
  }
  return imbalance;
}

/// Angle by which the thrust axis has tilted about z of the world, towards -x if positive [rad].
double rolled(const SpaceVehicle& v, const MotionState& s) {
  const Vector3d up = v.ringOrientation(s).col(1);
  return std::atan2(-up(0), up(1));
}

/// In a trial where all is even the bars, free to turn in space, find their plane themselves. The model along the axis
/// has half an arm, whose nodes weigh otherwise in the hub: the wings are its to 2 %. Those in the plane of a boom of
/// 1000 km are on whole arms, and their bars turn about one axis.
TEST(WingsInSpace, AnEvenTrialIsThatAlongTheAxisAndThatOfWingsInAPlane) {
  Smooth smooth;
  smooth.parameters = vehicle::realise(smooth.vehicle, smooth.table);  // with drag and friction
  smooth.parameters.boom_mass = smooth.parameters.boom_drag = smooth.parameters.boom_friction = 0;
  AxisSettings along = cells(0.0025);
  along.in_space = true;
  vehicle::Vehicle far = smooth.vehicle;
  far.boom.length.value = 1e6;
  vehicle::Trial boom = smooth.trial();
  boom.mount = vehicle::Mount::BOOM;
  const AxisVehicle axis(smooth.vehicle, smooth.parameters, smooth.trial(), along, smooth.wing);
  const SpaceVehicle plane(far, smooth.parameters, boom, cells(0.0025), {}, smooth.wing);
  const SpaceVehicle space = smooth.inSpace(cells(0.0025));
  EXPECT_NEAR(space.mass(), smooth.parameters.ring_mass + smooth.parameters.centre_mass, 1e-12);
  std::vector<const TrialVehicle*> vehicles{&axis, &plane, &space};
  std::vector<MotionState> states;
  std::vector<std::unique_ptr<Stepper>> steppers;
  for (const TrialVehicle* v : vehicles) {
    states.push_back(v->start(vehicle::Mode::FIXED_WING, 0));
    steppers.push_back(std::make_unique<Stepper>(v->problem(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3)));
  }
  for (int k = 1; k <= 15; ++k) {
    std::vector<AxisSample> at;
    std::vector<double> energy;
    for (std::size_t n = 0; n < vehicles.size(); ++n) {
      run(*vehicles[n], *steppers[n], states[n], 0.001 * k, 1e-3, 0.6 * smooth.parameters.max_thrust);
      at.push_back(vehicles[n]->sample(states[n]));
      energy.push_back((states[n].kinetic + states[n].stored) / vehicles[n]->shareOfVehicle());
    }
    for (int n = 0; n < 2; ++n) {
      const bool whole = n == 1;
      const double e = energy[n];
      EXPECT_NEAR(at[2].travel, at[n].travel, whole ? 1e-9 : 5e-6) << k;
      EXPECT_NEAR(at[2].ring_speed, at[n].ring_speed, whole ? 1e-7 : 5e-4) << k;
      EXPECT_NEAR(at[2].wing_left, at[n].wing_left, whole ? 1e-7 : 2e-2 * std::abs(at[n].wing_left)) << k;
      EXPECT_NEAR(energy[2], e, (whole ? 1e-7 : 5e-4) * e) << k;
    }
    EXPECT_NEAR(at[2].wing_left, at[2].wing_right, 1e-6) << k;
    EXPECT_LT(at[2].tilt + at[2].housing_tilt + at[2].drift, 1e-7) << k;
    EXPECT_GT(std::abs(at[2].wing_left), 3e-4 * k * k) << "they move";
  }
}

/// Spun and shaken.
MotionState tumbling(const SpaceVehicle& v, const Stepper& stepper) {
  const MotionState rest = v.start(vehicle::Mode::FIXED_WING, 0);
  VectorXd rates = v.rigidRates(rest.y, Vector3d(0.3, -0.2, 0.1), Vector3d(3, 8, -2));
  const int housing = static_cast<int>(rates.size()) - 21 - 6 * 12;
  rates.segment<3>(housing) += Vector3d(0.1, -0.5, 0.05);
  const auto& linear = v.problem()->coordinates().linear();  // clamps and axles move with their bodies
  rates = linear.expandDirection(linear.freePart(rates), VectorXd::Zero(4));
  return stepper.start(rest.z, VectorXd::Zero(4), rates);
}

/// With the loss of the travel, the friction of the pins, air and a bias of the fold, which act within the vehicle.
TEST(WingsInSpace, FreeFlightKeepsBothMomenta) {
  Smooth smooth;
  smooth.parameters.wing_friction = 1;
  AxisSettings settings = cells();
  settings.wing_forces.air = 1e-6;
  settings.wing_forces.fold_bias = 1e-3;
  const SpaceVehicle v = smooth.inSpace(settings);
  Stepper stepper = stepperOf(v, 1e-3, 1e-12);
  MotionState s = tumbling(v, stepper);
  const Vector3d p = v.linearMomentum(stepper, s), l = v.angularMomentum(stepper, s);
  const AxisSample first = v.sample(s);
  double turned = 0, loss = 0;
  for (int k = 0; k < 25; ++k) {
    loss += stepper.step(s, s.time + 1e-3, [](double, double) { return VectorXd::Zero(4); }).loss;
    turned += 1e-3 * v.ringTurning(s).norm();
    EXPECT_LT((v.linearMomentum(stepper, s) - p).norm(), 1e-10 * p.norm()) << k;
    EXPECT_LT((v.angularMomentum(stepper, s) - l).norm(), 1e-10 * l.norm()) << k;
  }
  EXPECT_GT(turned, 0.15);
  EXPECT_GT(std::abs(v.sample(s).wing_left - first.wing_left), 0.02);
  EXPECT_GT(loss, 1e-5);
}

/// The damping of the material takes the stress at the end of a step. Its moment about the middle is not zero, and
/// falls at least with the step's square, with wings or without.
TEST(WingsInSpace, DampingOfTheMaterialKeepsTheLinearMomentum) {
  const Smooth smooth;
  AxisSettings settings = cells();
  settings.damping = DampingLaw::KELVIN_VOIGT;
  std::array<std::array<double, 2>, 2> off{};
  for (const bool wings : {false, true}) {
    const SpaceVehicle v = smooth.inSpace(settings, {}, wings);
    const MotionState rest = v.start(vehicle::Mode::FIXED_WING, 0);
    for (int k = 0; k < 2; ++k) {
      const double h = k == 0 ? 1e-3 : 5e-4;
      Stepper stepper = stepperOf(v, h, 1e-12);
      MotionState s =
          stepper.start(rest.z, VectorXd::Zero(4), v.rigidRates(rest.y, Vector3d(0.3, -0.2, 0.1), Vector3d(3, 8, -2)));
      const Vector3d p = v.linearMomentum(stepper, s), l = v.angularMomentum(stepper, s);
      run(v, stepper, s, 0.01, h, 0);
      EXPECT_LT((v.linearMomentum(stepper, s) - p).norm(), 1e-10 * p.norm());
      off[wings ? 1 : 0][k] = (v.angularMomentum(stepper, s) - l).norm() / l.norm();
    }
  }
  for (const auto& [coarse, fine] : off) EXPECT_LT(fine, coarse / 3);
  EXPECT_LT(off[1][1], 1e-5);
  EXPECT_LT(off[1][1], 2 * off[0][1]) << "the wings add none";
}

/// Elimination may keep the bars' places and not the ring's: a start with turned bars must name both.
TEST(WingsInSpace, InQTheyRestFolded) {
  const Smooth smooth;
  const SpaceVehicle v = smooth.inSpace(cells());
  Stepper stepper = stepperOf(v, 1e-3);
  MotionState s = v.start(vehicle::Mode::QUADROTOR, 0);
  const AxisSample start = v.sample(s);
  EXPECT_LT(std::abs(start.ring_position) + start.drift + start.centre_off, 1e-12);
  EXPECT_GT(start.wing_left, 1.5);
  EXPECT_NEAR(start.wing_left, start.wing_right, 1e-12);
  run(v, stepper, s, 0.004, 1e-3, 0);
  const AxisSample end = v.sample(s);
  EXPECT_NEAR(end.travel, start.travel, 1e-6);
  EXPECT_NEAR(end.wing_left, start.wing_left, 1e-4);
  EXPECT_LT(end.hub_twist, 1e-3);
}

/// Spun as a whole: a kick of the housing makes light cells shake, which steps of 1 ms do not follow.
TEST(WingsInSpace, TheirAccountClosesWithTheStepsSquare) {
  const Smooth smooth;
  const SpaceVehicle v = smooth.inSpace(cells());
  const MotionState rest = v.start(vehicle::Mode::FIXED_WING, 0);
  std::array<double, 2> fed{};
  for (int k = 0; k < 2; ++k) {
    const double h = k == 0 ? 1e-3 : 5e-4;
    Stepper stepper = stepperOf(v, h, 1e-12);
    MotionState s =
        stepper.start(rest.z, VectorXd::Zero(4), v.rigidRates(rest.y, Vector3d(0.3, -0.2, 0.1), Vector3d(3, 8, -2)));
    fed[k] = std::abs(run(v, stepper, s, 0.016, h, 10));
  }
  EXPECT_LT(fed[1], 2e-6);
  EXPECT_NEAR(std::log2(fed[0] / fed[1]), 2, 0.2) << fed[0] << " " << fed[1];
}

/// What wings of a millionth of their mass change is some millionths. What their bars store does not fall with it.
TEST(WingsInSpace, WithNoMassTheyAreNotThere) {
  Smooth smooth;
  smooth.parameters.wing_inertia = 1e-6;
  SpaceSettings uneven;
  uneven.rotor_scale = {1, 1, 1, 0.7};
  const SpaceVehicle light = smooth.inSpace(cells(), uneven), bare = smooth.inSpace(cells(), uneven, false);
  EXPECT_NEAR(light.mass(), bare.mass(), 1e-6 * bare.mass());
  Stepper one = stepperOf(light, 1e-3), other = stepperOf(bare, 1e-3);
  MotionState a = light.start(vehicle::Mode::FIXED_WING, 0), b = bare.start(vehicle::Mode::FIXED_WING, 0);
  run(light, one, a, 0.012, 1e-3, 15);
  run(bare, other, b, 0.012, 1e-3, 15);
  const AxisSample p = light.sample(a), q = bare.sample(b);
  EXPECT_GT(q.tilt, 1e-3);
  EXPECT_NEAR(p.travel, q.travel, 1e-8);
  EXPECT_NEAR(p.ring_speed, q.ring_speed, 3e-6 * q.ring_speed);
  EXPECT_NEAR(p.tilt, q.tilt, 3e-6 * q.tilt);
  EXPECT_NEAR(p.turn_rate, q.turn_rate, 3e-6 * q.turn_rate);
  EXPECT_TRUE(std::isfinite(p.wing_left) && std::isnan(q.wing_left));
}

/// The momenta are those of the rotors' thrusts and torques, whatever the wings do.
TEST(WingsInSpace, AWeakRotorTiltsTheWingedVehicleByTheTorqueOfTheOthers) {
  const Smooth smooth;
  SpaceSettings space;
  space.rotor_scale = {1, 1, 1, 0.7};
  const SpaceVehicle v = smooth.inSpace(cells(), space);
  Stepper stepper = stepperOf(v, 1e-3);
  MotionState s = v.start(vehicle::Mode::FIXED_WING, 0);
  const double time = 0.012, thrust = 16;
  run(v, stepper, s, time, 1e-3, thrust);
  const VectorXd each = v.controls(0, 1e-3, thrust);
  Vector3d torque = Vector3d::Zero();
  for (int rotor = 0; rotor < 4; ++rotor) torque += v.rotorPlace(rotor).cross(Vector3d(0, each(rotor), 0));
  EXPECT_NEAR((v.angularMomentum(stepper, s) - time * torque).norm(), 0, 1e-2 * time * torque.norm());
  EXPECT_NEAR(v.linearMomentum(stepper, s)(1), time * each.sum(), 1e-3 * time * each.sum());
  EXPECT_GT(v.ringTurning(s).dot(torque), 0.9 * v.ringTurning(s).norm() * torque.norm());
  const AxisSample end = v.sample(s);
  EXPECT_GT(end.tilt, 1e-3);
  EXPECT_GT(std::abs(end.wing_left - end.wing_right), 1e-5) << "and parts the wings";
}

/// Angular momentum of the left wing about z through a point, per rate of its crank at rest [kg m2].
double spinOfTheCrank(const WingLinkage& linkage, const Vector2d& from_axle) {
  const RingWithLinkage::Matrix7 mass = RingWithLinkage(linkage).mass(0);
  const Vector3d momentum = mass.block<3, 1>(0, 6), spin = mass.block<3, 1>(3, 6);
  return spin(2) - (from_axle(0) * momentum(1) - from_axle(1) * momentum(0));
}

/// Moment of inertia of the whole about z through its centre of mass, and that centre.
std::pair<double, Vector3d> inertiaAboutZ(const SpaceVehicle& v, const Stepper& stepper, const MotionState& rest) {
  const MotionState s =
      stepper.start(rest.z, VectorXd::Zero(4), v.rigidRates(rest.y, Vector3d::Zero(), Vector3d::UnitZ()));
  const Vector3d p = v.linearMomentum(stepper, s), centre = Vector3d(p(1), -p(0), 0) / v.mass();
  return {v.angularMomentum(stepper, s)(2) - v.mass() * centre.squaredNorm(), centre};
}

/// A wing that lags leaves the other one's angular momentum without its counterpart: the rest turns against it, by what
/// a rigid vehicle would, but for its soft arms.
TEST(WingsInSpace, AWingThatSticksRollsTheVehicle) {
  Smooth smooth;
  smooth.parameters.wing_friction = 1;
  std::array<double, 2> roll{};
  for (int k = 0; k < 2; ++k) {
    AxisSettings settings = cells();
    (k == 0 ? settings.friction_right : settings.friction_left) = 50;
    const SpaceVehicle v = smooth.inSpace(settings);
    Stepper stepper = stepperOf(v, 1e-3);
    const MotionState rest = v.start(vehicle::Mode::FIXED_WING, 0);
    MotionState s = rest;
    run(v, stepper, s, 0.01, 1e-3, 16);
    const AxisSample end = v.sample(s);
    roll[k] = rolled(v, s);
    const auto [inertia, centre] = inertiaAboutZ(v, stepper, rest);
    const Vector2d axle(smooth.vehicle.geometry.housing_radius + smooth.vehicle.arm.pin_x, smooth.vehicle.arm.pin_y);
    const double apart = (end.wing_left - end.wing_right) / v.linkage()->at(0).wing_rate;  // of the cranks
    const double wanted = -spinOfTheCrank(*v.linkage(), centre.head<2>() - axle) * apart / inertia;
    EXPECT_NEAR(roll[k], wanted, 0.15 * std::abs(wanted));
  }
  EXPECT_GT(roll[0], 5e-4) << "the left wing swings backwards about z, further than the right one";
  EXPECT_NEAR(roll[0], -roll[1], 1e-6 * std::abs(roll[0])) << "the other way round";
}

/// What loads the wings at rest is not in the equilibrium at the start, and the vehicle says so.
TEST(WingsInSpace, SaysThatABiasIsNotInTheStart) {
  const Smooth smooth;
  AxisSettings biased = cells();
  biased.wing_forces.fold_bias = 1e-3;
  const auto says = [](const SpaceVehicle& v) {
    const std::vector<std::string> out = v.leftOut();
    return std::count(out.begin(), out.end(), "the wings' load in the equilibrium at the start");
  };
  EXPECT_EQ(says(smooth.inSpace(biased)), 1);
  EXPECT_EQ(says(smooth.inSpace(cells())), 0);
}

TEST(WingsInSpace, RefusesWhatItHasNot) {
  const Smooth smooth;
  AxisSettings tied = cells();
  tied.wings_follow_travel = true;
  EXPECT_THROW(smooth.inSpace(tied), common::Error);
  vehicle::Vehicle three = smooth.vehicle;
  three.arm.count = 3;
  EXPECT_THROW(SpaceVehicle(three, smooth.parameters, smooth.trial(), cells(), {}, smooth.wing), common::Error);
  EXPECT_THROW(SpaceVehicle(smooth.vehicle, smooth.parameters, smooth.trial(), cells(), {}, {}), common::Error);
}

}  // namespace
}  // namespace snapwing::motion
