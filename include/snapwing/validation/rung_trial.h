#pragma once
/// One pulse on one vehicle, on any rung, with an answer in one form: what a validation compares.

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "snapwing/motion/trial_file.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/vehicle.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::validation {

struct RungTrial {
  motion::TrialRung rung = motion::TrialRung::LUMPED;
  vehicle::Mode start = vehicle::Mode::FIXED_WING;
  vehicle::Pulse pulse;  ///< as the motors of this vehicle see it
  vehicle::Trial trial;
  scene::SceneKernel kernel = scene::SceneKernel::LINEAR;  ///< of the solid
  std::vector<double> box;  ///< coordinates of vehicle::uncertainNames(), in [-1, 1]; empty: nominal
  double cell_size = 1e-3;  ///< [m] of the solid
  double step = 2e-3;       ///< [s] of the solid; half and a quarter of it where the scheme's account does not close
  /// [s] where a search for the shortest pulse of a solid begins; NaN: at the lumped one
  double near = std::numeric_limits<double>::quiet_NaN();
  double resolution = 1e-4;                                 ///< [s] of the shortest pulse
  motion::DampingLaw damping = motion::DampingLaw::TRAVEL;  ///< of the solid
  /// The lumped model on the static curve of this rung's solid, in place of the solid in time.
  bool on_curve = false;
  /// Static curve of the lumped rung in place of the vehicle's table, whose parameters stay: that of a solid.
  std::optional<vehicle::ForceTable> curve;
};

struct RungOutcome {
  std::string failure;  ///< why there is no answer; empty: there is one
  vehicle::Mode end = vehicle::Mode::UNKNOWN;
  bool snapped = false;
  double snap_time = std::numeric_limits<double>::quiet_NaN();  ///< [s] last crossing of the barrier
  double peak_travel = std::numeric_limits<double>::quiet_NaN(), least_travel = peak_travel;  ///< [m]
  double margin = std::numeric_limits<double>::quiet_NaN();                                   ///< [1] lumped only
  double imbalance = std::numeric_limits<double>::quiet_NaN();  ///< [J] that the scheme fed or ate; solids only
  double min_det_f = std::numeric_limits<double>::quiet_NaN();  ///< [1] solids only
  /// [1] at any time, largest of a cell and largest mean (motion::AxisSample::strain); solids only
  double strain = std::numeric_limits<double>::quiet_NaN(), mean_strain = strain;
  /// [s] of a search for the shortest pulse; [N] of one for the heaviest centre
  double threshold = std::numeric_limits<double>::quiet_NaN();
  double cpu_seconds = 0;
  std::vector<double> time, travel, thrust;  ///< [s], [m], [N] at most a few hundred points
};

class SolidCurves;

class RungRunner {
 public:
  /// @param body  of the solid in place of the vehicle's arm.density_file; empty: that one
  /// @param cancelled  polled at every step of a solid; true ends a run, whose outcome is then no outcome
  RungRunner(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
             const std::optional<vehicle::WingTable>& wing, const std::string& body = {},
             std::function<bool()> cancelled = {});

  /// What happens; an error of the solver or of the model is the outcome's `failure`.
  RungOutcome run(const RungTrial& trial) const;
  /// The shortest pulse that switches, to `resolution`: `threshold` of the outcome. On solids the search begins at
  /// `near`, and fails if there is none within 60 ms of it.
  RungOutcome shortest(const RungTrial& trial) const;
  /// The heaviest centre that the start mode carries with the ring held and the motors still, to .01 N of weight:
  /// `threshold` of the outcome [N]. On solids the search begins at `near` [N], or at the lumped one.
  RungOutcome carried(const RungTrial& trial) const;

 private:
  RungOutcome runLumped(const RungTrial& trial) const;
  RungOutcome runOnCurve(const RungTrial& trial) const;
  rom::LumpedModel lumpedOf(const RungTrial& trial) const;
  motion::AxisVehicle solidOf(const RungTrial& trial) const;
  double shortestLumped(const RungTrial& trial) const;
  double shortestSolid(const RungTrial& trial) const;
  double carriedLumped(const RungTrial& trial) const;
  double carriedSolid(const RungTrial& trial) const;
  RungOutcome runSolid(const RungTrial& trial, const motion::AxisVehicle& solid) const;
  RungOutcome runSolid(const RungTrial& trial, const motion::AxisVehicle& solid, double step) const;
  motion::AxisSettings settingsOf(const RungTrial& trial) const;
  vehicle::VehicleParameters parametersOf(const RungTrial& trial) const;

  vehicle::Vehicle vehicle_;
  vehicle::ForceTable table_;
  std::optional<vehicle::WingTable> wing_;
  vehicle::Vehicle printed_;  ///< with the body that the solids have
  std::function<bool()> cancelled_;
  std::shared_ptr<SolidCurves> curves_;
};

}  // namespace snapwing::validation
