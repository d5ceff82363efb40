#pragma once
/// The two-bar (von Mises) truss as an equilibrium problem of one unknown.

#include <algorithm>
#include <cmath>

#include "snapwing/statics/automatic.h"

namespace snapwing::statics::testing_scenes {

/// Half span 1, rise b, bars EA = 1 with Green strain (pi = 1/2 EA L0 e^2 each), apex driven down by p through a
/// spring of stiffness k whose apex end is free: z = apex displacement. Pi = E(z) + k/2 (p - z)^2.
class Truss : public solver::Problem {
 public:
  Truss(double rise, double spring) : rise_(rise), spring_(spring) {
    pattern_.size = 1;
    pattern_.start = {0, 1};
    pattern_.row = {0};
  }
  int freeCount() const override { return 1; }
  int controlCount() const override { return 1; }
  const solver::SparsePattern& pattern() const override { return pattern_; }
  double forceFloor() const override { return 1e-16; }
  std::string describeCell(int) const override { return "bar"; }
  void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, solver::Order order,
                solver::Evaluation& out) const override {
    const double length = std::sqrt(1 + rise_ * rise_), y = rise_ - z(0);
    const double strain = (y * y - rise_ * rise_) / (2 * length * length);
    const double slope = -y / (length * length), curvature = 1 / (length * length);
    const double gap = p(0) - z(0);
    out.elastic_energy = length * strain * strain;
    out.energy = out.elastic_energy + 0.5 * spring_ * gap * gap;
    out.residual = Eigen::VectorXd::Constant(1, 2 * length * strain * slope - spring_ * gap);
    out.control_force = Eigen::VectorXd::Constant(1, spring_ * gap);
    const double geometric = order == solver::Order::PROJECTED ? std::max(0.0, strain) : strain;
    out.hessian = {2 * length * (slope * slope + geometric * curvature) + spring_};
    out.force_scale = 1e-3;
    out.finite = true;
  }
  void controlTangent(const solver::Evaluation&, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                      Eigen::VectorXd& control_part) const override {
    free_part = -spring_ * dp;
    control_part = spring_ * dp;
  }
  double apexForce(double w) const {  // 2 bars, load down
    const double length = std::sqrt(1 + rise_ * rise_), y = rise_ - w;
    return 2 * length * ((y * y - rise_ * rise_) / (2 * length * length)) * (-y / (length * length));
  }

 private:
  double rise_, spring_;
  solver::SparsePattern pattern_;
};

/// Dead load on the apex: Pi = E(z) - p z.
class LoadedTruss : public Truss {
 public:
  explicit LoadedTruss(double rise) : Truss(rise, 0) {}
  void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, solver::Order order,
                solver::Evaluation& out) const override {
    Truss::evaluate(z, p, order, out);
    out.energy -= p(0) * z(0);
    out.residual(0) -= p(0);
    out.control_force(0) = -z(0);
    out.force_scale = 1e-3;
  }
  void controlTangent(const solver::Evaluation&, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                      Eigen::VectorXd& control_part) const override {
    free_part = -dp;
    control_part = Eigen::VectorXd::Zero(1);
  }
};

}  // namespace snapwing::statics::testing_scenes
