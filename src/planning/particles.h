#pragma once
/// The particles of the mode estimate, what they say together, and drawing them anew. Private to the layer.

#include <memory>
#include <vector>

#include "outside_force.h"
#include "random_source.h"
#include "snapwing/rom/lumped_model.h"

namespace snapwing::planning {

struct Particle {
  std::shared_ptr<const rom::LumpedModel> model;
  rom::LumpedState state;
  double bias = 0;          ///< [m/s2] of the accelerometer
  double output_delay = 0;  ///< [s] of outputs read back
  double restitution = 0;   ///< [1] of a mechanical stop
  OutsideForce outside;
  double weight = 1;  ///< normalised
  /// @param barrier  [m] travel that parts the modes
  bool inQuadrotor(double barrier) const { return state.travel > barrier; }
};

/// Makes the sum of the weights 1.
void normalise(std::vector<Particle>* particles);
/// Number of equally weighted particles that know as much.
double effective(const std::vector<Particle>& particles);
double shareInQuadrotor(const std::vector<Particle>& particles, double barrier);
/// Share of those that believe in a force from outside.
double shareTouched(const std::vector<Particle>& particles);
/// What drawing anew now would add to the variance of the log odds of the modes [1].
double samplingVariance(const std::vector<Particle>& particles, double barrier);

/// As many particles, drawn by their weights. Those who believe in a touch and those who do not, each kind apart and
/// never fewer than a fifth of all: a force needs some readings to show, and until then its weight is small [Boers and
/// Driessen 2003]. Within a kind each mode apart: drawing them together lets the share of a mode drift by chance, until
/// one of them is gone. Weights keep the share of each kind and mode.
std::vector<Particle> drawAnew(const std::vector<Particle>& particles, double barrier, RandomSource& random);

}  // namespace snapwing::planning
