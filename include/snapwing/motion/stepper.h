#pragma once
/// Steps in time of any sum of terms, with or without constraints that are kept as equations: Newton on each step,
/// halved where it fails, chosen by a local error if asked for, with an account of energy. Every number is
/// reproducible: same state, same bits.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/motion/scheme.h"
#include "snapwing/solver/equilibrium.h"
#include "snapwing/solver/prony_term.h"
#include "snapwing/solver/term_problem.h"

namespace snapwing::motion {

/// Motion at one instant; what a run is resumed from.
struct MotionState {
  double time = 0;                                       ///< [s]
  Eigen::VectorXd z;                                     ///< free coordinates
  std::shared_ptr<const solver::References> references;  ///< of rotations; null: all 1
  Eigen::VectorXd y, v;                                  ///< full coordinates [m] and rates [m/s]
  Eigen::VectorXd multipliers;   ///< of kept constraints, mean of the last step [N]; empty without, or where unknown
  Eigen::VectorXd acceleration;  ///< mean of the last step [m/s2]; empty at the start and after jumps
  Eigen::VectorXd mean_rate;     ///< the last step over its time [m/s]; empty at the start and after jumps
  Eigen::VectorXd mean_rate_change;  ///< how it changed since the step before [m/s2]; empty until there are two
  double last_step = 0;              ///< [s] that it was
  double next_step = 0;              ///< [s] that the error asks for; 0: the largest
  double kinetic = 0;                ///< [J]
  double stored = 0;                 ///< [J] that of internal variables included
  Eigen::VectorXd history;           ///< internal variables of the terms that have some, in the problem's order
};

struct StepperSettings {
  double largest_step = 1e-3;        ///< [s] > 0
  double smallest_step = 1e-7;       ///< [s] > 0: below, the motion has failed
  double error = 0;                  ///< [m] largest local error of a step, mean over the mass; 0: steps are not chosen
  double relative_tolerance = 1e-8;  ///< of Newton, as in NewtonSettings
  double roundings = 10;             ///< as in NewtonSettings
  int max_iterations = 30;
  solver::Projection projection = solver::Projection::ON_DEMAND;
  bool keep_factor = false;  ///< as in NewtonSettings
  /// @throws common::Error naming the member
  void validate() const;
};

/// What a term did in a step.
struct TermWork {
  std::string name;
  solver::Term::Role role;
  double work = 0;  ///< [J] done by loads; lost to dissipation, >= 0
};

struct StepAccount {
  double h = 0;        ///< [s]
  double kinetic = 0;  ///< at the end [J]
  double stored = 0;   ///< at the end [J]
  double work = 0;     ///< of loads [J]
  double loss = 0;     ///< to dissipation [J]
  /// kinetic + stored - what they were - work + loss [J]: what the scheme itself fed or ate
  double imbalance = 0;
  std::vector<TermWork> terms;  ///< loads and dissipation, in the problem's order; those with internal variables last
  int iterations = 0, factorizations = 0;
  double error = 0;      ///< [m] local error, mean over the mass
  double min_det_f = 1;  ///< smallest on the step's path
};

/// Called where steps begin: the controls for one that goes from `from` to `from + h` (means over it).
using ControlOf = std::function<Eigen::VectorXd(double from, double h)>;

/// Rigid motions of all that moves at full coordinates y, one a column: along them the scheme CORRECTED_MIDPOINT adds
/// no force.
using RigidMotions = std::function<Eigen::MatrixXd(const Eigen::VectorXd& y)>;

/// M v of a problem's terms of inertia by coordinate [kg m/s], for rates v [m/s].
Eigen::VectorXd momentumOf(const solver::TermProblem& problem, const Eigen::VectorXd& v);

class Stepper {
 public:
  /// @param problem  with its inertia. @throws common::Error for settings
  /// @param rigid  for CORRECTED_MIDPOINT, whose controls must be loads: what moves coordinates does work that the
  /// account does not know. Empty: momenta are not kept by its force
  Stepper(std::shared_ptr<const solver::TermProblem> problem, const Scheme& scheme, const StepperSettings& settings,
          RigidMotions rigid = {});
  ~Stepper();

  /// At rest, or moving with `rate`, at free coordinates. @param rate  full [m/s]; empty: at rest
  /// @param references  of rotations; null: all 1
  MotionState start(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const Eigen::VectorXd& rate = {},
                    std::shared_ptr<const solver::References> references = nullptr) const;
  /// One step, not beyond `until`; a step that fails is halved. A step whose error is too large is thrown away and done
  /// again. @throws common::Error saying when, where and why, if the smallest step fails; the state is then what it was
  StepAccount step(MotionState& state, double until, const ControlOf& control);

  /// Kinetic energy [J] and momenta by coordinate M v [kg m/s].
  double kineticEnergy(const Eigen::VectorXd& v) const;
  Eigen::VectorXd momentum(const Eigen::VectorXd& v) const { return momentumOf(*problem_, v); }
  double storedEnergy(const Eigen::VectorXd& y, const Eigen::VectorXd& p) const;  ///< [J]
  /// Forgets the factor and how earlier steps went: what follows depends on the state alone, as in a resumed run.
  void restart() { solver_->restart(); }
  const solver::TermProblem& problem() const { return *problem_; }
  const Scheme& scheme() const { return scheme_; }
  double secondsAssembly() const { return solver_->secondsAssembly(); }         ///< of the CPU so far [s]
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
  /// Solves the step again until its account closes. @return false: no bounded force does it
  bool correct(const MotionState& from, Trial& out);
  Eigen::VectorXd withoutRigidPart(const Eigen::VectorXd& y, const Eigen::VectorXd& d) const;
  /// Internal variables at the end of a step, with their energy and loss.
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
    Eigen::Index first;  ///< of its variables
  };
  std::vector<WithHistory> with_history_;
  Eigen::Index history_count_ = 0;
  double total_mass_ = 0;  ///< [kg] summed over coordinates
  int iterations_ = 0, factorizations_ = 0;
  mutable solver::Sum sum_;
};

}  // namespace snapwing::motion
