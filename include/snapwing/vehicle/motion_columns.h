#pragma once
/// What trials in time taught of the travel, as optional columns of a force table's file. A table from statics knows
/// the inertia of the static path alone; in a snap the arms move in more ways than that one, and more is lost.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace snapwing::vehicle {

/// Of the whole vehicle that was tried, at the table's travels; beyond those that it crossed the columns go on as
/// constants. Another vehicle's mass is its own static one and what motion adds, effective_mass - static_mass.
struct MotionColumns {
  std::vector<double> effective_mass;       ///< 2 T / u'^2 [kg], T in the frame of the common speed, with every motion
  std::vector<double> static_mass;          ///< m(u) of the static path of the same cells [kg]
  std::vector<double> damping;              ///< c of the force c u' that takes what was lost beside drag [N s/m]
  double covered_from = 0, covered_to = 0;  ///< travels that the trials crossed [m]

  /// @param points  of the table
  /// @throws Error naming the column and index: another length, not finite, a mass that is not positive, a negative
  /// damping; or travels that are no range
  void validate(std::size_t points) const;
};

/// @return none if the table has no such columns
/// @throws FileError if the file is missing, no force table, or its columns are not what validate() allows
std::optional<MotionColumns> loadMotionColumns(const std::string& path);

}  // namespace snapwing::vehicle
