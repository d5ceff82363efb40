#include "curve_summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "snapwing/common/json_text.h"

namespace snapwing::tools {

namespace {

using nlohmann::json;
using statics::Feature;
using statics::FeatureKind;

constexpr double NONE = std::numeric_limits<double>::quiet_NaN();

/// Features of a curve that leads away from 0 in its own direction, and the state that it leaves.
struct Told {
  vehicle::CurveFeatures f{NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, false};
  double first = NONE;
  std::vector<double> zeros;
};

bool leadsDown(const vehicle::ForceTable& t) { return std::abs(t.travel.front()) > std::abs(t.travel.back()); }

/// The same curve seen along the other direction: u -> -u, R -> -R.
vehicle::ForceTable mirrored(vehicle::ForceTable t) {
  for (auto* values : {&t.travel, &t.force, &t.stiffness, &t.energy, &t.rotation, &t.min_det_f, &t.force_back})
    std::reverse(values->begin(), values->end());
  for (auto* values : {&t.travel, &t.force, &t.force_back}) {
    for (double& value : *values) value = -value;
  }
  std::reverse(t.stable.begin(), t.stable.end());
  t.shapes = {};
  return t;
}

Told interpolated(const vehicle::ForceTable& table) {
  const bool down = leadsDown(table);
  Told told;
  told.f = vehicle::curveFeatures(down ? mirrored(table) : table);
  if (down) {
    for (double* value : {&told.f.peak_travel, &told.f.peak_force, &told.f.valley_travel, &told.f.valley_force,
                          &told.f.barrier_travel, &told.f.second_travel})
      *value = -*value;
  }
  const auto nearest = std::min_element(table.travel.begin(), table.travel.end(),
                                        [](double a, double b) { return std::abs(a) < std::abs(b); });
  double largest = 0;
  for (const double force : table.force) largest = std::max(largest, std::abs(force));
  const double force = table.force[static_cast<std::size_t>(nearest - table.travel.begin())];
  if (*nearest == 0 && std::abs(force) <= 1e-9 * largest) told.first = 0;
  for (const double zero : {told.first, told.f.barrier_travel, told.f.second_travel}) {
    if (!std::isnan(zero)) told.zeros.push_back(zero);
  }
  return told;
}

Told solved(std::vector<Feature> found, bool down, double factor, bool preloaded) {
  Told told;
  const double sign = down ? -1 : 1;
  std::stable_sort(found.begin(), found.end(),
                   [&](const Feature& a, const Feature& b) { return sign * a.point.control < sign * b.point.control; });
  const Feature *peak = nullptr, *valley = nullptr, *first = nullptr, *barrier = nullptr, *second = nullptr;
  for (const Feature& feature : found) {
    const statics::PathPoint& p = feature.point;
    const double force = sign * p.force;
    if (feature.kind == FeatureKind::ZERO) {
      told.zeros.push_back(p.control);
      if (p.stiffness > 0 && peak == nullptr && first == nullptr) first = &feature;
      if (p.stiffness < 0 && peak != nullptr && barrier == nullptr) barrier = &feature;
      if (p.stiffness > 0 && barrier != nullptr && second == nullptr) second = &feature;
    } else if (feature.kind == FeatureKind::PEAK) {
      if (peak == nullptr && sign * p.control > 0) peak = &feature;
    } else if (peak != nullptr && (valley == nullptr || force < sign * valley->point.force)) {
      valley = &feature;
    }
  }
  for (double& zero : told.zeros) zero += 0.0;  // no -0
  vehicle::CurveFeatures& f = told.f;
  if (first) told.first = first->point.control + 0.0;
  if (peak) f.peak_travel = peak->point.control, f.peak_force = factor * peak->point.force;
  if (valley) f.valley_travel = valley->point.control, f.valley_force = factor * valley->point.force;
  if (barrier) f.barrier_travel = barrier->point.control;
  if (second) f.second_travel = second->point.control;
  f.bistable = first != nullptr && barrier != nullptr && second != nullptr;
  if (f.bistable && !preloaded) {
    f.barrier_forward = factor * (barrier->point.energy - first->point.energy);
    f.barrier_back = factor * (barrier->point.energy - second->point.energy);
  }
  return told;
}

// Lines for people.

std::string print(const char* format, double a, double b = 0) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

double number(const json& j, const char* key) {
  return j.contains(key) && j[key].is_number() ? j[key].get<double>() : NONE;
}

std::string text(const json& j, const char* key) {
  return j.contains(key) && j[key].is_string() ? j[key].get<std::string>() : "";
}

std::string headline(const json& j) {
  const json& from = j.contains("provenance") ? j["provenance"] : j;
  std::string line = text(from, from.contains("scene") ? "scene" : "vehicle");
  for (const char* key : {"rung", "kernel"}) {
    if (!text(from, key).empty()) line += (line.empty() ? "" : ", ") + text(from, key);
  }
  if (j.contains("cell_size_m")) line += print(", cells of %.4g mm", 1e3 * number(j, "cell_size_m"));
  if (j.contains("dof")) line += ", " + std::to_string(j["dof"].get<long>()) + " unknowns";
  return line + ": " + text(j, "status") + "\n";
}

std::string extreme(const json& j, const char* name) {
  const double force = number(j[name], "force_N");
  char label[16];
  std::snprintf(label, sizeof label, "  %-11s", name);
  return label + (std::isnan(force) ? "none" : print("%.4g N at %.4g mm", force, 1e3 * number(j[name], "travel_m"))) +
         "\n";
}

std::string equilibria(const json& j) {
  const json& e = j["equilibria"];
  std::string line;
  const std::pair<const char*, const char*> names[] = {
      {"first_m", " mm"}, {"barrier_m", " mm (unstable)"}, {"second_m", " mm"}};
  for (const auto& [key, after] : names) {
    if (!std::isnan(number(e, key))) line += (line.empty() ? "" : ", ") + print("%.4g", 1e3 * number(e, key)) + after;
  }
  return "  equilibria " + (line.empty() ? "none" : line) + "\n";
}

std::string features(const json& j) {
  std::string lines = extreme(j, "peak") + extreme(j, "valley") + equilibria(j);
  lines += std::string("  bistable   ") + (j["bistable"].get<bool>() ? "yes" : "no");
  const double there = number(j, "barrier_forward_J"), back = number(j, "barrier_back_J");
  if (!std::isnan(there)) lines += print("; barriers %.4g mJ there, %.4g mJ back", 1e3 * there, 1e3 * back);
  if (text(j, "features") == "interpolated") lines += "\n  (interpolated between the points, not solved for)";
  return lines + "\n";
}

std::string stability(const json& j) {
  const long points = j["points"].get<long>();
  const auto stable = [&](const char* key) { return std::to_string(points - j[key].get<long>()); };
  std::string line = "  points     " + std::to_string(points) + ": ";
  if (j.contains("points_unstable")) return line + stable("points_unstable") + " stable\n";
  return line + stable("points_unstable_while_held") + " stable while held, " + stable("points_unstable_when_free") +
         " stable when let go\n";
}

}  // namespace

void countStable(const std::vector<int>& stable, const std::vector<double>& stiffness, bool driven, json& j) {
  int held = 0, free = 0;
  for (std::size_t k = 0; k < stable.size(); ++k) {
    held += stable[k] ? 0 : 1;
    free += stable[k] && stiffness[k] >= 0 ? 0 : 1;
  }
  j["points"] = stable.size();
  j[driven ? "points_unstable_while_held" : "points_unstable"] = held;
  if (driven) j["points_unstable_when_free"] = free;
}

json orNull(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

void addLocated(const std::vector<Feature>& found, double factor, json& j) {
  for (const Feature& f : found) {
    j["located"].push_back({{"kind", statics::featureName(f.kind)},
                            {"control", f.point.control},
                            {"force", factor * f.point.force},
                            {"energy", factor * f.point.energy},
                            {"stable_when_free", f.point.stable && f.point.stiffness > 0},
                            {"accuracy", f.accuracy},
                            {"remainder", f.remainder}});
  }
}

void addFeatures(const vehicle::ForceTable& table, const statics::LocatedFeatures& located, double factor,
                 bool preloaded, json& j) {
  if (table.travel.size() >= 4) {
    const double hysteresis = vehicle::curveFeatures(table).hysteresis;
    const Told told =
        located.complete ? solved(located.found, leadsDown(table), factor, preloaded) : interpolated(table);
    const vehicle::CurveFeatures& f = told.f;
    const bool exact = located.complete;
    j["features"] = exact ? "solved for" : "interpolated";
    j["peak"] = {{"travel_m", orNull(f.peak_travel)}, {"force_N", orNull(f.peak_force)}, {"exact", exact}};
    j["valley"] = {{"travel_m", orNull(f.valley_travel)}, {"force_N", orNull(f.valley_force)}, {"exact", exact}};
    j["zeros_m"] = told.zeros;
    j["equilibria"] = {{"first_m", orNull(told.first)},
                       {"barrier_m", orNull(f.barrier_travel)},
                       {"second_m", orNull(f.second_travel)},
                       {"exact", exact}};
    j["barrier_forward_J"] = orNull(preloaded ? NONE : f.barrier_forward);
    j["barrier_back_J"] = orNull(preloaded ? NONE : f.barrier_back);
    j["hysteresis_N"] = orNull(hysteresis);
    j["bistable"] = f.bistable;
  }
  addLocated(located.found, factor, j);
  countStable(table.stable, table.stiffness, true, j);
}

std::string curveAnswer(const json& summary, const std::vector<std::string>& files) {
  std::string lines = headline(summary);
  if (summary.contains("peak")) lines += features(summary);
  if (summary.contains("points")) lines += stability(summary);
  if (summary.contains("singular_points")) {
    for (const json& s : summary["singular_points"]) {
      lines += "  " + text(s, "kind") + print(" at control %.6g", number(s, "control")) + "\n";
    }
  }
  if (summary.contains("monitors_at_end")) {
    for (const auto& [name, value] : summary["monitors_at_end"].items())
      lines += "  at the end " + name + print(" = %.6g", value.get<double>()) + "\n";
  }
  if (summary.contains("seconds")) {
    lines += print("  cost       %.3g s, %.0f factorizations", number(summary["seconds"], "total"),
                   number(summary, "factorizations"));
    const double series = summary.contains("series") ? number(summary, "series") : 0;
    lines += (series > 0 ? print(", %.0f power series", series) : "") + "\n";
  }
  for (const std::string& file : files) lines += "  wrote      " + file + "\n";
  return common::shownBytes(lines);
}

}  // namespace snapwing::tools
