#pragma once
/// The arms of a vehicle as bodies of one scene, each in its own axes.

#include <vector>

#include "snapwing/elasticity/prony_series.h"
#include "snapwing/motion/axis_vehicle.h"
#include "snapwing/scene/scene.h"
#include "snapwing/solver/reduction.h"

namespace snapwing::motion {

/// One body for each group of arms that move alike, all driven by the one travel.
/// @param force_scale  of the real arm; @param series  of the material
/// @param shares  how many times the first group's arm each of them is, in forces and masses
scene::Scene armBodies(const vehicle::Vehicle& vehicle, double force_scale, const AxisSettings& settings,
                       const elasticity::PronySeries& series, const std::vector<double>& shares);

/// Largest principal strain of solids at nodal displacements in whatever axes (mpm::Discretisation::largestStrain). [1]
double largestStrain(const scene::CompiledScene& arms, const Eigen::VectorXd& displacements);
/// True if an eliminated coordinate is that of an axle across it, in its arm's first direction. @param dof  of a node
bool ofAxle(const scene::CompiledScene& arms, int dof);
/// The equation of such a coordinate for the same points along the axle: they do not slide.
solver::Equation alongAxle(const solver::Reduction& arms, int dof);

}  // namespace snapwing::motion
