#pragma once
/// V = k/4 ((x - h)^2 - h^2)^2 with k = h = 1: states at 0 and 2, barrier 1/4 at 1 (reference numbers, section 5).

#include <limits>

#include "snapwing/rom/lumped_model.h"

namespace snapwing::rom::testing {

class Quartic : public Potential {
 public:
  Quartic() : equilibria_(findEquilibria(*this, -0.5, 2.5)) {}
  PotentialSample at(double x) const override {
    const double y = x - 1.0, w = y * y - 1.0;
    return {0.25 * w * w, w * y, 3.0 * y * y - 1.0};
  }
  bool inTable(double) const override { return true; }
  const Equilibria& equilibria() const override { return equilibria_; }
  double forceError() const override { return std::numeric_limits<double>::quiet_NaN(); }

 private:
  Equilibria equilibria_;
};

/// Relative mass 1, thrust 2 F gives the force F on the relative motion, no lag to speak of, no losses.
inline LumpedModel quarticModel(double force, double step = 1e-3, double damping = 0.0) {
  vehicle::VehicleParameters p;
  p.ring_mass = p.centre_mass = 2.0;
  p.max_thrust = 2.0 * force;
  p.time_constant_up = p.time_constant_down = 1e-9;
  p.damping = damping;
  LumpedSettings settings;
  settings.step = step;
  return LumpedModel(std::make_shared<Quartic>(), p, 0.0, settings);
}

}  // namespace snapwing::rom::testing
