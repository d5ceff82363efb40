#pragma once
/// A branch of equilibria as a power series from one of its points, z(p) = z_0 + sum z_k t^k, t = (p - p_0) / unit, and
/// continued by Pade approximants: the asymptotic numerical method [Cochelin 1994; Najah, Cochelin, Damil,
/// Potier-Ferry 1998]. All coefficients come of one factor.

#include <Eigen/Core>
#include <vector>

#include "snapwing/solver/equilibrium.h"
#include "snapwing/solver/residual_series.h"

namespace snapwing::statics {

class BranchSeries {
 public:
  /// @param forces  of the solver's problem; @param solver  with the factor of `from`, positive definite
  /// @param from    linearised; @param wanted  control to be reached, other than that of `from`. Where the first
  ///   coefficients say that it will not be, the others are not looked for, and the series covers nothing.
  BranchSeries(solver::ResidualSeries& forces, const solver::EquilibriumSolver& solver, const solver::Equilibrium& from,
               double wanted);

  /// Controls from the point to the reach are covered, there approximants of neighbouring orders agree.
  bool covers(double p) const;
  /// Takes back the reach, where more is asked of its end than agreement: an error e there times what it should be.
  void shorten(double excess);
  /// @param p  covered; @param z  [m], (free x 1); @param slope  dz/dp
  void at(double p, Eigen::VectorXd& z, Eigen::VectorXd& slope) const;

  static int order();  ///< of the series

 private:
  using Denominator = std::vector<double>;  ///< q of an approximant: coefficients of 1, t, t^2 ..
  bool hopeless(int count) const;
  Denominator denominator(int order) const;
  bool weights(const Denominator& d, double t, Eigen::VectorXd& of_z, Eigen::VectorXd& of_slope) const;
  void orthonormalise();
  void findReach();

  double begin_, unit_, reach_ = 0;
  Eigen::VectorXd start_;         ///< z_0
  Eigen::MatrixXd coefficients_;  ///< z_1, z_2 .. in columns
  Eigen::MatrixXd shares_;        ///< of orthonormal vectors in each, lower triangle
  Denominator best_, below_;      ///< of the order and of one less
};

}  // namespace snapwing::statics
