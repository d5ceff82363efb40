#pragma once
/// The wing's linkage as a planar four-bar of rigid bars, in closed form; microseconds per position.
///
/// Frame: the plane of one arm at rest, origin at the arm's axle A, x outward (away from the housing), y up [m].
/// Bodies: crank = the arm, turns about A by crank_sign * theta and carries joint 1 at X1; rocker, turns about the
/// auxiliary joint B and ends in joint 2 at X2; coupler = the wing, through X1 and X2, with the tip at T.
/// With x1 = R(theta) X1, d = B - x1, D = |d|, a = |X2 - X1|, b = |X2 - B|:
///     x2 = x1 + p d + s h d_perp,   p = (a^2 - b^2 + D^2) / (2 D^2),   h^2 = a^2 / D^2 - p^2.
/// s = +1 or -1 is the assembly mode, fixed by the rest positions. The transmission angle mu is the angle between
/// coupler and rocker, cos mu = (a^2 + b^2 - D^2) / (2 a b). Where sin mu = 0 (h = 0) the two modes meet: a dead point.
/// Source: Li et al., "Soft Hybrid Aerial Vehicle via Bistable Mechanism", multi-body mechanism; bars taken as rigid.

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace snapwing::design {

/// Rest positions; together they are the whole linkage. [m]
struct FourBar {
  Eigen::Vector2d auxiliary{0.035, 0.020};  ///< B, fixed to the axle's connector
  Eigen::Vector2d joint1{0, 0};             ///< X1, arm and wing
  Eigen::Vector2d joint2{0, 0};             ///< X2, wing and rocker
  Eigen::Vector2d tip{0, 0};                ///< T, end of the leading edge
  int crank_sign = 1;                       ///< +1: the arm turns counter-clockwise in this frame as u grows; -1
  double min_bar_length = 1e-3;             ///< [m] shorter bars (A-X1, X1-X2, X2-B) and A-B are refused

  /// @throws common::Error naming the bar: too short, a number that is not finite, crank_sign neither +1 nor -1, or
  ///   a rest position on a dead point (X1, X2 and B in one line: the assembly mode is then not defined)
  void validate() const;
  double crankLength() const { return joint1.norm(); }                 ///< [m]
  double couplerLength() const { return (joint2 - joint1).norm(); }    ///< [m]
  double rockerLength() const { return (joint2 - auxiliary).norm(); }  ///< [m]
  /// Which side of the line x1 -> B joint 2 is on at rest: +1 left, -1 right, 0 on it.
  int branch() const;
  /// The same side, for any position: tells whether a solution of another solver is still on this branch.
  int branchOf(const Eigen::Vector2d& joint1_now, const Eigen::Vector2d& joint2_now) const;
};

/// Position of the linkage at one arm rotation. Rotations are continuous from rest (they may pass +-pi) and
/// counter-clockwise positive.
struct FourBarPose {
  Eigen::Vector2d joint1, joint2, tip;  ///< [m]
  double wing_rotation = 0;             ///< coupler [rad]
  double rocker_rotation = 0;           ///< [rad]
  double transmission_sine = 0;         ///< sin mu with the sign of the branch; 0 at a dead point
  double wing_rate = 0;                 ///< transmission ratio d wing_rotation / d theta [1]
  double rocker_rate = 0;               ///< d rocker_rotation / d theta [1]
};

/// Pose and exact derivatives with respect to X = (X1x, X1y, X2x, X2y) at fixed T, B and theta.
struct FourBarSensitivity {
  FourBarPose pose;
  Eigen::Matrix<double, 2, 4> joint1, joint2, tip;                                               ///< [1]
  Eigen::RowVector4d wing_rotation, rocker_rotation, transmission_sine, wing_rate, rocker_rate;  ///< [1/m]
};

/// Position at arm rotation theta >= 0 [rad] on the branch of the rest positions; none if the loop cannot close there.
std::optional<FourBarPose> poseAt(const FourBar& bar, double theta);
/// The same with derivatives; none also exactly on a dead point, where they are infinite.
std::optional<FourBarSensitivity> sensitivityAt(const FourBar& bar, double theta);
/// Every assembly mode at theta: none, one (dead point) or two; the branch of the rest positions comes first.
std::vector<FourBarPose> assemblyModes(const FourBar& bar, double theta);
/// The linkage whose joint 2 is mirrored about the line X1-B: same bars, put together the other way.
FourBar otherAssembly(const FourBar& bar);

/// What happens between rest and a largest rotation. All exact: D(theta) has closed-form extremes and crossings.
struct TravelCheck {
  bool closes = false;                       ///< the loop closes over the whole travel: no dead point, no branch change
  double dead_point = 0;                     ///< first theta at which the loop opens [rad]; NaN if it never does
  double smallest_transmission = 0;          ///< min over the travel of min(mu, pi - mu) [rad]; 0 if it does not close
  double smallest_transmission_at = 0;       ///< theta of it [rad]
  double largest_bar_mismatch = 0;           ///< how far the loop is from closing at worst [m]; 0 if it closes
  std::string verdict(double margin) const;  ///< one sentence; `margin` [rad] is the least transmission angle wanted
};
/// @param largest  theta at the end of the travel, > 0 [rad]
TravelCheck checkTravel(const FourBar& bar, double largest);

}  // namespace snapwing::design
