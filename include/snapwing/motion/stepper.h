#pragma once
/// Time integration of a TermProblem, with or without kept constraints: Newton on each step, step halving where it
/// fails, step control by a local error if requested, and an energy balance. Reproducible: equal states give equal
/// bits.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/motion/scheme.h"
#include "snapwing/solver/equilibrium.h"
#include "snapwing/solver/prony_term.h"
#include "snapwing/solver/term_problem.h"

namespace snapwing::motion {

/// State of motion at one instant, from which a run can be resumed.
struct MotionState {
  double time = 0;                                       ///< [s]
  Eigen::VectorXd z;                                     ///< free coordinates, (free x 1) [m]
  std::shared_ptr<const solver::References> references;  ///< of rotations; null: all I
  Eigen::VectorXd y, v;                                  ///< full coordinates [m] and rates [m/s], (full x 1)
  Eigen::VectorXd multipliers;       ///< of kept constraints, mean of the last step [N]; empty without, or if unknown
  Eigen::VectorXd acceleration;      ///< mean of the last step [m/s2], (full x 1); empty before the first step
  Eigen::VectorXd mean_rate;         ///< mean rates of the last step [m/s]; empty before the first step
  Eigen::VectorXd mean_rate_change;  ///< derivative of mean_rate, from the last two steps [m/s2]; empty before that
  double last_step = 0;              ///< length of the last step [s]
  double next_step = 0;              ///< proposed length of the next step [s]; 0: the largest
  double kinetic = 0;                ///< [J]
  double stored = 0;                 ///< [J] energy of internal variables included
  Eigen::VectorXd history;           ///< internal variables of all HistoryTerms, in the problem's order
};

struct StepperSettings {
  double largest_step = 1e-3;        ///< [s] (0, 1]
  double smallest_step = 1e-7;       ///< [s] (0, largest_step]: if it fails, the motion has failed
  double error = 0;                  ///< [m] >= 0, tolerance of the local error, rms over the mass; 0: no step control
  double relative_tolerance = 1e-8;  ///< of Newton, as in NewtonSettings; a thousandth of it with CORRECTED_MIDPOINT
  double roundings = 10;             ///< as in NewtonSettings
  int max_iterations = 30;
  solver::Projection projection = solver::Projection::ON_DEMAND;
  bool keep_factor = false;  ///< as in NewtonSettings
  /// @throws common::Error naming the member
  void validate() const;
};

/// Work of a term in a step.
struct TermWork {
  std::string name;
  solver::Term::Role role;
  double work = 0;  ///< [J] LOAD: work done on the vehicle; DISSIPATION: energy lost
};

/// Energy balance and cost of a step.
struct StepAccount {
  double h = 0;        ///< [s]
  double kinetic = 0;  ///< at the end [J]
  double stored = 0;   ///< at the end [J]
  double work = 0;     ///< of loads [J]
  double loss = 0;     ///< to dissipation [J]
  /// Change of (kinetic + stored) - work + loss [J]: energy that the scheme itself added (> 0) or removed
  double imbalance = 0;
  std::vector<TermWork> terms;  ///< loads and dissipation, in the problem's order; HistoryTerms last
  int iterations = 0, factorizations = 0;
  double error = 0;      ///< [m] local error, rms over the mass; 0 without step control
  double min_det_f = 1;  ///< smallest on the step's path [1]
};

/// Controls of a step from `from` to `from + h` [s], as means over it, (controls x 1).
using ControlOf = std::function<Eigen::VectorXd(double from, double h)>;

/// Rates of the rigid motions of the whole system at full coordinates y, one a column, (full x motions). The scheme
/// CORRECTED_MIDPOINT adds no force along them.
using RigidMotions = std::function<Eigen::MatrixXd(const Eigen::VectorXd& y)>;

/// M v of a problem's inertia terms [kg m/s], (full x 1). @param v  rates [m/s], (full x 1)
Eigen::VectorXd momentumOf(const solver::TermProblem& problem, const Eigen::VectorXd& v);

class Stepper {
 public:
  /// @param problem  with inertia terms
  /// @param rigid  for CORRECTED_MIDPOINT. Empty: its force does not conserve momenta. Controls must be loads with this
  /// scheme: the energy balance does not contain the work of prescribed displacements
  /// @throws common::Error for settings out of range, or a problem without mass
  Stepper(std::shared_ptr<const solver::TermProblem> problem, const Scheme& scheme, const StepperSettings& settings,
          RigidMotions rigid = {});
  ~Stepper();

  /// Initial state at free coordinates z [m] and controls p.
  /// @param rate  of the full coordinates [m/s]; empty: at rest
  /// @param references  of rotations; null: all I. @throws common::Error for another number of rates
  MotionState start(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const Eigen::VectorXd& rate = {},
                    std::shared_ptr<const solver::References> references = nullptr) const;
  /// One step, not beyond `until` [s]. A step that fails, or whose error is too large, is repeated with half its
  /// length.
  /// @throws common::Error with time and reasons if the smallest step fails; the state is then unchanged
  StepAccount step(MotionState& state, double until, const ControlOf& control);

  /// Kinetic energy [J] and generalised momenta M v [kg m/s] at rates v [m/s].
  double kineticEnergy(const Eigen::VectorXd& v) const;
  Eigen::VectorXd momentum(const Eigen::VectorXd& v) const { return momentumOf(*problem_, v); }
  double storedEnergy(const Eigen::VectorXd& y, const Eigen::VectorXd& p) const;  ///< of the terms [J]; no HistoryTerms
  /// Discards the factor and the history of the solver: the next step depends only on the state, as in a resumed run.
  void restart() { solver_->restart(); }
  const solver::TermProblem& problem() const { return *problem_; }
  const Scheme& scheme() const { return scheme_; }
  double secondsAssembly() const { return solver_->secondsAssembly(); }         ///< wall time so far [s]
  double secondsFactor() const { return solver_->cholesky().secondsFactor(); }  ///< [s]
  double secondsSolve() const { return solver_->cholesky().secondsSolve(); }    ///< [s]
  int totalIterations() const { return iterations_; }
  int totalFactorizations() const { return factorizations_; }

 private:
  struct Trial;
  bool attempt(const MotionState& from, double h, const ControlOf& control, Trial& out);
  bool solve(const MotionState& from, const solver::StepContext& context, Trial& out);
  static Eigen::VectorXd guessOf(const MotionState& from, double h);
  void account(const MotionState& from, Trial& out);
  /// Repeats the solve of the step until its energy balance closes. @return false: no bounded force closes it
  bool correct(const MotionState& from, Trial& out);
  Eigen::VectorXd withoutRigidPart(const Eigen::VectorXd& y, const Eigen::VectorXd& d) const;
  /// Updates the internal variables at the end of a step, and adds their energy and loss.
  void passHistory(Trial& out);
  double heldBy(const Eigen::VectorXd& history) const;  ///< [J]
  double meanOverMass(const Eigen::VectorXd& shift) const;

  std::shared_ptr<const solver::TermProblem> problem_;
  Scheme scheme_;
  StepperSettings settings_;
  RigidMotions rigid_;
  std::unique_ptr<solver::StepProblem> step_problem_;
  std::unique_ptr<solver::EquilibriumSolver> solver_;
  struct WithHistory {
    std::size_t term;  ///< of the problem
    const solver::HistoryTerm* history;
    Eigen::Index first;  ///< index of its first variable
  };
  std::vector<WithHistory> with_history_;
  Eigen::Index history_count_ = 0;
  double total_mass_ = 0;  ///< [kg] summed over coordinates
  int iterations_ = 0, factorizations_ = 0;
  mutable solver::Sum sum_;
};

}  // namespace snapwing::motion
