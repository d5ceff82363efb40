#pragma once
/// Regular background grid, kernels on it and quadrature rules within a cell.
///
/// A cell (i, j, k) covers origin + h (i..i+1, ...). With both kernels every cell has a fixed block of nodes, so that
/// all cells with the same particles share one table of weights and gradients:
///   LINEAR     nodes at the cells' corners, 2 per axis
///   QUADRATIC  B-spline with knots on the cells' faces, nodes at the cells' centres and one ring outside, 3 per axis
/// The formulation is total Lagrangian: particles stay in their cells and are quadrature points.

#include <Eigen/Core>
#include <array>
#include <vector>

namespace snapwing::mpm {

enum class Kernel { LINEAR, QUADRATIC };

/// Nodes per axis that a cell's field depends on.
inline int nodesPerAxis(Kernel kernel) { return kernel == Kernel::LINEAR ? 2 : 3; }

/// Row length of a cell's tables: the stencil rounded up to a multiple of four.
constexpr int paddedStencil(int stencil) { return (stencil + 3) / 4 * 4; }

/// Values of a cell's basis functions along one axis, and derivatives with respect to the cell coordinate [1].
/// @param x  cell coordinate in [0, 1]
void axisKernel(Kernel kernel, double x, std::array<double, 3>& value, std::array<double, 3>& slope);

template <int D>
using Vector = Eigen::Matrix<double, D, 1>;
template <int D>
using Index = std::array<int, D>;

template <int D>
struct Grid {
  Vector<D> origin = Vector<D>::Zero();  ///< lower corner [m]
  double cell_size = 0;                  ///< h [m]
  Index<D> cells{};                      ///< cells along each axis
  Kernel kernel = Kernel::LINEAR;

  int cellCount() const;
  int nodeCount() const;
  int cellNumber(const Index<D>& cell) const;
  Index<D> cellIndex(int number) const;
  /// Node numbers of a cell, x fastest.
  std::vector<int> cellNodes(const Index<D>& cell) const;
  /// Rest position of a node [m]; u_i = A X_i + b reproduces linear fields with either kernel.
  Vector<D> nodePosition(int number) const;
  Vector<D> cellCentre(const Index<D>& cell) const;  ///< [m]
  /// Cell that contains a point [m], and the point's cell coordinates; outer faces included. @return false if outside
  bool locate(const Vector<D>& point, Index<D>& cell, Vector<D>& local) const;
  /// Kernel values of a cell's nodes at cell coordinates, and their gradients [1/m], one a column.
  void weights(const Vector<D>& local, Eigen::VectorXd& value, Eigen::Matrix<double, D, Eigen::Dynamic>& slope) const;
  int nodesAlong(int axis) const { return cells[axis] + nodesPerAxis(kernel) - 1; }
};

/// Particles of a cell: positions, shares of the cell's volume, and tabulated kernel values.
template <int D>
struct QuadratureRule {
  int stencil = 0;               ///< nodes per cell
  std::vector<Vector<D>> local;  ///< positions in cell coordinates, [0, 1]^D
  std::vector<double> weight;    ///< share of the cell's volume [1]; the sum is the filled share
  std::vector<double> value;     ///< N, particle-major (particles x stencil)
  std::vector<double> slope;     ///< dN/dX [1/m], (particles x stencil x D)

  int size() const { return static_cast<int>(weight.size()); }
  const double* slopeOf(int particle) const { return slope.data() + static_cast<std::size_t>(particle) * stencil * D; }
  const double* valueOf(int particle) const { return value.data() + static_cast<std::size_t>(particle) * stencil; }
};

/// Rule from given positions (cell coordinates) and weights [1], for a grid's kernel and cell size.
template <int D>
QuadratureRule<D> makeRule(const Grid<D>& grid, const std::vector<Vector<D>>& local, const std::vector<double>& weight);

/// Gauss-Legendre product rule of a full cell. @param points  1 .. 4 per axis. @throws common::Error
template <int D>
QuadratureRule<D> gaussRule(const Grid<D>& grid, int points);

}  // namespace snapwing::mpm
