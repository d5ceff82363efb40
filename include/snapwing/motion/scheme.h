#pragma once
/// Time schemes as a step sees them: the weight of the mass, where stored energies are averaged, how rates follow.
///
/// All of them find y1 with  kappa M (y1 - y0 - h v0) + (mean force along the step) = 0.
///   BACKWARD_EULER  kappa = 1/h^2, force at the end, v1 = d/h, d = y1 - y0. First order; every mode loses
///                   1 - 1/sqrt(1 + (w h)^2) of its amplitude a step. The paper's.
///   MIDPOINT        kappa = 2/h^2, force at the middle, v1 = 2 d/h - v0. Second order; keeps linear and angular
///                   momentum to rounding, energy to O(h^2).
///   CORRECTED_MIDPOINT  the same with a force beta M d' more, d' the step less its rigid part, beta such that the
///                   step's account of energy closes (Stepper): keeps both momenta. The scalar costs some solves.
///   AVERAGE_FORCE   the midpoint's mass with the force averaged at m Gauss points: keeps energy to O(h^2m). The step
///                   has a potential with a symmetric Hessian. Angular momentum of a turning soft body to O(h^2).

#include <Eigen/Core>
#include <string>

#include "snapwing/solver/term.h"

namespace snapwing::motion {

enum class SchemeKind { BACKWARD_EULER, MIDPOINT, AVERAGE_FORCE, CORRECTED_MIDPOINT };

/// backward_euler, midpoint, average_force or corrected_midpoint. @throws common::Error
SchemeKind schemeFromName(const std::string& name);
std::string schemeName(SchemeKind kind);

class Scheme {
 public:
  /// @param points  of AVERAGE_FORCE: 1 .. 4 Gauss points
  /// @param bias    of MIDPOINT: the force is taken at (1 + bias)/2 of the step, in [0, 0.5]; more than 0 damps high
  ///                frequencies and is of first order. @throws common::Error
  explicit Scheme(SchemeKind kind, int points = 2, double bias = 0);

  SchemeKind kind() const { return kind_; }
  int order() const { return kind_ == SchemeKind::BACKWARD_EULER || bias_ > 0 ? 1 : 2; }
  /// Weight of the mass, rates and path of a step. @param h  [s] > 0
  solver::Step begin(double h, const Eigen::VectorXd& y0, const Eigen::VectorXd& v0) const;
  /// Rates at the end of a step [m/s].
  /// @param d  of the full coordinates [m]; @param v0  rates at its start [m/s]
  Eigen::VectorXd rates(double h, const Eigen::VectorXd& d, const Eigen::VectorXd& v0) const;
  /// The residual is tested along the mean of both ends' rotations.
  bool meanDirections() const { return kind_ != SchemeKind::BACKWARD_EULER; }
  /// Local error of a step [m], from how much the mean acceleration changed since the step before.
  /// @param change  a - a_before [m/s2]; @param h, before  [s] of both steps
  Eigen::VectorXd localError(const Eigen::VectorXd& change, const Eigen::VectorXd& acceleration, double h,
                             double before) const;

 private:
  SchemeKind kind_;
  int points_;
  double bias_;
};

}  // namespace snapwing::motion
