#pragma once
/// Inertia of a solid in a step: E = kappa/2 |y - y~|^2_M, y~ = y0 + h v0. kappa = 1/h^2 gives backward Euler, 2/h^2
/// the midpoint family (Step::kappa). Zero in statics.

#include <memory>

#include "snapwing/mpm/mass.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

template <int D>
class InertiaTerm : public Term {
 public:
  /// @param mass    of the solid whose pattern defines the region
  /// @param first   full coordinate of the solid's first displacement
  explicit InertiaTerm(std::shared_ptr<const mpm::Mass<D>> mass, int region = 0, int first = 0)
      : mass_(std::move(mass)), region_(region), first_(first) {
    rows_ = mass_->multiply(Eigen::VectorXd::Ones(D * mass_->nodes())).norm();
  }

  std::string name() const override { return "inertia"; }
  Role role() const override { return Role::INERTIA; }
  int region() const override { return region_; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;

  const mpm::Mass<D>& mass() const { return *mass_; }

 private:
  std::shared_ptr<const mpm::Mass<D>> mass_;
  int region_, first_;
  double rows_ = 0;  ///< 2-norm of the row sums of M [kg]
};

}  // namespace snapwing::solver
