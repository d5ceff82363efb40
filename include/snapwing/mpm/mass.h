#pragma once
/// Mass matrix of solids: M_ab = sum over particles of m N_a N_b, one scalar per pair of nodes, the same for every
/// axis. It is constant in time, also for rigid bodies.

#include <Eigen/Core>
#include <vector>

#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

enum class MassKind {
  CONSISTENT,  ///< by the kernel's shape functions
  LUMPED,      ///< row sums on the diagonal
};

/// Total mass, centre of mass and second moments.
template <int D>
struct MassMoments {
  double total = 0;                                              ///< [kg]
  Vector<D> centre = Vector<D>::Zero();                          ///< [m]
  elasticity::Matrix<D> second = elasticity::Matrix<D>::Zero();  ///< sum of m (x - centre)(x - centre)^T [kg m2]
};

template <int D>
class Mass {
 public:
  /// Integrates the mass at the current densities of the cells.
  /// @param solid         finished
  /// @param mass_density  of each body at rho = 1 [kg/m3]; a cell has rho times it
  /// @param rules         quadrature rule of each cell; empty: the finest one of its terms (cells of rigid bodies have
  /// no
  ///                      terms)
  Mass(const Discretisation<D>& solid, const std::vector<double>& mass_density, const std::vector<int>& rules = {},
       MassKind kind = MassKind::CONSISTENT);

  int nodes() const { return pattern_.nodes(); }
  /// One value per block of the solid's pattern [kg].
  const std::vector<double>& blocks() const { return blocks_; }
  /// M v, (dofCount x 1). [kg m/s] for v in m/s, at least (dofCount x 1)
  Eigen::VectorXd multiply(const Eigen::Ref<const Eigen::VectorXd>& v) const;
  /// Moments at nodal displacements u [m], at least (dofCount x 1).
  MassMoments<D> moments(const Eigen::VectorXd& u) const;

 private:
  template <class Visit>
  void eachPair(const Visit& visit) const;

  BlockPattern<D> pattern_;
  std::vector<Vector<D>> rest_;  ///< of the nodes [m]
  std::vector<double> blocks_;
};

/// Quadrature rule of a cell's mass: that of `rules`, or if empty the finest one of its terms.
template <int D>
const QuadratureRule<D>& massRule(const Discretisation<D>& solid, int cell, const std::vector<int>& rules);

}  // namespace snapwing::mpm
