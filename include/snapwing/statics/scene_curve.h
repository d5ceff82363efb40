#pragma once
/// The traced curve of a scene, with its monitors.

#include <string>
#include <vector>

#include "snapwing/scene/scene_problem.h"
#include "snapwing/statics/automatic.h"
#include "snapwing/vehicle/force_table.h"

namespace snapwing::statics {

struct SceneCurve {
  PathResult path;                            ///< of the problem; forces there are without the multiplicity
  PathResult back;                            ///< empty if not asked for
  std::vector<std::vector<double>> monitors;  ///< per point of `path`
  std::vector<mpm::MovingMass> inertia;       ///< of the whole, per point of `path`
  double multiplicity = 1;
  /// Numbers of points of `path` after which the control turned, and the number of negative pivots changed.
  std::vector<int> limit_points, crossings;
  bool monotone() const { return limit_points.empty(); }

  /// Curve of the whole (times the multiplicity) as CSV text with units in its header.
  std::string csv(const scene::Scene& scene) const;
  /// The same as a force table (travel increasing; without provenance). Needs 4 points and a driven port.
  vehicle::ForceTable table() const;
};

enum class TraceMethod {
  DISPLACEMENT,  ///< of the control, jumps to other branches included
  AUTOMATIC,     ///< displacement control, arc length where it fails or jumps
  ARC_LENGTH,    ///< all the way
};

struct TraceSettings {
  solver::NewtonSettings newton;
  TraceMethod method = TraceMethod::DISPLACEMENT;
  int largest_arc = 2000;   ///< points of one arc
  double perturbation = 0;  ///< [m] as in PathSettings; 0: the scene's own
  bool reverse = false;     ///< `path` leads from the far end to 0, `back` from 0 to the far end
  /// Points that an interrupted run reached; what follows has the same bits as without the interruption.
  const SceneCurve* resume = nullptr;
  /// Told all that was reached after every point: for checkpoints.
  std::function<void(const SceneCurve& sofar)> reached;
};

/// Follows the scene's path from 0, and back if it asks for that.
/// @param progress  share done and control; true cancels
/// @throws common::Error if an arc is to be resumed: its direction is not kept
SceneCurve traceScene(const scene::Scene& scene, const scene::CompiledScene& compiled, const TraceSettings& settings,
                      const std::function<bool(double, double)>& progress);

}  // namespace snapwing::statics
