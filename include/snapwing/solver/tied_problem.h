#pragma once
/// A problem with linear constraints that are kept as equations instead of being eliminated:
///   g(z; p) = C z - D p - e = 0,    L = Pi(z; p) + lambda . g + rho/2 |g|^2
/// The last term vanishes at a solution; it is what the augmented Lagrangian method needs, and it makes the Hessian of
/// L regular where the ties alone hold a body. The force that holds the control is dL/dp = dPi/dp - D^T lambda: the
/// reaction of a driven port is its multiplier.
///
/// Scenes keep ports and joints this way (`Drive`), and so does `JointEquilibrium`, whose C depends on what is
/// designed.

#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/solver/drive.h"
#include "snapwing/solver/problem.h"

namespace snapwing::solver {

using ConstraintRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// How far the rows of C are from depending on each other.
struct RowRank {
  int rank = 0;               ///< singular values above `threshold` times the largest
  double smallest = 0;        ///< smallest singular value over the largest [1]
  std::vector<int> culprits;  ///< rows with a large share in the smallest one's left vector
};
RowRank rankOf(const ConstraintRows& rows, double threshold = 1e-8);

struct Ties {
  ConstraintRows rows;        ///< C, (ties x free coordinates)
  Eigen::MatrixXd control;    ///< D, (ties x controls)
  Eigen::VectorXd constant;   ///< e [m]
  std::vector<int> equation;  ///< number in the list that the tie came from
  int count() const { return static_cast<int>(constant.size()); }
  Eigen::VectorXd gap(const Eigen::VectorXd& z, const Eigen::VectorXd& p) const;
};

/// Splits constraints: those marked `tie` become ties of the problem that is left by eliminating the others. Ties that
/// repeat what others already say (a joint at a driven port) are dropped.
/// @throws common::Error naming the equation that contradicts earlier ones
Ties makeTies(int dofs, int controls, const std::vector<Equation>& equations, const Reduction& held);

/// Mean diagonal of the Hessian at rest [N/m]: what a penalty is measured against.
double meanStiffness(const Problem& problem);

/// The potential L at given multipliers. Copies share everything but the multipliers and e.
class TiedProblem : public Problem {
 public:
  /// @param base           without the ties
  /// @param penalty        rho [N/m] > 0
  /// @param gap_tolerance  [m] > 0, on every tie
  TiedProblem(std::shared_ptr<const Problem> base, Ties ties, Drive drive, double penalty, double gap_tolerance);

  const TiedProblem* tied() const override { return this; }
  int freeCount() const override { return base_->freeCount(); }
  int controlCount() const override { return base_->controlCount(); }
  const SparsePattern& pattern() const override { return shared_->pattern; }
  void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const override;
  void controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                      Eigen::VectorXd& control_part) const override;
  double forceFloor() const override { return base_->forceFloor(); }
  double energyFloor() const override { return base_->energyFloor(); }
  std::string describeCell(int cell) const override { return base_->describeCell(cell); }

  const Ties& ties() const { return shared_->ties; }
  Drive drive() const { return shared_->drive; }
  double penalty() const { return shared_->rho; }  ///< rho [N/m]
  /// g(z; p) [m]
  Eigen::VectorXd gap(const Eigen::VectorXd& z, const Eigen::VectorXd& p) const;
  /// Another e [m], (ties x 1), than the one of ties().
  void setConstant(const Eigen::VectorXd& constant) { constant_ = constant; }
  double gapTolerance() const { return shared_->gap_tolerance; }
  const Eigen::VectorXd& multipliers() const { return multipliers_; }
  void setMultipliers(const Eigen::VectorXd& multipliers) { multipliers_ = multipliers; }

 private:
  struct Shared {
    Ties ties;
    Drive drive;
    double rho = 0, gap_tolerance = 0;
    SparsePattern pattern;                              ///< of H + rho C^T C
    std::vector<int> place;                             ///< of each entry of H in it
    std::vector<std::pair<int, double>> penalty_terms;  ///< entries of C^T C
  };
  void buildPattern(Shared& shared) const;

  std::shared_ptr<const Problem> base_;
  std::shared_ptr<const Shared> shared_;
  Eigen::VectorXd multipliers_, constant_;
};

}  // namespace snapwing::solver
