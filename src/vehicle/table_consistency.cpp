#include "table_consistency.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "snapwing/common/error.h"

namespace snapwing::vehicle {

namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string share(double value) { return number(100 * value) + " %"; }

/// A ratio near a power of ten is a unit, not an error of the computation.
std::string unitHint(double ratio) {
  for (const double factor : {1e3, 1e-3, 1e6, 1e-6}) {
    if (std::abs(std::log(std::abs(ratio) / factor)) < 0.1) {
      return "; the factor is " + number(ratio) + ": a column is in another unit than it says (mm for m?)";
    }
  }
  return {};
}

/// Integral of the cubic through both forces and stiffnesses.
double work(const ForceTable& t, std::size_t k) {
  const double h = t.travel[k + 1] - t.travel[k];
  return 0.5 * h * (t.force[k] + t.force[k + 1]) + h * h / 12 * (t.stiffness[k] - t.stiffness[k + 1]);
}

void checkEnergy(const ForceTable& t, const std::string& path) {
  double off = 0, all = 0, gained = 0, worst = -1;
  std::size_t where = 0;
  for (std::size_t k = 0; k + 1 < t.travel.size(); ++k) {
    const double h = t.travel[k + 1] - t.travel[k];
    // By the trapezoid, so that a wrong stiffness is not blamed on the energy; the better of both counts.
    const double change = t.energy[k + 1] - t.energy[k], plain = 0.5 * h * (t.force[k] + t.force[k + 1]);
    const double error = std::min(std::abs(change - work(t, k)), std::abs(change - plain));
    off += error, all += std::abs(plain), gained += std::abs(change);
    if (error > worst) worst = error, where = k;
  }
  if (off <= ENERGY_ERROR_ALLOWED * all) return;
  throw common::FileError(path, "'force' is not the slope of 'energy': they differ by " + share(off / all) +
                                    " over the path, most at " + number(t.travel[where]) + " .. " +
                                    number(t.travel[where + 1]) + " m; allowed: " + share(ENERGY_ERROR_ALLOWED) +
                                    unitHint(all / gained));
}

void checkStiffness(const ForceTable& t, const std::string& path) {
  double off = 0, slopes = 0, given = 0, worst = -1;
  std::size_t where = 0;
  for (std::size_t k = 0; k + 1 < t.travel.size(); ++k) {
    const double h = t.travel[k + 1] - t.travel[k], slope = (t.force[k + 1] - t.force[k]) / h;
    const double mean = 0.5 * (t.stiffness[k] + t.stiffness[k + 1]), error = slope - mean;
    off += h * error * error, slopes += h * slope * slope, given += h * mean * mean;
    if (std::abs(error) > worst) worst = std::abs(error), where = k;
  }
  if (off <= STIFFNESS_ERROR_ALLOWED * STIFFNESS_ERROR_ALLOWED * slopes) return;
  throw common::FileError(path,
                          "'stiffness' is not the slope of 'force': they differ by " + share(std::sqrt(off / slopes)) +
                              " (rms), most at " + number(t.travel[where]) + " .. " + number(t.travel[where + 1]) +
                              " m; allowed: " + share(STIFFNESS_ERROR_ALLOWED) + unitHint(std::sqrt(slopes / given)));
}

/// The arm was built at u = 0: there it holds no force.
void checkRest(const ForceTable& t, const std::string& path) {
  const auto above = std::upper_bound(t.travel.begin() + 1, t.travel.end() - 1, 0.0);
  const std::size_t k = static_cast<std::size_t>(above - t.travel.begin()) - 1;
  const double s = (0.0 - t.travel[k]) / (t.travel[k + 1] - t.travel[k]);
  if (!(s >= -1e-9 && s <= 1 + 1e-9)) {
    throw common::FileError(path, "'travel' is " + number(t.travel.front()) + " .. " + number(t.travel.back()) +
                                      " m; allowed: a range with u = 0, where the arm is at rest");
  }
  const double rest = (1 - s) * t.force[k] + s * t.force[k + 1];
  double largest = 0;
  for (const double force : t.force) largest = std::max(largest, std::abs(force));
  if (std::abs(rest) <= REST_FORCE_ALLOWED * largest) return;
  throw common::FileError(path, "'force' at u = 0 is " + number(rest) +
                                    " N; allowed: 0, as u = 0 is where the arm was built, up to " +
                                    share(REST_FORCE_ALLOWED) + " of the largest force, " + number(largest) + " N");
}

/// A mass in g passes the check against its bounds from below (ForceTable::validate).
void checkInertia(const ForceTable& t, const std::string& path) {
  if (t.kinetic_mass.empty()) return;
  const auto most = std::max_element(t.kinetic_mass.begin(), t.kinetic_mass.end());
  if (*most <= KINETIC_SHARE_ALLOWED * t.mass) return;
  throw common::FileError(path, "'kinetic_mass' is " + number(*most) + " kg at " +
                                    number(t.travel[static_cast<std::size_t>(most - t.kinetic_mass.begin())]) +
                                    " m; allowed: up to " + number(KINETIC_SHARE_ALLOWED) + " times 'mass', " +
                                    number(t.mass) + " kg; is it in g?");
}

}  // namespace

void requireConsistent(const ForceTable& table, const std::string& path) {
  checkEnergy(table, path);
  checkStiffness(table, path);
  checkRest(table, path);
  checkInertia(table, path);
}

void requireTravelOf(const ForceTable& table, const Vehicle& vehicle, const std::string& path) {
  const double low = table.travel.front(), high = table.travel.back();
  const double reach = vehicle.arm.domain_length + vehicle.arm.domain_height;
  const std::string given = "'travel' is " + number(low) + " .. " + number(high) + " m; allowed: ";
  if (std::max(-low, high) > 2 * reach) {
    throw common::FileError(path, given + "what an arm of " + number(reach) +
                                      " m (domain_length + domain_height) can reach; " + "is it in mm?");
  }
  constexpr double SLACK = 1e-6;  // [m] of printed numbers
  if (low <= vehicle.limits.travel_min + SLACK && high >= vehicle.limits.travel_max - SLACK) return;
  throw common::FileError(path, given + "a table over the whole of limits.travel_min .. travel_max of " + vehicle.file +
                                    ", " + number(vehicle.limits.travel_min) + " .. " +
                                    number(vehicle.limits.travel_max) + " m; `snapwing curve " + vehicle.file + " -o " +
                                    path + "` computes one");
}

void requireMassOf(const ForceTable& table, const Vehicle& vehicle, const std::string& path) {
  const double arms = table.arm_count * table.mass,
               ring_side = vehicle.masses.total.value - vehicle.masses.centre.value;
  if (arms <= ring_side) return;
  throw common::FileError(path, "'mass' is " + number(table.mass) + " kg for each of " +
                                    std::to_string(table.arm_count) +
                                    " arms; allowed: together up to masses.total - masses.centre of " + vehicle.file +
                                    ", " + number(ring_side) + " kg; is it in g?");
}

}  // namespace snapwing::vehicle
