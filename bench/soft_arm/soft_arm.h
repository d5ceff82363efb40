#pragma once
/// One soft arm in the plane between a rigid ring and a rigid centre that move along the thrust axis, with a quarter of
/// all masses and forces, integrated in time: an independent check of the lumped model, in which the arm follows its
/// static path.
///
/// Unknowns q = (z, u, z_r): free nodal displacements in the ring's frame, travel, place of the ring. A node moves
/// along the axis with z_r' + its displacement's rate, so that the mass matrix is constant:
///   T = m_r z_r'^2 / 2 + m_c (z_r' - u')^2 / 2 + sum over the arm's mass |z_r' e_y + N (T z' + B u')|^2 / 2
/// Implicit midpoint, full Newton with the exact tangent. Damping acts on the travel alone, -c u', none in the
/// material.

#include <memory>

#include "snapwing/scene/scene_problem.h"
#include "snapwing/vehicle/vehicle_parameters.h"

namespace snapwing::bench {

struct SoftState {
  double time = 0;
  Eigen::VectorXd z, z_rate;
  double travel = 0, travel_rate = 0, ring = 0, ring_speed = 0;
  double thrust = 0;  ///< of the vehicle [N]
};

class SoftArm {
 public:
  /// @param arm      planar, of one body; must outlive this. @param arms  of the vehicle
  /// @param boom     boom's mass, drag and friction join the ring
  SoftArm(const scene::CompiledScene& arm, double mass_density, int arms, const vehicle::VehicleParameters& parameters,
          bool boom);

  /// At rest in the static equilibrium at a travel, from the arm's path. @throws common::Error if it is not converged
  SoftState start(double travel) const;
  /// One step. @param demand steady thrust / full thrust. @return false if Newton does not converge or an element
  /// inverts
  bool step(SoftState* state, double demand, double dt);
  double armMass() const { return mass_rr_; }  ///< of one [kg]
  /// Kinetic and elastic energy of the vehicle [J].
  double energy(const SoftState& state) const;
  int iterations() const { return iterations_; }

 private:
  struct Bordered {
    Eigen::VectorXd rz;
    double ru, rr;
  };
  void assembleMass(double mass_density);
  /// M v of the arm alone: free part, travel, ring.
  Bordered momentum(const Eigen::VectorXd& z, double u, double r) const;

  const scene::CompiledScene& arm_;
  const solver::TermProblem& problem_;
  int arms_;
  vehicle::VehicleParameters p_;
  double ring_mass_, ring_drag_, friction_;
  std::vector<double> mass_;           ///< T^T M T in the pattern of the problem
  Eigen::VectorXd mass_zu_, mass_zr_;  ///< couplings to travel and ring
  double mass_uu_ = 0, mass_ur_ = 0, mass_rr_ = 0;
  solver::Cholesky cholesky_;
  int iterations_ = 0;
};

}  // namespace snapwing::bench
