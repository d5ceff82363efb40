#pragma once
/// Effective inertia and damping of the travel from trials in time, as optional columns of a force table's file. A
/// table from statics contains only the inertia of the static path; in a snap the arms also move across it, and lose
/// more energy.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace snapwing::vehicle {

/// Values of the whole vehicle of the trials at the table's travels; constant beyond the travels that they crossed. For
/// another vehicle add effective_mass - static_mass to its own static mass.
struct MotionColumns {
  std::vector<double> effective_mass;  ///< 2 T / u'^2 [kg], T in the frame of the common speed, all motions included
  std::vector<double> static_mass;     ///< m(u) of the static path of the same cells [kg]
  std::vector<double> damping;         ///< c of a force c u' with the same loss as all but drag [N s/m]
  double covered_from = 0, covered_to = 0;  ///< travels that the trials crossed [m]

  /// @param points  number of points of the table
  /// @throws Error naming the column and index, for another length, a value that is not finite, a mass <= 0 or a
  /// negative damping; also unless covered_from < covered_to
  void validate(std::size_t points) const;
};

/// Reads the columns of a force table. @return none if it has none
/// @throws FileError if the file is missing, no force table, or its columns are invalid (validate())
std::optional<MotionColumns> loadMotionColumns(const std::string& path);

}  // namespace snapwing::vehicle
