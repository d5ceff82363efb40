#pragma once
/// Quintic Hermite spline of the vehicle's elastic energy through the table's energy, force and stiffness.
/// E is C2, so the force F = dE/du is C1 and exact derivative of the energy that the integrator conserves.
/// Outside the table the stiffness goes on growing linearly (cubic energy correction), smoothly and without an end.

#include <vector>

#include "snapwing/common/force_table.h"
#include "snapwing/rom/potential.h"

namespace snapwing::rom {

class EnergySpline : public Potential {
 public:
  /// @param table  of one arm, validated here; its totals are arm_count * force_scale times the table's numbers
  /// @param force_scale  real force / computed force [1], > 0
  /// @throws common::Error for a bad table or scale
  explicit EnergySpline(const common::ForceTable& table, double force_scale = 1.0);

  PotentialSample at(double u) const override;
  bool inTable(double u) const override { return u >= travel_.front() && u <= travel_.back(); }
  const Equilibria& equilibria() const override { return equilibria_; }
  /// Largest difference, at the table's inner knots, to a spline that lacks this knot: what the spacing of the points
  /// can hide. Says nothing about the solver's own error.
  double forceError() const override { return force_error_; }

  double lowest() const { return travel_.front(); }  ///< [m]
  double highest() const { return travel_.back(); }  ///< [m]
  double scale() const { return scale_; }            ///< arm_count * force_scale [1]

 private:
  double knotRemovalError() const;
  std::vector<double> travel_;
  std::vector<double> coefficients_;  ///< six per interval, in the local coordinate (u - u_k) / h_k
  std::vector<double> inverse_width_;
  double uniform_inverse_ = 0;  ///< 1/h if the knots are equally spaced, else 0: finds the interval without search
  PotentialSample low_, high_;  ///< ends of the table
  double growth_low_ = 0, growth_high_ = 0;  ///< d(stiffness)/du of the continuation [N/m2], towards the outside
  double scale_ = 1;
  Equilibria equilibria_;
  double force_error_ = 0;
};

}  // namespace snapwing::rom
