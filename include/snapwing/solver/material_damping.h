#pragma once
/// Viscous losses of a solid's material, in a step of length h from y0. Three laws that give one mode the same damping
/// ratio and a snap three different ones: docs/motion.md compares them.

#include <memory>

#include "snapwing/mpm/mass.h"
#include "snapwing/solver/green_particles.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

enum class LaggedTangent {
  EXACT,      ///< the paper's: with a negative stiffness it FEEDS the motion, c(u) = beta k(u)
  PROJECTED,  ///< each particle's tangent without its negative eigenvalues: never feeds it
};

/// Lagged Rayleigh damping: E = d^T (a M + b K(y0)) d / (2 h), d = y - y0. It brakes rigid rotations as well.
template <int D>
class RayleighTerm : public Term {
 public:
  /// @param solid  finished; its blocks are those of the region
  /// @param mass   of the same solid; null: a must be 0
  /// @param a      [1/s] >= 0; @param b  [s] >= 0. @throws common::Error
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

/// Kelvin-Voigt: E = beta/(2 h) sum of m w dG : C : dG, dG = G(y) - G(y0) with Green's strain G and the law's moduli at
/// rest C. Objective: rigid motions cost nothing.
template <int D>
class KelvinVoigtTerm : public Term {
 public:
  /// @param beta  [s] >= 0. @throws common::Error
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
