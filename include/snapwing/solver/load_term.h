#pragma once
/// Dead loads: E = -(l + L p) . y, p the controls.

#include "snapwing/solver/term.h"

namespace snapwing::solver {

class LoadTerm : public Term {
 public:
  /// @param dead         l [N], on the first full coordinates, (n x 1); empty: none
  /// @param per_control  L, force per unit of each control [N], (n x controls); empty: none
  LoadTerm(Eigen::VectorXd dead, Eigen::MatrixXd per_control)
      : dead_(std::move(dead)), per_control_(std::move(per_control)) {}

  std::string name() const override { return "loads"; }
  Role role() const override { return Role::LOAD; }
  bool linearInStatics() const override { return true; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;
  void controlTangent(const Point& at, const Eigen::VectorXd& dy, const Eigen::VectorXd& dp, Eigen::VectorXd& by_y,
                      Eigen::VectorXd& by_p) const override;

  /// l + L p [N]; empty without loads.
  Eigen::VectorXd loadAt(const Eigen::VectorXd& p) const;
  /// Replaces l [N]. Only between solves.
  void setDead(Eigen::VectorXd dead) { dead_ = std::move(dead); }

 private:
  Eigen::VectorXd dead_;
  Eigen::MatrixXd per_control_;
};

}  // namespace snapwing::solver
