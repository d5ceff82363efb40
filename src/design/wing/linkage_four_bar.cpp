#include "snapwing/design/wing/linkage_four_bar.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "linkage_loop.h"
#include "snapwing/common/error.h"

namespace snapwing::design {

using Eigen::Vector2d;

namespace {

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

int signOf(double a) { return a > 0 ? 1 : a < 0 ? -1 : 0; }

void checkLength(const char* name, double length, double least) {
  if (!(length >= least)) {
    std::ostringstream text;
    text << "linkage: the bar " << name << " is " << length << " m long; allowed: at least " << least << " m";
    throw common::Error(text.str());
  }
}

/// Jets of the four design variables and theta, in this order.
using LoopJet = Jet<5>;

Loop<double> plainLoop(const FourBar& bar, double theta) {
  const Plane<double> x1{bar.joint1.x(), bar.joint1.y()}, x2{bar.joint2.x(), bar.joint2.y()};
  return closeLoop(LoopFrame::of(bar), x1, x2, theta);
}

Loop<LoopJet> jetLoop(const FourBar& bar, double theta) {
  const Plane<LoopJet> x1{LoopJet::variable(bar.joint1.x(), 0), LoopJet::variable(bar.joint1.y(), 1)};
  const Plane<LoopJet> x2{LoopJet::variable(bar.joint2.x(), 2), LoopJet::variable(bar.joint2.y(), 3)};
  return closeLoop(LoopFrame::of(bar), x1, x2, LoopJet::variable(theta, 4));
}

/// d/dtheta of both rotations from the velocity of the closed loop, without jets. Infinite at a dead point.
void setRates(const FourBar& bar, FourBarPose* pose) {
  const Vector2d coupler = pose->joint2 - pose->joint1, rocker = pose->joint2 - bar.auxiliary;
  // Joint 2 moves at right angles to the rocker, and relative to joint 1 at right angles to the coupler.
  const Vector2d v1 = bar.crank_sign * Vector2d(-pose->joint1.y(), pose->joint1.x());
  const double det = cross(coupler, rocker);
  pose->wing_rate = -v1.dot(rocker) / det;
  pose->rocker_rate = -v1.dot(coupler) / det;
}

FourBarPose poseOf(const FourBar& bar, const Loop<double>& loop) {
  FourBarPose pose;
  pose.joint1 = {loop.joint1.x, loop.joint1.y};
  pose.joint2 = {loop.joint2.x, loop.joint2.y};
  pose.tip = {loop.tip.x, loop.tip.y};
  pose.wing_rotation = loop.wing_rotation;
  pose.rocker_rotation = loop.rocker_rotation;
  pose.transmission_sine = loop.transmission_sine;
  setRates(bar, &pose);
  return pose;
}

Eigen::RowVector4d designPart(const LoopJet& jet) { return jet.gradient.head<4>().transpose(); }

Eigen::Matrix<double, 2, 4> designPart(const Plane<LoopJet>& p) {
  Eigen::Matrix<double, 2, 4> both;
  both << designPart(p.x), designPart(p.y);
  return both;
}

}  // namespace

void FourBar::validate() const {
  for (const Vector2d& p : {auxiliary, joint1, joint2, tip}) {
    if (!p.allFinite()) throw common::Error("linkage: a rest position is not finite; allowed: finite numbers [m]");
  }
  if (crank_sign != 1 && crank_sign != -1) {
    throw common::Error("linkage: crank_sign is " + std::to_string(crank_sign) + "; allowed: 1, -1");
  }
  checkLength("axle-auxiliary (ground)", auxiliary.norm(), min_bar_length);
  checkLength("axle-X1 (crank)", crankLength(), min_bar_length);
  checkLength("X1-X2 (coupler)", couplerLength(), min_bar_length);
  checkLength("X2-auxiliary (rocker)", rockerLength(), min_bar_length);
  const double sine = cross(joint2 - joint1, joint2 - auxiliary) / (couplerLength() * rockerLength());
  if (std::abs(sine) < 1e-9) {
    throw common::Error(
        "linkage: X1, X2 and the auxiliary joint lie on one line at rest; allowed: no dead point at rest");
  }
}

int FourBar::branch() const { return branchOf(joint1, joint2); }

int FourBar::branchOf(const Vector2d& joint1_now, const Vector2d& joint2_now) const {
  return signOf(cross(auxiliary - joint1_now, joint2_now - joint1_now));
}

std::optional<FourBarPose> poseAt(const FourBar& bar, double theta) {
  const Loop<double> loop = plainLoop(bar, theta);
  if (!(loop.opening >= 0)) return std::nullopt;
  return poseOf(bar, loop);
}

std::optional<FourBarSensitivity> sensitivityAt(const FourBar& bar, double theta) {
  const Loop<double> plain = plainLoop(bar, theta);
  if (!(plain.opening > 0)) return std::nullopt;
  const Loop<LoopJet> loop = jetLoop(bar, theta);
  FourBarSensitivity s;
  s.pose = poseOf(bar, plain);
  s.joint1 = designPart(loop.joint1);
  s.joint2 = designPart(loop.joint2);
  s.tip = designPart(loop.tip);
  s.wing_rotation = designPart(loop.wing_rotation);
  s.rocker_rotation = designPart(loop.rocker_rotation);
  s.transmission_sine = designPart(loop.transmission_sine);
  s.wing_rate = loop.wing_rotation.hessian.block<1, 4>(4, 0);
  s.rocker_rate = loop.rocker_rotation.hessian.block<1, 4>(4, 0);
  return s;
}

FourBar otherAssembly(const FourBar& bar) {
  FourBar other = bar;
  const Vector2d axis = (bar.auxiliary - bar.joint1).normalized();
  const Vector2d arm = bar.joint2 - bar.joint1;
  other.joint2 = bar.joint1 + 2 * axis.dot(arm) * axis - arm;
  return other;
}

std::vector<FourBarPose> assemblyModes(const FourBar& bar, double theta) {
  const Loop<double> loop = plainLoop(bar, theta);
  if (!(loop.opening >= 0)) return {};
  std::vector<FourBarPose> modes{poseOf(bar, loop)};
  if (loop.opening == 0) return modes;
  // The same rigid wing on the other side of the line x1 -> B: its rotation follows from the mirrored coupler.
  FourBarPose mirrored = modes[0];
  const Vector2d axis = (bar.auxiliary - mirrored.joint1).normalized();
  const Vector2d arm = modes[0].joint2 - mirrored.joint1;
  mirrored.joint2 = mirrored.joint1 + 2 * axis.dot(arm) * axis - arm;
  const Vector2d moved = mirrored.joint2 - mirrored.joint1;
  mirrored.wing_rotation += std::atan2(cross(arm, moved), arm.dot(moved));
  const Vector2d rocker = modes[0].joint2 - bar.auxiliary, rocker_moved = mirrored.joint2 - bar.auxiliary;
  mirrored.rocker_rotation += std::atan2(cross(rocker, rocker_moved), rocker.dot(rocker_moved));
  const double c = std::cos(mirrored.wing_rotation), s = std::sin(mirrored.wing_rotation);
  const Vector2d edge = bar.tip - bar.joint1;
  mirrored.tip = mirrored.joint1 + Vector2d(c * edge.x() - s * edge.y(), s * edge.x() + c * edge.y());
  mirrored.transmission_sine = -mirrored.transmission_sine;
  setRates(bar, &mirrored);
  modes.push_back(mirrored);
  return modes;
}

}  // namespace snapwing::design
