#pragma once
/// Power series of forces along a path, for continuation of high order [Cochelin 1994]: the coefficient k of a force is
/// linear in that of the path, with the Hessian at its start, but for a remainder that lower orders make.

#include <Eigen/Core>

namespace snapwing::solver {

/// Of dPi/dz along z(t) = sum z_k t^k, p(t) = p_0 + p_1 t.
class ResidualSeries {
 public:
  virtual ~ResidualSeries() = default;
  /// @param z  z_0, (free x 1) [m]; @param p  p_0, (controls x 1)
  virtual void start(const Eigen::VectorXd& z, const Eigen::VectorXd& p) = 0;
  /// Takes z_k, k = 1, 2 .. one after the other.
  /// @param p  p_1 if k = 1, else zero; @return remainder of the residual's coefficient k + 1 [N], (free x 1)
  virtual Eigen::VectorXd advance(int k, const Eigen::VectorXd& z, const Eigen::VectorXd& p) = 0;
};

/// Of a term's dE/dy along full coordinates y(t).
class ForceSeries {
 public:
  virtual ~ForceSeries() = default;
  /// @param y  y_0 [m], (full x 1)
  virtual void start(const Eigen::VectorXd& y) = 0;
  /// Adds the remainder of the coefficient k + 1 to `force` [N]. @param y  y_k [m], (full x 1)
  virtual void advance(int k, const Eigen::VectorXd& y, Eigen::VectorXd& force) = 0;
};

}  // namespace snapwing::solver
