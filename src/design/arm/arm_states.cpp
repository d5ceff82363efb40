#include "arm_states.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "snapwing/common/parallel.h"
#include "snapwing/statics/path.h"

namespace snapwing::design {

namespace {

constexpr double TRACE_STEP = 0.0025;   ///< [m]
constexpr double RETRACE_STEP = 0.005;  ///< [m]; the path follower halves it where Newton needs it

statics::PathSettings pathSettings(double tolerance) {
  statics::PathSettings settings;
  settings.newton.relative_tolerance = tolerance;
  // Where a path turns unstable is not asked here; finding it takes dozens of factors without a Cholesky factor.
  settings.locate_singular = false;
  return settings;
}

}  // namespace

void ArmTopology::sense(const Variant& variant, State& state, const solver::TangentSystem* system,
                        const solver::Evaluation& at) const {
  const Mechanism& mechanism = variant.mechanism;
  if (state.wants_strain) state.strain = mechanism.strain(settings_.strain_power, system, at);
  if (state.wants_rotation) state.rotation = mechanism.rotation(system, at);
  if (state.wants_potential) state.potential = mechanism.potential(system, at);
}

/// A variant's states are dealt out to two workers: with three variants on two threads, one would else wait for the
/// other. The number of workers does not depend on the number of threads, so that the bits do not either.
void ArmTopology::makeLanes(Variant& variant) const {
  constexpr std::size_t OF_PULLED = 4;  // the state under a force takes as long as about four at a travel
  const std::size_t count = variant.states.size();
  const std::size_t split = count > OF_PULLED ? (count - OF_PULLED) / 2 : count;
  for (const auto& [first, end] : {std::array<std::size_t, 2>{0, split}, {split, count}}) {
    if (first == end && first > 0) continue;
    variant.workers.push_back(std::make_unique<Worker>(variant.mechanism.problem(), newton_tolerance_));
    Worker& worker = *variant.workers.back();
    worker.first = first, worker.end = end, worker.with_pulled = first == 0;
  }
}

bool ArmTopology::solveState(const Variant& variant, Worker& worker, State& state, bool with_derivatives) const {
  solver::Evaluation& at = worker.at;
  const solver::NewtonResult solved = worker.newton.solve(Eigen::VectorXd::Constant(1, state.travel), state.z, at);
  worker.newton_iterations += solved.iterations;
  if (!solved.converged()) {
    std::ostringstream text;
    text << "no equilibrium at u = " << state.travel << " m: " << solver::statusName(solved.status);
    worker.why = text.str();
    return false;
  }
  const Mechanism& mechanism = variant.mechanism;
  state.force = mechanism.force(at);
  if (!with_derivatives) {
    sense(variant, state, nullptr, at);
    return true;
  }
  const double begin = solver::secondsNow();
  solver::TangentSystem system(mechanism.problem(), worker.newton.cholesky());
  if (system.factorize(at) < 0) {
    worker.why = "singular tangent at u = " + std::to_string(state.travel) + " m";
    return false;
  }
  Eigen::VectorXd free_part, control_part;
  mechanism.problem().controlTangent(at, Eigen::VectorXd::Ones(1), free_part, control_part);
  state.slope = -worker.newton.cholesky().solve(free_part);
  state.stiffness = mechanism.multiplicity() * (control_part(0) + free_part.dot(state.slope));
  state.by_density = mechanism.forceByDensity(system, at, state.slope);
  sense(variant, state, &system, at);
  worker.seconds_derivatives += solver::secondsNow() - begin;
  return true;
}

/// First travel on the path from rest that pulls with at least -f: its state is the start of a Newton on the travel.
bool ArmTopology::tracePulled(Variant& variant, std::string& why) const {
  constexpr double LARGEST = 0.2;  // [m] of pull
  const solver::Problem& problem = variant.mechanism.problem();
  statics::PathFollower follower(problem, pathSettings(newton_tolerance_));
  State& s = variant.pulled;
  s.travel = 0;
  s.z = Eigen::VectorXd::Zero(problem.freeCount());
  std::ostringstream text;
  text << "the arm does not hold the compliance force of " << settings_.compliance_force << " N up to u = ";
  while (s.travel > -LARGEST) {
    const statics::PathResult path = follower.follow(s.z, {s.travel, s.travel - TRACE_STEP});
    if (path.status != solver::SolveStatus::CONVERGED) {
      text << s.travel << " m: " << path.message;
      break;
    }
    s.travel -= TRACE_STEP;
    s.z = path.points.back().solution;
    if (variant.mechanism.multiplicity() * path.points.back().force <= -settings_.compliance_force) return true;
  }
  if (s.travel <= -LARGEST) text << s.travel << " m";
  why = text.str();
  s.z.resize(0);
  return false;
}

/// Newton on the travel until R(u3) = -f, from the last design's state or else from the path.
bool ArmTopology::solvePulled(Variant& variant, Worker& worker) const {
  if (settings_.compliance_weight == 0 || settings_.compliance_force == 0) return true;
  State& s = variant.pulled;
  for (int attempt = s.z.size() == 0 ? 1 : 0; attempt < 2; ++attempt) {
    if (attempt == 1 && !tracePulled(variant, worker.why)) return false;
    for (int k = 0; k < 30; ++k) {
      if (!solveState(variant, worker, s, true)) break;
      const double missing = -settings_.compliance_force - s.force;
      if (std::abs(missing) < 1e-7 * settings_.compliance_force) return true;
      if (!(s.stiffness > 0)) break;
      const double step = std::clamp(missing / s.stiffness, -TRACE_STEP, TRACE_STEP);
      s.travel += step;
      s.z += step * s.slope;
    }
  }
  if (worker.why.empty()) worker.why = "no equilibrium under the compliance force was found near the path from rest";
  return false;
}

bool ArmTopology::retrace(Variant& variant) const {
  ++variant.retraces;
  variant.retraced = true;
  std::vector<double> targets{0.0};
  std::vector<std::size_t> place;
  for (const double travel : travels_) {
    while (targets.back() + RETRACE_STEP < travel - 1e-6) targets.push_back(targets.back() + RETRACE_STEP);
    place.push_back(targets.size());
    targets.push_back(travel);
  }
  const solver::Problem& problem = variant.mechanism.problem();
  const statics::PathResult path = statics::PathFollower(problem, pathSettings(newton_tolerance_))
                                       .follow(Eigen::VectorXd::Zero(problem.freeCount()), targets);
  variant.newton_iterations += path.iterations;
  variant.seconds_retrace += path.seconds;
  if (path.status != solver::SolveStatus::CONVERGED) {
    variant.why = path.message;
    return false;
  }
  for (std::size_t k = 0; k < place.size(); ++k) variant.states[k].z = path.points[place[k]].solution;
  return true;
}

void ArmTopology::beginVariant(Variant& variant) const {
  variant.mechanism.setDensities(variant.density);
  variant.retraced = false;
  const bool cold = variant.states.front().z.size() == 0;
  // Warm states that the path from rest does not reach are still equilibria: the run goes on from them.
  variant.good = !(cold || retrace_wanted_) || retrace(variant) || !cold;
}

/// @return false if no equilibrium was found at a travel; whether the worker is good says all
bool ArmTopology::solveStates(Variant& variant, Worker& worker, bool with_derivatives) const {
  worker.newton.restart();  // a run that is resumed has no factor of earlier designs either
  worker.why.clear();
  worker.good = false;
  for (std::size_t k = worker.first; k < worker.end; ++k) {
    if (!solveState(variant, worker, variant.states[k], with_derivatives)) return false;
  }
  worker.good = !worker.with_pulled || solvePulled(variant, worker);
  return true;
}

/// Workers share nothing that changes, so that the number of threads does not change a bit.
bool ArmTopology::solveVariants(bool with_derivatives, std::string& why) {
  const auto workers = static_cast<int>(variants_.front()->workers.size()), count = static_cast<int>(variants_.size());
  common::parallelFor(count, settings_.threads, [&](int v) { beginVariant(*variants_[v]); });
  std::vector<char> found(static_cast<std::size_t>(count) * workers, 1);
  common::parallelFor(count * workers, settings_.threads, [&](int n) {
    Variant& variant = *variants_[n / workers];
    if (variant.good) found[n] = solveStates(variant, *variant.workers[n % workers], with_derivatives);
  });
  common::parallelFor(count, settings_.threads, [&](int v) {
    Variant& variant = *variants_[v];
    const auto begin = found.begin() + v * workers;
    if (variant.good && !variant.retraced && std::find(begin, begin + workers, 0) != begin + workers) {
      variant.good = retrace(variant);  // all states again, from rest
      for (auto& worker : variant.workers) {
        if (!variant.good || !solveStates(variant, *worker, with_derivatives)) break;
      }
    }
    for (const auto& worker : variant.workers) {
      if (variant.good && !worker->good) variant.good = false, variant.why = worker->why;
    }
  });
  for (const auto& variant : variants_) {
    if (variant->good) continue;
    why = variant->why;
    return false;
  }
  return true;
}

int ArmTopology::retraces() const {
  int sum = 0;
  for (const auto& variant : variants_) sum += variant->retraces;
  return sum;
}

long ArmTopology::newtonIterations() const {
  long sum = 0;
  for (const auto& variant : variants_) {
    sum += variant->newton_iterations;
    for (const auto& worker : variant->workers) sum += worker->newton_iterations;
  }
  return sum;
}

ArmTopology::Seconds ArmTopology::seconds() const {
  Seconds sum;
  for (const auto& variant : variants_) {
    sum.retraces += variant->seconds_retrace;
    for (const auto& worker : variant->workers) {
      sum.assembly += worker->newton.secondsAssembly();
      sum.factor += worker->newton.cholesky().secondsFactor();
      sum.solve += worker->newton.cholesky().secondsSolve();
      sum.derivatives += worker->seconds_derivatives;
    }
  }
  return sum;
}

std::map<std::string, Eigen::VectorXd> ArmTopology::warmStates() const {
  std::map<std::string, Eigen::VectorXd> arrays;
  for (std::size_t v = 0; v < variants_.size(); ++v) {
    const std::string name = "warm_" + std::to_string(v) + "_";
    for (std::size_t k = 0; k < variants_[v]->states.size(); ++k) {
      arrays[name + std::to_string(k)] = variants_[v]->states[k].z;
    }
    arrays[name + "pulled"] = variants_[v]->pulled.z;
    arrays[name + "pulled_travel"] = Eigen::VectorXd::Constant(1, variants_[v]->pulled.travel);
  }
  return arrays;
}

void ArmTopology::restoreWarmStates(const std::map<std::string, Eigen::VectorXd>& arrays) {
  const std::map<std::string, Eigen::VectorXd> mine = warmStates();
  for (const auto& [name, empty] : mine) {
    if (arrays.count(name) == 0) return;  // from rest, then
  }
  for (std::size_t v = 0; v < variants_.size(); ++v) {
    const std::string name = "warm_" + std::to_string(v) + "_";
    for (std::size_t k = 0; k < variants_[v]->states.size(); ++k) {
      variants_[v]->states[k].z = arrays.at(name + std::to_string(k));
    }
    variants_[v]->pulled.z = arrays.at(name + "pulled");
    variants_[v]->pulled.travel = arrays.at(name + "pulled_travel")(0);
  }
  retrace_wanted_ = false;
  restored_ = true;
}

}  // namespace snapwing::design
