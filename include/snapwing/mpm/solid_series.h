#pragma once
/// Power series of a solid's internal force along a path of displacements u(t) = sum u_k t^k.
///
/// The force's coefficient k is K u_k + r_k, K the Hessian at u_0 and r_k a function of lower orders alone: what a
/// series of equilibria is made of [Cochelin 1994].

#include <memory>
#include <vector>

#include "snapwing/elasticity/taylor_tape.h"
#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

template <int D>
class SolidSeries {
 public:
  /// Whether all laws state their series (ConstitutiveModel::writeStress).
  static bool possible(const Discretisation<D>& solid);
  /// @param solid  lent, with densities that do not change meanwhile; @param order  highest one of a path
  SolidSeries(const Discretisation<D>& solid, int order);
  ~SolidSeries();

  /// Begins at displacements u_0 [m], at least (dofCount x 1), with det F > 0 at every particle.
  void start(const Eigen::VectorXd& u);
  /// Takes coefficient k of the path, k = 1, 2 .. order - 1 one after the other, and adds r_(k + 1) to `force`.
  /// @param u  [m], at least (dofCount x 1); @param force  [N], as long
  void advance(int k, const Eigen::VectorXd& u, Eigen::VectorXd& force);
  /// Memory of the coefficients [bytes], taken by the first start().
  double bytes() const;

 private:
  using Lanes = elasticity::Lanes;
  struct Batch;  ///< cells of one kind side by side
  struct Scratch;
  void addBatches(const std::vector<int>& cells);
  void gather(const Batch& batch, const Eigen::VectorXd& u, Scratch& scratch) const;

  const Discretisation<D>& solid_;
  int order_;
  std::vector<elasticity::TaylorTape> tapes_;  ///< of each law
  std::vector<Batch> batches_;
  std::unique_ptr<Lanes[]> states_;  ///< [batch][term][particle][order][node]
  std::size_t size_ = 0;             ///< of them
};

}  // namespace snapwing::mpm
