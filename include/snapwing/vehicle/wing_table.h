#pragma once
/// Position and inertia of the wing against the housing's travel u. Linkage frame: plane of one arm at rest, origin at
/// the arm's axle, x outward, y up [m]. The left wing lies on the vehicle's side +y, the right one is its mirror image.

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace snapwing::vehicle {

/// Outer end of an edge of the blade's fan, one entry per travel; z: out of the linkage's plane. [m]
struct Fold {
  std::vector<double> x, y, z;
};

/// One entry per travel, except stored_energy, which is empty on the rigid rung.
struct WingTable {
  std::vector<double> travel;              ///< u [m], from 0, strictly increasing
  std::vector<double> arm_rotation;        ///< theta [rad]
  std::vector<double> wing_angle;          ///< rotation of the wing from rest, counter-clockwise positive [rad]
  std::vector<double> rocker_angle;        ///< [rad]
  std::vector<double> joint1_x, joint1_y;  ///< [m] linkage frame
  std::vector<double> joint2_x, joint2_y;  ///< [m]
  std::vector<double> tip_x, tip_y;        ///< of the wing [m]
  std::vector<double> transmission_ratio;  ///< d wing_angle / d theta [1]
  std::vector<double> angle_per_travel;    ///< d wing_angle / du [rad/m]
  std::vector<double> transmission_angle;  ///< min(mu, pi - mu) [rad]
  std::vector<double> stored_energy;       ///< elastic energy in the bars of one wing [J]; empty: rigid bars store none
  // Columns of the blade; empty if the table was computed without one.
  // Inertia of both wings: T = m z'^2 / 2 + S z' u' + K u'^2 / 2, z: position of the ring along the thrust axis,
  // h: height of the wings' common centre above the ring.
  std::vector<double> kinetic_mass;    ///< K [kg]
  std::vector<double> coupled_mass;    ///< S = m dh/du [kg]
  std::vector<double> friction_force;  ///< of both wings' pins against du/dt, positive [N]
  std::array<Fold, 4> folds;      ///< outer ends of the fan's edges after the leading one; the last one at the anchor
  std::vector<double> axle;       ///< radius from the vehicle's axis, height in the ring's frame [m]
  std::vector<double> auxiliary;  ///< x, y [m] linkage frame
  std::map<std::string, std::string> provenance;

  /// @throws common::Error naming the array, for different lengths, travel not increasing, or values not finite
  void validate() const;
  bool hasBlade() const { return !axle.empty(); }
  /// A column at any travel [m]: linear between rows, constant beyond the ends.
  double at(const std::vector<double>& column, double u) const;
};

/// Refuses wings on a boom, for models that neglect the centripetal force on them.
/// @param who  begins the message @throws common::Error, always
[[noreturn]] void refuseWingsOnBoom(const std::string& who);

/// Writes HDF5 atomically, one dataset per array with the attribute "unit". @throws common::FileError
void saveWingTable(const WingTable& table, const std::string& path);
/// Reads such a file. @throws common::FileError
WingTable loadWingTable(const std::string& path);

/// Calls visit(name, unit, array) for each array, in the file's order.
void forEachColumn(WingTable* table, const std::function<void(const char*, const char*, std::vector<double>*)>& visit);

}  // namespace snapwing::vehicle
