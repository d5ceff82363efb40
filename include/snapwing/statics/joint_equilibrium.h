#pragma once
/// Equilibrium of solids whose joints are linear equalities between interpolated displacements (Li et al.,
/// "joint_equilibrium"):
///   min_u  E(u) - f.u   s.t.   H u = h
/// by Newton on the saddle point (Lagrange multipliers) or by an augmented Lagrangian. The multipliers are the joints'
/// forces. Unlike `Reduction`, nothing is eliminated, so that H may depend on what is designed.

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/mpm/discretisation.h"
#include "snapwing/statics/saddle_point.h"

namespace snapwing::statics {

enum class JointMethod { LAGRANGE, AUGMENTED_LAGRANGIAN };

struct JointSettings {
  JointMethod method = JointMethod::LAGRANGE;
  int max_iterations = 60;
  double force_tolerance = 1e-9;       ///< [N] largest component of the residual
  double gap_tolerance = 1e-11;        ///< [m] largest |H u - h|
  double multiplier_tolerance = 1e-6;  ///< augmented Lagrangian: last change of the multipliers over the largest
  double energy_floor = 0;  ///< [J] smaller changes of the energy are rounding, some 1e-15 E times the volume
  double stiffness = 0;     ///< [N/m] w of the saddle point and of the penalty; > 0
  int threads = 1;
};

enum class JointStatus { NOT_SOLVED, CONVERGED, NOT_CONVERGED, RANK_DEFICIENT };

struct JointResult {
  JointStatus status = JointStatus::NOT_SOLVED;
  std::string message;
  Eigen::VectorXd u;                                           ///< [m]
  Eigen::VectorXd multipliers;                                 ///< one per row [N]
  mpm::Assembly assembly;                                      ///< at u, with the exact tangent
  double gap = std::numeric_limits<double>::quiet_NaN();       ///< [m]
  double residual = std::numeric_limits<double>::quiet_NaN();  ///< [N]
  bool stable = false;  ///< K + w H^T H is positive definite: a minimum among all u with H u = h
  int iterations = 0;
};

template <int D>
class JointEquilibrium {
 public:
  /// @param solid  finished; H  rows over its dofs, of order one; names  one per row, for messages
  /// @throws common::Error for sizes or settings that make no sense
  JointEquilibrium(std::shared_ptr<const mpm::Discretisation<D>> solid, ConstraintRows H,
                   std::vector<std::string> names, JointSettings settings);

  /// @param f  dead forces [N], (dofs); h  (rows) [m]; guess  displacements to start from [m]
  JointResult solve(const Eigen::VectorXd& f, const Eigen::VectorXd& h, const Eigen::VectorXd& guess);
  /// [K H^T; H 0] [x; y] = [f; g] with the tangent of a converged result. @throws common::Error without a factor
  void solveTangent(const JointResult& at, const Eigen::MatrixXd& f, const Eigen::MatrixXd& g, Eigen::MatrixXd* x,
                    Eigen::MatrixXd* y);

  const ConstraintRows& rows() const { return saddle_.rows(); }
  const RowRank& rank() const { return rank_; }
  /// Why H is refused; empty if its rows are independent.
  std::string refusal() const;

 private:
  double potential(const Eigen::VectorXd& u, const Eigen::VectorXd& f, const Eigen::VectorXd& h,
                   const Eigen::VectorXd& multipliers) const;
  Eigen::VectorXd shortened(const JointResult& at, const Eigen::VectorXd& f, const Eigen::VectorXd& h,
                            const Eigen::VectorXd& du, double slope) const;
  void factorizeShifted(const std::vector<double>& blocks);
  Eigen::VectorXd step(const Eigen::VectorXd& f, const Eigen::VectorXd& h, const Eigen::VectorXd& gap, JointResult* at);
  bool augmented() const { return settings_.method == JointMethod::AUGMENTED_LAGRANGIAN; }

  std::shared_ptr<const mpm::Discretisation<D>> solid_;
  std::vector<std::string> names_;
  JointSettings settings_;
  RowRank rank_;
  SaddlePoint<D> saddle_;
};

}  // namespace snapwing::statics
