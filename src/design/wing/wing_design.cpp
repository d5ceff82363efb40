#include "snapwing/design/wing/wing_design.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/uniform.h"
#include "wing_local_search.h"

namespace snapwing::design {

using Eigen::Vector4d;

namespace {

constexpr double FEASIBLE = 1e-6;  ///< of the scaled constraints: 10 nm
constexpr double DISTINCT = 2e-3;  ///< [m] layouts closer than this are one
constexpr double PENALTY = 0.01;   ///< [m2] per squared constraint, only to rank random layouts
constexpr std::size_t RUNNERS_UP = 8;

double penalised(const WingEvaluation& e) { return e.objective + PENALTY * e.constraints.cwiseMax(0.0).squaredNorm(); }

/// Uniform in [0, 1) with the same bits everywhere; the library's distributions differ between implementations.
double uniform(std::mt19937_64* rng) { return common::uniform(*rng); }

bool buildable(const FourBar& bar) {
  return bar.crankLength() > bar.min_bar_length && bar.couplerLength() > bar.min_bar_length &&
         bar.rockerLength() > bar.min_bar_length && bar.branch() != 0;
}

bool near(const Vector4d& a, const Vector4d& b) { return (a - b).cwiseAbs().maxCoeff() < DISTINCT; }

void keepDistinct(const LocalResult& run, std::vector<LocalResult>* kept) {
  for (LocalResult& other : *kept) {
    if (!near(other.X, run.X)) continue;
    if (run.objective < other.objective) other = run;
    return;
  }
  kept->push_back(run);
}

/// The constraint samples the travel; between its points the angle may dip by a hair.
double leastTransmission(const WingSettings& s) { return s.transmission_margin - 2e-3; }

bool marginKept(const WingSettings& s, const TravelCheck& check) {
  return check.closes && check.smallest_transmission >= leastTransmission(s);
}

}  // namespace

const char* nameOf(WingStatus status) {
  switch (status) {
    case WingStatus::DESIGNED:
      return "designed";
    case WingStatus::INFEASIBLE:
      return "infeasible";
    case WingStatus::CANCELLED:
      return "cancelled";
    default:
      return "not solved";
  }
}

std::vector<Vector4d> sampleLayouts(const WingProblem& problem, int samples, int count, unsigned seed) {
  std::mt19937_64 rng(seed);
  const Vector4d low = problem.low(), high = problem.high();
  std::vector<std::pair<double, Vector4d>> all;
  for (int i = 0; i < samples; ++i) {
    Vector4d X;
    for (int k = 0; k < 4; ++k) X[k] = low[k] + (high[k] - low[k]) * uniform(&rng);
    if (!buildable(problem.linkage(X))) continue;
    const double value = penalised(problem.evaluate(X, false));
    if (std::isfinite(value)) all.emplace_back(value, X);
  }
  const auto kept = std::min<std::size_t>(all.size(), static_cast<std::size_t>(count));
  const auto less = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kept), all.end(), less);
  std::vector<Vector4d> best;
  for (std::size_t i = 0; i < kept; ++i) best.push_back(all[i].second);
  return best;
}

void assess(const WingSettings& s, WingDesign* d) {
  d->travel = checkTravel(d->linkage, s.targets[1].arm_rotation);
  for (int i = 0; i < 2; ++i) {
    const auto pose = poseAt(d->linkage, s.targets[i].arm_rotation);
    if (!pose) {
      d->status = WingStatus::INFEASIBLE;
      d->message = d->travel.verdict(leastTransmission(s));
      return;
    }
    WingState& state = d->states[i];
    state.arm_rotation = s.targets[i].arm_rotation;
    state.pose = *pose;
    state.target = s.tipTarget(i);
    state.tip_residual = (pose->tip - state.target).norm();
    state.rotation_error = pose->wing_rotation - s.wantedRotation(i);
  }
  const FourBarPose& second = d->states[1].pose;
  d->separation = (second.joint1 - second.joint2).norm();
  d->joint2_x = second.joint2.x();
  d->joint1_y = second.joint1.y();
  const double slack = FEASIBLE * 0.01;
  const bool walls = d->separation >= s.separation - slack && d->joint2_x >= s.wall_joint2_x - slack &&
                     d->joint1_y <= s.wall_joint1_y + slack;
  d->status = walls && marginKept(s, d->travel) ? WingStatus::DESIGNED : WingStatus::INFEASIBLE;
  d->message = d->travel.verdict(leastTransmission(s));
  if (!walls) d->message += "; joints outside the walls or closer than the separation";
}

WingDesign designWing(const WingProblem& problem, const std::function<bool(const WingProgress&)>& go_on,
                      const std::function<bool()>& cancelled) {
  const auto begin = std::chrono::steady_clock::now();
  const WingSettings& s = problem.settings();
  s.validate();
  const RigidWingProblem rigid(s);
  WingDesign design;
  design.samples = s.samples;
  WingProgress progress;
  progress.runs = s.starts;
  const auto halted = [&] {
    design.status = WingStatus::CANCELLED;
    design.message = "cancelled after " + std::to_string(design.runs) + " local runs";
    return design;
  };
  for (const Vector4d& start : sampleLayouts(rigid, s.samples, s.starts, static_cast<unsigned>(s.seed))) {
    if (go_on && !go_on(progress)) return halted();
    const LocalResult run = improve(problem, start, cancelled);
    if (run.stop == CANCELLED_RUN) return halted();
    ++design.runs;
    design.evaluations += run.evaluations;
    progress.run = design.runs;
    progress.violation = std::min(progress.violation, run.violation);
    const bool good = run.violation <= FEASIBLE && buildable(problem.linkage(run.X)) &&
                      marginKept(s, checkTravel(problem.linkage(run.X), s.targets[1].arm_rotation));
    if (!good) continue;
    keepDistinct(run, &design.runners_up);
    progress.objective = std::min(progress.objective, run.objective);
  }
  std::stable_sort(design.runners_up.begin(), design.runners_up.end(),
                   [](const LocalResult& a, const LocalResult& b) { return a.objective < b.objective; });
  if (design.runners_up.size() > RUNNERS_UP) design.runners_up.resize(RUNNERS_UP);
  design.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (design.runners_up.empty()) {
    std::ostringstream text;
    text << "none of " << design.runs << " starts reached a layout within the constraints; least violation "
         << progress.violation << " (scaled)";
    if (progress.violation <= FEASIBLE) {
      text.str("");
      text << "of " << design.runs
           << " starts some met the sampled constraints, but those pass a dead point or lose the "
           << "transmission margin between the samples";
    }
    design.status = WingStatus::INFEASIBLE;
    design.message = text.str();
    return design;
  }
  design.linkage = problem.linkage(design.runners_up[0].X);
  design.objective = design.runners_up[0].objective;
  assess(s, &design);
  return design;
}

}  // namespace snapwing::design
