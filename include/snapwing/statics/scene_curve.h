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
  PathResult below;                           ///< from 0 to the scene's `from`; empty if there is none
  std::vector<std::vector<double>> monitors;  ///< per point of `path`
  std::vector<mpm::MovingMass> inertia;       ///< of the whole, per point of `path`
  std::vector<std::vector<double>> monitors_below;
  std::vector<mpm::MovingMass> inertia_below;
  int rotation = -1;  ///< number of the monitor that is the rotation in a table; -1: none
  double multiplicity = 1;
  /// Numbers of points of `path` after which the control turned, and the number of negative pivots changed.
  std::vector<int> limit_points, crossings;
  bool monotone() const { return limit_points.empty(); }

  /// Status, message and costs of all runs together, without points.
  PathResult costs() const;
  /// `path` of the whole (times the multiplicity) as CSV text with units in its header.
  std::string csv(const scene::Scene& scene) const;
  /// The curve as a force table (travel increasing; without provenance), `below` included. Needs 4 points and a driven
  /// port.
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

/// Outline of a planar body that is given by its density, at rest and moved at each point of a curve's table.
vehicle::ArmShapes outlineAlong(const scene::Scene& scene, const scene::CompiledScene& compiled,
                                const SceneCurve& curve, int body);

/// Follows the scene's path from 0, and back and below 0 if it asks for that.
/// @param progress  share done and control; true cancels
/// @throws common::Error if an arc is to be resumed: its direction is not kept
SceneCurve traceScene(const scene::Scene& scene, const scene::CompiledScene& compiled, const TraceSettings& settings,
                      const std::function<bool(double, double)>& progress);

}  // namespace snapwing::statics
