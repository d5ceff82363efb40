#pragma once
/// From design variables to the densities that physics sees, as a chain of maps each of which gives its value and the
/// transpose of its Jacobian:  x -> patches -> cone filter -> projection -> patches -> density.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <vector>

namespace snapwing::design {

class Parametrization {
 public:
  virtual ~Parametrization() = default;
  /// @param x  (n x 1)
  virtual Eigen::VectorXd eval(const Eigen::VectorXd& x) const = 0;
  /// J(x)^T g. @param x  input of eval; @param g  derivative by its output
  virtual Eigen::VectorXd applyJacobianTranspose(const Eigen::VectorXd& x, const Eigen::VectorXd& g) const = 0;
};

/// Maps applied one after the other.
class Chain : public Parametrization {
 public:
  explicit Chain(std::vector<std::shared_ptr<const Parametrization>> maps) : maps_(std::move(maps)) {}
  Eigen::VectorXd eval(const Eigen::VectorXd& x) const override;
  Eigen::VectorXd applyJacobianTranspose(const Eigen::VectorXd& x, const Eigen::VectorXd& g) const override;

 private:
  std::vector<std::shared_ptr<const Parametrization>> maps_;
};

/// Cone filter K_ij = max(0, r - |X_i - X_j|), scaled on both sides (W = S K S, S diagonal) until rows and columns sum
/// to one: it keeps constants and the area of any density, also along the domain's edge.
class DensityFilter : public Parametrization {
 public:
  /// @param centres  of equal cells [m]; @param radius  [m], >= 0; below the spacing it does nothing
  DensityFilter(const std::vector<std::array<double, 2>>& centres, double radius);
  Eigen::VectorXd eval(const Eigen::VectorXd& x) const override { return weights_ * x; }
  Eigen::VectorXd applyJacobianTranspose(const Eigen::VectorXd& /*x*/, const Eigen::VectorXd& g) const override {
    return weights_ * g;  // symmetric
  }
  const Eigen::SparseMatrix<double>& weights() const { return weights_; }

 private:
  Eigen::SparseMatrix<double> weights_;
};

/// Smooth step rho = (tanh(b eta) + tanh(b (x - eta))) / (tanh(b eta) + tanh(b (1 - eta))) [Wang, Lazarov, Sigmund
/// 2011]. eta above 1/2 erodes, below dilates.
class Projection : public Parametrization {
 public:
  /// @param sharpness  b >= 0 (0: identity); @param threshold  eta in (0, 1)
  Projection(double sharpness, double threshold);
  Eigen::VectorXd eval(const Eigen::VectorXd& x) const override;
  Eigen::VectorXd applyJacobianTranspose(const Eigen::VectorXd& x, const Eigen::VectorXd& g) const override;

 private:
  double sharpness_, threshold_;
};

/// Cells that are held at a value whatever the design says.
class Patches : public Parametrization {
 public:
  /// @param held  per cell: the value, or a negative number where the design decides
  explicit Patches(Eigen::VectorXd held) : held_(std::move(held)) {}
  Eigen::VectorXd eval(const Eigen::VectorXd& x) const override;
  Eigen::VectorXd applyJacobianTranspose(const Eigen::VectorXd& x, const Eigen::VectorXd& g) const override;

 private:
  Eigen::VectorXd held_;
};

/// Share of grey, sum 4 rho (1 - rho) / n: 0 black and white, 1 all half.
double greyLevel(const Eigen::VectorXd& density);

}  // namespace snapwing::design
