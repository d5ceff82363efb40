#pragma once
/// Vehicle parameters of the particles: drawn from the box, and moved a little when particles are copied so that copies
/// do not stay equal [Liu and West 2001].

#include <vector>

#include "random_source.h"
#include "snapwing/vehicle/vehicle_parameters.h"

namespace snapwing::planning {

class ParameterCloud {
 public:
  /// Uniform draws. @param count  at least 2
  ParameterCloud(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table, int count, RandomSource& random);

  const std::vector<vehicle::VehicleParameters>& drawn() const { return drawn_; }

  /// Moves each member towards the mean and scatters it, keeping mean and spread; stays within the first draws' range.
  void scatter(std::vector<vehicle::VehicleParameters>& parameters, RandomSource& random) const;

 private:
  std::vector<vehicle::VehicleParameters> drawn_;
  vehicle::VehicleParameters low_, high_;
};

}  // namespace snapwing::planning
