#pragma once
/// How far the arm has turned at a travel u: what drives the wing. Either from the designed arm's own force table, so
/// that wing and arm stay consistent, or from given points.

#include <string>
#include <vector>

#include "snapwing/vehicle/force_table.h"

namespace snapwing::design {

/// theta(u): shape-preserving cubic through points (monotone where the points are; Fritsch and Carlson 1980).
class ArmMotion {
 public:
  /// @param travel    u [m], strictly increasing, at least 3 points
  /// @param rotation  theta [rad], same length, >= 0 at u = 0 side; the first point is rest and must have rotation 0
  /// @throws common::Error naming the array and the index
  ArmMotion(std::vector<double> travel, std::vector<double> rotation, std::string source);
  /// Rotation column of a force table from u = 0 on. @throws common::Error if u = 0 is not inside the table
  static ArmMotion fromTable(const vehicle::ForceTable& table, const std::string& source);

  /// theta [rad] at u [m]; u must lie within the points. @throws common::Error
  double rotation(double u) const;
  /// d theta / d u [rad/m]
  double slope(double u) const;
  double largestTravel() const { return travel_.back(); }  ///< [m]
  /// First travel at which theta is reached [m]. @throws common::Error if it never is
  double travelAt(double theta) const;
  const std::string& source() const { return source_; }

 private:
  std::size_t segment(double u) const;
  std::vector<double> travel_, rotation_, slope_;
  std::string source_;
};

}  // namespace snapwing::design
