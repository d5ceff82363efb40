#pragma once
/// The traced curve of a scene, with its monitors.

#include <string>
#include <vector>

#include "snapwing/scene/scene_problem.h"
#include "snapwing/statics/automatic.h"
#include "snapwing/vehicle/force_table.h"

namespace snapwing::statics {

struct SceneCurve {
  PathResult path;                                  ///< of the problem: forces and energies without the multiplicity
  PathResult back;                                  ///< from the end to 0; empty if not requested
  PathResult below;                                 ///< from 0 to the scene's `from`; empty if there is none
  std::vector<std::vector<double>> monitors;        ///< per point of `path` and monitor [m] or [rad]
  std::vector<mpm::MovingMass> inertia;             ///< of the whole scene, per point of `path`
  std::vector<std::vector<double>> monitors_below;  ///< likewise of `below`
  std::vector<mpm::MovingMass> inertia_below;       ///< likewise of `below`
  int rotation = -1;                                ///< index of the monitor that is the rotation in a table; -1: none
  double multiplicity = 1;                          ///< forces and energies of the whole / those of the problem
  /// Indices of the points of `path` at which the control reverses, and after which the number of negative pivots
  /// changes.
  std::vector<int> limit_points, crossings;
  bool monotone() const { return limit_points.empty(); }

  /// Status, message and summed costs of all runs, without points.
  PathResult costs() const;
  /// `path` of the whole scene (times the multiplicity) as CSV text with units in its header.
  std::string csv(const scene::Scene& scene) const;
  /// The curve of the whole scene, `below` included, as a force table: travel increasing, without provenance. Valid
  /// with a monotone path of a driven port with at least 4 points (ForceTable::validate).
  vehicle::ForceTable table() const;
};

enum class TraceMethod {
  DISPLACEMENT,  ///< displacement control; may jump to another branch
  AUTOMATIC,     ///< displacement control, arc length where it fails or jumps
  ARC_LENGTH,    ///< arc length only
};

struct TraceSettings {
  solver::NewtonSettings newton;
  TraceMethod method = TraceMethod::DISPLACEMENT;
  int largest_arc = 2000;   ///< points of one arc, >= 2
  double perturbation = 0;  ///< [m] as in PathSettings; 0: the scene's own
  bool reverse = false;     ///< `path` leads from the far end to 0, `back` from 0 to the far end
  /// Points of an interrupted run; the resumed run has the same bits as one without interruption. Null: none.
  const SceneCurve* resume = nullptr;
  /// Called after every point with all points so far: for checkpoints.
  std::function<void(const SceneCurve& sofar)> reached;
};

/// Outline (level set rho = 0.5) of a planar body given by its density, at rest and at each point of curve.table(). [m]
/// @throws common::Error for another kind of body
vehicle::ArmShapes outlineAlong(const scene::Scene& scene, const scene::CompiledScene& compiled,
                                const SceneCurve& curve, int body);

/// Traces the scene's path from 0 to `to`, then if requested from 0 to `from`, and back.
/// @param progress  called with the share done [1] and the control; true cancels
/// @throws common::Error for `resume` with ARC_LENGTH: a checkpoint has no direction of the arc
SceneCurve traceScene(const scene::Scene& scene, const scene::CompiledScene& compiled, const TraceSettings& settings,
                      const std::function<bool(double, double)>& progress);

}  // namespace snapwing::statics
