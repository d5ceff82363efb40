#include "snapwing/rom/vehicle_curves.h"

#include "snapwing/common/pulse.h"

namespace snapwing::rom {

VehicleCurves::VehicleCurves(const common::ForceTable& arm, const std::optional<common::WingTable>& wing)
    : spline_(arm) {
  if (arm.mass > 0) arms_ = std::make_shared<const TravelInertia>(arm);
  if (wing) wing_.emplace(*wing);
}

LumpedModel VehicleCurves::model(const common::Radio& radio, const common::VehicleParameters& parameters,
                                 const LumpedSettings& settings) const {
  const double idle = common::thrustFraction(parameters.quadratic_share, common::motorOutput(radio, 0.0));
  std::shared_ptr<const TravelInertia> wing;
  if (wing_) wing = std::make_shared<TravelInertia>(wing_->scaled(parameters.wing_inertia, parameters.wing_friction));
  return LumpedModel(std::make_shared<EnergySpline>(spline_.withForceScale(parameters.force_scale)), parameters, idle,
                     settings, std::move(wing), arms_);
}

LumpedModel LumpedModel::fromVehicle(const common::Vehicle& vehicle, const common::ForceTable& table,
                                     const common::VehicleParameters& parameters, const LumpedSettings& settings,
                                     const std::optional<common::WingTable>& wing) {
  return VehicleCurves(table, wing).model(vehicle.radio, parameters, settings);
}

}  // namespace snapwing::rom
