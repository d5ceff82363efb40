#pragma once
/// What a hyperelastic law gives at one material point: energy, first Piola stress and tangent.

#include <Eigen/Core>

#include "snapwing/elasticity/density_interpolation.h"

namespace snapwing::elasticity {

template <int D>
using Matrix = Eigen::Matrix<double, D, D>;
/// dP/dF with vec() by columns: entry (i + D j, k + D l) = dP_ij / dF_kl.
template <int D>
using FullTangent = Eigen::Matrix<double, D * D, D * D>;

enum class Order {
  ENERGY,     ///< energy only
  STRESS,     ///< and stress
  TANGENT,    ///< and the exact tangent
  PROJECTED,  ///< and the tangent with its negative eigenvalues set to zero
  ABSOLUTE,   ///< and the tangent with the magnitudes of its eigenvalues
};
inline bool withTangent(Order order) { return order >= Order::TANGENT; }

/// Isotropic tangents in the form that assembly is fast with:
///   dP = a dF + b (Q : dF) Q + c Q dF^T Q + a0 dF + b0 tr(dF) I + c0 dF^T,   Q = F^-T
/// a, a0, b0 and c0 must depend on the density alone, not on F: a cell then adds them once for all of its particles.
template <int D>
struct CompactTangent {
  double a = 0, b = 0, c = 0;
  Matrix<D> q = Matrix<D>::Zero();
  double a0 = 0, b0 = 0, c0 = 0;

  FullTangent<D> full() const;
  Matrix<D> times(const Matrix<D>& d_f) const;
};

/// Quantities per reference volume. Only what the asked order covers is filled.
template <int D>
struct Response {
  double energy = 0;                             ///< W [J/m3]
  Matrix<D> stress = Matrix<D>::Zero();          ///< P = dW/dF [Pa]
  bool compact = true;                           ///< tangent in `tangent`, else in `full`
  CompactTangent<D> tangent;                     ///< [Pa]
  FullTangent<D> full = FullTangent<D>::Zero();  ///< [Pa], symmetric
  double det_f = 1;                              ///< det of the deformation gradient that the law sees
};

/// A law W(F, density). Thread-safe: const and without state.
template <int D>
class ConstitutiveModel {
 public:
  virtual ~ConstitutiveModel() = default;
  /// What a density makes of the law: worked out once per cell, not once per particle.
  virtual DensityInterpolation::Value prepare(double density) const = 0;
  /// @param f     deformation gradient [1]
  /// @param cell  of prepare()
  /// @return false if the energy is infinite there (turned inside out); `out` then holds only det_f
  virtual bool evaluatePrepared(const Matrix<D>& f, const DensityInterpolation::Value& cell, Order order,
                                Response<D>& out) const = 0;
  /// The same for a density in [0, 1].
  bool evaluate(const Matrix<D>& f, double density, Order order, Response<D>& out) const {
    return evaluatePrepared(f, prepare(density), order, out);
  }
  /// Explicit derivatives by the density at fixed F: dW/drho and dP/drho. Same return value as evaluatePrepared().
  virtual bool densityDerivative(const Matrix<D>& f, const DensityInterpolation::Value& cell, double& d_energy,
                                 Matrix<D>& d_stress) const = 0;
};

}  // namespace snapwing::elasticity
