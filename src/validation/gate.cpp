// What the trials must show for the gate to open.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "snapwing/common/error.h"
#include "snapwing/scene/rung.h"
#include "snapwing/validation/validation.h"

namespace snapwing::validation {

namespace {

using motion::TrialRung;

// How far the rungs may be apart on the nominal vehicle.
constexpr double SNAP_TIME = 5.0, THRESHOLD = 3.0;  // [ms]
constexpr double PEAK = 2.0;                        // [mm]
constexpr double STEP_ERROR = 1.0;                  // [ms] snap time, full against half step

std::string modeWords(const RungOutcome& o) {
  if (!o.failure.empty()) return o.failure;
  char text[200];
  std::snprintf(text, sizeof text, "ends in %s, travel %.1f .. %.1f mm", vehicle::modeName(o.end).c_str(),
                1e3 * o.least_travel, 1e3 * o.peak_travel);
  std::string words = text;
  if (std::isfinite(o.snap_time)) {
    std::snprintf(text, sizeof text, ", last crossed the barrier at %.1f ms", 1e3 * o.snap_time);
    words += text;
  }
  if (std::isfinite(o.margin)) {
    std::snprintf(text, sizeof text, ", margin %+.2f", o.margin);
    words += text;
  }
  return words;
}

/// The trials of one plan.
class PlanGate {
 public:
  PlanGate(const Validation& found, int plan, const vehicle::Vehicle& vehicle)
      : found_(found), plan_(plan), vehicle_(vehicle) {}

  std::vector<Check> checks() {
    for (const ValidationTrial& t : found_.trials) {
      if (t.plan != plan_ || t.role == TrialRole::THRESHOLD) continue;
      if (t.role == TrialRole::SAMPLE) continue;
      endsRight(t);
    }
    samples();
    agreement(TrialRung::PLANAR);
    if (find(TrialRung::VOLUMETRIC, TrialRole::NOMINAL) != nullptr) agreement(TrialRung::VOLUMETRIC);
    convergence();
    return std::move(checks_);
  }

 private:
  std::string name(const std::string& what) const {
    return found_.plans[static_cast<std::size_t>(plan_)].name() + ", " + what;
  }
  static std::string roleName(const ValidationTrial& t) {
    if (t.role == TrialRole::HALF_STEP) return "half step";
    const std::string kernel = t.trial.kernel == scene::SceneKernel::LINEAR ? "" : ", reduced kernel";
    if (t.role == TrialRole::COARSE) return "coarse cells" + kernel;
    if (t.role == TrialRole::WEAKEST) return "weakest vehicle " + t.name.substr(t.name.rfind('_') + 1);
    return "nominal" + kernel;
  }
  const RungOutcome* find(TrialRung rung, TrialRole role,
                          scene::SceneKernel kernel = scene::SceneKernel::LINEAR) const {
    const auto at = std::find_if(found_.trials.begin(), found_.trials.end(), [&](const ValidationTrial& t) {
      return t.plan == plan_ && t.role == role && t.trial.rung == rung && t.trial.kernel == kernel;
    });
    return at == found_.trials.end() ? nullptr : &at->outcome;
  }

  void endsRight(const ValidationTrial& t) {
    const std::string who = motion::rungName(t.trial.rung) + ", " + roleName(t);
    checks_.push_back(yesOrNo(name(who + ": end mode"), t.outcome.snapped, modeWords(t.outcome)));
    if (!t.outcome.failure.empty()) return;
    checks_.push_back(within(name(who + ": peak within limits.travel_max"), 1e3 * t.outcome.peak_travel, NAN,
                             1e3 * vehicle_.limits.travel_max, "mm"));
  }

  /// One answer for all sampled vehicles on the planar rung; those that fail are named.
  void samples() {
    int all = 0, switched = 0, believed = 0;
    std::string failed;
    for (const ValidationTrial& t : found_.trials) {
      if (t.plan != plan_ || t.role != TrialRole::SAMPLE) continue;
      if (t.trial.rung == TrialRung::LUMPED) {
        believed += t.outcome.snapped;
        continue;
      }
      ++all;
      switched += t.outcome.snapped;
      if (!t.outcome.snapped) failed += (failed.empty() ? "" : "; ") + t.name + ": " + modeWords(t.outcome);
    }
    if (all == 0) return;
    checks_.push_back(yesOrNo(name("planar, " + std::to_string(all) + " sampled vehicles: end mode"), switched == all,
                              std::to_string(switched) + " of " + std::to_string(all) + " switch, " +
                                  std::to_string(believed) + " by the lumped rung" +
                                  (failed.empty() ? "" : "; " + failed)));
  }

  /// A number of the nominal vehicle. Where a rung ran on cells of two sizes, h and 2 h, each kernel is extrapolated at
  /// first order, 2 x(h) - x(2 h). Their mean counts; its error bar is half their spread, or a third of the largest
  /// correction if that is more: the rule of a design's check (docs/design.md).
  struct Judged {
    double value = NAN;
    std::string words;
  };
  Judged judged(TrialRung rung, double RungOutcome::*member, const char* unit) const {
    Judged out;
    if (find(rung, TrialRole::COARSE) == nullptr) {
      out.value = 1e3 * (find(rung, TrialRole::NOMINAL)->*member);
      return out;
    }
    double least = INFINITY, most = -INFINITY, correction = 0;
    char words[200];
    for (const auto kernel : {scene::SceneKernel::LINEAR, scene::SceneKernel::LINEAR_REDUCED}) {
      const RungOutcome* fine = find(rung, TrialRole::NOMINAL, kernel);
      const RungOutcome* coarse = find(rung, TrialRole::COARSE, kernel);
      if (fine == nullptr || coarse == nullptr) continue;
      const double at = 1e3 * (fine->*member), moved = at - 1e3 * (coarse->*member);
      if (!std::isfinite(at + moved)) return out;
      least = std::min(least, at + moved), most = std::max(most, at + moved);
      correction = std::max(correction, std::abs(moved));
      std::snprintf(words, sizeof words, "%s: %.1f, %.1f %s; ", scene::kernelName(kernel).c_str(), at - moved, at,
                    unit);
      out.words += words;
    }
    out.value = 0.5 * (least + most);
    std::snprintf(words, sizeof words, "extrapolated %.1f +- %.1f %s", out.value,
                  std::max(0.5 * (most - least), correction / 3), unit);
    out.words += words;
    return out;
  }

  void agreement(TrialRung rung) {
    const RungOutcome* lumped = find(TrialRung::LUMPED, TrialRole::NOMINAL);
    if (lumped == nullptr || find(rung, TrialRole::NOMINAL) == nullptr) return;
    const std::string who = motion::rungName(rung) + " against lumped: ";
    const Judged snap = judged(rung, &RungOutcome::snap_time, "ms");
    const Judged peak = judged(rung, &RungOutcome::peak_travel, "mm");
    checks_.push_back(within(name(who + "time of the snap"), snap.value - 1e3 * lumped->snap_time, -SNAP_TIME,
                             SNAP_TIME, "ms", snap.words));
    checks_.push_back(
        within(name(who + "peak travel"), peak.value - 1e3 * lumped->peak_travel, -PEAK, PEAK, "mm", peak.words));
    shortestPulse(rung, who);
  }

  void shortestPulse(TrialRung rung, const std::string& who) {
    const RungOutcome* a = find(TrialRung::LUMPED, TrialRole::THRESHOLD);
    const RungOutcome* b = find(rung, TrialRole::THRESHOLD);
    if (a == nullptr || b == nullptr) return;
    char words[400];
    std::snprintf(words, sizeof words, "%.1f ms lumped, %.1f ms here%s%s", 1e3 * a->threshold, 1e3 * b->threshold,
                  b->failure.empty() ? "" : ": ", b->failure.c_str());
    checks_.push_back(
        within(name(who + "shortest pulse"), 1e3 * (b->threshold - a->threshold), -THRESHOLD, THRESHOLD, "ms", words));
  }

  void convergence() {
    const RungOutcome* full = find(TrialRung::PLANAR, TrialRole::NOMINAL);
    const RungOutcome* half = find(TrialRung::PLANAR, TrialRole::HALF_STEP);
    if (full == nullptr || half == nullptr) return;
    checks_.push_back(within(name("planar: snap with the full less that with half the step"),
                             1e3 * (full->snap_time - half->snap_time), -STEP_ERROR, STEP_ERROR, "ms"));
    for (const ValidationTrial& t : found_.trials) {
      if (t.plan != plan_ || t.role != TrialRole::NOMINAL || t.trial.rung == TrialRung::LUMPED) continue;
      checks_.push_back(told(name(motion::rungName(t.trial.rung) + ", " + roleName(t) + ": fed or eaten by the scheme"),
                             1e3 * t.outcome.imbalance, "mJ", "largest at any time"));
    }
    checks_.push_back(told(name("planar: smallest det F of a step"), full->min_det_f, "1"));
  }

  const Validation& found_;
  int plan_;
  const vehicle::Vehicle& vehicle_;
  std::vector<Check> checks_;
};

}  // namespace

std::vector<Check> checkTrials(const Validation& found, const vehicle::Vehicle& vehicle) {
  std::vector<Check> all;
  for (std::size_t k = 0; k < found.plans.size(); ++k) {
    const std::vector<Check> some = PlanGate(found, static_cast<int>(k), vehicle).checks();
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

std::vector<Check> checkAccidents(const std::vector<planning::AccidentMargin>& accidents,
                                  const vehicle::Vehicle& vehicle) {
  std::string known;
  for (const auto& a : accidents) known += (known.empty() ? "" : ", ") + a.name;
  for (const std::string& wanted : vehicle.must_survive) {
    const bool found = std::any_of(accidents.begin(), accidents.end(), [&](const auto& a) { return a.name == wanted; });
    if (!found) throw common::SettingError(vehicle.file, "must_survive", wanted, "any of: " + known);
  }
  std::vector<Check> checks;
  for (const auto& a : accidents) {
    const auto& wanted = vehicle.must_survive;
    const bool gates = std::find(wanted.begin(), wanted.end(), a.name) != wanted.end();
    std::string words = a.explanation;
    if (std::isinf(a.limit)) words += "; no limit within reach";
    Check check = told("accident: " + a.name, a.limit, a.unit, words);
    if (std::isfinite(a.occurs)) check.low = a.occurs;
    if (gates) check.verdict = a.holds ? Verdict::PASS : Verdict::FAIL;
    checks.push_back(check);
  }
  return checks;
}

}  // namespace snapwing::validation
