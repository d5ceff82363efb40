#pragma once
/// Quintic Hermite spline of the vehicle's elastic energy through the table's energy, force and stiffness.
/// E is C2, so the force F = dE/du is C1 and exact derivative of the energy that the integrator conserves.
/// Outside the table the stiffness grows linearly (cubic energy correction), smoothly and without an end.

#include <memory>
#include <vector>

#include "snapwing/rom/potential.h"
#include "snapwing/vehicle/force_table.h"

namespace snapwing::rom {

class EnergySpline : public Potential {
 public:
  /// @param table  of one arm, validated here; the vehicle's numbers are arm_count * force_scale times the table's
  /// @param force_scale  real force / computed force [1], > 0
  /// @throws common::Error for a bad table or scale
  explicit EnergySpline(const vehicle::ForceTable& table, double force_scale = 1.0);

  /// The same curve with another force scale, at no cost: the coefficients are shared. @throws common::Error
  EnergySpline withForceScale(double force_scale) const;

  PotentialSample at(double u) const override;
  bool inTable(double u) const override { return u >= lowest() && u <= highest(); }
  const Equilibria& equilibria() const override { return equilibria_; }
  /// Largest force error, at the table's inner knots, of a spline that lacks this knot: what the spacing of the points
  /// can hide. Says nothing about the solver's own error.
  double forceError() const override { return scale_ * curve_->force_error; }

  double lowest() const { return curve_->travel.front(); }  ///< [m]
  double highest() const { return curve_->travel.back(); }  ///< [m]
  double forceScale() const { return scale_; }              ///< [1]

 private:
  struct Curve {
    std::vector<double> travel;         ///< knots [m]
    std::vector<double> coefficients;   ///< six per interval, in the local coordinate (u - u_k) / h_k
    std::vector<double> inverse_width;  ///< 1 / h_k [1/m]
    double uniform_inverse = 0;         ///< 1/h if the knots are equally spaced, else 0: finds intervals without search
    PotentialSample low, high;          ///< ends of the table
    double growth_low = 0, growth_high = 0;  ///< d(stiffness)/du of the continuation, outwards [N/m2]
    double force_error = 0;
    PotentialSample at(double u) const;
    double knotRemovalError() const;
  };
  void scaleTo(double force_scale, const Equilibria& unscaled);

  std::shared_ptr<const Curve> curve_;  ///< whole vehicle at force scale 1
  Equilibria unscaled_;
  double scale_ = 1;
  Equilibria equilibria_;
};

}  // namespace snapwing::rom
