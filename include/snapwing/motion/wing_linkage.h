#pragma once
/// One wing's linkage as rigid bodies in the plane of its arm: the crank (a bar that rotates with the arm at the axle),
/// the wing (the coupler with the blade) and the rocker. Frame of the wing's table: origin at the axle, x outward, y up
/// [m].
///
/// Positions are those of the wing's table, the bars' masses those of its layout file. The folding blade is replaced by
/// the rigid body that fits the table's K and S best (least squares; error: bladeError()).

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "snapwing/solver/rigid_inertia_term.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::motion {

/// Configuration of the linkage at one rotation of its crank.
struct LinkagePose {
  double wing = 0, rocker = 0;            ///< rotations from rest [rad]
  double wing_rate = 0, rocker_rate = 0;  ///< their derivatives with respect to the crank's rotation [1]
};

class WingLinkage {
 public:
  enum Body { CRANK, WING, ROCKER };

  /// @param table   with the blade's columns; @param layout  file of the same wing, whose section `bars` is read
  /// @param inertia_scale, friction_scale  [1] real / computed
  /// @throws common::Error for a table without blade, one that no rigid blade fits, or an arm that rotates clockwise in
  /// the linkage's frame; common::FileError, common::SettingError for the layout file
  WingLinkage(const vehicle::WingTable& table, const std::string& layout, double inertia_scale, double friction_scale);

  /// Positions of the pins at rest in the linkage's frame [m].
  const Eigen::Vector2d& auxiliary() const { return auxiliary_; }
  const Eigen::Vector2d& joint1() const { return joint1_; }
  const Eigen::Vector2d& joint2() const { return joint2_; }
  /// Mass moments about the linkage's origin at rest.
  const solver::RigidMass& mass(Body body) const { return mass_[body]; }
  double totalMass() const { return mass_[CRANK].mass + mass_[WING].mass + mass_[ROCKER].mass; }  ///< [kg]
  /// Friction moment of one pin of the left or right wing, which may differ by the layout's unevenness [N m].
  double frictionMoment(bool left) const { return friction_ * (1 + (left ? unevenness_ : -unevenness_)); }
  /// Rotations of the crank [rad] and elastic energy of one wing's bars at them [J]; energy empty: rigid bars.
  const std::vector<double>& rotations() const { return rotation_; }
  const std::vector<double>& storedEnergy() const { return stored_; }
  /// Largest |K - the table's| / the largest K of the table [1].
  double bladeError() const { return blade_error_; }

  /// Angles of the table, interpolated linearly and continued a little beyond its ends; without rates.
  /// @param crank  [rad]
  LinkagePose guessAt(double crank) const;
  /// Solves for the closed chain by Newton's method from guessAt(). @param crank  [rad]
  /// @throws common::Error where the chain does not close
  LinkagePose at(double crank) const;
  /// Of one wing relative to a ring at rest, per rotation of the crank: K [kg m2], S [kg m]. @param crank  [rad]
  std::array<double, 2> inertia(double crank) const;
  /// Wing table of both wings as these rigid bodies for the lumped model, without the blade's folds. One entry each:
  /// @param travel  [m]; @param rotation  of the arm [rad]; @param slope  d(rotation)/d(travel) [rad/m]
  vehicle::WingTable tableOn(const std::vector<double>& travel, const std::vector<double>& rotation,
                             const std::vector<double>& slope) const;

 private:
  void readBars(const std::string& layout);
  void fitBlade(const vehicle::WingTable& table);
  /// Coefficients of the blade's K and S for (m, b_x, b_y, J) at a pose; b, J about joint 2.
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
