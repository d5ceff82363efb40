#pragma once
/// The traced curve of a scene, with its monitors.

#include <string>
#include <vector>

#include "snapwing/common/force_table.h"
#include "snapwing/statics/arc_length.h"
#include "snapwing/statics/scene_problem.h"

namespace snapwing::statics {

struct SceneCurve {
  PathResult path;                            ///< of the problem; forces there are without the multiplicity
  PathResult back;                            ///< empty if not asked for
  std::vector<std::vector<double>> monitors;  ///< per point of `path`
  double multiplicity = 1;
  std::vector<int> limit_points, crossings;  ///< by arc length only, see ArcResult

  /// Curve of the whole (times the multiplicity) as CSV text with units in its header.
  std::string csv(const Scene& scene) const;
  /// The same as a force table (travel increasing; without provenance). Needs 4 points and a driven port.
  common::ForceTable table() const;
};

/// Follows the scene's path from 0, and back if it asks for that.
/// @param progress  share done and control; true cancels
SceneCurve traceScene(const Scene& scene, const CompiledScene& compiled, PathSettings settings,
                      const std::function<bool(double, double)>& progress);

/// Follows the same branch by its arc length: through snap-back, to the scene's end or `max_points`. The control need
/// not grow from point to point.
SceneCurve traceSceneByArc(const Scene& scene, const CompiledScene& compiled, const NewtonSettings& newton,
                           int max_points, const std::function<bool(double, double)>& progress);

}  // namespace snapwing::statics
