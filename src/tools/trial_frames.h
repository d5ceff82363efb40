#pragma once
/// Deformed arms of a trial over time: a VTU file every so often and the .pvd that ParaView opens.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/motion/axis_trial.h"

namespace snapwing::tools {

class TrialFrames {
 public:
  /// @param folder  where frame_0000.vtu .. and trial.pvd go; @param every  [s]; 0: none
  TrialFrames(const motion::TrialVehicle& vehicle, std::string folder, double every)
      : vehicle_(vehicle), folder_(std::move(folder)), every_(every) {}

  /// Writes the newest state if it is the first in its stretch of `every` seconds. Also to be called when a run goes on
  /// from a checkpoint: what was killed right behind it may lack that frame.
  void take(const motion::AxisRun& run) const;
  /// The .pvd of all frames of the run, those before an interruption included.
  void finish(const motion::AxisRun& run) const;

 private:
  /// Number of the frame that a sample is, -1 if none.
  int frameOf(const std::vector<motion::AxisSample>& samples, std::size_t k) const;
  std::string fileOf(int frame) const;

  const motion::TrialVehicle& vehicle_;
  std::string folder_;
  double every_;
};

}  // namespace snapwing::tools
