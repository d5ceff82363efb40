#include "snapwing/vehicle/force_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snapwing/common/bisection.h"
#include "snapwing/common/error.h"

namespace snapwing::vehicle {

namespace {

constexpr double NONE = std::numeric_limits<double>::quiet_NaN();

void checkArray(const std::vector<double>& values, const char* name, std::size_t expected) {
  if (values.size() != expected) {
    throw common::Error(std::string("force table: '") + name + "' has " + std::to_string(values.size()) +
                        " entries, travel has " + std::to_string(expected));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      throw common::Error(std::string("force table: '") + name + "' is not finite at entry " + std::to_string(i));
    }
  }
}

/// Masses are positive, and S^2 <= m K (Cauchy and Schwarz).
void checkInertia(const ForceTable& table) {
  if (!(table.mass >= 0 && std::isfinite(table.mass))) {
    throw common::Error("force table: 'mass' is " + std::to_string(table.mass) + "; allowed: 0 or more");
  }
  for (std::size_t i = 0; i < table.travel.size(); ++i) {
    const double k = table.kinetic_mass[i], s = table.coupled_mass[i];
    if (!(k >= 0 && s * s <= table.mass * k * (1 + 1e-9))) {
      throw common::Error("force table: 'kinetic_mass' is " + std::to_string(k) + " kg at entry " + std::to_string(i) +
                          "; allowed: at least coupled_mass^2 / mass = " + std::to_string(s * s / table.mass) + " kg");
    }
  }
}

/// Force of one arm between knots: cubic Hermite in travel with the table's stiffness as slope.
class ForceInterpolant {
 public:
  explicit ForceInterpolant(const ForceTable& table) : t_(table) {}

  std::size_t intervals() const { return t_.travel.size() - 1; }

  double force(std::size_t k, double s) const {
    const double h = width(k);
    return (1 + 2 * s) * (1 - s) * (1 - s) * t_.force[k] + s * (1 - s) * (1 - s) * h * t_.stiffness[k] +
           s * s * (3 - 2 * s) * t_.force[k + 1] + s * s * (s - 1) * h * t_.stiffness[k + 1];
  }
  double stiffness(std::size_t k, double s) const {
    return 6 * s * (1 - s) * (t_.force[k + 1] - t_.force[k]) / width(k) + (1 - s) * (1 - 3 * s) * t_.stiffness[k] +
           s * (3 * s - 2) * t_.stiffness[k + 1];
  }
  /// Energy relative to the knot's stored one: exact integral of the interpolated force.
  double energy(std::size_t k, double s) const {
    const double h = width(k), s2 = s * s, s3 = s2 * s, s4 = s3 * s;
    return t_.energy[k] + h * (t_.force[k] * (s - s3 + s4 / 2) + h * t_.stiffness[k] * (s2 / 2 - 2 * s3 / 3 + s4 / 4) +
                               t_.force[k + 1] * (s3 - s4 / 2) + h * t_.stiffness[k + 1] * (s4 / 4 - s3 / 3));
  }
  double travel(std::size_t k, double s) const { return t_.travel[k] + s * width(k); }

 private:
  double width(std::size_t k) const { return t_.travel[k + 1] - t_.travel[k]; }
  const ForceTable& t_;
};

/// A place on the curve: interval and fraction.
struct Place {
  std::size_t k = 0;
  double s = 0;
  bool found = false;
};

/// First sign change of `f` (force or stiffness) at or after interval `from`; falling: from + to -.
Place firstChange(const ForceInterpolant& curve, std::size_t from, bool falling,
                  double (ForceInterpolant::*f)(std::size_t, double) const) {
  for (std::size_t k = from; k < curve.intervals(); ++k) {
    const double a = (curve.*f)(k, 0), b = (curve.*f)(k, 1);
    const bool changes = falling ? (a > 0 && b <= 0) : (a < 0 && b >= 0);
    if (changes) return {k, common::bisect([&](double s) { return (curve.*f)(k, s); }, 0.0, 1.0, 60), true};
  }
  return {};
}

Place lowestValley(const ForceInterpolant& curve, std::size_t from) {
  Place lowest;
  for (std::size_t k = from; k < curve.intervals();) {
    const Place next = firstChange(curve, k, false, &ForceInterpolant::stiffness);
    if (!next.found) break;
    if (!lowest.found || curve.force(next.k, next.s) < curve.force(lowest.k, lowest.s)) lowest = next;
    k = next.k + 1;
  }
  return lowest;
}

double largestHysteresis(const ForceTable& table) {
  if (table.force_back.empty()) return NONE;
  double largest = 0;
  for (std::size_t i = 0; i < table.force.size(); ++i) {
    largest = std::max(largest, std::abs(table.force[i] - table.force_back[i]));
  }
  return table.arm_count * largest;
}

}  // namespace

void ForceTable::validate() const {
  const std::size_t n = travel.size();
  if (n < 4) throw common::Error("force table: " + std::to_string(n) + " points; allowed: at least 4");
  const std::vector<std::pair<const std::vector<double>*, const char*>> arrays = {{&travel, "travel"},
                                                                                  {&force, "force"},
                                                                                  {&stiffness, "stiffness"},
                                                                                  {&energy, "energy"},
                                                                                  {&rotation, "rotation"},
                                                                                  {&min_det_f, "min_det_f"},
                                                                                  {&kinetic_mass, "kinetic_mass"},
                                                                                  {&coupled_mass, "coupled_mass"}};
  for (const auto& [array, name] : arrays) checkArray(*array, name, n);
  if (!force_back.empty()) checkArray(force_back, "force_back", n);
  if (stable.size() != n || iterations.size() != n)
    throw common::Error("force table: 'stable' or 'iterations' has a wrong length");
  for (std::size_t i = 1; i < n; ++i) {
    if (travel[i] <= travel[i - 1])
      throw common::Error("force table: travel does not increase at entry " + std::to_string(i));
  }
  checkInertia(*this);
  if (arm_count < 1)
    throw common::Error("force table: arm_count is " + std::to_string(arm_count) + "; allowed: at least 1");
  if (!shapes.moved.empty() && shapes.moved.size() != n) throw common::Error("force table: shapes do not match travel");
}

CurveFeatures curveFeatures(const ForceTable& table) {
  table.validate();
  const ForceInterpolant curve(table);
  const double arms = table.arm_count;
  CurveFeatures f{NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, largestHysteresis(table), false};

  const auto start = std::lower_bound(table.travel.begin(), table.travel.end(), 0.0) - table.travel.begin();
  const Place peak = firstChange(curve, static_cast<std::size_t>(start), true, &ForceInterpolant::stiffness);
  if (!peak.found) return f;
  f.peak_travel = curve.travel(peak.k, peak.s);
  f.peak_force = arms * curve.force(peak.k, peak.s);
  const Place valley = lowestValley(curve, peak.k);
  if (!valley.found) return f;
  f.valley_travel = curve.travel(valley.k, valley.s);
  f.valley_force = arms * curve.force(valley.k, valley.s);

  const Place barrier = firstChange(curve, peak.k, true, &ForceInterpolant::force);
  if (!barrier.found) return f;
  f.barrier_travel = curve.travel(barrier.k, barrier.s);
  const Place second = firstChange(curve, barrier.k, false, &ForceInterpolant::force);
  if (!second.found) return f;
  f.second_travel = curve.travel(second.k, second.s);
  const double top = curve.energy(barrier.k, barrier.s);
  const auto rest = static_cast<std::size_t>(std::min<long>(start, static_cast<long>(curve.intervals()) - 1));
  f.barrier_forward = arms * (top - curve.energy(rest, 0));
  f.barrier_back = arms * (top - curve.energy(second.k, second.s));
  f.bistable = f.barrier_forward > 0 && f.barrier_back > 0;
  return f;
}

double forceAt(const ForceTable& table, double travel) {
  const std::vector<double>& u = table.travel;
  const std::size_t last = u.size() - 1;
  if (travel <= u.front()) return table.force.front() + table.stiffness.front() * (travel - u.front());
  if (travel >= u.back()) return table.force[last] + table.stiffness[last] * (travel - u.back());
  const std::size_t k = std::upper_bound(u.begin(), u.end(), travel) - u.begin() - 1;
  return ForceInterpolant(table).force(k, (travel - u[k]) / (u[k + 1] - u[k]));
}

}  // namespace snapwing::vehicle
