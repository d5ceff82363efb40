#pragma once
/// Lagrangian term of constraints, lambda . g + rho/2 |g|^2 [J], with the multipliers of the point
/// (Point::multipliers).

#include <memory>
#include <string>
#include <vector>

#include "snapwing/solver/constraints.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

class ConstraintTerm : public Term {
 public:
  explicit ConstraintTerm(std::shared_ptr<const Constraints> constraints);

  std::string name() const override { return "constraints"; }
  Role role() const override { return Role::CONSTRAINT; }
  std::vector<std::vector<int>> couples() const override { return couples_; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;
  void controlTangent(const Point& at, const Eigen::VectorXd& dy, const Eigen::VectorXd& dp, Eigen::VectorXd& by_y,
                      Eigen::VectorXd& by_p) const override;

 private:
  std::shared_ptr<const Constraints> constraints_;
  std::vector<std::vector<int>> couples_;  ///< per row, if rho > 0
};

}  // namespace snapwing::solver
