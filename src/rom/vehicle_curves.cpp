#include "snapwing/rom/vehicle_curves.h"

#include "snapwing/vehicle/pulse.h"

namespace snapwing::rom {

VehicleCurves::VehicleCurves(const vehicle::ForceTable& arm, const std::optional<vehicle::WingTable>& wing)
    : spline_(arm) {
  if (arm.mass > 0) arms_ = std::make_shared<const TravelInertia>(arm);
  if (wing) wing_.emplace(*wing);
}

LumpedModel VehicleCurves::model(const vehicle::Radio& radio, const vehicle::VehicleParameters& parameters,
                                 const LumpedSettings& settings) const {
  const double idle = vehicle::thrustFraction(parameters.quadratic_share, radio, 0.0);
  std::shared_ptr<const TravelInertia> wing;
  if (wing_) wing = std::make_shared<TravelInertia>(wing_->scaled(parameters.wing_inertia, parameters.wing_friction));
  return LumpedModel(std::make_shared<EnergySpline>(spline_.withForceScale(parameters.force_scale)), parameters, idle,
                     settings, std::move(wing), arms_);
}

LumpedModel LumpedModel::fromVehicle(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                                     const vehicle::VehicleParameters& parameters, const LumpedSettings& settings,
                                     const std::optional<vehicle::WingTable>& wing) {
  return VehicleCurves(table, wing).model(vehicle.radio, parameters, settings);
}

}  // namespace snapwing::rom
