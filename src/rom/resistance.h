#pragma once
/// Forces against motion and their slopes in the speed. Private to the layer.

#include <cmath>

#include "snapwing/rom/potential.h"

namespace snapwing::rom {

struct Resistance {
  double force = 0, slope = 0;
};

inline Resistance drag(double coefficient, double speed) {
  const double k = coefficient * std::abs(speed);
  return {k * speed, 2.0 * k};
}

/// Coulomb friction whose step is `width` wide. [m/s]
inline Resistance coulomb(double friction, double speed, double width) {
  const double r = 1.0 / std::sqrt(speed * speed + width * width);
  return {friction * speed * r, friction * width * width * r * r * r};
}

/// Elastic force over a step and its slope in the end travel: the discrete gradient, which does exactly the work that
/// the energy loses. For steps too short for the quotient it is the force at the middle.
inline Resistance elasticForce(const Potential& potential, double u0, double energy0, double u1) {
  const double du = u1 - u0;
  if (std::abs(du) < 1e-7) {
    const PotentialSample middle = potential.at(u0 + 0.5 * du);
    return {middle.force, 0.5 * middle.stiffness};
  }
  const PotentialSample end = potential.at(u1);
  const double force = (end.energy - energy0) / du;
  return {force, (end.force - force) / du};
}

}  // namespace snapwing::rom
