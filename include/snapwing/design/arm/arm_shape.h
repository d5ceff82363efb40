#pragma once
/// A design as a body with a sharp edge: thresholded and smoothed outline, offset, and densities on any grid.

#include <array>
#include <vector>

#include "snapwing/mpm/density_field.h"

namespace snapwing::design {

using Loop = std::vector<std::array<double, 2>>;  ///< closed polygon [m]; material on the left

class ArmShape {
 public:
  /// Loops of rho = 1/2 of the filtered field, smoothed, without islands and specks.
  /// @param smoothing  passes of Taubin smoothing (keeps size), >= 0
  explicit ArmShape(const mpm::DensityField& field, int smoothing = 10);
  explicit ArmShape(std::vector<Loop> loops) : loops_(std::move(loops)) {}

  const std::vector<Loop>& loops() const { return loops_; }
  bool empty() const { return loops_.empty(); }
  /// Distance to the outline, negative inside [m].
  double signedDistance(double x, double y) const;
  double area() const;  ///< [m2]

  /// Cells of a domain that the shape covers: rho = coverage^(1/power), so that stiffness rho^power follows coverage;
  /// cells outside are absent. Only the part connected to the cell at (pin_x, pin_y) is kept.
  /// @param domain  gives the grid and which cells may exist; @param offset  [m] moves the outline outward
  mpm::DensityField cover(const mpm::DensityField& domain, double offset, double power, double pin_x,
                          double pin_y) const;

 private:
  std::vector<Loop> loops_;
};

/// Shoelace area of one loop, positive counter-clockwise [m2].
double loopArea(const Loop& loop);

}  // namespace snapwing::design
