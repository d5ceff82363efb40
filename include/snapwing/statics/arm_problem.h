#pragma once
/// One arm of a vehicle as a planar solid: density per cell, the housing drives the leg's face, the axle is a line pin.

#include <memory>
#include <string>

#include "snapwing/elasticity/density_interpolation.h"
#include "snapwing/elasticity/material.h"
#include "snapwing/mpm/density_field.h"
#include "snapwing/mpm/moving_mass.h"
#include "snapwing/solver/term_problem.h"
#include "snapwing/statics/features.h"
#include "snapwing/statics/path.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::statics {

struct ArmProblemSettings {
  double cell_size = 0;  ///< [m], 0 = that of the design
  elasticity::Plane plane = elasticity::Plane::STRESS;
  elasticity::DensityInterpolation interpolation;
  int threads = 1;
};

/// The problem has one control: the travel u of the housing, positive downwards in arm coordinates.
class ArmProblem {
 public:
  /// @param design  density of the L-shaped domain
  /// @throws common::Error if pin or clamp do not meet material
  ArmProblem(const vehicle::ArmSettings& arm, const elasticity::Material& material, const mpm::DensityField& design,
             const ArmProblemSettings& settings);

  const solver::TermProblem& problem() const { return *problem_; }
  const mpm::Discretisation<2>& solid() const { return *solid_; }
  const mpm::DensityField& field() const { return field_; }
  /// New densities, one per cell of the design in the order of solid(). What holds a state of the problem
  /// (a Newton, a path) must start anew. @throws common::Error for a wrong count or a value outside 0 .. 1
  void setDensities(const std::vector<double>& densities);
  /// Rotation of the bar's outer end about the axle [rad], positive as u grows: the rotation that fits the nodes within
  /// 4 mm of the axle best (least squares).
  double rotation(const Eigen::VectorXd& z, double travel) const;
  /// Inertia against the travel, with `slope` dz/du of the static path.
  mpm::MovingMass movingMass(const Eigen::VectorXd& slope) const;
  /// Loops of the design's outline, and the same moved.
  std::vector<std::vector<std::array<double, 2>>> restShapes() const { return mpm::outline(field_, 0.5); }
  std::vector<std::vector<std::array<double, 2>>> movedShapes(const Eigen::VectorXd& z, double travel) const;

 private:
  Eigen::VectorXd displacements(const Eigen::VectorXd& z, double travel) const;

  vehicle::ArmSettings arm_;
  double mass_density_;  ///< [kg/m3]
  mpm::DensityField field_;
  std::shared_ptr<mpm::Discretisation<2>> solid_;
  std::unique_ptr<solver::TermProblem> problem_;
};

struct ArmCurveSettings {
  double from = -0.015;  ///< [m] <= 0
  double to = 0.080;     ///< [m] > 0
  double step = 0.001;   ///< [m] > 0
  bool back = true;      ///< trace to -> 0 as well
  bool locate = false;   ///< solve for peaks, valleys and zeros between 0 and to
  PathSettings path;
  /// Told the share that is done and the travel [m]; true cancels.
  std::function<bool(double share, double travel)> progress;
  void validate() const;
};

struct ArmCurve {
  solver::SolveStatus status = solver::SolveStatus::NOT_SOLVED;
  std::string message;
  vehicle::ForceTable table;  ///< without provenance
  LocatedFeatures located;    ///< forces and energies of the problem: one arm; empty if not asked for
  int iterations = 0, factorizations = 0, projections = 0, halvings = 0;
  double seconds = 0, seconds_assembly = 0, seconds_factor = 0, seconds_solve = 0, seconds_analysis = 0;
};

/// Traces 0 -> to, back to 0 if wished, and 0 -> from.
ArmCurve traceArm(const ArmProblem& arm, const ArmCurveSettings& settings);

}  // namespace snapwing::statics
