#include "snapwing/rom/potential.h"

#include <cmath>

#include "snapwing/common/bisection.h"

namespace snapwing::rom {

namespace {

constexpr int HALVINGS = 100;
constexpr double WIDTH = 1e-15;  // [m]

// Zero of the force between two travels of opposite sign.
double zeroOfForce(const Potential& potential, double low, double high) {
  return common::bisect([&](double u) { return potential.at(u).force; }, low, high, HALVINGS, WIDTH);
}

// Zero of the stiffness around u: extremum of the force, refined between the scan's neighbours.
double refineExtremum(const Potential& potential, double low, double high) {
  return common::bisect([&](double u) { return potential.at(u).stiffness; }, low, high, HALVINGS, WIDTH);
}

double extremeForce(const Potential& potential, double from, double to, int count, bool largest, double* travel) {
  const double h = (to - from) / count;
  double best = largest ? -INFINITY : INFINITY;
  int best_index = 0;
  for (int i = 0; i <= count; ++i) {
    const double force = potential.at(from + i * h).force;
    if (largest ? force > best : force < best) {
      best = force;
      best_index = i;
    }
  }
  const double u = from + best_index * h;
  *travel = refineExtremum(potential, u - h, u + h);
  return potential.at(*travel).force;
}

}  // namespace

Equilibria findEquilibria(const Potential& potential, double low, double high, int count) {
  Equilibria result;
  // Zeros in the pattern rising, falling, rising.
  double zeros[3] = {0, 0, 0};
  int found = 0;
  const double h = (high - low) / count;
  double left = potential.at(low).force;
  for (int i = 1; i <= count && found < 3; ++i) {
    const double u = low + i * h;
    const double right = potential.at(u).force;
    const bool rises = left < 0 && right >= 0;
    const bool falls = left >= 0 && right < 0;
    if ((found != 1 && rises) || (found == 1 && falls)) zeros[found++] = zeroOfForce(potential, u - h, u);
    left = right;
  }
  if (found > 0) result.first = zeros[0];
  if (found < 3) return result;
  result.bistable = true;
  result.barrier = zeros[1];
  result.second = zeros[2];
  result.barrier_first = potential.energy(zeros[1]) - potential.energy(zeros[0]);
  result.barrier_second = potential.energy(zeros[1]) - potential.energy(zeros[2]);
  result.peak_force = extremeForce(potential, zeros[0], zeros[1], count, true, &result.peak_travel);
  result.valley_force = extremeForce(potential, zeros[1], zeros[2], count, false, &result.valley_travel);
  return result;
}

}  // namespace snapwing::rom
