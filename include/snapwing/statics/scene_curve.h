#pragma once
/// The traced curve of a scene, with its monitors.

#include <string>
#include <vector>

#include "snapwing/common/force_table.h"
#include "snapwing/statics/path.h"
#include "snapwing/statics/scene_problem.h"

namespace snapwing::statics {

struct SceneCurve {
  PathResult path;                            ///< of the problem; forces there are without the multiplicity
  PathResult back;                            ///< empty if not asked for
  std::vector<std::vector<double>> monitors;  ///< per point of `path`
  double multiplicity = 1;

  /// Curve of the whole (times the multiplicity) as CSV text with units in its header.
  std::string csv(const Scene& scene) const;
  /// The same as a force table (travel increasing; without provenance). Needs 4 points and a driven port.
  common::ForceTable table() const;
};

/// Follows the scene's path from 0, and back if it asks for that.
/// @param progress  share done and control; true cancels
SceneCurve traceScene(const Scene& scene, const CompiledScene& compiled, PathSettings settings,
                      const std::function<bool(double, double)>& progress);

}  // namespace snapwing::statics
