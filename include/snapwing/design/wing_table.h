#pragma once
/// The wing against the housing's travel u: the table that the vehicle, the report and the markers read.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "snapwing/design/linkage_four_bar.h"
#include "snapwing/design/wing_arm_motion.h"

namespace snapwing::design {

/// One entry per travel, except stored_energy, which is empty on the rigid rung.
struct WingTable {
  std::vector<double> travel;              ///< u [m], from 0, strictly increasing
  std::vector<double> arm_rotation;        ///< theta [rad]
  std::vector<double> wing_angle;          ///< rotation of the wing from rest, counter-clockwise positive [rad]
  std::vector<double> rocker_angle;        ///< [rad]
  std::vector<double> joint1_x, joint1_y;  ///< [m] linkage frame
  std::vector<double> joint2_x, joint2_y;  ///< [m]
  std::vector<double> tip_x, tip_y;        ///< [m]
  std::vector<double> transmission_ratio;  ///< d wing_angle / d theta [1]
  std::vector<double> angle_per_travel;    ///< d wing_angle / du [rad/m]
  std::vector<double> transmission_angle;  ///< min(mu, pi - mu) [rad]
  std::vector<double> stored_energy;       ///< elastic energy in the bars of one wing [J]; empty: rigid bars store none
  std::map<std::string, std::string> provenance;

  /// @throws common::Error naming the array: lengths differ, not increasing, not finite
  void validate() const;
};

/// Rigid table at equal steps of u. @param largest  last travel [m]; @param points  at least 2
/// @return none if the loop does not close somewhere on the way
std::optional<WingTable> tabulate(const FourBar& bar, const ArmMotion& motion, double largest, int points);

/// HDF5, one dataset per array with the attribute "unit"; atomic. @throws common::FileError
void saveWingTable(const WingTable& table, const std::string& path);
/// @throws common::FileError
WingTable loadWingTable(const std::string& path);

/// Calls visit(name, unit, array) for each array, in the file's order.
void forEachColumn(WingTable* table, const std::function<void(const char*, const char*, std::vector<double>*)>& visit);

}  // namespace snapwing::design
