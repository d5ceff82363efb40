#pragma once
/// The wing's blade and bars in space: where every panel and bar is at an arm rotation, and what they weigh. For
/// markers and for the dynamics; costs microseconds and needs no solver.
///
/// The blade is a fan of four flat triangles with their apex in joint 2, between the leading edge (joint 2 to tip) and
/// the last edge, which runs from joint 2 through the ring-fixed anchor. The span S between these two edges changes
/// with theta; each panel keeps its apex angle psi = (largest S over the travel + slack) / 4. Edges 0, 2, 4 stay in
/// the linkage's plane, edges 1 and 3 rise out of it by delta:  cos delta = cos psi / cos(S / 4).
/// Simplifications: panels are triangles (the paper cuts an arc), the film does not stretch, its last edge slides on
/// the anchor bar, and ribs run along the middles of panels 2 and 3.
///
/// Frame "ring": origin in the middle of the ring, x forward, y left, z up along the thrust. The left wing's linkage
/// plane is x = 0 with its x axis along +y; the right wing is its mirror image in the plane y = 0.

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "snapwing/design/wing/wing_layout.h"

namespace snapwing::design {

enum class WingSide { LEFT, RIGHT };

using Triangle = std::array<Eigen::Vector3d, 3>;

/// One wing at one arm rotation, frame "ring" [m].
struct WingBladePose {
  Eigen::Vector3d axle, auxiliary, joint1, joint2, tip;
  std::array<Eigen::Vector3d, 5> edges;  ///< outer ends of the fan's edges; edges[0] is the tip
  std::array<Triangle, 4> panels;        ///< joint 2, edges[i], edges[i + 1]
  double span = 0;                       ///< S [rad]
  double wing_angle = 0;                 ///< of the linkage, counter-clockwise positive in its own plane [rad]
};

/// Mass, centre and inertia about the centre, axes of frame "ring".
struct MassProperties {
  double mass = 0;                                    ///< [kg]
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< [kg m2]
};

class WingBlade {
 public:
  /// @throws common::Error if the linkage has a dead point before the largest arm rotation of the layout, or if the
  ///   fan would have to open beyond what four panels can (span above 2 pi)
  explicit WingBlade(WingLayout layout);

  /// Position at arm rotation theta [rad] >= 0; none if the loop does not close there.
  std::optional<WingBladePose> poseAt(double theta, WingSide side) const;
  /// Of one wing at a pose: film, ribs, leading edge rod and the three bars.
  MassProperties massAt(const WingBladePose& pose) const;
  /// m in T = 1/2 m (du/dt)^2 of one wing against the ring. [kg]
  /// @param at  the pose; before, after  poses at travels that lie `du` [m] apart around it
  double kineticMass(const WingBladePose& at, const WingBladePose& before, const WingBladePose& after, double du) const;
  /// First moment of one wing along the thrust axis, mass times height of its centre above the ring. [kg m]
  double massMoment(const WingBladePose& pose) const;
  /// Force that friction at the four pins adds against the housing's motion [N], positive.
  /// @param theta  [rad]; @param slope  d theta / d u [rad/m]; @return none where the loop does not close
  std::optional<double> frictionForce(double theta, double slope, WingSide side) const;

  double panelAngle() const { return panel_angle_; }  ///< psi [rad]
  double edgeLength() const { return edge_length_; }  ///< joint 2 to tip [m]
  const WingLayout& layout() const { return layout_; }

 private:
  struct Body;
  std::vector<Body> bodiesOf(const WingBladePose& pose) const;
  double spanAt(const FourBarPose& pose) const;
  WingLayout layout_;
  double edge_length_ = 0;
  double panel_angle_ = 0;
};

}  // namespace snapwing::design
