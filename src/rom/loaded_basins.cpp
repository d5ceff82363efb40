#include "snapwing/rom/loaded_basins.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>

#include "snapwing/common/error.h"

namespace snapwing::rom {

namespace {
constexpr int POINTS = 33;            // of a scan for an extremum, between whose neighbours the force is level
constexpr double EXTREMUM_TO = 1e-9;  // [m]
}  // namespace

LoadedBasins::LoadedBasins(const Potential& potential, const TravelInertia* moved)
    : potential_(potential), equilibria_(potential.equilibria()) {
  if (moved != nullptr) moved_.emplace(*moved);
  if (!equilibria_.bistable) throw common::Error("the force curve is not bistable: there is no second mode");
  if (!moved_) return;
  const auto scan = [&](double from, double to) {
    std::vector<Point> points;
    for (int i = 0; i < POINTS; ++i) {
      const double u = from + (to - from) * i / (POINTS - 1);
      points.push_back({u, potential_->at(u).force, (*moved_)->at(u).coupled_mass});
    }
    return points;
  };
  rising_ = scan(equilibria_.first, equilibria_.barrier);
  falling_ = scan(equilibria_.barrier, equilibria_.second);
}

PotentialSample LoadedBasins::sample(double travel, double specific_force) const {
  PotentialSample s = potential_->at(travel);
  if (moved_) {
    const InertiaSample w = (*moved_)->at(travel);
    s.energy += specific_force * w.mass_moment;
    s.force += specific_force * w.coupled_mass;
    s.stiffness += specific_force * w.coupled_slope;
  }
  return s;
}

// Zero of force - load between two travels, of a force that rises or falls from one to the other: Newton kept inside
// the bracket. Which of both is not judged by an end: the zero may lie right there.
double LoadedBasins::solveForce(bool rising, const RelativeLoad& load, double low, double high, double guess) const {
  double u = guess > low && guess < high ? guess : 0.5 * (low + high);
  for (int i = 0; i < 80; ++i) {
    const PotentialSample here = sample(u, load.specific_force);
    if ((here.force < load.force) == rising) {
      low = u;
    } else {
      high = u;
    }
    double next = u - (here.force - load.force) / here.stiffness;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - u) < 1e-14) return next;
    u = next;
  }
  return u;
}

double LoadedBasins::extremum(const std::vector<Point>& points, double specific_force, bool largest) const {
  const double sign = largest ? 1.0 : -1.0;
  int best = 0;
  double value = -INFINITY;
  for (int i = 0; i < POINTS; ++i) {
    const double force = sign * (points[i].force + specific_force * points[i].coupled_mass);
    if (force > value) {
      value = force;
      best = i;
    }
  }
  if (best == 0 || best == POINTS - 1) return points[best].travel;
  const auto at = [&](int i) { return points[i].force + specific_force * points[i].coupled_mass; };
  const double left = at(best - 1), middle = at(best), right = at(best + 1);
  const double bend = left - 2 * middle + right;
  const double shift = bend != 0 ? std::clamp(0.5 * (left - right) / bend, -1.0, 1.0) : 0.0;
  const double vertex = points[best].travel + shift * (points[1].travel - points[0].travel);
  return levelForce(specific_force, points[best - 1].travel, points[best + 1].travel, vertex);
}

// A parabola through points of the scan is off by a tenth of a millimetre, which is up to .006 of a margin.
double LoadedBasins::levelForce(double specific_force, double low, double high, double guess) const {
  const auto stiffness = [&](double u) { return sample(u, specific_force).stiffness; };
  const double at_low = stiffness(low), at_high = stiffness(high);
  if ((at_low < 0) == (at_high < 0)) return guess;
  std::uintmax_t calls = 60;
  const auto narrow = [](double l, double h) { return h - l < EXTREMUM_TO; };
  const auto bracket = boost::math::tools::toms748_solve(stiffness, low, high, at_low, at_high, narrow, calls);
  return 0.5 * (bracket.first + bracket.second);
}

LoadedBasins::Branch LoadedBasins::branch(double specific_force) const {
  const Equilibria& e = equilibria_;
  if (!moved_ || specific_force == 0) return {e.peak_travel, e.peak_force, e.valley_travel, e.valley_force};
  Branch b;
  b.peak_travel = extremum(rising_, specific_force, true);
  b.valley_travel = extremum(falling_, specific_force, false);
  b.peak_force = sample(b.peak_travel, specific_force).force;
  b.valley_force = sample(b.valley_travel, specific_force).force;
  return b;
}

double LoadedBasins::limit(vehicle::Mode mode, double specific_force) const {
  const Branch b = branch(specific_force);
  return mode == vehicle::Mode::FIXED_WING ? b.peak_force : b.valley_force;
}

bool LoadedBasins::equilibrium(vehicle::Mode mode, const RelativeLoad& load, double* travel) const {
  const Branch b = branch(load.specific_force);
  if (mode == vehicle::Mode::FIXED_WING) {
    if (load.force >= b.peak_force) return false;
    double low = std::min(equilibria_.first, b.peak_travel), reach = 1e-3;
    while (sample(low, load.specific_force).force > load.force) low -= (reach *= 2);
    *travel = solveForce(true, load, low, b.peak_travel, NAN);
    return true;
  }
  if (load.force <= b.valley_force) return false;
  double high = std::max(equilibria_.second, b.valley_travel), reach = 1e-3;
  while (sample(high, load.specific_force).force < load.force) high += (reach *= 2);
  *travel = solveForce(true, load, b.valley_travel, high, NAN);
  return true;
}

vehicle::Mode LoadedBarrier::sideOf(double u) const {
  if (u <= peak) return vehicle::Mode::FIXED_WING;
  if (u >= valley) return vehicle::Mode::QUADROTOR;
  return u < travel ? vehicle::Mode::FIXED_WING : vehicle::Mode::QUADROTOR;
}

LoadedBarrier LoadedBasins::barrierUnder(const RelativeLoad& load, double guess) const {
  const Branch b = branch(load.specific_force);
  LoadedBarrier barrier;
  barrier.peak = b.peak_travel;
  barrier.valley = b.valley_travel;
  if (load.force >= b.peak_force) {
    barrier.travel = b.peak_travel;
    barrier.excess = (load.force - b.peak_force) * (equilibria_.barrier - b.peak_travel);
  } else if (load.force <= b.valley_force) {
    barrier.travel = b.valley_travel;
    barrier.excess = (b.valley_force - load.force) * (b.valley_travel - equilibria_.barrier);
  } else {
    barrier.exists = true;
    barrier.travel = solveForce(false, load, b.peak_travel, b.valley_travel, guess);
  }
  return barrier;
}

double LoadedBasins::loadedEnergy(double travel, const RelativeLoad& load) const {
  return sample(travel, load.specific_force).energy - load.force * travel;
}

double LoadedBasins::clearance(vehicle::Mode mode, double travel, double kinetic, const RelativeLoad& load) const {
  const LoadedBarrier top = barrierUnder(load);
  if (!top.exists) {
    const vehicle::Mode left = top.travel == top.peak ? vehicle::Mode::QUADROTOR : vehicle::Mode::FIXED_WING;
    return mode == left ? INFINITY : -INFINITY;
  }
  return loadedEnergy(top.travel, load) - loadedEnergy(travel, load) - kinetic;
}

}  // namespace snapwing::rom
