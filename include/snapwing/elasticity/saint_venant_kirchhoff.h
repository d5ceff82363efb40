#pragma once
/// Saint Venant-Kirchhoff law, W = lambda/2 tr(G)^2 + mu G:G, G = (F^T F - I) / 2: linear between Green's strain and
/// the second Piola stress. For large rotations at small strain; under compression to less than 0.58 of a length it
/// softens, and it does not resist inversion (det F <= 0). With a density interpolation as the neo-Hookean law has it:
///   W(F, rho) = s(rho) [W(I + m (F - I)) + (1 - m^2) W_linear(F - I)]
/// Plane stress is exact: S33 = 0 makes lambda 2 lambda mu / (lambda + 2 mu).

#include "snapwing/elasticity/constitutive_model.h"
#include "snapwing/elasticity/density_interpolation.h"
#include "snapwing/elasticity/material.h"

namespace snapwing::elasticity {

/// D = 2 (plane strain or plane stress) or 3.
template <int D>
class SaintVenantKirchhoff : public ConstitutiveModel<D> {
 public:
  /// @param plane  only for D = 2
  /// @throws common::Error for constants out of range
  SaintVenantKirchhoff(const Material& material, const DensityInterpolation& interpolation,
                       Plane plane = Plane::STRAIN);

  DensityInterpolation::Value prepare(double density) const override { return interpolation_.at(density); }
  bool evaluatePrepared(const Matrix<D>& f, const DensityInterpolation::Value& cell, Order order,
                        Response<D>& out) const override;
  void writeStress(TaylorTape& tape) const override;
  bool densityDerivative(const Matrix<D>& f, const DensityInterpolation::Value& cell, double& d_energy,
                         Matrix<D>& d_stress) const override;

 private:
  double energyOf(const Matrix<D>& strain) const;         ///< W at a strain [J/m3]
  Matrix<D> secondStress(const Matrix<D>& strain) const;  ///< S = lambda tr(G) I + 2 mu G [Pa]
  /// dP = dF S + F (lambda tr(dG) I + 2 mu dG) of I + h.
  Matrix<D> stressChange(const Matrix<D>& h, const Matrix<D>& d_f) const;

  DensityInterpolation interpolation_;
  double mu_, lambda_;
};

}  // namespace snapwing::elasticity
