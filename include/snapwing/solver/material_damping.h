#pragma once
/// Viscous losses of a solid's material in a step of length h from y0. Three laws: calibrated to the same damping ratio
/// of one mode, they dissipate different energies in a snap (compared in docs/motion.md).

#include <memory>

#include "snapwing/mpm/mass.h"
#include "snapwing/solver/green_particles.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

enum class LaggedTangent {
  EXACT,      ///< the paper's, c(u) = beta k(u): where the stiffness is negative it ADDS energy to the motion
  PROJECTED,  ///< each particle's tangent without its negative eigenvalues: never adds energy
};

/// Lagged Rayleigh damping: E = d^T (a M + b K(y0)) d / (2 h), d = y - y0. It also damps rigid rotations.
template <int D>
class RayleighTerm : public Term {
 public:
  /// @param solid  finished; its pattern defines the region
  /// @param mass   of the same solid; null: a must be 0
  /// @param a      [1/s] >= 0; @param b  [s] >= 0
  /// @param first  full coordinate of the solid's first displacement. @throws common::Error
  RayleighTerm(std::shared_ptr<const mpm::Discretisation<D>> solid, std::shared_ptr<const mpm::Mass<D>> mass, double a,
               double b, LaggedTangent tangent, int region = 0, int first = 0);

  std::string name() const override { return "material damping"; }
  Role role() const override { return Role::DISSIPATION; }
  int region() const override { return region_; }
  std::shared_ptr<const Memory> keep(const Point& start) const override;
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  struct Lagged;
  std::shared_ptr<const mpm::Discretisation<D>> solid_;
  std::shared_ptr<const mpm::Mass<D>> mass_;
  double a_, b_;
  LaggedTangent tangent_;
  int region_, first_;
};

/// Kelvin-Voigt damping: E = beta/(2 h) sum over particles of V dG : C : dG, dG = G(y) - G(y0). G: Green's strain, C:
/// moduli of the elastic law at rest, V: volume of the particle. Objective: rigid motions are not damped.
template <int D>
class KelvinVoigtTerm : public Term {
 public:
  /// @param solid  finished; @param beta  [s] >= 0; @param region, first  as of ElasticTerm. @throws common::Error
  KelvinVoigtTerm(std::shared_ptr<const mpm::Discretisation<D>> solid, double beta, int region = 0, int first = 0);

  std::string name() const override { return "material damping"; }
  Role role() const override { return Role::DISSIPATION; }
  int region() const override { return particles_.region(); }
  std::shared_ptr<const Memory> keep(const Point& start) const override;
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  struct Strains;
  GreenParticles<D> particles_;
  double beta_;
};

}  // namespace snapwing::solver
