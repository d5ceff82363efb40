#pragma once
/// A problem as a sum of terms on full coordinates: Pi(z; p) = sum of E_k(y(z, p), p).

#include <memory>
#include <string>
#include <vector>

#include "snapwing/solver/constraint_term.h"
#include "snapwing/solver/coordinates.h"
#include "snapwing/solver/problem.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

/// A time step for TermProblem::evaluateAt. Owned by the stepper.
struct StepContext {
  Step step;
  /// Rotations at the start. If given, the residual is pulled back by the mean of start and end
  /// (Coordinates::pullBackMean), which conserves angular momentum and energy. It is then not the derivative of the
  /// potential.
  std::shared_ptr<const Coordinates::Place> mean_with;
  double stored_at_start = 0;  ///< [J] of Role::STORED at y0; used with Step::path
};

class TermProblem : public Problem {
 public:
  struct Parts {
    HessianLayout layout;  ///< with the regions; the problem adds the couples
    std::shared_ptr<const Coordinates> coordinates;
    std::vector<std::shared_ptr<const Term>> terms;    ///< evaluated in this order
    int threads = 1;                                   ///< of assembly
    double force_floor = 0;                            ///< [N] Problem::forceFloor
    double energy_floor = 0;                           ///< [J] Problem::energyFloor
    std::shared_ptr<const Constraints> constraints{};  ///< kept as equations; null: none
  };
  /// @throws common::Error for sizes that do not match, and for regions or coordinates that do not exist
  explicit TermProblem(Parts parts);

  int freeCount() const override { return coordinates_->freeCount(); }
  int controlCount() const override { return coordinates_->controlCount(); }
  const SparsePattern& pattern() const override { return pull_back_.pattern(); }
  void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const override {
    evaluateAt(z, p, nullptr, nullptr, order, out);
  }
  void evaluateLagrangian(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const Eigen::VectorXd& multipliers,
                          Order order, Evaluation& out) const override {
    evaluateAt(z, p, nullptr, nullptr, order, out, &multipliers);
  }
  /// @param z  (free x 1) [m]; @param p  (controls x 1)
  /// @param references  of the rotations; null: all I
  /// @param step        null: statics
  /// @param multipliers of the constraints [N]; null: zeros
  void evaluateAt(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const References* references,
                  const StepContext* step, Order order, Evaluation& out,
                  const Eigen::VectorXd* multipliers = nullptr) const;
  void controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                      Eigen::VectorXd& control_part) const override;
  std::vector<NodeRotation> nodeRotations(const Evaluation& at) const override;
  std::unique_ptr<ResidualSeries> series(int order, std::string& why) const override;
  double forceFloor() const override { return parts_.force_floor; }
  double energyFloor() const override { return parts_.energy_floor; }
  std::string describeCell(int cell) const override;
  const Constraints* constraints() const override { return constraints_.get(); }
  bool curvedConstraints() const override { return constraints_ != nullptr && constant_rows_ == nullptr; }

  const Coordinates& coordinates() const { return *coordinates_; }
  std::shared_ptr<const Coordinates> sharedCoordinates() const { return coordinates_; }
  const std::vector<std::shared_ptr<const Term>>& terms() const { return parts_.terms; }
  int threads() const { return parts_.threads; }
  /// Data that the terms store at a step's start (Step::kept). @param y  full coordinates there [m]; @param p  controls
  std::vector<std::shared_ptr<const Memory>> keep(const Eigen::VectorXd& y, const Eigen::VectorXd& p) const;
  /// Evaluates one term only, by its index in terms(): for energy balances. Resets `sum` first.
  void evaluateTerm(std::size_t term, const Point& at, Order order, Sum& sum) const;
  /// A problem with the same coordinates, layout and constraints, and further terms behind its own.
  std::shared_ptr<const TermProblem> with(const std::vector<std::shared_ptr<const Term>>& more) const;
  /// d(dPi/dy . v)/d(density) of each cell at an evaluation, or dPi/d(density) if v is null. (cells x 1) [J], v in m
  Eigen::VectorXd densityDerivative(const Evaluation& at, const Eigen::VectorXd* v, int cells) const;

 private:
  HessianLayout wholeLayout();
  void sumTerms(const Point& at, Order order, Sum& sum) const;
  void averageStored(const Point& at, const StepContext& context, Order order, Evaluation& out) const;

  Parts parts_;
  std::shared_ptr<const Coordinates> coordinates_;
  std::shared_ptr<const Constraints> constraints_;       ///< with eliminated coordinates substituted
  std::unique_ptr<const ConstraintTerm> constraint_;     ///< their term
  std::shared_ptr<const ConstraintRows> constant_rows_;  ///< dg/dz, if there are no rotations
  std::vector<std::vector<int>> couples_;                ///< places per term, then of the constraints
  HessianLayout layout_;                                 ///< with the terms' couples
  HessianPullBack pull_back_;
};

/// Parts with the elastic energy of a solid as the only region and the first term. The coordinates must begin with the
/// solid's displacements. @param force_floor  [N]
template <int D>
TermProblem::Parts solidParts(std::shared_ptr<const mpm::Discretisation<D>> solid,
                              std::shared_ptr<const Coordinates> coordinates, int threads, double force_floor);

/// The problem of one time step, for Newton's method: same unknowns and pattern as the base, evaluated with the step.
class StepProblem : public Problem {
 public:
  /// @param references  of the rotations; null: all I
  StepProblem(std::shared_ptr<const TermProblem> base, std::shared_ptr<const StepContext> step,
              std::shared_ptr<const References> references)
      : base_(std::move(base)), step_(std::move(step)), references_(std::move(references)) {}

  /// Sets the next step; the pattern stays the same.
  void setStep(std::shared_ptr<const StepContext> step, std::shared_ptr<const References> references) {
    step_ = std::move(step);
    references_ = std::move(references);
  }
  int freeCount() const override { return base_->freeCount(); }
  int controlCount() const override { return base_->controlCount(); }
  const SparsePattern& pattern() const override { return base_->pattern(); }
  void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const override {
    base_->evaluateAt(z, p, references_.get(), step_.get(), order, out);
  }
  void evaluateLagrangian(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const Eigen::VectorXd& multipliers,
                          Order order, Evaluation& out) const override {
    base_->evaluateAt(z, p, references_.get(), step_.get(), order, out, &multipliers);
  }
  const Constraints* constraints() const override { return base_->constraints(); }
  bool curvedConstraints() const override { return base_->curvedConstraints(); }
  void controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                      Eigen::VectorXd& control_part) const override {
    base_->controlTangent(at, dp, free_part, control_part);
  }
  std::vector<NodeRotation> nodeRotations(const Evaluation& at) const override { return base_->nodeRotations(at); }
  double forceFloor() const override { return base_->forceFloor(); }
  double energyFloor() const override { return base_->energyFloor(); }
  std::string describeCell(int cell) const override { return base_->describeCell(cell); }

 private:
  std::shared_ptr<const TermProblem> base_;
  std::shared_ptr<const StepContext> step_;
  std::shared_ptr<const References> references_;
};

}  // namespace snapwing::solver
