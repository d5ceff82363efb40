#include "arm_judgement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "arm_extrapolation.h"

namespace snapwing::design {

namespace {

using C = const ArmCheckCase&;
using Quantity = double (*)(C);

struct Wish {
  const char* name;
  std::array<double, 2> range;
  const char* unit;
  Quantity quantity;
};

ArmTarget targetOf(const Wish& wish) {
  ArmTarget t;
  t.name = wish.name;
  char text[80];
  std::snprintf(text, sizeof text, "%g .. %g %s", wish.range[0], wish.range[1], wish.unit);
  t.wanted = text;
  t.low = std::numeric_limits<double>::infinity(), t.high = -t.low;
  return t;
}

/// All bodies must be in the range, those of a moved outline too if asked.
ArmTarget judgeRange(const ArmCheck& check, const Wish& wish, bool offset_cases) {
  ArmTarget t = targetOf(wish);
  bool met = true;
  for (C c : check.cases) {
    if (c.name == "grey" || (c.offset != 0 && !offset_cases)) continue;
    const double x = c.traced ? wish.quantity(c) : std::numeric_limits<double>::quiet_NaN();
    met = met && x >= wish.range[0] && x <= wish.range[1];
    if (std::isnan(x)) continue;
    t.low = std::min(t.low, x), t.high = std::max(t.high, x);
  }
  if (t.low > t.high) t.low = t.high = std::numeric_limits<double>::quiet_NaN();
  t.verdict = met ? Verdict::MET : Verdict::NOT_MET;
  return t;
}

/// A check with two cell sizes of a kernel, planar or solid, is there to be extrapolated, whether it can be or not.
bool hasTwoSizes(const ArmCheck& check, bool solid) {
  for (C a : check.cases) {
    for (C b : check.cases) {
      if (a.solid == solid && b.solid == solid && a.rung == b.rung && a.name != "grey" && b.name != "grey" &&
          a.offset == 0 && b.offset == 0 && a.cell_size < b.cell_size)
        return true;
    }
  }
  return false;
}

/// The value in the limit of small cells must be in the range with its whole error bar, for planar bodies and solids.
ArmTarget judgeLimit(const ArmCheck& check, const Wish& wish) {
  if (!hasTwoSizes(check, false)) return judgeRange(check, wish, false);
  ArmTarget t = targetOf(wish);
  t.converged = true;
  t.verdict = Verdict::MET;
  for (const bool solid : {false, true}) {
    if (!hasTwoSizes(check, solid)) continue;
    const ArmEstimate e = estimate(check, solid, wish.quantity);
    const bool inside = e.low() >= wish.range[0] && e.high() <= wish.range[1];
    const bool outside = !(e.low() <= wish.range[1] && e.high() >= wish.range[0]);  // NaN is outside
    if (outside) t.verdict = Verdict::NOT_MET;
    if (!inside && t.verdict == Verdict::MET) t.verdict = Verdict::NOT_DECIDED;
    if (std::isnan(e.value)) continue;
    t.low = std::min(t.low, e.low()), t.high = std::max(t.high, e.high());
  }
  if (t.low > t.high) t.low = t.high = std::numeric_limits<double>::quiet_NaN();
  return t;
}

}  // namespace

const char* nameOf(Verdict verdict) {
  if (verdict == Verdict::MET) return "met";
  return verdict == Verdict::NOT_MET ? "NOT MET" : "NOT DECIDED";
}

void judgeAll(const ArmTargets& wanted, ArmCheck& check) {
  const auto limit = [&](const Wish& wish) { check.targets.push_back(judgeLimit(check, wish)); };
  const auto range = [&](const Wish& wish, bool offset_cases) {
    check.targets.push_back(judgeRange(check, wish, offset_cases));
  };
  if (wanted.peak) limit({"peak force", *wanted.peak, "N", [](C c) { return c.features.peak_force; }});
  if (wanted.valley) limit({"valley force", *wanted.valley, "N", [](C c) { return c.features.valley_force; }});
  if (wanted.second) limit({"second equilibrium", *wanted.second, "m", [](C c) { return c.features.second_travel; }});
  const bool turns = std::any_of(check.cases.begin(), check.cases.end(), [](C c) { return c.turns; });
  if (turns && wanted.rotation)
    limit({"rotation there", *wanted.rotation, "rad", [](C c) { return c.rotation_second; }});
  range({"hysteresis over peak", {0, wanted.hysteresis}, "", [](C c) { return c.hysteresis_share; }}, false);
  range({"unstable points", {0, 0}, "", [](C c) { return static_cast<double>(c.unstable_points); }}, false);
  range({"bistable, printing error too", {1, 1}, "", [](C c) { return c.bistable ? 1.0 : 0.0; }}, true);
  const auto met = [](const ArmTarget& t) { return t.met(); };
  check.all_met = check.complete && std::all_of(check.targets.begin(), check.targets.end(), met);
  check.bistable = check.complete && check.targets.back().met();
}

}  // namespace snapwing::design
