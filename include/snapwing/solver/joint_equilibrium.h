#pragma once
/// Equilibrium of solids whose joints are linear equalities between interpolated displacements (Li et al.,
/// "joint_equilibrium"):
///   min_u  E(u) - f.u   s.t.   H u = h
/// where nothing is eliminated, so that H may depend on what is designed. The multipliers are the joints' forces. A
/// `TermProblem` whose controls are h, solved by `EquilibriumSolver`; what is added here: H is refused by name if its
/// rows depend on each other, f and h change from solve to solve, and the saddle point serves as the derivatives'
/// system.

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/mpm/discretisation.h"
#include "snapwing/solver/equilibrium.h"
#include "snapwing/solver/load_term.h"
#include "snapwing/solver/term_problem.h"

namespace snapwing::solver {

struct JointSettings {
  Enforcement enforcement = Enforcement::MULTIPLIERS;  ///< or AUGMENTED_LAGRANGIAN
  int max_iterations = 60;        ///< of Newton's method; of the augmented Lagrangian's updates (at least 40)
  double force_tolerance = 1e-9;  ///< [N] on |dL/du|
  double gap_tolerance = 1e-11;   ///< [m] largest |H u - h|; times the stiffness: error of a force
  double energy_floor = 0;        ///< [J] smaller changes of the energy are rounding, some 1e-15 E times the volume
  double stiffness = 0;           ///< [N/m] rho of Constraints; > 0
  int threads = 1;
};

enum class JointStatus { NOT_SOLVED, CONVERGED, NOT_CONVERGED, RANK_DEFICIENT };

struct JointResult {
  JointStatus status = JointStatus::NOT_SOLVED;
  std::string message;
  Eigen::VectorXd u;                                                      ///< [m]
  Eigen::VectorXd multipliers;                                            ///< one per row [N]
  Evaluation at;                                                          ///< at u, with the exact tangent
  double constraint_residual = std::numeric_limits<double>::quiet_NaN();  ///< [m]
  double residual = std::numeric_limits<double>::quiet_NaN();             ///< [N]
  bool stable = false;                                                    ///< a minimum among all u with H u = h
  int iterations = 0;
};

template <int D>
class JointEquilibrium {
 public:
  /// @param solid  finished; H  rows over its dofs, of order one; names  one per row, for messages
  /// @throws common::Error for sizes or settings that make no sense
  JointEquilibrium(std::shared_ptr<const mpm::Discretisation<D>> solid, ConstraintRows H,
                   std::vector<std::string> names, const JointSettings& settings);

  /// @param f  dead forces [N], (dofs); h  (rows) [m]; guess  displacements to start from [m]
  JointResult solve(const Eigen::VectorXd& f, const Eigen::VectorXd& h, const Eigen::VectorXd& guess);
  /// Energy, forces and exact tangent at u; the forces without f.
  Evaluation linearise(const Eigen::VectorXd& u);
  /// [K H^T; H 0] [x; y] = [f; g] with the tangent of an evaluation.
  /// @throws common::Error without a stable equilibrium, and for joints that were refused
  void solveTangent(const Evaluation& at, const Eigen::MatrixXd& f, const Eigen::MatrixXd& g, Eigen::MatrixXd* x,
                    Eigen::MatrixXd* y);

  const RowRank& rank() const { return rank_; }
  /// Why H is refused; empty if its rows are independent.
  std::string refusal() const;

 private:
  std::vector<std::string> names_;
  RowRank rank_;
  std::shared_ptr<LoadTerm> load_;
  std::shared_ptr<const TermProblem> problem_;
  std::unique_ptr<EquilibriumSolver> solver_;
};

}  // namespace snapwing::solver
