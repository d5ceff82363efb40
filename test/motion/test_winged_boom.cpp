// Wings on a boom that turns: momentum, the model along the axis on a very long boom, the turning boom without wings,
// and a free linkage on a turning arm as the equation of its one angle.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "one_mode.h"
#include "snapwing/common/error.h"
#include "snapwing/motion/space_vehicle.h"
#include "snapwing/motion/trial_file.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace snapwing::motion {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Without drag and friction.
struct Smooth {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  vehicle::WingTable wing = *vehicle::wingTableOf(vehicle, table);
  vehicle::VehicleParameters parameters = vehicle::realise(vehicle, table);
  Smooth() {
    parameters.ring_drag = parameters.centre_drag = parameters.boom_drag = parameters.boom_friction = 0;
    parameters.wing_friction = 0;
  }
  vehicle::Trial trial(vehicle::Mount mount, double speed = 0, bool wings = true) const {
    vehicle::Trial out;
    out.mount = mount;
    out.wings = wings;
    out.initial_thrust_fraction = 0.0;
    out.initial_speed = speed;
    return out;
  }
  SpaceVehicle onBoom(const AxisSettings& settings, double speed, bool wings = true) const {
    return {vehicle, parameters, trial(vehicle::Mount::BOOM, speed, wings), settings, {}, wing};
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

TEST(WingedBoom, KeepsItsAngularMomentumAboutTheBoomsAxis) {
  const Smooth smooth;
  const SpaceVehicle v = smooth.onBoom(cells(), 6);
  const Vector3d pivot = v.ringCentre() - smooth.vehicle.boom.length.value * Vector3d::UnitX();
  Stepper stepper = stepperOf(v, 1e-3, 1e-12);
  MotionState s = v.start(vehicle::Mode::QUADROTOR, 0);
  const auto about = [&] { return (v.angularMomentum(stepper, s) - pivot.cross(v.linearMomentum(stepper, s)))(2); };
  const double l = about();
  const vehicle::VehicleParameters& p = smooth.parameters;
  const double at_tip = p.ring_mass + p.centre_mass + p.boom_mass;
  EXPECT_NEAR(l, 6 * smooth.vehicle.boom.length.value * at_tip, 0.02 * l) << "and a little for the ring's own turning";
  const AxisSample first = v.sample(s);
  EXPECT_NEAR(first.wing_left, first.wing_right, 1e-9);
  for (int k = 0; k < 12; ++k) {
    run(v, stepper, s, s.time + 1e-3, 1e-3, 0);
    EXPECT_NEAR(about(), l, 1e-10 * l) << k;
  }
  // The pins' friction and the damping of the travel aside, nothing is lost.
  const AxisSample last = v.sample(s);
  EXPECT_GT(std::abs(last.wing_left - last.wing_right), 0.05) << "outside and inside differ";
  EXPECT_LT(last.hub_twist, 1e-3);
}

TEST(WingedBoom, ItsAccountClosesWithTheStepsSquare) {
  const Smooth smooth;
  const SpaceVehicle v = smooth.onBoom(cells(), 6);
  std::array<double, 2> fed{};
  for (int k = 0; k < 2; ++k) {
    const double h = k == 0 ? 1e-3 : 5e-4;
    Stepper stepper = stepperOf(v, h, 1e-12);
    MotionState s = v.start(vehicle::Mode::QUADROTOR, 0);
    fed[k] = std::abs(run(v, stepper, s, 0.012, h, 10));
  }
  EXPECT_LT(fed[1], 1e-4);
  EXPECT_LT(fed[1], fed[0] / 3);
}

/// On a boom of 10 km there is no centripetal load: the model along the axis in free flight.
TEST(WingedBoom, OnAVeryLongBoomItIsTheModelAlongTheAxis) {
  Smooth smooth;
  smooth.vehicle.boom.length.value = 1e4;
  smooth.parameters.boom_mass = 0;
  AxisSettings half = cells(0.0025);
  half.in_space = true;
  const AxisVehicle axis(smooth.vehicle, smooth.parameters, smooth.trial(vehicle::Mount::FREE), half, smooth.wing);
  const SpaceVehicle space = smooth.onBoom(cells(0.0025), 0);
  Stepper one = stepperOf(axis, 2e-3), other = stepperOf(space, 2e-3);
  MotionState a = axis.start(vehicle::Mode::FIXED_WING, 0), b = space.start(vehicle::Mode::FIXED_WING, 0);
  const double thrust = 0.6 * smooth.parameters.max_thrust;
  for (int k = 1; k <= 10; ++k) {
    run(axis, one, a, 0.002 * k, 2e-3, thrust);
    run(space, other, b, 0.002 * k, 2e-3, thrust);
    const AxisSample p = axis.sample(a), q = space.sample(b);
    EXPECT_NEAR(q.travel, p.travel, 1e-5) << k;
    EXPECT_NEAR(q.ring_speed, p.ring_speed, 1e-3) << k;
    EXPECT_NEAR(q.wing_left, p.wing_left, 1e-3 + 2e-2 * std::abs(p.wing_left))
        << "nodes of half an arm weigh otherwise";
    EXPECT_NEAR(q.wing_left, q.wing_right, 1e-5) << k;
  }
  EXPECT_GT(axis.sample(a).travel, 3e-3);
  EXPECT_GT(std::abs(axis.sample(a).wing_left), 0.02);
}

TEST(WingedBoom, WithWingsOfNoMassItIsTheBoomWithoutWings) {
  Smooth smooth;
  smooth.parameters.wing_inertia = 1e-6;
  const SpaceVehicle winged = smooth.onBoom(cells(), 6), bare = smooth.onBoom(cells(), 6, false);
  EXPECT_NEAR(winged.mass(), bare.mass(), 1e-6 * bare.mass());
  Stepper one = stepperOf(winged, 1e-3), other = stepperOf(bare, 1e-3);
  MotionState a = winged.start(vehicle::Mode::FIXED_WING, 0), b = bare.start(vehicle::Mode::FIXED_WING, 0);
  run(winged, one, a, 0.012, 1e-3, 15);
  run(bare, other, b, 0.012, 1e-3, 15);
  const AxisSample p = winged.sample(a), q = bare.sample(b);
  EXPECT_NEAR(p.travel, q.travel, 1e-8);
  EXPECT_NEAR(p.ring_speed, q.ring_speed, 1e-6 * q.ring_speed);
  EXPECT_NEAR(p.centre_off, q.centre_off, 1e-8);
  EXPECT_GT(q.centre_off, 1e-4);
  EXPECT_TRUE(std::isfinite(p.wing_left) && std::isnan(q.wing_left));
}

/// Kinetic energy of a wing's bars per (turning rate of the boom)^2 / 2: their moment of inertia about its axis.
/// @param axle  from the boom's axis to the wing's axle, in the wing's plane [m]
double aboutTheBoom(const WingLinkage& linkage, double crank, const Vector2d& axle) {
  const LinkagePose pose = linkage.at(crank);
  const auto turned = [](double angle, const Vector2d& x) -> Vector2d { return Eigen::Rotation2Dd(angle) * x; };
  const Vector2d pin1 = turned(crank, linkage.joint1());
  const std::array<double, 3> angles{crank, pose.wing, pose.rocker};
  const std::array<Vector2d, 3> origins{axle, axle + pin1 - turned(pose.wing, linkage.joint1()),
                                        axle + linkage.auxiliary() - turned(pose.rocker, linkage.auxiliary())};
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const solver::RigidMass& mass = linkage.mass(static_cast<WingLinkage::Body>(k));
    sum += mass.mass * origins[k].squaredNorm() + 2 * origins[k].dot(turned(angles[k], mass.first.head<2>())) +
           mass.second.topLeftCorner<2, 2>().trace();
  }
  return sum;
}

/// Seen from a boom that turns steadily, a linkage whose crank nothing holds is a bead on a turning rod: with the
/// crank's angle q alone, K(q) q'' + K'(q) q'^2 / 2 = W^2 / 2 dI/dq. @return q after some time
double freeLinkage(const WingLinkage& linkage, const Vector2d& axle, double w, double until) {
  constexpr int STEPS = 400;
  constexpr double H = 1e-5;
  const auto rate = [&](const Vector2d& x) {
    const double k = linkage.inertia(x(0))[0],
                 k_slope = (linkage.inertia(x(0) + H)[0] - linkage.inertia(x(0) - H)[0]) / (2 * H),
                 slope = (aboutTheBoom(linkage, x(0) + H, axle) - aboutTheBoom(linkage, x(0) - H, axle)) / (2 * H);
    return Vector2d(x(1), (0.5 * w * w * slope - 0.5 * k_slope * x(1) * x(1)) / k);
  };
  Vector2d x = Vector2d::Zero();
  const double h = until / STEPS;
  for (int n = 0; n < STEPS; ++n) {
    const Vector2d a = rate(x), b = rate(x + h / 2 * a), c = rate(x + h / 2 * b), d = rate(x + h * c);
    x += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return x(0);
}

TEST(WingedBoom, AFreeLinkageFollowsTheEquationOfItsOneAngle) {
  Smooth smooth;
  smooth.parameters.boom_mass = 1e5;  // turns steadily
  AxisSettings loose = cells();
  loose.hub_stiffness = 1e-9;  // [N m]
  const double speed = 6, length = smooth.vehicle.boom.length.value, until = 0.03;
  const SpaceVehicle v = smooth.onBoom(loose, speed);
  Stepper stepper = stepperOf(v, 2.5e-4, 1e-10);
  MotionState s = v.start(vehicle::Mode::FIXED_WING, 0);
  run(v, stepper, s, until, 2.5e-4, 0);
  const double out = smooth.vehicle.geometry.housing_radius + smooth.vehicle.arm.pin_x;
  const double up = smooth.vehicle.arm.pin_y - v.ringCentre()(1);
  // In the plane of the wing inside, x points inwards.
  const double outside = freeLinkage(*v.linkage(), Vector2d(length + out, up), speed / length, until);
  const double inside = freeLinkage(*v.linkage(), Vector2d(out - length, up), speed / length, until);
  const AxisSample sample = v.sample(s);
  const double left = v.linkage()->at(outside).wing, right = v.linkage()->at(inside).wing;
  EXPECT_GT(std::min(std::abs(left), std::abs(right)), 0.04);
  EXPECT_LT(left * right, 0) << "one outwards, one inwards of its own plane: both away from the boom's axis";
  EXPECT_NEAR(sample.wing_left, left, 2e-3 * std::abs(left));
  EXPECT_NEAR(sample.wing_right, right, 2e-3 * std::abs(right));
}

TEST(WingedBoom, RefusesWhatItHasNot) {
  const Smooth smooth;
  const auto made = [&](vehicle::Mount mount, const AxisSettings& settings, bool table) {
    return SpaceVehicle(smooth.vehicle, smooth.parameters, smooth.trial(mount), settings, {},
                        table ? std::optional(smooth.wing) : std::nullopt);
  };
  AxisSettings tied = cells();
  tied.wings_follow_travel = true;
  EXPECT_THROW(made(vehicle::Mount::FREE, cells(), false), common::Error);
  EXPECT_THROW(made(vehicle::Mount::BOOM, tied, true), common::Error);
  EXPECT_THROW(made(vehicle::Mount::BOOM, cells(), false), common::Error);
}

TEST(WingForces, AreReadAndTheBiasLiftsAWingAgainstItsArm) {
  const std::string folder = test::sourceDir() + "/config/trials/paper/";
  const TrialFile boom = loadTrial(folder + "boom_wings.yaml");
  EXPECT_TRUE(boom.six && boom.trial.wings.value());
  EXPECT_EQ(loadTrial(folder + "hand_f_to_q_fold_stop.yaml").axis.wing_forces.fold_stop, 10);
  const Smooth smooth;
  AxisSettings settings;
  settings.cell_size = 0.0025;
  settings.wing_forces = loadTrial(folder + "hand_f_to_q_bias.yaml").axis.wing_forces;
  const AxisVehicle v(smooth.vehicle, smooth.parameters, smooth.trial(vehicle::Mount::FREE), settings, smooth.wing);
  const MotionState s = v.start(vehicle::Mode::FIXED_WING, 0);
  // An arm's end turns by 8 rad per N m in F (docs/motion.md); the moment on it is the bias times the wing's rate.
  const double crank = v.armRotation(s), angle = v.wingAngle(s, true);
  EXPECT_NEAR(crank, 8 * 2e-3 * v.linkage()->at(crank).wing_rate, 0.15 * crank);
  EXPECT_NEAR(angle, v.linkage()->at(crank).wing, 1e-3);
  EXPECT_GT(angle, 0.2);
}

TEST(WingForces, TheStopOfTheFoldActsBeyondTheDesignAlone) {
  const Smooth smooth;
  const auto linkage = std::make_shared<const WingLinkage>(smooth.wing, smooth.vehicle.wing.layout_file, 1, 1);
  const WingAssembly wings(linkage, {{true, 1, 1, {}}}, 2, 0);
  const Turning crank = wings.turning(0, WingLinkage::CRANK);
  WingForces of;
  of.fold_stop = 10;
  const auto terms = wings.forces(0, of);
  ASSERT_EQ(terms.size(), 1U);
  EXPECT_TRUE(wings.forces(0, {}).empty());
  const auto energy = [&](double angle) {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(wings.count());
    y(crank.cosine) = crank.length * (std::cos(angle) - 1), y(crank.sine) = crank.length * std::sin(angle);
    solver::Sum sum;
    sum.reset(solver::HessianLayout(wings.count()), 0, solver::Order::ENERGY);
    terms.front()->evaluate({y, Eigen::VectorXd()}, solver::Order::ENERGY, sum);
    return sum.energy;
  };
  const double end = smooth.wing.arm_rotation.back();
  EXPECT_EQ(energy(0.3), 0);
  EXPECT_NEAR(energy(end - 0.01), 0, 1e-12);
  EXPECT_NEAR(energy(end + 0.1), 5 * 0.01, 1e-9);
}

}  // namespace
}  // namespace snapwing::motion
