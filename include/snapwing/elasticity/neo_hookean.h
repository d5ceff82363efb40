#pragma once
/// Compressible neo-Hookean law, W = mu/2 (I1 - d) - mu ln J + lambda/2 ln^2 J, with a density interpolation.
///
/// Every variant has the form W = mu/2 |F|^2 + g(ln J), J the planar (D = 2) or spatial determinant, so that
///   P = mu F + g' F^-T,   dP = mu dF + (g'' Q:dF) Q - g' Q dF^T Q,   Q = F^-T.
/// Plane stress: the thickness stretch e^t follows from P33 = 0, mu (e^2t - 1) + lambda (ln J + t) = 0, and g'' holds
/// its consistent change.

#include "snapwing/elasticity/constitutive_model.h"
#include "snapwing/elasticity/density_interpolation.h"
#include "snapwing/elasticity/material.h"

namespace snapwing::elasticity {

/// Parts of the energy, for selective reduced integration.
enum class Part {
  ALL,
  SHEAR,   ///< mu/2 (I1 - d) - mu ln J
  VOLUME,  ///< lambda/2 ln^2 J
};

/// [Pa]
struct NeoHookeanModuli {
  double mu = 0, lambda = 0;  ///< of the chosen part
  double log_mu = 0;          ///< factor of -ln J
  double linear_lambda = 0;   ///< of the linear law at small strain
};

/// D = 2 (plane strain or plane stress) or 3.
template <int D>
class NeoHookean : public ConstitutiveModel<D> {
 public:
  /// @param plane  only for D = 2
  /// @param part   plane stress has no volumetric locking and takes only ALL
  /// @throws common::Error for constants out of range
  NeoHookean(const Material& material, const DensityInterpolation& interpolation, Plane plane = Plane::STRAIN,
             Part part = Part::ALL);

  DensityInterpolation::Value prepare(double density) const override { return interpolation_.at(density); }
  SharedTangent shared(const DensityInterpolation::Value& cell, Order order) const override;
  bool linear(const DensityInterpolation::Value& cell) const override { return cell.mix == 0; }
  bool evaluatePrepared(const Matrix<D>& f, const DensityInterpolation::Value& cell, Order order,
                        Response<D>& out) const override;
  bool inLanes(Order order) const override { return order <= Order::TANGENT; }
  void evaluateLanes(const PointLanes<D>& points, ResponseLanes<D>& out) const override;
  void writeStress(TaylorTape& tape) const override;
  bool densityDerivative(const Matrix<D>& f, const DensityInterpolation::Value& cell, double& d_energy,
                         Matrix<D>& d_stress) const override;

 private:
  /// Hyperelastic part at F; false if det F <= 0.
  bool hyperelastic(const Matrix<D>& f, Response<D>& out) const;
  double linearEnergy(const Matrix<D>& h) const;
  SharedTangent linearTangent(const DensityInterpolation::Value& cell) const;
  Matrix<D> linearStress(const Matrix<D>& h) const;
  FullTangent<D> projected(const Matrix<D>& f, Order order) const;

  DensityInterpolation interpolation_;
  bool plane_stress_;
  NeoHookeanModuli moduli_;
};

}  // namespace snapwing::elasticity
