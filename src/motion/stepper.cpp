#include "snapwing/motion/stepper.h"

#include <cmath>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/require.h"

namespace snapwing::motion {

using solver::Order;
using solver::Term;

void StepperSettings::validate() const {
  const common::Require require;
  require(largest_step > 0 && largest_step <= 1, "largest_step", largest_step, "(0, 1] s");
  require(smallest_step > 0 && smallest_step <= largest_step, "smallest_step", smallest_step, "(0, largest_step]");
  require(error >= 0 && std::isfinite(error), "error", error, ">= 0 m");
}

/// Terms of inertia as a step from rest at 0 with h = 0 and unit weight sees them: their slope at v is M v.
Eigen::VectorXd momentumOf(const solver::TermProblem& problem, const Eigen::VectorXd& v) {
  solver::Step unit;
  unit.kappa = 1;
  unit.y0 = unit.v0 = Eigen::VectorXd::Zero(v.size());
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(problem.controlCount());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(v.size());
  solver::Sum own;
  for (std::size_t k = 0; k < problem.terms().size(); ++k) {
    if (problem.terms()[k]->role() != Term::Role::INERTIA) continue;
    problem.evaluateTerm(k, {v, none, &unit, problem.threads()}, Order::STRESS, own);
    sum += own.gradient;
  }
  return sum;
}

/// A step that was tried.
struct Stepper::Trial {
  MotionState end;
  StepAccount account;
  solver::StepContext context;
  solver::Equilibrium x;
  Eigen::VectorXd control;
  solver::NewtonResult newton;
};

Stepper::Stepper(std::shared_ptr<const solver::TermProblem> problem, const Scheme& scheme,
                 const StepperSettings& settings, RigidMotions rigid)
    : problem_(std::move(problem)), scheme_(scheme), settings_(settings), rigid_(std::move(rigid)) {
  settings_.validate();
  step_problem_ = std::make_unique<solver::StepProblem>(problem_, nullptr, nullptr);
  solver::NewtonSettings newton;
  newton.max_iterations = settings.max_iterations;
  newton.relative_tolerance = settings.relative_tolerance;
  newton.roundings = settings.roundings;
  if (scheme.kind() == SchemeKind::CORRECTED_MIDPOINT) {
    // What a residual leaves is work that no scalar takes back.
    newton.relative_tolerance = std::max(1e-3 * settings.relative_tolerance, 1e-15);
  }
  newton.projection = settings.projection;
  // The saddle point of constraints that are kept asks for each tangent.
  newton.keep_factor = settings.keep_factor && problem_->constraints() == nullptr;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(problem_->controlCount());
  solver_ = std::make_unique<solver::EquilibriumSolver>(*step_problem_, newton, solver::ControlLine{none, none});
  for (std::size_t k = 0; k < problem_->terms().size(); ++k) {
    const auto* term = dynamic_cast<const solver::HistoryTerm*>(problem_->terms()[k].get());
    if (term == nullptr) continue;
    with_history_.push_back({k, term, history_count_});
    history_count_ += term->historyCount();
  }
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(problem_->coordinates().fullCount());
  total_mass_ = momentum(ones).sum();
  if (!(total_mass_ > 0)) throw common::Error("a problem in time has no mass: give it a term of inertia");
}

Stepper::~Stepper() = default;

MotionState Stepper::start(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const Eigen::VectorXd& rate,
                           std::shared_ptr<const solver::References> references) const {
  MotionState state;
  state.z = z;
  state.y = problem_->coordinates().expand(z, p, references.get());
  state.references = std::move(references);
  state.v = rate.size() > 0 ? rate : Eigen::VectorXd::Zero(state.y.size());
  if (state.v.size() != state.y.size()) {
    throw common::Error("rates have " + std::to_string(state.v.size()) +
                        " values; allowed: " + std::to_string(state.y.size()));
  }
  state.kinetic = kineticEnergy(state.v);
  state.stored = storedEnergy(state.y, p);
  state.history = Eigen::VectorXd::Zero(history_count_);
  return state;
}

double Stepper::kineticEnergy(const Eigen::VectorXd& v) const { return 0.5 * v.dot(momentum(v)); }

double Stepper::heldBy(const Eigen::VectorXd& history) const {
  double energy = 0;
  for (const WithHistory& with : with_history_) {
    energy += with.history->storedIn(history.segment(with.first, with.history->historyCount()));
  }
  return energy;
}

double Stepper::meanOverMass(const Eigen::VectorXd& shift) const {
  return std::sqrt(std::max(0.0, shift.dot(momentum(shift))) / total_mass_);
}

double Stepper::storedEnergy(const Eigen::VectorXd& y, const Eigen::VectorXd& p) const {
  double energy = 0;
  for (std::size_t k = 0; k < problem_->terms().size(); ++k) {
    if (problem_->terms()[k]->role() != Term::Role::STORED) continue;
    problem_->evaluateTerm(k, {y, p, nullptr, problem_->threads()}, Order::ENERGY, sum_);
    energy += sum_.finite ? sum_.stored : std::numeric_limits<double>::infinity();
  }
  return energy;
}

/// First guess of a step: on as the steps before led. Rates at their ends would do as well for what moves smoothly, but
/// those of stiff light cells change their sign at each step of the midpoint rule, while the cells hardly move.
Eigen::VectorXd Stepper::guessOf(const MotionState& from, double h) {
  if (from.mean_rate_change.size() > 0) {
    return h * (from.mean_rate + 0.5 * (h + from.last_step) * from.mean_rate_change);
  }
  Eigen::VectorXd moved = h * from.v;
  if (from.acceleration.size() > 0) moved += 0.5 * h * h * from.acceleration;
  return moved;
}

/// Bodies turn on as they do.
bool Stepper::solve(const MotionState& from, const solver::StepContext& context, Trial& out) {
  const solver::Coordinates& coordinates = problem_->coordinates();
  const double h = context.step.h;
  step_problem_->setStep(std::shared_ptr<const solver::StepContext>(std::shared_ptr<void>(), &context),
                         from.references);
  const Eigen::VectorXd moved = guessOf(from, h);
  solver::Coordinates::Place now;
  coordinates.at(from.z, out.control, from.references.get(), now);
  const Eigen::VectorXd turned = coordinates.rotationRates(now, moved);
  const Eigen::VectorXd guess = coordinates.freePart(from.y + moved, from.z.tail(turned.size()) + turned);
  solver_->setLine({out.control, Eigen::VectorXd::Zero(out.control.size())});
  const int constraints = solver_->constraintCount();
  const bool known = from.multipliers.size() == constraints;
  for (const bool from_rest : {false, true}) {
    out.x.z = from_rest ? from.z : guess;
    out.x.multipliers = known ? from.multipliers : Eigen::VectorXd(Eigen::VectorXd::Zero(constraints));
    out.newton = solver_->minimise(out.x);
    out.end.z = out.x.z;
    out.end.multipliers = out.x.multipliers;
    out.account.iterations += out.newton.iterations;
    out.account.factorizations += out.newton.factorizations;
    if (out.newton.converged()) return true;
  }
  return false;
}

bool Stepper::attempt(const MotionState& from, double h, const ControlOf& control, Trial& out) {
  out.account = StepAccount{};
  out.account.h = h;
  out.control = control(from.time, h);
  out.context = solver::StepContext{};
  out.context.step = scheme_.begin(h, from.y, from.v);
  out.context.step.p0 = out.control;
  out.context.step.kept = problem_->keep(from.y, out.control);
  out.context.stored_at_start = from.stored - heldBy(from.history);
  if (!with_history_.empty()) {
    out.context.step.kept.resize(problem_->terms().size());
    const solver::Point start{from.y, out.control, nullptr, problem_->threads()};
    for (const WithHistory& with : with_history_) {
      out.context.step.kept[with.term] =
          with.history->keepWith(start, from.history.segment(with.first, with.history->historyCount()));
    }
  }
  if (scheme_.meanDirections() && problem_->coordinates().rotationCount() > 0) {
    auto place = std::make_shared<solver::Coordinates::Place>();
    problem_->coordinates().at(from.z, out.control, from.references.get(), *place);
    out.context.mean_with = place;
  }
  bool good = solve(from, out.context, out);
  if (good) account(from, out);
  if (good && scheme_.kind() == SchemeKind::CORRECTED_MIDPOINT) good = correct(from, out);
  iterations_ += out.account.iterations;
  factorizations_ += out.account.factorizations;
  if (!good) return false;
  // The path may miss what the end shows: an inverted element.
  return std::isfinite(out.account.stored);
}

void Stepper::account(const MotionState& from, Trial& out) {
  const solver::Step& step = out.context.step;
  MotionState& end = out.end;
  end.time = from.time + step.h;
  end.y = out.x.at.place.y;
  end.v = scheme_.rates(step.h, end.y - from.y, from.v);
  end.acceleration = (end.v - from.v) / step.h;
  end.mean_rate = (end.y - from.y) / step.h;
  if (from.mean_rate.size() > 0) {
    end.mean_rate_change = (end.mean_rate - from.mean_rate) / (0.5 * (step.h + from.last_step));
  }
  end.last_step = step.h;
  end.references = from.references;
  StepAccount& account = out.account;
  account.terms.clear();
  account.work = account.loss = 0;
  const Eigen::VectorXd d = end.y - from.y;
  const solver::Point point{end.y, out.control, &step, problem_->threads()};
  for (std::size_t k = 0; k < problem_->terms().size(); ++k) {
    const Term& term = *problem_->terms()[k];
    if (term.role() != Term::Role::LOAD && term.role() != Term::Role::DISSIPATION) continue;
    if (dynamic_cast<const solver::HistoryTerm*>(&term) != nullptr) continue;
    problem_->evaluateTerm(k, point, Order::STRESS, sum_);
    const double done = sum_.gradient.dot(d);
    const bool load = term.role() == Term::Role::LOAD;
    account.terms.push_back({term.name(), term.role(), load ? -done : done});
    (load ? account.work : account.loss) += load ? -done : done;
  }
  account.kinetic = kineticEnergy(end.v);
  account.stored = storedEnergy(end.y, out.control);
  passHistory(out);
  end.kinetic = account.kinetic;
  end.stored = account.stored;
  account.imbalance = account.kinetic + account.stored - from.kinetic - from.stored - account.work + account.loss;
  account.min_det_f = out.x.at.min_det_f;
  if (settings_.error > 0) {
    const Eigen::VectorXd change =
        from.acceleration.size() > 0 ? Eigen::VectorXd(end.acceleration - from.acceleration) : end.acceleration;
    const double before = from.last_step > 0 ? from.last_step : step.h;
    account.error = meanOverMass(scheme_.localError(change, end.acceleration, step.h, before));
  }
  if (problem_->coordinates().rotationCount() > 0) {
    end.references = problem_->coordinates().renew(end.z, from.references.get());
  }
}

Eigen::VectorXd Stepper::withoutRigidPart(const Eigen::VectorXd& y, const Eigen::VectorXd& d) const {
  if (!rigid_) return d;
  const Eigen::MatrixXd motions = rigid_(y);
  Eigen::MatrixXd weighed(motions.rows(), motions.cols());
  for (Eigen::Index k = 0; k < motions.cols(); ++k) weighed.col(k) = momentum(motions.col(k));
  const Eigen::MatrixXd masses = motions.transpose() * weighed;
  return d - motions * masses.ldlt().solve(weighed.transpose() * d);
}

/// The force is beta M d' on the step, beta (d' . M d') the work that the account misses; inertia takes it as a change
/// of the rates at the start. d' of the round before changes by about beta h^2 of itself in a round, and so does what
/// is missing: at first it may even grow.
bool Stepper::correct(const MotionState& from, Trial& out) {
  constexpr int ROUNDS = 20, IN_VAIN = 2;
  constexpr double CLOSED = 1e-12, LARGEST = 0.1;  // of the energies; of 1/h^2
  solver::Step& step = out.context.step;
  double beta = 0, least = std::numeric_limits<double>::infinity();
  for (int round = 0, in_vain = 0; round < ROUNDS; ++round) {
    const StepAccount& now = out.account;
    const double missing = now.imbalance;
    if (!std::isfinite(missing)) return false;
    if (std::abs(missing) <= CLOSED * (now.kinetic + std::abs(now.stored) + std::abs(now.work) + now.loss)) break;
    in_vain = std::abs(missing) < 0.9 * least ? 0 : in_vain + 1;
    if (in_vain > IN_VAIN) break;  // Newton's tolerance is reached
    least = std::min(least, std::abs(missing));
    const Eigen::VectorXd d = out.end.y - from.y, own = withoutRigidPart(from.y + 0.5 * d, d);
    const double square = own.dot(momentum(own));
    // What hardly changes its shape has no room for it, and no need.
    if (!(square > 1e-24 * d.dot(momentum(d)))) break;
    beta += missing / square;
    if (std::abs(beta) * step.h * step.h > LARGEST) return false;
    step.v0 = from.v - beta / (step.kappa * step.h) * own;
    out.newton = solver_->minimise(out.x);
    out.account.iterations += out.newton.iterations;
    out.account.factorizations += out.newton.factorizations;
    if (!out.newton.converged()) return false;
    out.end.z = out.x.z;
    out.end.multipliers = out.x.multipliers;
    account(from, out);
  }
  return true;
}

/// What a branch loses is known in closed form; work beyond that and its energy is the scheme's.
void Stepper::passHistory(Trial& out) {
  out.end.history.resize(history_count_);
  solver::Point end{out.end.y, out.control, &out.context.step, problem_->threads()};
  for (const WithHistory& with : with_history_) {
    end.kept = out.context.step.kept[with.term].get();
    const solver::HistoryTerm::Passed passed = with.history->pass(end);
    out.end.history.segment(with.first, passed.history.size()) = passed.history;
    out.account.stored += passed.stored;
    out.account.loss += passed.loss;
    out.account.terms.push_back({with.history->name(), Term::Role::DISSIPATION, passed.loss});
  }
}

StepAccount Stepper::step(MotionState& state, double until, const ControlOf& control) {
  if (!(until > state.time)) {
    throw common::Error("a step from " + common::toText(state.time) + " s until " + common::toText(until) +
                        " s; allowed: later than its start");
  }
  double wanted = state.next_step > 0 ? state.next_step : settings_.largest_step;
  const double left = until - state.time;
  Trial trial;
  std::string tried;
  for (;;) {
    // Equal steps up to `until`, so that no sliver is left.
    const double h = left / std::max(1.0, std::ceil(left / wanted - 1e-9));
    const bool good = attempt(state, h, control, trial);
    const bool exact =
        settings_.error == 0 || trial.account.error <= settings_.error || wanted <= settings_.smallest_step;
    if (good && exact) {
      const bool may_grow = settings_.error > 0 && trial.account.error < settings_.error / 10;
      trial.end.next_step = may_grow ? std::min(2 * wanted, settings_.largest_step) : wanted;
      if (settings_.error == 0) trial.end.next_step = std::min(2 * wanted, settings_.largest_step);
      if (std::abs(until - trial.end.time) < 1e-12 * std::max(1.0, until)) trial.end.time = until;
      state = std::move(trial.end);
      return trial.account;
    }
    if (!good) {
      tried += (tried.empty() ? "" : "; ") + common::toText(h) + " s: " +
               (trial.newton.converged() ? "the end of the step inverts an element (det F <= 0)"
                                         : solver::statusName(trial.newton.status) + ", " + trial.newton.message);
      if (wanted <= settings_.smallest_step || tried.size() > 4000) {
        throw common::Error("the motion failed at " + common::toText(state.time) + " s; steps tried: " + tried);
      }
    }
    wanted = std::max(0.5 * std::min(wanted, h), settings_.smallest_step);
  }
}

}  // namespace snapwing::motion
