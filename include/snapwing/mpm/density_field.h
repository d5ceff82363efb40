#pragma once
/// Density on a regular planar grid: the form in which an arm design is stored and exchanged.

#include <array>
#include <string>
#include <vector>

namespace snapwing::mpm {

/// Cells outside the design domain are absent (negative density).
struct DensityField {
  double cell_size = 0;        ///< [m]
  std::array<int, 2> cells{};  ///< along x, y; lower corner at the origin
  std::vector<double> value;   ///< rho in [0, 1], x fastest; -1 where there is no cell

  /// Density of cell (i, j) [1]; negative: no cell.
  double at(int i, int j) const { return value[static_cast<std::size_t>(j) * cells[0] + i]; }
  bool present(int i, int j) const { return i >= 0 && j >= 0 && i < cells[0] && j < cells[1] && at(i, j) >= 0; }

  /// The field on cells of another size [m], by area averages in which absent cells are void. A new cell exists where
  /// it overlaps an old one.
  /// @param power  [1] 1: averages rho, which conserves the mass. p > 1: averages rho^p, which conserves the stiffness;
  /// new cells with a mean of rho^p below 0.05 (slivers) are absent
  /// @throws common::Error if the size does not divide the extent
  DensityField resampled(double new_cell_size, double power = 1) const;
};

/// A field with all cells absent on a domain of length x height [m].
/// @param path  for messages; @param columns, rows  cells along x and y
/// @throws common::FileError if the cells are not square, or too many
DensityField emptyDensity(const std::string& path, std::size_t columns, std::size_t rows, double length, double height);

/// Reads lines "i,j,rho" under that header (comments start with #); cells that are not listed are empty.
/// @param length  extent of the domain along x [m], height along y: cells must be square and fill it
/// @param cells   of the domain along x and y; {0, 0}: from the largest i and j, which requires listed cells with i = 0
/// and with j = 0
/// @throws common::FileError naming the line, or what is wrong with the whole
DensityField loadDensityCsv(const std::string& path, double length, double height, std::array<int, 2> cells = {0, 0});

/// Closed loops of the level set rho = level, linear between cell centres, void outside. [m]
std::vector<std::vector<std::array<double, 2>>> outline(const DensityField& field, double level);

}  // namespace snapwing::mpm
