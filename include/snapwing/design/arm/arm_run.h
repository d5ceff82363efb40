#pragma once
/// Runs the design of an arm: optimisation with progress, checkpoints and history, and a check of its gradients.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/design/arm/arm_settings.h"
#include "snapwing/design/optim/optimizer.h"
#include "snapwing/mpm/density_field.h"

namespace snapwing::design {

/// One iteration, for progress and history; iterations count on over the stages. Forces of one arm.
struct ArmProgress {
  OptimizerReport report;
  int stage = 0;
  double volume = 0, volume_bound = 0, grey = 0, sharpness = 0;
  std::vector<double> forces;  ///< [N] at the states' travels
};

struct ArmRunOptions {
  std::string folder;         ///< for checkpoint.h5, history.h5, history.csv; "": none
  bool resume = false;        ///< from the folder's checkpoint; begins anew with a warning if another program left it
  int checkpoint_every = 10;  ///< iterations
  /// True cancels.
  std::function<bool(const ArmProgress&)> progress;
  /// Called once for output that cannot be kept, as a checkpoint: the run continues.
  std::function<void(const std::string&)> warning;
};

struct ArmRun {
  OptimizerResult result;
  mpm::DensityField field;                ///< nominal, projected
  std::vector<double> travels;            ///< [m]
  std::vector<double> forces;             ///< [N]
  double volume = 0, mass = 0, grey = 0;  ///< [1], [kg] of one arm, [1]
  int retraces = 0, evaluations = 0;      ///< of the stages that ran
  double seconds = 0, cpu_seconds = 0;    ///< the second one of this session only, all threads
  std::string worst;  ///< name of the constraint that is violated most, empty if none beyond the tolerance
  std::vector<ArmProgress> history;
};

/// All stages, one after the other. A resumed run has the same bits as one that was never stopped.
/// @throws common::Error for bad input, or a checkpoint of other inputs
ArmRun runArmDesign(const ArmDesignSettings& settings, const ArmRunOptions& options);

/// Derivative along a fixed direction against central differences; errors as shares of sum_i |g_i d_i|.
struct GradientRow {
  std::string quantity;
  double derivative = 0;
  std::vector<double> relative_errors;  ///< for steps()
  double best() const;                  ///< the smallest of relative_errors [1]
};
struct GradientCheck {
  bool valid = false;
  std::string message;
  std::vector<double> steps;
  std::vector<GradientRow> rows;
  double worst() const;  ///< the largest best() of all rows [1]
};
/// Objective and every constraint at a wavy design near the start. @param share  where in its stage, 0..1
GradientCheck checkArmGradients(const ArmDesignSettings& settings, double share, int stage = 0);

/// Writes a field as lines "i,j,rho" under comment lines. @throws common::FileError
void saveDensityCsv(const mpm::DensityField& field, const std::string& comment, const std::string& path);
/// A field that fills the designed domain's bounding box. @throws common::FileError
mpm::DensityField loadDesignedDensity(const ArmDesignSettings& settings, const std::string& path);

}  // namespace snapwing::design
