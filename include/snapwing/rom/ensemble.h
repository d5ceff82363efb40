#pragma once
/// The lumped model for many vehicles side by side: what a pulse does to each vehicle of the uncertainty box, for the
/// search of a plan and for certificates. Same equations as LumpedModel, which stays the truth: classical Runge-Kutta
/// of fourth order in (travel, root of the relative motion's kinetic energy, common momentum), the thrust's lag in
/// closed form, curves on a uniform grid, margins watched in masks. Vehicles go side by side (SIDE_BY_SIDE), those that
/// ring equally long; each has its own time, chooses its own steps by an estimate of their error and is done when
/// nothing can change its margin any more. A vehicle whose numbers become non-finite is evaluated by LumpedModel. Same
/// bits on every processor, for any number of threads and in any company.

#include <memory>
#include <vector>

#include "snapwing/rom/vehicle_curves.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/trial.h"

namespace snapwing::rom {

/// Width of the processor's vectors that is used; the answers have the same bits.
enum class Vectors { WIDEST, PLAIN };

struct EnsembleSettings {
  /// Of the same meaning, but that a vehicle takes shorter steps where its motion wants them, and that their allowed
  /// error grows with the largest step; `convergence` has no meaning here.
  LumpedSettings model{8e-3};
  Vectors vectors = Vectors::WIDEST;
};

/// What a pulse does to one vehicle; the members mean what they mean in SnapPrediction.
struct EnsembleOutcome {
  double energy_margin = -1;  ///< [1]; -1: not settled within the horizon
  double peak_travel = 0;     ///< [m]
  bool snapped = false;
};

class Ensemble {
 public:
  static constexpr int SIDE_BY_SIDE = 16;  ///< vehicles that one call of predict() moves together

  /// @param curves  of the vehicle
  /// @param radio  gives the motors' idle thrust. @throws common::Error for a curve that is not bistable, or settings
  Ensemble(const VehicleCurves& curves, const vehicle::Radio& radio, const EnsembleSettings& settings = {});
  ~Ensemble();
  Ensemble(Ensemble&&) noexcept;

  /// @throws common::Error for bad parameters
  void add(const vehicle::VehicleParameters& parameters);
  int size() const;

  /// Outcomes of vehicles first .. first + count - 1. May be called from several threads.
  /// @param pulse      its throttle and hold are every vehicle's, its duration is not used
  /// @param durations  of the pulse for each vehicle of the ensemble [s], 0 .. 60
  /// @throws common::Error for an unknown start mode, a bad pulse, trial or range
  std::vector<EnsembleOutcome> predict(vehicle::Mode start, const vehicle::Pulse& pulse,
                                       const std::vector<double>& durations, const vehicle::Trial& trial, int first,
                                       int count) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace snapwing::rom
