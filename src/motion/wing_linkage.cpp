#include "snapwing/motion/wing_linkage.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/settings_reader.h"

namespace snapwing::motion {

using Eigen::Vector2d;

namespace {

Vector2d turned(double angle, const Vector2d& x) {
  return {std::cos(angle) * x(0) - std::sin(angle) * x(1), std::sin(angle) * x(0) + std::cos(angle) * x(1)};
}
Vector2d across(const Vector2d& x) { return {-x(1), x(0)}; }

/// A thin bar between two points in the plane, with all its mass on the line.
void addBar(double mass, const Vector2d& a, const Vector2d& b, solver::RigidMass& to) {
  to.mass += mass;
  to.first.head<2>() += 0.5 * mass * (a + b);
  to.second.topLeftCorner<2, 2>() +=
      mass / 6 * (2 * a * a.transpose() + 2 * b * b.transpose() + a * b.transpose() + b * a.transpose());
}

}  // namespace

WingLinkage::WingLinkage(const vehicle::WingTable& table, const std::string& layout, double inertia_scale,
                         double friction_scale)
    : rotation_(table.arm_rotation),
      wing_(table.wing_angle),
      rocker_(table.rocker_angle),
      stored_(table.stored_energy),
      friction_scale_(friction_scale),
      inertia_scale_(inertia_scale) {
  table.validate();
  if (!table.hasBlade() || table.kinetic_mass.empty()) {
    throw common::Error("wing table: no columns of the blade; allowed: a table computed with a blade");
  }
  auxiliary_ = Vector2d(table.auxiliary[0], table.auxiliary[1]);
  joint1_ = Vector2d(table.joint1_x[0], table.joint1_y[0]);
  joint2_ = Vector2d(table.joint2_x[0], table.joint2_y[0]);
  tip_ = Vector2d(table.tip_x[0], table.tip_y[0]);
  const std::size_t last = table.travel.size() - 1;
  const Vector2d wanted(table.joint1_x[last], table.joint1_y[last]);
  if (rotation_.front() != 0 || (turned(rotation_.back(), joint1_) - wanted).norm() > 1e-6 * joint1_.norm()) {
    throw common::Error(
        "wing table: joint 1 does not rotate counter-clockwise with the arm from rest; allowed: a layout "
        "with crank_sign 1");
  }
  readBars(layout);
  addBar(bar_density_ * joint1_.norm(), Vector2d::Zero(), joint1_, mass_[CRANK]);
  addBar(bar_density_ * (joint2_ - joint1_).norm(), joint1_, joint2_, mass_[WING]);
  addBar(bar_density_ * (joint2_ - auxiliary_).norm(), auxiliary_, joint2_, mass_[ROCKER]);
  fitBlade(table);
  // The blade's second moment about joint 2 in the plane, half of what its first moments leave about each axis.
  const Vector2d b = blade_.segment<2>(1), centre = b / blade_(0);
  const double spin = blade_(3) - b.squaredNorm() / blade_(0);
  Eigen::Matrix2d about = blade_(0) * centre * centre.transpose() + 0.5 * spin * Eigen::Matrix2d::Identity();
  solver::RigidMass& wing = mass_[WING];
  wing.mass += blade_(0);
  wing.first.head<2>() += blade_(0) * joint2_ + b;
  wing.second.topLeftCorner<2, 2>() +=
      about + blade_(0) * joint2_ * joint2_.transpose() + joint2_ * b.transpose() + b * joint2_.transpose();
  for (solver::RigidMass& mass : mass_) {
    mass.mass *= inertia_scale;
    mass.first *= inertia_scale;
    mass.second *= inertia_scale;
  }
}

void WingLinkage::readBars(const std::string& layout) {
  common::SettingsReader file = common::SettingsReader::fromFile(layout);
  common::SettingsReader bars = file.map("bars");
  bar_density_ = bars.number("mass_density", {1, 1e5}, "kg/m3") * bars.number("width", {1e-5, 1}, "m") *
                 bars.number("thickness", {1e-5, 1}, "m");
  friction_ = friction_scale_ * bars.number("friction_moment", {0, 10}, "N m");
  unevenness_ = bars.number("friction_unevenness", {-1, 1}, "1");
}

LinkagePose WingLinkage::guessAt(double crank) const {
  const auto upper = std::upper_bound(rotation_.begin() + 1, rotation_.end() - 1, crank);
  const auto k = static_cast<std::size_t>(upper - rotation_.begin());
  const double share = std::clamp((crank - rotation_[k - 1]) / (rotation_[k] - rotation_[k - 1]), -3.0, 3.0);
  LinkagePose pose;
  pose.wing = wing_[k - 1] + share * (wing_[k] - wing_[k - 1]);
  pose.rocker = rocker_[k - 1] + share * (rocker_[k] - rocker_[k - 1]);
  return pose;
}

LinkagePose WingLinkage::at(double crank) const {
  constexpr int ITERATIONS = 50;
  LinkagePose pose = guessAt(crank);
  const Vector2d first = turned(crank, joint1_);
  for (int k = 0; k < ITERATIONS; ++k) {
    const Vector2d coupler = turned(pose.wing, joint2_ - joint1_), rocker = turned(pose.rocker, joint2_ - auxiliary_);
    const Vector2d gap = first + coupler - auxiliary_ - rocker;
    Eigen::Matrix2d slope;
    slope << across(coupler), -across(rocker);
    const Eigen::PartialPivLU<Eigen::Matrix2d> lu(slope);
    const Vector2d by_crank = lu.solve(-across(first));
    pose.wing_rate = by_crank(0), pose.rocker_rate = by_crank(1);
    if (gap.norm() < 1e-14) return pose;
    const Vector2d step = lu.solve(-gap);
    if (!step.allFinite()) break;
    pose.wing += step(0), pose.rocker += step(1);
    if (step.norm() < 1e-14) return pose;
  }
  throw common::Error("the wing's linkage does not close at an arm rotation of " + common::toText(crank) +
                      " rad; allowed: about " + common::toText(rotation_.front()) + " .. " +
                      common::toText(rotation_.back()) + " rad");
}

std::array<Eigen::Vector4d, 2> WingLinkage::bladeColumns(const LinkagePose& pose) const {
  const Vector2d pin = pose.rocker_rate * across(turned(pose.rocker, joint2_ - auxiliary_));  // rate of joint 2
  const double w = pose.wing_rate, c = std::cos(pose.wing), s = std::sin(pose.wing);
  // Rates of a point r of the blade: pin + w across(R r).
  return {
      Eigen::Vector4d(pin.squaredNorm(), 2 * w * (-pin(0) * s + pin(1) * c), 2 * w * (-pin(0) * c - pin(1) * s), w * w),
      Eigen::Vector4d(pin(1), w * c, -w * s, 0)};
}

std::array<double, 2> WingLinkage::barInertia(double crank, const LinkagePose& pose) const {
  const Vector2d first = across(turned(crank, joint1_)),
                 second = pose.rocker_rate * across(turned(pose.rocker, joint2_ - auxiliary_));
  double kinetic = 0, coupled = 0;
  const auto bar = [&](double length, const Vector2d& a, const Vector2d& b) {
    const double mass = bar_density_ * length;
    kinetic += mass / 3 * (a.squaredNorm() + b.squaredNorm() + a.dot(b));
    coupled += mass / 2 * (a(1) + b(1));
  };
  bar(joint1_.norm(), Vector2d::Zero(), first);
  bar((joint2_ - joint1_).norm(), first, second);
  bar((joint2_ - auxiliary_).norm(), Vector2d::Zero(), second);
  return {kinetic, coupled};
}

/// Least squares on K and S of the table over its travels, each in units of its largest.
void WingLinkage::fitBlade(const vehicle::WingTable& table) {
  const auto rows = static_cast<Eigen::Index>(table.travel.size());
  Eigen::MatrixXd matrix(2 * rows, 4);
  Eigen::VectorXd wanted(2 * rows), bars(rows), kinetic(rows);
  const double largest_k = *std::max_element(table.kinetic_mass.begin(), table.kinetic_mass.end());
  double largest_s = 0;
  for (const double s : table.coupled_mass) largest_s = std::max(largest_s, std::abs(s));
  for (Eigen::Index n = 0; n < rows; ++n) {
    const LinkagePose pose = at(table.arm_rotation[n]);
    const double slope = table.angle_per_travel[n] / pose.wing_rate;  // of the arm's rotation by the travel
    const auto [own_k, own_s] = barInertia(table.arm_rotation[n], pose);
    const auto [k, s] = bladeColumns(pose);
    matrix.row(n) = 2 * slope * slope / largest_k * k.transpose();
    matrix.row(rows + n) = 2 * slope / largest_s * s.transpose();
    wanted(n) = (table.kinetic_mass[n] - 2 * slope * slope * own_k) / largest_k;
    wanted(rows + n) = (table.coupled_mass[n] - 2 * slope * own_s) / largest_s;
  }
  const Eigen::VectorXd scale = matrix.colwise().norm();
  const Eigen::MatrixXd even = matrix * scale.cwiseInverse().asDiagonal();
  blade_ = scale.cwiseInverse().asDiagonal() * even.colPivHouseholderQr().solve(wanted);
  blade_error_ = (matrix * blade_ - wanted).head(rows).cwiseAbs().maxCoeff();
  if (!(blade_(0) > 0) || !(blade_(3) * blade_(0) > blade_.segment<2>(1).squaredNorm())) {
    throw common::Error(
        "wing table: no rigid blade fits kinetic_mass and coupled_mass; allowed: the table of this layout");
  }
}

std::array<double, 2> WingLinkage::inertia(double crank) const {
  const LinkagePose pose = at(crank);
  const auto [bar_k, bar_s] = barInertia(crank, pose);
  const auto [k, s] = bladeColumns(pose);
  return {inertia_scale_ * (bar_k + k.dot(blade_)), inertia_scale_ * (bar_s + s.dot(blade_))};
}

vehicle::WingTable WingLinkage::tableOn(const std::vector<double>& travel, const std::vector<double>& rotation,
                                        const std::vector<double>& slope) const {
  vehicle::WingTable out;
  out.travel = travel;
  out.arm_rotation = rotation;
  for (std::size_t n = 0; n < travel.size(); ++n) {
    const LinkagePose pose = at(rotation[n]);
    const auto [k, s] = inertia(rotation[n]);
    const Vector2d first = turned(rotation[n], joint1_), coupler = turned(pose.wing, joint2_ - joint1_),
                   rocker = turned(pose.rocker, joint2_ - auxiliary_), tip = first + turned(pose.wing, tip_ - joint1_);
    out.wing_angle.push_back(pose.wing);
    out.rocker_angle.push_back(pose.rocker);
    out.joint1_x.push_back(first(0)), out.joint1_y.push_back(first(1));
    out.joint2_x.push_back(first(0) + coupler(0)), out.joint2_y.push_back(first(1) + coupler(1));
    out.tip_x.push_back(tip(0)), out.tip_y.push_back(tip(1));
    out.transmission_ratio.push_back(pose.wing_rate);
    out.angle_per_travel.push_back(pose.wing_rate * slope[n]);
    const double mu = std::acos(std::clamp(coupler.dot(rocker) / (coupler.norm() * rocker.norm()), -1.0, 1.0));
    out.transmission_angle.push_back(std::min(mu, M_PI - mu));
    out.kinetic_mass.push_back(2 * slope[n] * slope[n] * k);
    out.coupled_mass.push_back(2 * slope[n] * s);
    const double turning =
        1 + std::abs(pose.wing_rate - 1) + std::abs(pose.wing_rate - pose.rocker_rate) + std::abs(pose.rocker_rate);
    out.friction_force.push_back(2 * friction_ * turning * std::abs(slope[n]));
  }
  return out;
}

}  // namespace snapwing::motion
