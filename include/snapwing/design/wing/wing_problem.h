#pragma once
/// The wing design as an optimisation problem in X = (X1x, X1y, X2x, X2y) [m].
///
///   min  sum_i |tip_i - target_i|^2 + w_r^2 sum_i (phi_i - phi_i*)^2 + w_d^2 ((phi_2 - phi_1) - (phi_2* - phi_1*))^2
///        + alpha e(state 2)                                                                                     [m2]
///   s.t. s1 - |x1 - x2| <= 0,  s2 - x2.x <= 0,  x1.y - s3 <= 0   in state 2,
///        cos^2 mu(theta_k) - cos^2 mu_min <= 0                   at theta_k from rest to state 2 (no dead point),
///        least crank and rocker lengths, boxes of X1 and X2.
/// With w_r = w_d = 0 the objective is the paper's ("wing_design"); the transmission angle, the bar lengths and the
/// boxes are additions that keep the mechanism buildable. e is zero for rigid bars.

#include <Eigen/Core>
#include <memory>

#include "snapwing/design/wing/linkage_four_bar.h"
#include "snapwing/design/wing/wing_settings.h"

namespace snapwing::design {

/// Values and exact derivatives at one X. Constraints are satisfied where <= 0, and scaled to be of order one.
struct WingEvaluation {
  double objective = 0;                                ///< [m2]
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();  ///< [m]
  Eigen::VectorXd constraints;                         ///< [1]
  Eigen::Matrix<double, Eigen::Dynamic, 4> jacobian;   ///< one row per constraint [1/m]
};

/// What the optimiser sees. Implementations: rigid bars (here) and elastic bars (linkage_elastic.h).
class WingProblem {
 public:
  explicit WingProblem(WingSettings settings) : settings_(std::move(settings)) {}
  virtual ~WingProblem() = default;
  /// @param with_derivatives  leave gradient and jacobian at zero if false
  virtual WingEvaluation evaluate(const Eigen::Vector4d& X, bool with_derivatives) const = 0;
  int constraintCount() const;
  const WingSettings& settings() const { return settings_; }
  FourBar linkage(const Eigen::Vector4d& X) const;  ///< X = (X1, X2) [m]
  Eigen::Vector4d low() const;                      ///< bounds of X [m]
  Eigen::Vector4d high() const;                     ///< [m]

 protected:
  WingSettings settings_;
};

/// Rigid bars. Also defined where the loop does not close (a smooth continuation that the constraints rule out).
class RigidWingProblem : public WingProblem {
 public:
  using WingProblem::WingProblem;
  WingEvaluation evaluate(const Eigen::Vector4d& X, bool with_derivatives) const override;
};

}  // namespace snapwing::design
