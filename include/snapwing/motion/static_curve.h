#pragma once
/// Quasi-static force of a compiled scene against its control, coarse but with the exact slope at each point: where a
/// trial starts, and what it calls barrier and valley. Of the scene itself, at the trial's own cells.

#include <vector>

#include "snapwing/scene/scene_problem.h"

namespace snapwing::motion {

struct StaticPoint {
  double control = 0;     ///< [m]
  double force = 0;       ///< [N] of the problem, without the scene's multiplicity
  double stiffness = 0;   ///< [N/m] along the branch
  Eigen::VectorXd z;      ///< free coordinates
  Eigen::VectorXd slope;  ///< dz/d(control)
};

class StaticCurve {
 public:
  /// @param to    last control [m] > 0; @param step  of the control [m] > 0
  /// @throws common::Error saying where no equilibrium was found
  StaticCurve(const scene::CompiledScene& scene, double to, double step);

  const std::vector<StaticPoint>& points() const { return points_; }
  double forceAt(double control) const;  ///< cubic between points [N]
  /// Middle zero, the minimum behind it and the zero behind that; NaN where the curve has none.
  double barrier() const { return barrier_; }
  double valley() const { return valley_; }
  double valleyForce() const { return forceAt(valley_); }
  double second() const { return second_; }
  bool bistable() const { return second_ == second_; }
  /// The equilibrium at a control, from the point nearby. @throws common::Error
  StaticPoint at(double control) const;

 private:
  void findFeatures();
  double zero(std::size_t k) const;

  const scene::CompiledScene& scene_;
  std::vector<StaticPoint> points_;
  double barrier_, valley_, second_;
};

}  // namespace snapwing::motion
