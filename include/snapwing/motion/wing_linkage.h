#pragma once
/// One wing's linkage as rigid bodies in the plane of its arm: the crank (a bar that turns with the arm's axle), the
/// wing (the coupler with the blade) and the rocker. Frame of the wing's table: origin at the axle, x outward, y up
/// [m].
///
/// Places come from the wing's table, the bars' masses from its layout file. The blade folds, which no rigid body does:
/// it is the rigid body that comes nearest to the table's K and S (`blade_error` says how near).

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "snapwing/solver/rigid_inertia_term.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::motion {

/// Position of the linkage at one rotation of its crank, with its rates by that rotation.
struct LinkagePose {
  double wing = 0, rocker = 0;            ///< rotations from rest [rad]
  double wing_rate = 0, rocker_rate = 0;  ///< by the crank's [1]
};

class WingLinkage {
 public:
  enum Body { CRANK, WING, ROCKER };

  /// @param table   with the blade's columns; @param layout  file of the same wing, whose `bars` are read
  /// @param inertia_scale, friction_scale  of the real wing. @throws common::Error, common::FileError; for an arm that
  /// turns clockwise in the linkage's frame
  WingLinkage(const vehicle::WingTable& table, const std::string& layout, double inertia_scale, double friction_scale);

  /// Places of the pins at rest in the linkage's frame [m].
  const Eigen::Vector2d& auxiliary() const { return auxiliary_; }
  const Eigen::Vector2d& joint1() const { return joint1_; }
  const Eigen::Vector2d& joint2() const { return joint2_; }
  const solver::RigidMass& mass(Body body) const { return mass_[body]; }
  double totalMass() const { return mass_[CRANK].mass + mass_[WING].mass + mass_[ROCKER].mass; }  ///< [kg]
  /// Of one pin [N m]. @param left  or right: the layout may make them uneven
  double frictionMoment(bool left) const { return friction_ * (1 + (left ? unevenness_ : -unevenness_)); }
  /// Elastic energy of the bars of one wing against the crank's rotation; empty: they are rigid. [rad], [J]
  const std::vector<double>& rotations() const { return rotation_; }
  const std::vector<double>& storedEnergy() const { return stored_; }
  /// Largest |K - the table's| over the largest of the table [1].
  double bladeError() const { return blade_error_; }

  /// Angles of the table, straight on for a little beyond its ends; no rates.
  LinkagePose guessAt(double crank) const;
  /// Closed from the table's angles nearby. @throws common::Error where the chain does not close
  LinkagePose at(double crank) const;
  /// Of one wing against a ring that stands still, per rotation of the crank: K [kg m2], S [kg m].
  std::array<double, 2> inertia(double crank) const;
  /// What the lumped model needs of both wings as these rigid bodies, on an arm that turns by rotation(travel): a table
  /// without the blade's folds. @param slope  of the rotation by the travel [rad/m]
  vehicle::WingTable tableOn(const std::vector<double>& travel, const std::vector<double>& rotation,
                             const std::vector<double>& slope) const;

 private:
  void readBars(const std::string& layout);
  void fitBlade(const vehicle::WingTable& table);
  /// K and S of the blade per unit of mass, first moments (2) and second moment about joint 2, at a pose.
  std::array<Eigen::Vector4d, 2> bladeColumns(const LinkagePose& pose) const;
  std::array<double, 2> barInertia(double crank, const LinkagePose& pose) const;

  Eigen::Vector2d auxiliary_, joint1_, joint2_, tip_;
  std::vector<double> rotation_, wing_, rocker_, stored_;
  std::array<solver::RigidMass, 3> mass_;
  Eigen::Vector4d blade_ = Eigen::Vector4d::Zero();  ///< m [kg], b [kg m], J about joint 2 [kg m2]
  double bar_density_ = 0;                           ///< [kg/m]
  double friction_ = 0, unevenness_ = 0, blade_error_ = 0, friction_scale_ = 1, inertia_scale_ = 1;
};

}  // namespace snapwing::motion
