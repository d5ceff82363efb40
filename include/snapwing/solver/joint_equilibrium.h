#pragma once
/// Equilibrium of solids whose joints are linear equalities between interpolated displacements (Li et al.,
/// "joint_equilibrium"):
///   min_u  E(u) - f.u   s.t.   H u = h
/// Nothing is eliminated, so that H may depend on design variables. The multipliers are the forces of the joints.
/// Internally a `TermProblem` with controls h, solved by `EquilibriumSolver`. In addition: an H with dependent rows is
/// refused by name, f and h may change between solves, and the saddle-point matrix is available for derivatives.

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
  int max_iterations = 60;        ///< of Newton's method; also of the multipliers' updates, then at least 40
  double force_tolerance = 1e-9;  ///< [N] on |dL/du|
  double gap_tolerance = 1e-11;   ///< [m] on the largest |H u - h|
  double energy_floor = 0;        ///< [J] as Problem::energyFloor; about 1e-15 Young's modulus times volume
  double stiffness = 0;           ///< [N/m] > 0: penalty rho of Constraints
  int threads = 1;
};

enum class JointStatus { NOT_SOLVED, CONVERGED, NOT_CONVERGED, RANK_DEFICIENT };

struct JointResult {
  JointStatus status = JointStatus::NOT_SOLVED;
  std::string message;
  Eigen::VectorXd u;                                                      ///< [m], (dofs x 1)
  Eigen::VectorXd multipliers;                                            ///< [N], (rows x 1)
  Evaluation at;                                                          ///< at u, with the exact tangent
  double constraint_residual = std::numeric_limits<double>::quiet_NaN();  ///< largest |H u - h| [m]
  double residual = std::numeric_limits<double>::quiet_NaN();             ///< |dL/du| [N]
  bool stable = false;                                                    ///< a minimum subject to H u = h
  int iterations = 0;
};

template <int D>
class JointEquilibrium {
 public:
  /// @param solid  finished; @param H  (rows x dofs) [1]; @param names  one per row, for messages
  /// @throws common::Error for sizes that do not match, or settings out of range
  JointEquilibrium(std::shared_ptr<const mpm::Discretisation<D>> solid, const ConstraintRows& H,
                   std::vector<std::string> names, const JointSettings& settings);

  /// @param f  dead forces [N], (dofs x 1); @param h  [m], (rows x 1); @param guess  initial u [m], (dofs x 1)
  JointResult solve(const Eigen::VectorXd& f, const Eigen::VectorXd& h, const Eigen::VectorXd& guess);
  /// Evaluation of order TANGENT at u, h = 0 and zero multipliers, with the f of the last solve.
  Evaluation linearise(const Eigen::VectorXd& u);
  /// Solves [K H^T; H 0] [x; y] = [f; g], one system a column, K the tangent of an evaluation.
  /// @throws common::Error if the equilibrium is not stable or H was refused
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
