#include "arm_states.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <sstream>
#include <thread>

#include "snapwing/statics/path.h"

namespace snapwing::design {

namespace {

constexpr double TRACE_STEP = 0.0025;  ///< [m]

statics::PathSettings pathSettings(double tolerance) {
  statics::PathSettings settings;
  settings.newton.relative_tolerance = tolerance;
  return settings;
}

}  // namespace

void ArmTopology::sense(const Variant& variant, State& state, const statics::Cholesky* cholesky,
                        const statics::Evaluation& at) const {
  const Mechanism& mechanism = variant.mechanism;
  if (state.wants_strain) state.strain = mechanism.strain(settings_.strain_power, cholesky, at);
  if (state.wants_rotation) state.rotation = mechanism.rotation(cholesky, at);
  if (state.wants_potential) state.potential = mechanism.potential(cholesky, at);
}

bool ArmTopology::solveState(Variant& variant, State& state, bool with_derivatives, std::string& why) const {
  statics::Evaluation at;
  const statics::NewtonResult solved = variant.newton.solve(Eigen::VectorXd::Constant(1, state.travel), state.z, at);
  variant.newton_iterations += solved.iterations;
  if (!solved.converged()) {
    std::ostringstream text;
    text << "no equilibrium at u = " << state.travel << " m: " << statics::statusName(solved.status);
    why = text.str();
    return false;
  }
  const Mechanism& mechanism = variant.mechanism;
  state.force = mechanism.force(at);
  if (!with_derivatives) {
    sense(variant, state, nullptr, at);
    return true;
  }
  statics::Cholesky& cholesky = variant.newton.cholesky();
  if (!cholesky.factorize(at.hessian) && cholesky.factorizeIndefinite(at.hessian) < 0) {
    why = "singular tangent at u = " + std::to_string(state.travel) + " m";
    return false;
  }
  Eigen::VectorXd free_part, control_part;
  mechanism.problem().controlTangent(at, Eigen::VectorXd::Ones(1), free_part, control_part);
  state.slope = -cholesky.solve(free_part);
  state.stiffness = mechanism.multiplicity() * (control_part(0) + free_part.dot(state.slope));
  state.by_density = mechanism.forceByDensity(cholesky, at);
  sense(variant, state, &cholesky, at);
  return true;
}

/// First travel on the path from rest that pulls with at least -f: its state is the start of a Newton on the travel.
bool ArmTopology::tracePulled(Variant& variant, std::string& why) const {
  constexpr double LARGEST = 0.2;  // [m] of pull
  const statics::Problem& problem = variant.mechanism.problem();
  statics::PathFollower follower(problem, pathSettings(newton_tolerance_));
  State& s = variant.pulled;
  s.travel = 0;
  s.z = Eigen::VectorXd::Zero(problem.freeCount());
  std::ostringstream text;
  text << "the arm does not hold the compliance force of " << settings_.compliance_force << " N up to u = ";
  while (s.travel > -LARGEST) {
    const statics::PathResult path = follower.follow(s.z, {s.travel, s.travel - TRACE_STEP});
    if (path.status != statics::SolveStatus::CONVERGED) {
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
bool ArmTopology::solvePulled(Variant& variant, std::string& why) const {
  if (settings_.compliance_weight == 0 || settings_.compliance_force == 0) return true;
  State& s = variant.pulled;
  for (int attempt = s.z.size() == 0 ? 1 : 0; attempt < 2; ++attempt) {
    if (attempt == 1 && !tracePulled(variant, why)) return false;
    for (int k = 0; k < 30; ++k) {
      if (!solveState(variant, s, true, why)) break;
      const double missing = -settings_.compliance_force - s.force;
      if (std::abs(missing) < 1e-7 * settings_.compliance_force) return true;
      if (!(s.stiffness > 0)) break;
      const double step = std::clamp(missing / s.stiffness, -TRACE_STEP, TRACE_STEP);
      s.travel += step;
      s.z += step * s.slope;
    }
  }
  if (why.empty()) why = "no equilibrium under the compliance force was found near the path from rest";
  return false;
}

bool ArmTopology::retrace(Variant& variant, std::string& why) const {
  ++variant.retraces;
  std::vector<double> targets{0.0};
  std::vector<std::size_t> place;
  for (const double travel : travels_) {
    while (targets.back() + TRACE_STEP < travel - 1e-6) targets.push_back(targets.back() + TRACE_STEP);
    place.push_back(targets.size());
    targets.push_back(travel);
  }
  const statics::Problem& problem = variant.mechanism.problem();
  const statics::PathResult path = statics::PathFollower(problem, pathSettings(newton_tolerance_))
                                       .follow(Eigen::VectorXd::Zero(problem.freeCount()), targets);
  variant.newton_iterations += path.iterations;
  if (path.status != statics::SolveStatus::CONVERGED) {
    why = path.message;
    return false;
  }
  for (std::size_t k = 0; k < place.size(); ++k) variant.states[k].z = path.points[place[k]].solution;
  return true;
}

bool ArmTopology::solveVariant(Variant& variant, bool with_derivatives, std::string& why) const {
  variant.mechanism.setDensities(variant.density);
  const bool cold = variant.states.front().z.size() == 0;
  if ((cold || retrace_wanted_) && !retrace(variant, why)) return false;
  bool retraced = cold || retrace_wanted_;
  for (std::size_t k = 0; k < variant.states.size(); ++k) {
    if (solveState(variant, variant.states[k], with_derivatives, why)) continue;
    if (retraced || !retrace(variant, why)) return false;
    retraced = true;
    k = static_cast<std::size_t>(-1);  // all states again, from rest
  }
  return solvePulled(variant, why);
}

/// Variants share nothing that changes, so that the number of threads does not change a bit.
bool ArmTopology::solveVariants(bool with_derivatives, std::string& why) {
  const int count = static_cast<int>(variants_.size());
  std::vector<std::string> reasons(variants_.size());
  std::vector<char> good(variants_.size(), 0);
  std::vector<std::exception_ptr> thrown(variants_.size());
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int v = next++; v < count; v = next++) {
      try {
        good[v] = solveVariant(*variants_[v], with_derivatives, reasons[v]) ? 1 : 0;
      } catch (...) {
        thrown[v] = std::current_exception();
      }
    }
  };
  std::vector<std::thread> others;
  for (int t = 1; t < std::min(settings_.threads, count); ++t) others.emplace_back(work);
  work();
  for (std::thread& thread : others) thread.join();
  for (int v = 0; v < count; ++v) {
    if (thrown[v]) std::rethrow_exception(thrown[v]);
    if (good[v]) continue;
    why = reasons[v];
    return false;
  }
  return true;
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
