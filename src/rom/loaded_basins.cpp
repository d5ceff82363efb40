#include "snapwing/rom/loaded_basins.h"

#include <cmath>

#include "snapwing/common/error.h"

namespace snapwing::rom {

namespace {

// Solves force(u) = load between two travels where force - load has opposite signs: Newton kept inside the bracket.
double solveForce(const Potential& potential, double load, double low, double high) {
  const bool rising = potential.at(low).force < load;
  double u = 0.5 * (low + high);
  for (int i = 0; i < 80; ++i) {
    const PotentialSample sample = potential.at(u);
    if ((sample.force < load) == rising) {
      low = u;
    } else {
      high = u;
    }
    double next = u - (sample.force - load) / sample.stiffness;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - u) < 1e-14) return next;
    u = next;
  }
  return u;
}

}  // namespace

LoadedBasins::LoadedBasins(const Potential& potential) : potential_(potential), equilibria_(potential.equilibria()) {
  if (!equilibria_.bistable) throw common::Error("the force curve is not bistable: there is no second mode");
}

bool LoadedBasins::equilibrium(common::Mode mode, double load, double* travel) const {
  if (mode == common::Mode::FIXED_WING) {
    if (load >= equilibria_.peak_force) return false;
    double low = equilibria_.first, reach = 1e-3;
    while (potential_.at(low).force > load) low -= (reach *= 2);
    *travel = solveForce(potential_, load, low, equilibria_.peak_travel);
    return true;
  }
  if (load <= equilibria_.valley_force) return false;
  double high = equilibria_.second, reach = 1e-3;
  while (potential_.at(high).force < load) high += (reach *= 2);
  *travel = solveForce(potential_, load, equilibria_.valley_travel, high);
  return true;
}

bool LoadedBasins::barrier(double load, double* travel) const {
  if (load >= equilibria_.peak_force || load <= equilibria_.valley_force) return false;
  *travel = solveForce(potential_, load, equilibria_.peak_travel, equilibria_.valley_travel);
  return true;
}

double LoadedBasins::clearance(common::Mode mode, double travel, double kinetic, double load) const {
  double top = 0;
  if (!barrier(load, &top)) {
    const bool only_first = load <= equilibria_.valley_force;
    return (mode == common::Mode::FIXED_WING) == only_first ? INFINITY : -INFINITY;
  }
  return loadedEnergy(top, load) - loadedEnergy(travel, load) - kinetic;
}

}  // namespace snapwing::rom
