#pragma once
/// Static force of a compiled scene against its control, at coarse points with exact slopes, for the start of a trial
/// and its barrier and valley. Traced on the trial's own cells.

#include <functional>
#include <vector>

#include "snapwing/common/loan.h"
#include "snapwing/scene/scene_problem.h"
#include "snapwing/vehicle/force_table.h"

namespace snapwing::motion {

struct StaticPoint {
  double control = 0;     ///< [m]
  double force = 0;       ///< [N] of the problem, without the scene's multiplicity
  double stiffness = 0;   ///< [N/m] along the branch
  double min_det_f = 1;   ///< smallest over the particles [1]
  bool stable = false;    ///< no negative pivot
  Eigen::VectorXd z;      ///< free coordinates [m]
  Eigen::VectorXd slope;  ///< dz/d(control)
};

class StaticCurve {
 public:
  /// @param scene  lent; @param to  last control [m] > 0; @param step  of the control [m] > 0
  /// @param cancelled  polled in every iteration; true ends the trace with an error
  /// @throws common::Error with the control at which no equilibrium was found
  StaticCurve(const scene::CompiledScene& scene, double to, double step, std::function<bool()> cancelled = {});

  const std::vector<StaticPoint>& points() const { return points_; }
  /// The curve as a table, forces of the problem, rotation and inertia zero.
  const vehicle::ForceTable& table() const { return table_; }
  double forceAt(double control) const { return vehicle::forceAt(table_, control); }  ///< [N]
  /// Unstable middle zero, minimum after the peak, and second stable zero; NaN if the curve has none.
  double barrier() const { return features_.barrier_travel; }    ///< [m]
  double valley() const { return features_.valley_travel; }      ///< [m]
  double valleyForce() const { return features_.valley_force; }  ///< [N]
  double second() const { return features_.second_travel; }      ///< [m]
  bool bistable() const { return features_.bistable; }
  /// Solves for the equilibrium at a control [m], from the nearest point. @throws common::Error if not converged
  StaticPoint at(double control) const;

 private:
  void follow(double to, double step);

  common::Loan<const scene::CompiledScene> scene_;
  std::function<bool()> cancelled_;
  std::vector<StaticPoint> points_;
  vehicle::ForceTable table_;
  vehicle::CurveFeatures features_{};
};

}  // namespace snapwing::motion
