#pragma once
/// Grids of the solid linkage: four bars, each with its own map; see snapwing/design/wing/linkage_solid.h.

#include <array>
#include <complex>
#include <memory>
#include <utility>
#include <vector>

#include "snapwing/design/wing/linkage_solid.h"
#include "snapwing/mpm/map_derivative.h"

namespace snapwing::design {

enum SolidBarName { ARM_BAR, COUPLER_BAR, EDGE_BAR, ROCKER_BAR, SOLID_BARS };

using Complex = std::complex<double>;
/// Derivatives by X = (X1x, X1y, X2x, X2y).
using ComplexSlopes = std::array<Complex, 4>;

/// Straight line from a to b, both fixed or a joint.
struct SolidBar {
  Eigen::Vector2d a, b;
  Eigen::Matrix<double, 2, 4> da, db;  ///< by X [1]
  double before = 0, after = 0;        ///< material beyond a and b, shares of |b - a|

  Eigen::Vector2d at(double t) const { return a + t * (b - a); }
  /// A short piece of the bar as a complex number, and its derivatives. @param share  of the bar's length
  Complex piece(double share) const;
  ComplexSlopes pieceSlopes(double share) const;
};

/// (node, weight) pairs of an interpolated displacement or of a difference of two.
using NodeWeights = std::vector<std::pair<int, double>>;

template <int D>
class SolidMesh {
 public:
  SolidMesh(const FourBar& layout, const WingBars& bars, const SolidSettings& settings);

  const SolidBar& bar(int name) const { return bars_[name]; }
  const std::shared_ptr<const mpm::Discretisation<D>>& solid() const { return solid_; }
  /// Rates of the maps by X, one list per bar; see mpm/map_derivative.h.
  const std::vector<std::vector<elasticity::Matrix<D>>>& rates() const { return rates_; }
  /// Displacement on the middle line at t (0 at a, 1 at b). @param level  0 .. 1 through the thickness; 2-D: unused
  NodeWeights at(int name, double t, double level = 0.5) const;
  /// Displacement at t + grip less that at t - grip.
  NodeWeights difference(int name, double t, double grip) const;
  double volume() const;  ///< of all bars [m3]
  /// Rest position in the plane of a node. [m]
  Eigen::Vector2d rest(int node) const;

 private:
  elasticity::Matrix<D> mapOf(const SolidBar& bar) const;
  mpm::Vector<D> gridPoint(int name, double t, double level) const;

  std::array<SolidBar, SOLID_BARS> bars_;
  mpm::Index<D> cells_{};
  double width_, thickness_;
  std::shared_ptr<const mpm::Discretisation<D>> solid_;
  std::vector<std::vector<elasticity::Matrix<D>>> rates_;
};

inline Eigen::Vector2d vectorOf(const Complex& z) { return {z.real(), z.imag()}; }
inline Complex complexOf(const Eigen::Vector2d& v) { return {v.x(), v.y()}; }

/// sum of weights times nodal vectors, its first two components.
template <int D>
Eigen::Vector2d gathered(const NodeWeights& weights, const Eigen::VectorXd& u) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& [node, weight] : weights) sum += weight * u.segment<2>(D * node);
  return sum;
}
template <int D>
void scatter(const NodeWeights& weights, const Eigen::Vector2d& v, Eigen::Ref<Eigen::VectorXd> u) {
  for (const auto& [node, weight] : weights) u.segment<2>(D * node) += weight * v;
}

}  // namespace snapwing::design
