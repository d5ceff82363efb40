// Inertia of the wing table against the mass matrix of the wing's parts as rigid bodies.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "snapwing/design/wing/wing_blade.h"
#include "snapwing/design/wing/wing_table.h"
#include "snapwing/solver/rigid_inertia_term.h"
#include "wing_example.h"

namespace snapwing::design {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double LENGTH = 0.01;  // [m] of the rotations' coordinates
constexpr int BODY_DOFS = 12;    // c and the entries of E

/// A part that does not bend: thin rod (two points) or thin triangle (three).
struct Part {
  double mass;
  std::vector<Vector3d> points;
};

Part rod(double per_length, const Vector3d& a, const Vector3d& b) { return {per_length * (b - a).norm(), {a, b}}; }

/// What the fan and the bars of one wing weigh, from the layout's numbers.
std::vector<Part> partsAt(const WingLayout& layout, const WingBladePose& pose) {
  const WingBladeSettings& b = layout.blade;
  const double bar = layout.bars.mass_density * layout.bars.width * layout.bars.thickness;
  const double pi = std::acos(-1.0);
  std::vector<Part> parts = {rod(bar, pose.axle, pose.joint1), rod(bar, pose.joint1, pose.joint2),
                             rod(bar, pose.auxiliary, pose.joint2),
                             rod(b.rod_density * pi / 4 * b.rod_diameter * b.rod_diameter, pose.joint2, pose.tip)};
  for (const Triangle& t : pose.panels) {
    const double area = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
    parts.push_back({b.film_density * b.film_thickness * area, {t[0], t[1], t[2]}});
  }
  const double length = (pose.tip - pose.joint2).norm();
  for (const int i : {1, 2}) {
    const Vector3d middle = (pose.edges[i] + pose.edges[i + 1]) / 2 - pose.joint2;
    parts.push_back(
        rod(b.rib_density * b.rib_width * b.rib_thickness, pose.joint2, pose.joint2 + length * middle.normalized()));
  }
  return parts;
}

/// Axes that a part carries along.
Matrix3d axesOf(const Part& part) {
  Matrix3d axes;
  axes.col(0) = (part.points[1] - part.points[0]).normalized();
  const Vector3d other =
      part.points.size() == 3 ? Vector3d(part.points[2] - part.points[0]) : axes.col(0).unitOrthogonal();
  axes.col(2) = axes.col(0).cross(other).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

/// Moments of a part as it lies at rest, about its first point: over a rod or a triangle the mean of x x^T is
/// (sum of vertices' v v^T + (sum of v)(sum of v)^T) / (n (n + 1)).
solver::RigidMass massOf(const Part& part) {
  const double n = static_cast<double>(part.points.size());
  solver::RigidMass m;
  m.mass = part.mass;
  Vector3d sum = Vector3d::Zero();
  Matrix3d squares = Matrix3d::Zero();
  for (const Vector3d& p : part.points) {
    const Vector3d v = p - part.points[0];
    sum += v;
    squares += v * v.transpose();
  }
  m.first = part.mass / n * sum;
  m.second = part.mass / (n * (n + 1)) * (squares + sum * sum.transpose());
  return m;
}

/// Full coordinates (c, E) of all parts that have moved from `rest`: c of the first point, E = L (R - 1).
Eigen::VectorXd coordinatesOf(const std::vector<Part>& rest, const std::vector<Part>& moved) {
  Eigen::VectorXd y(BODY_DOFS * rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    Matrix3d turn = axesOf(moved[i]) * axesOf(rest[i]).transpose();
    if (rest[i].points.size() == 2) {  // a thin rod does not notice its own roll
      turn = Eigen::Quaterniond::FromTwoVectors(axesOf(rest[i]).col(0), axesOf(moved[i]).col(0)).toRotationMatrix();
    }
    const Matrix3d e = LENGTH * (turn - Matrix3d::Identity());
    y.segment<3>(BODY_DOFS * i) = moved[i].points[0] - rest[i].points[0];
    y.segment<9>(BODY_DOFS * i + 3) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(e.data());
  }
  return y;
}

TEST(WingInertia, OfTheTableIsThatOfTheBodiesMassMatrix) {
  const WingSettings settings = paperSettings();
  const WingLayout layout = layoutOf(settings, paperDesign(), vehicle::loadVehicle(settings.vehicle_file), "rigid");
  const WingBlade blade(layout);
  const ArmMotion& motion = *settings.motion;
  auto table = tabulate(layout.linkage, motion, 0.9 * motion.largestTravel(), 9);
  ASSERT_TRUE(table);
  addBlade(blade, motion, &*table);

  double largest = 0;
  for (std::size_t i = 1; i < table->travel.size(); ++i) {
    const double u = table->travel[i], step = 1e-5;
    double kinetic = 0, momentum = 0;
    for (const WingSide side : {WingSide::LEFT, WingSide::RIGHT}) {
      const auto at = [&](double travel) {
        return partsAt(layout, blade.poseAt(motion.rotation(travel), side).value());
      };
      const std::vector<Part> rest = at(0);
      const Eigen::VectorXd rate = (coordinatesOf(rest, at(u + step)) - coordinatesOf(rest, at(u - step))) / (2 * step);
      for (std::size_t k = 0; k < rest.size(); ++k) {
        solver::Rotation rotation;
        rotation.first = static_cast<int>(BODY_DOFS * k) + 3;
        rotation.length = LENGTH;
        const solver::RigidInertiaTerm term("part", 3, static_cast<int>(BODY_DOFS * k), rotation, massOf(rest[k]));
        kinetic += 2 * term.kineticEnergy(rate);
        momentum += term.momentum(rate).z();
      }
    }
    // Differences over the same step; what is left is rounding over it, 1e-16 / 1e-5 of lengths, in sums of ten parts.
    EXPECT_NEAR(kinetic, table->kinetic_mass[i], 1e-8 * table->kinetic_mass[i]) << u;
    EXPECT_NEAR(momentum, table->coupled_mass[i], 1e-8 * table->kinetic_mass[i]) << u;
    largest = std::max(largest, std::abs(momentum));
  }
  EXPECT_GT(largest, 1e-3) << "kg";
}

}  // namespace
}  // namespace snapwing::design
