#pragma once
/// Vehicle parameters of the particles: drawn from the box, and moved a little when particles are copied so that copies
/// do not stay equal [Liu and West 2001].

#include <vector>

#include "random_source.h"
#include "snapwing/common/vehicle_parameters.h"

namespace snapwing::planning {

class ParameterCloud {
 public:
  /// Uniform draws. @param count  at least 2
  ParameterCloud(const common::Vehicle& vehicle, const common::ForceTable& table, int count, RandomSource& random);

  const std::vector<common::VehicleParameters>& drawn() const { return drawn_; }

  /// Moves each member towards the mean and scatters it, keeping mean and spread; stays within the first draws' range.
  void scatter(std::vector<common::VehicleParameters>& parameters, RandomSource& random) const;

 private:
  std::vector<common::VehicleParameters> drawn_;
  common::VehicleParameters low_, high_;
};

}  // namespace snapwing::planning
