#pragma once
/// A design from its settings to files: optimised, checked, with report, curves and parts in one folder, where it is
/// found again by the hash of its inputs.

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "snapwing/design/arm/arm_check.h"
#include "snapwing/design/arm/arm_parts.h"
#include "snapwing/design/arm/arm_run.h"

namespace snapwing::design {

struct ArmOutcome {
  std::string folder;
  bool optimized = false;  ///< false: a given density was checked
  OptimizerStatus status = OptimizerStatus::NOT_RUN;
  std::string message;
  double objective = std::numeric_limits<double>::quiet_NaN();
  double violation = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;
  bool bistable = false, all_met = false;  ///< the check's verdicts
  /// Of the printed body in the limit of small cells, or on the finest planar grid; no points if none was traced.
  vehicle::ForceTable table;
  std::string densityFile() const { return folder + "/density.csv"; }  ///< the optimiser's own field
  std::string bodyFile() const { return folder + "/body.csv"; }   ///< the printed body; a vehicle's arm.density_file
  std::string tableFile() const { return folder + "/table.h5"; }  ///< a vehicle's arm.table_file
};

struct ArmJob {
  std::string folder;                                  ///< of the results; made if missing
  bool resume = false;                                 ///< resume from the folder's checkpoint
  std::function<bool(const ArmProgress&)> progress;    ///< each iteration; true cancels
  std::function<bool(const std::string&)> checking;    ///< the case that begins, else ""; true cancels
  std::function<void(const std::string&)> warning;     ///< what went wrong without ending the run
  std::function<void(const ArmRun&)> optimized;        ///< the end of the optimisation
  std::function<void(const ArmCheck&)> checked;        ///< the end of the check
  std::function<void(const ArmPartsReport&)> printed;  ///< the end of the parts
};

/// Names of the files in the folder, beside the curves and the parts.
std::vector<std::string> armOutcomeFiles();

/// Optimises, checks and writes density.csv, history, body.csv, table.h5, curve_*.h5, parts/ and, last, report.json. If
/// cancelled, the checkpoint stays and no report is written. @throws common::Error
ArmOutcome designArm(const ArmDesignSettings& settings, const ArmJob& job);

/// The part of designArm() that follows the optimisation. @param run  not cancelled. @throws common::Error
ArmOutcome finishArmDesign(const ArmDesignSettings& settings, const ArmRun& run, const ArmJob& job);

/// The same for a density that is given. @throws common::Error
ArmOutcome checkArmDensity(const ArmDesignSettings& settings, const mpm::DensityField& field, const ArmJob& job);

/// Where a store keeps the design of these inputs: store/<hash>.
std::string storedArmFolder(const ArmDesignSettings& settings, const std::string& store);
/// The outcome in a folder, if its report is there and this program made it of the same inputs. @throws
/// common::FileError if the report is there but cannot be read
std::optional<ArmOutcome> loadArmOutcome(const ArmDesignSettings& settings, const std::string& folder);

}  // namespace snapwing::design
