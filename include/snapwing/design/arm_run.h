#pragma once
/// Runs the design of an arm: optimisation with progress, checkpoints and history, and a check of its gradients.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/design/arm_settings.h"
#include "snapwing/design/optimizer.h"
#include "snapwing/mpm/density_field.h"

namespace snapwing::design {

/// One iteration, for progress and history. Forces of one arm.
struct ArmProgress {
  OptimizerReport report;
  double volume = 0, volume_bound = 0, grey = 0, sharpness = 0;
  std::vector<double> forces;  ///< [N] at the states' travels
};

struct ArmRunOptions {
  std::string folder;         ///< for checkpoint.h5, history.h5, history.csv; "": none
  bool resume = false;        ///< from the folder's checkpoint, if it belongs to the same inputs
  int checkpoint_every = 10;  ///< iterations
  /// True cancels.
  std::function<bool(const ArmProgress&)> progress;
};

struct ArmRun {
  OptimizerResult result;
  mpm::DensityField field;      ///< nominal, projected
  std::vector<double> travels;  ///< [m]
  std::vector<double> forces;   ///< [N]
  double volume = 0, grey = 0;
  int retraces = 0;
  std::vector<ArmProgress> history;
};

/// @throws common::Error for bad input, or a checkpoint of other inputs
ArmRun runArmDesign(const ArmDesignSettings& settings, const ArmRunOptions& options);

/// Derivative along a fixed direction against central differences.
struct GradientRow {
  std::string quantity;
  double derivative = 0;
  std::vector<double> relative_errors;  ///< for steps()
  double best() const;
};
struct GradientCheck {
  bool valid = false;
  std::string message;
  std::vector<double> steps;
  std::vector<GradientRow> rows;
  double worst() const;
};
/// Objective and every constraint at a wavy design near the start. @param sharpness_share  where in the run, 0..1
GradientCheck checkArmGradients(const ArmDesignSettings& settings, double sharpness_share);

/// Writes a field as lines "i,j,rho" under comment lines. @throws common::FileError
void saveDensityCsv(const mpm::DensityField& field, const std::string& comment, const std::string& path);

}  // namespace snapwing::design
