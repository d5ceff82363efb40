#pragma once
/// Time integration schemes: weight of the mass, points at which the elastic force is evaluated, update of the rates.
///
/// All solve  kappa M (y1 - y0 - h v0) + (mean force along the step) = 0  for y1.
///   BACKWARD_EULER  kappa = 1/h^2, force at the end, v1 = d/h, d = y1 - y0. First order; each mode (w [rad/s]) loses
///                   the share 1 - 1/sqrt(1 + (w h)^2) of its amplitude in a step. The paper's.
///   MIDPOINT        kappa = 2/h^2, force at the middle, v1 = 2 d/h - v0. Second order; conserves linear and angular
///                   momentum to rounding, energy to O(h^2).
///   CORRECTED_MIDPOINT  MIDPOINT with an additional force beta M d', d' the step less its rigid part, beta such that
///                   the step's energy balance closes (Stepper). Conserves energy and both momenta, for some more
///                   solves.
///   AVERAGE_FORCE   the midpoint's mass with the force averaged over m Gauss points: conserves energy to O(h^2m). The
///                   step has a potential with a symmetric Hessian. Angular momentum of a rotating soft body: to
///                   O(h^2).

#include <Eigen/Core>
#include <string>

#include "snapwing/solver/term.h"

namespace snapwing::motion {

enum class SchemeKind { BACKWARD_EULER, MIDPOINT, AVERAGE_FORCE, CORRECTED_MIDPOINT };

/// @param name  backward_euler, midpoint, average_force or corrected_midpoint. @throws common::Error
SchemeKind schemeFromName(const std::string& name);
std::string schemeName(SchemeKind kind);

class Scheme {
 public:
  /// @param points  of AVERAGE_FORCE: 1 .. 4 Gauss points
  /// @param bias    of MIDPOINT, in [0, 0.5]: the force is evaluated at (1 + bias)/2 of the step; above 0 it damps high
  ///                frequencies and is of first order. @throws common::Error
  explicit Scheme(SchemeKind kind, int points = 2, double bias = 0);

  SchemeKind kind() const { return kind_; }
  int order() const { return kind_ == SchemeKind::BACKWARD_EULER || bias_ > 0 ? 1 : 2; }
  /// Step with kappa, path, y0 and v0 filled in. @param h  [s] > 0; @param y0  [m]; @param v0  [m/s]
  solver::Step begin(double h, const Eigen::VectorXd& y0, const Eigen::VectorXd& v0) const;
  /// Rates at the end of a step [m/s]. @param h  [s]; @param d  y1 - y0 [m]; @param v0  rates at the start [m/s]
  Eigen::VectorXd rates(double h, const Eigen::VectorXd& d, const Eigen::VectorXd& v0) const;
  /// True if the residual is pulled back by the mean of both ends' rotations (Coordinates::pullBackMean).
  bool meanDirections() const { return kind_ != SchemeKind::BACKWARD_EULER; }
  /// Estimate of a step's local error [m]: h^2/2 a (first order), or h^3/12 times the rate of change of the mean
  /// acceleration. @param change  a - a_before [m/s2]; @param acceleration  a; @param h, before  [s] of both steps
  Eigen::VectorXd localError(const Eigen::VectorXd& change, const Eigen::VectorXd& acceleration, double h,
                             double before) const;

 private:
  SchemeKind kind_;
  int points_;
  double bias_;
};

}  // namespace snapwing::motion
