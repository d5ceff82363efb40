#pragma once
/// The computed curves of a vehicle, arms and wings, from which lumped models of many realisations are made at little
/// cost: they share the coefficients and differ in scales.

#include <memory>
#include <optional>

#include "snapwing/rom/energy_spline.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/rom/travel_inertia.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::rom {

class VehicleCurves {
 public:
  /// @param arm   of one arm; @param wing  none: no wings
  /// @throws common::Error for bad tables
  explicit VehicleCurves(const vehicle::ForceTable& arm, const std::optional<vehicle::WingTable>& wing = {});

  /// @param radio  gives the motors' idle thrust. @throws common::Error for bad parameters or settings
  LumpedModel model(const vehicle::Radio& radio, const vehicle::VehicleParameters& parameters,
                    const LumpedSettings& settings = {}) const;

  const EnergySpline& spline() const { return spline_; }
  /// Inertia of arms and wings, scales 1; nullptr: weightless arms, no wings.
  const TravelInertia* arms() const { return arms_.get(); }
  const TravelInertia* wing() const { return wing_ ? &*wing_ : nullptr; }

 private:
  EnergySpline spline_;
  std::shared_ptr<const TravelInertia> arms_;
  std::optional<TravelInertia> wing_;
};

}  // namespace snapwing::rom
