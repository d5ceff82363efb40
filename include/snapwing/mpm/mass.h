#pragma once
/// Mass matrix of solids: M_ab = sum over particles of m N_a N_b, one scalar per pair of nodes and the same for every
/// axis. It is constant, for bodies that are rigid as well.

#include <Eigen/Core>
#include <vector>

#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

enum class MassKind {
  CONSISTENT,  ///< as the displacements are interpolated
  LUMPED,      ///< each row's sum on the diagonal
};

/// Total, centre and second moments of what moves.
template <int D>
struct MassMoments {
  double total = 0;                                              ///< [kg]
  Vector<D> centre = Vector<D>::Zero();                          ///< [m]
  elasticity::Matrix<D> second = elasticity::Matrix<D>::Zero();  ///< sum of m (x - centre)(x - centre)^T [kg m2]
};

template <int D>
class Mass {
 public:
  /// At the densities that the cells have now.
  /// @param solid         finished
  /// @param mass_density  of each body at full density [kg/m3]; a cell has it times its density
  /// @param rules         number of each cell's quadrature rule; empty: the finest of its terms, which cells without a
  ///                      constitutive law (rigid bodies) do not have
  Mass(const Discretisation<D>& solid, const std::vector<double>& mass_density, const std::vector<int>& rules = {},
       MassKind kind = MassKind::CONSISTENT);

  int nodes() const { return pattern_.nodes(); }
  /// One value per block of the solid's pattern [kg].
  const std::vector<double>& blocks() const { return blocks_; }
  /// M v, (dofCount x 1). [kg m/s] for v in m/s
  Eigen::VectorXd multiply(const Eigen::Ref<const Eigen::VectorXd>& v) const;
  /// At nodal displacements u [m], (dofCount x 1 or more).
  MassMoments<D> moments(const Eigen::VectorXd& u) const;

 private:
  template <class Visit>
  void eachPair(const Visit& visit) const;

  BlockPattern<D> pattern_;
  std::vector<Vector<D>> rest_;  ///< of the nodes [m]
  std::vector<double> blocks_;
};

/// The rule by which a cell's mass is summed: `rules`, or the finest of its terms.
template <int D>
const QuadratureRule<D>& massRule(const Discretisation<D>& solid, int cell, const std::vector<int>& rules);

}  // namespace snapwing::mpm
