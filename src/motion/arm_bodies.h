#pragma once
/// The soft arms of a vehicle as bodies of one scene, each in its own axes.

#include <Eigen/SparseCore>
#include <vector>

#include "snapwing/common/loan.h"
#include "snapwing/elasticity/prony_series.h"
#include "snapwing/motion/axis_vehicle.h"
#include "snapwing/scene/scene_problem.h"
#include "snapwing/solver/reduction.h"

namespace snapwing::motion {

/// Scene with one body for each group of arms that move alike, all driven by the one travel.
/// @param force_scale  [1] real force / computed force, applied to Young's modulus
/// @param series  relaxation of the material, by which a fast modulus is reduced to the slow one
/// @param shares  [1] of each group, forces and masses relative to the first group
/// @throws common::FileError for the density file; common::Error for a cell size that does not divide the domain
scene::Scene armBodies(const vehicle::Vehicle& vehicle, double force_scale, const AxisSettings& settings,
                       const elasticity::PronySeries& series, const std::vector<double>& shares);

/// How far the arms are strained. The scene is lent.
class ArmStrain {
 public:
  explicit ArmStrain(const scene::CompiledScene& arms);
  /// Fills in a sample's strains. @param displacements  nodal [m], in any axes
  void record(const Eigen::VectorXd& displacements, AxisSample& out) const;

 private:
  common::Loan<const scene::CompiledScene> arms_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> means_;
};

/// True if an eliminated coordinate is the x component of a node at the axle (outer half of the arm); volumetric only.
/// @param dof  number of an eliminated nodal coordinate
bool ofAxle(const scene::CompiledScene& arms, int dof);
/// The elimination equation of such a coordinate, applied to the z components: nodes do not slide along the axle.
solver::Equation alongAxle(const solver::Reduction& arms, int dof);

}  // namespace snapwing::motion
