#pragma once
/// Density on a regular planar grid, as an arm design is stored and exchanged.

#include <array>
#include <string>
#include <vector>

namespace snapwing::mpm {

/// Cells outside of the design domain are absent (negative).
struct DensityField {
  double cell_size = 0;        ///< [m]
  std::array<int, 2> cells{};  ///< along x, y; lower corner at the origin
  std::vector<double> value;   ///< rho in [0, 1], x fastest; -1 where there is no cell

  /// Density of cell (i, j) [1]; negative: no cell.
  double at(int i, int j) const { return value[static_cast<std::size_t>(j) * cells[0] + i]; }
  bool present(int i, int j) const { return i >= 0 && j >= 0 && i < cells[0] && j < cells[1] && at(i, j) >= 0; }

  /// The same field on cells of another size that divides the extent: area average, in which absent cells are void, so
  /// that the mass stays. A new cell exists where an old one lies. @throws common::Error if the size does not divide
  /// @param power  1: the density is averaged, which keeps the mass; p: its p-th power, which keeps the stiffness rho^p
  /// of a body whose cut cells have that of their covered share, without slivers of less than .05: what its coarser
  /// cells converge with
  DensityField resampled(double new_cell_size, double power = 1) const;
};

/// A field without cells on a domain that square cells fill. @param path  for messages
/// @throws common::FileError if the cells are not square there, or too many
DensityField emptyDensity(const std::string& path, std::size_t columns, std::size_t rows, double length, double height);

/// Reads lines "i,j,rho" under that header (comments start with #); cells that are not listed are empty.
/// @param length  extent of the domain along x [m], height along y: cells must be square and fill it
/// @param cells   of the domain along x and y; {0, 0}: told by the largest i and j, if cells with i = 0 and j = 0 are
/// there
/// @throws common::FileError naming the line
DensityField loadDensityCsv(const std::string& path, double length, double height, std::array<int, 2> cells = {0, 0});

/// Closed loops of the level set rho = level (linear between cell centres, void outside), in metres.
std::vector<std::vector<std::array<double, 2>>> outline(const DensityField& field, double level);

}  // namespace snapwing::mpm
