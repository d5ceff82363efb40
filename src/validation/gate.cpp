// What the trials must show for the gate to open.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "snapwing/common/error.h"
#include "snapwing/mpm/cell_values.h"
#include "snapwing/scene/rung.h"
#include "snapwing/validation/validation.h"

namespace snapwing::validation {

namespace {

using motion::TrialRung;

// How far the rungs may be apart on the nominal vehicle.
constexpr double SNAP_TIME = 5.0, THRESHOLD = 3.0;  // [ms]
constexpr double PEAK = 2.0;                        // [mm]
constexpr double STEP_ERROR = 1.0;                  // [ms] snap time, full against half step
constexpr double SEARCH_ERROR = 0.3;                // [ms] of a limit from two searches that end within .1 ms each

std::string shortly(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

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
      if (t.plan != plan_ || t.role == TrialRole::THRESHOLD || t.finer) continue;
      if (t.role == TrialRole::SAMPLE || t.trial.on_curve) continue;
      endsRight(t);
    }
    samples();
    agreement(TrialRung::PLANAR);
    if (find(TrialRung::VOLUMETRIC, TrialRole::NOMINAL) != nullptr) agreement(TrialRung::VOLUMETRIC);
    convergence();
    strain();
    return std::move(checks_);
  }

 private:
  std::string name(const std::string& what) const {
    return found_.plans[static_cast<std::size_t>(plan_)].name() + ", " + what;
  }
  static std::string roleName(const ValidationTrial& t) {
    if (t.role == TrialRole::HALF_STEP) return "half step";
    const std::string kernel = t.trial.kernel == scene::SceneKernel::LINEAR ? "" : ", reduced kernel";
    if (t.role == TrialRole::WEAKEST) return "weakest vehicle " + t.name.substr(t.name.rfind('_') + 1);
    return "nominal" + kernel;
  }
  const RungOutcome* find(TrialRung rung, TrialRole role, scene::SceneKernel kernel = scene::SceneKernel::LINEAR,
                          bool finer = false) const {
    const auto at = std::find_if(found_.trials.begin(), found_.trials.end(), [&](const ValidationTrial& t) {
      return t.plan == plan_ && t.role == role && t.trial.rung == rung && t.trial.kernel == kernel && t.finer == finer;
    });
    return at == found_.trials.end() ? nullptr : &at->outcome;
  }
  /// The same vehicle on cells of half the size; null if it was not asked.
  const ValidationTrial* twinOf(const ValidationTrial& t) const {
    const auto at = std::find_if(found_.trials.begin(), found_.trials.end(), [&](const ValidationTrial& other) {
      return other.finer && other.plan == t.plan && other.name == t.name + "_fine";
    });
    return at == found_.trials.end() ? nullptr : &*at;
  }

  /// True if the shortest pulse gets shorter with the cells: the limit lies further to the side of what switches.
  bool smallerCellsSwitchSooner() const {
    const RungOutcome* coarse = find(TrialRung::PLANAR, TrialRole::THRESHOLD);
    const RungOutcome* fine = ofPlane(TrialRole::THRESHOLD, true);
    return coarse != nullptr && fine != nullptr && fine->threshold < coarse->threshold;
  }

  /// The finer of two sizes counts. If it alone switches, that holds in the limit only if smaller cells switch sooner.
  Check endMode(const std::string& name, const ValidationTrial& t) const {
    const ValidationTrial* twin = twinOf(t);
    if (twin == nullptr) return yesOrNo(name, t.outcome.snapped, modeWords(t.outcome));
    Check check = yesOrNo(name, twin->outcome.snapped,
                          modeWords(t.outcome) + "; on cells of half the size: " + modeWords(twin->outcome));
    if (t.outcome.snapped || !twin->outcome.snapped) return check;
    if (t.outcome.failure.empty() && smallerCellsSwitchSooner()) {
      check.words += "; the shortest pulse gets shorter with the cells, so smaller ones switch, too";
    } else {
      check.verdict = Verdict::UNDECIDED;
      check.words += "; smaller cells decide";
    }
    return check;
  }

  void endsRight(const ValidationTrial& t) {
    const std::string who = motion::rungName(t.trial.rung) + ", " + roleName(t);
    checks_.push_back(endMode(name(who + ": end mode"), t));
    const ValidationTrial* twin = twinOf(t);
    const RungOutcome& counts = twin != nullptr ? twin->outcome : t.outcome;
    if (!counts.failure.empty()) return;
    checks_.push_back(within(name(who + ": peak within limits.travel_max"), 1e3 * counts.peak_travel, NAN,
                             1e3 * vehicle_.limits.travel_max, "mm"));
  }

  /// One answer for all sampled vehicles on the planar rung; those that fail are named.
  void samples() {
    int all = 0, switched = 0, believed = 0, failed = 0;
    std::string named;
    for (const ValidationTrial& t : found_.trials) {
      if (t.plan != plan_ || t.role != TrialRole::SAMPLE || t.finer) continue;
      if (t.trial.rung == TrialRung::LUMPED) {
        believed += t.outcome.snapped;
        continue;
      }
      const Check one = endMode(t.name, t);
      ++all;
      switched += one.verdict == Verdict::PASS;
      failed += one.verdict == Verdict::FAIL;
      if (!t.outcome.snapped) named += "; " + t.name + ": " + one.words;
    }
    if (all == 0) return;
    checks_.push_back(yesOrNo(name("planar, " + std::to_string(all) + " sampled vehicles: end mode"), switched == all,
                              std::to_string(switched) + " of " + std::to_string(all) + " switch, " +
                                  std::to_string(believed) + " by the lumped rung" + named));
    if (switched < all && failed == 0) checks_.back().verdict = Verdict::UNDECIDED;
  }

  /// A number of the nominal vehicle in the unit of 1000: where a rung ran on cells of two sizes, in the limit.
  struct Judged {
    Estimate value;
    std::string words;
  };
  /// In the plane.
  Judged judged(TrialRole role, double RungOutcome::*member, const char* unit) const {
    const RungOutcome *coarse = ofPlane(role, false), *fine = ofPlane(role, true);
    Judged out;
    out.value = {1e3 * (coarse->*member), 0};
    out.words = coarse->failure;
    if (fine == nullptr) return out;
    out.value = limitOfCells(1e3 * (fine->*member), 1e3 * (coarse->*member), 2);
    out.words = twoSizes("", 1e3 * (coarse->*member), 1e3 * (fine->*member), unit) + failures({coarse, fine}) +
                extrapolated(out.value, unit);
    return out;
  }

  /// As a solid: the plane in the limit, and what the solid has beyond the plane on the same cells, whose body is the
  /// same, in the limit of small ones. Both by static curves; how far the solid in time is from its own is added to the
  /// error.
  Judged judgedSolid(double RungOutcome::*member, const char* unit) const {
    if (ofPlane(TrialRole::LIMIT, false) == nullptr || ofPlane(TrialRole::LIMIT, true) == nullptr)
      return {{NAN, NAN}, "the static curves are missing"};
    Judged out = judged(TrialRole::LIMIT, member, unit);
    out.words = "plane " + out.words + "; beyond it ";
    std::vector<Estimate> beyond;
    double motion = 0;
    for (const auto kernel : {scene::SceneKernel::LINEAR, scene::SceneKernel::LINEAR_REDUCED}) {
      const RungOutcome* in_time = find(TrialRung::VOLUMETRIC, TrialRole::NOMINAL, kernel);
      if (in_time == nullptr) continue;
      double more[2] = {NAN, NAN};
      for (const bool finer : {false, true}) {
        const RungOutcome *solid = find(TrialRung::VOLUMETRIC, TrialRole::CURVE, kernel, finer),
                          *plane = ofPlane(TrialRole::CURVE, finer);
        if (solid == nullptr || plane == nullptr) continue;
        more[finer ? 1 : 0] = 1e3 * (solid->*member - plane->*member);
        out.words += failures({solid, plane});
        if (finer) continue;
        const double off = 1e3 * std::abs(in_time->*member - solid->*member);
        if (!(off <= motion)) motion = off;
      }
      beyond.push_back(limitOfCells(more[1], more[0], 2));
      out.words += twoSizes(scene::kernelName(kernel) + " ", more[0], more[1], unit);
    }
    const Estimate mean = meanOf(beyond);
    out.value = {out.value.value + mean.value, out.value.error + mean.error + motion};
    out.words += extrapolated(out.value, unit);
    return out;
  }
  const RungOutcome* ofPlane(TrialRole role, bool finer) const {
    return find(TrialRung::PLANAR, role, scene::SceneKernel::LINEAR, finer);
  }

  static std::string twoSizes(const std::string& what, double coarse, double fine, const char* unit) {
    return what + shortly(coarse) + ", " + shortly(fine) + " " + unit + "; ";
  }
  static std::string extrapolated(const Estimate& value, const char* unit) {
    return "extrapolated " + shortly(value.value) + " +- " + shortly(value.error) + " " + unit;
  }
  static std::string failures(const std::vector<const RungOutcome*>& of) {
    std::string words;
    for (const RungOutcome* one : of) {
      if (!one->failure.empty()) words += one->failure + "; ";
    }
    return words;
  }

  void agreement(TrialRung rung) {
    const RungOutcome* lumped = find(TrialRung::LUMPED, TrialRole::NOMINAL);
    if (lumped == nullptr || find(rung, TrialRole::NOMINAL) == nullptr) return;
    const std::string who = motion::rungName(rung) + " against lumped: ";
    const auto value = [&](double RungOutcome::*member, const char* unit) {
      return rung == TrialRung::VOLUMETRIC ? judgedSolid(member, unit) : judged(TrialRole::NOMINAL, member, unit);
    };
    const Judged snap = value(&RungOutcome::snap_time, "ms"), peak = value(&RungOutcome::peak_travel, "mm");
    checks_.push_back(within(name(who + "time of the snap"), snap.value.less(1e3 * lumped->snap_time), -SNAP_TIME,
                             SNAP_TIME, "ms", snap.words));
    checks_.push_back(
        within(name(who + "peak travel"), peak.value.less(1e3 * lumped->peak_travel), -PEAK, PEAK, "mm", peak.words));
    if (rung == TrialRung::PLANAR) shortestPulse(who);
  }

  void shortestPulse(const std::string& who) {
    const RungOutcome* lumped = find(TrialRung::LUMPED, TrialRole::THRESHOLD);
    if (lumped == nullptr || find(TrialRung::PLANAR, TrialRole::THRESHOLD) == nullptr) return;
    Judged here = judged(TrialRole::THRESHOLD, &RungOutcome::threshold, "ms");
    if (here.value.error > 0) here.value.error = std::max(here.value.error, SEARCH_ERROR);
    char words[60];
    std::snprintf(words, sizeof words, "%.1f ms lumped; here ", 1e3 * lumped->threshold);
    if (here.words.empty()) here.words = shortly(here.value.value) + " ms";
    checks_.push_back(within(name(who + "shortest pulse"), here.value.less(1e3 * lumped->threshold), -THRESHOLD,
                             THRESHOLD, "ms", words + here.words));
  }

  void convergence() {
    const RungOutcome* full = find(TrialRung::PLANAR, TrialRole::NOMINAL);
    const RungOutcome* half = find(TrialRung::PLANAR, TrialRole::HALF_STEP);
    if (full == nullptr || half == nullptr) return;
    checks_.push_back(within(name("planar: snap with the full less that with half the step"),
                             1e3 * (full->snap_time - half->snap_time), -STEP_ERROR, STEP_ERROR, "ms"));
    for (const ValidationTrial& t : found_.trials) {
      if (t.plan != plan_ || t.role != TrialRole::NOMINAL || t.finer) continue;
      if (t.trial.rung == TrialRung::LUMPED) continue;
      checks_.push_back(
          reported(name(motion::rungName(t.trial.rung) + ", " + roleName(t) + ": energy error of the scheme"),
                   1e3 * t.outcome.imbalance, "mJ", "largest at any time"));
    }
    checks_.push_back(reported(name("planar: smallest det F of a step"), full->min_det_f, "1"));
  }

  /// How far the nominal switch strains the arms, beside what the material bears; neither number gates.
  void strain() {
    const RungOutcome *coarse = ofPlane(TrialRole::NOMINAL, false), *fine = ofPlane(TrialRole::NOMINAL, true);
    if (coarse == nullptr) return;
    const RungOutcome* counts = fine != nullptr ? fine : coarse;
    checks_.push_back(meanStrain(*coarse, fine));
    checks_.push_back(
        reported(name("planar: largest strain of a cell"), counts->strain, "1",
                 "in a notch of the printed body: it grows with smaller cells and is compared with nothing"));
  }

  /// The mean over a fixed length converges, so it is what a limit is compared with. Cells that coarsen the body do not
  /// yet converge with one order: the error bar reaches back to the smaller cells' own value.
  Check meanStrain(const RungOutcome& coarse, const RungOutcome* fine) const {
    Estimate mean{coarse.mean_strain, 0};
    char words[300] = "on cells of one size: the error is unknown";
    if (fine != nullptr) {
      mean = limitOfCells(fine->mean_strain, coarse.mean_strain, 2);
      mean.error = std::abs(mean.value - fine->mean_strain);
      std::snprintf(words, sizeof words, "%.3f, %.3f on cells of two sizes; extrapolated %.3f +- %.3f",
                    coarse.mean_strain, fine->mean_strain, mean.value, mean.error);
    }
    Check check = reported(name("planar: largest mean strain"), mean.value, "1", words);
    check.error = mean.error;
    std::snprintf(words, sizeof words, "; mean over the material within %g mm of a point", 1e3 * mpm::STRAIN_RADIUS);
    check.words += words;
    if (!vehicle_.material.strain_limit) {
      check.words += "; the material's strain limit is unknown (material.strain_limit is not given)";
    } else {
      check.high = vehicle_.material.strain_limit->low();
      check.words += "; " + besideLimit(within("", mean, NAN, check.high, "1").verdict) +
                     " the file's material.strain_limit, for a single load";
    }
    check.words += "; its fatigue life is unknown";
    return check;
  }
  static std::string besideLimit(Verdict verdict) {
    if (verdict == Verdict::PASS) return "below";
    return verdict == Verdict::FAIL ? "ABOVE" : "an error bar across";
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

bool mustSurvive(const vehicle::Vehicle& vehicle, const std::string& accident) {
  const auto& wanted = vehicle.must_survive;
  return std::find(wanted.begin(), wanted.end(), accident) != wanted.end();
}

std::vector<Check> checkCarried(const Validation& found, const vehicle::Vehicle& vehicle) {
  constexpr double SEARCH = 0.02;  // [N] of a limit from two searches that end within .01 N each
  const RungOutcome* sizes[2] = {nullptr, nullptr};
  for (const ValidationTrial& t : found.trials) {
    if (t.role == TrialRole::CARRIED) sizes[t.finer ? 1 : 0] = &t.outcome;
  }
  const auto lumped = std::find_if(found.accidents.begin(), found.accidents.end(),
                                   [](const auto& a) { return a.name == HELD_UPRIGHT; });
  if (sizes[0] == nullptr || lumped == found.accidents.end()) return {};
  Estimate limit{sizes[0]->threshold, 0};
  std::string words = "what F carries on soft arms with the ring held; lumped " + shortly(lumped->limit) + " N";
  if (sizes[1] != nullptr) {
    limit = limitOfCells(sizes[1]->threshold, sizes[0]->threshold, 2);
    limit.error = std::max(limit.error, SEARCH);
    char text[80];
    std::snprintf(text, sizeof text, "; %.2f, %.2f N on two cell sizes", sizes[0]->threshold, sizes[1]->threshold);
    words += text;
  }
  if (sizes[1] == nullptr) words += "; on one cell size alone, whose arm is stiffer than in the limit of small cells";
  for (const RungOutcome* one : sizes) {
    if (one != nullptr && !one->failure.empty()) words += "; " + one->failure;
  }
  Check check = within(std::string("accident: ") + HELD_UPRIGHT + ", planar", limit, lumped->occurs, NAN, "N", words);
  if (!mustSurvive(vehicle, HELD_UPRIGHT)) check.verdict = Verdict::REPORTED;
  return {check};
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
    const bool gates = mustSurvive(vehicle, a.name);
    if (gates && !std::isfinite(a.occurs)) {
      throw common::SettingError(vehicle.file, "must_survive", a.name,
                                 "an accident that states what is met; how much of this one is met is up to the pilot");
    }
    std::string words = a.explanation;
    if (std::isinf(a.limit)) words += "; no limit within reach";
    Check check = reported("accident: " + a.name, a.limit, a.unit, words);
    if (std::isfinite(a.occurs)) check.low = a.occurs;
    if (gates) check.verdict = a.holds ? Verdict::PASS : Verdict::FAIL;
    checks.push_back(check);
  }
  return checks;
}

}  // namespace snapwing::validation
