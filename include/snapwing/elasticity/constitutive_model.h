#pragma once
/// What a hyperelastic law gives at one material point: energy, first Piola stress and tangent.

#include <Eigen/Core>

#include "snapwing/elasticity/density_interpolation.h"
#include "snapwing/elasticity/point_lanes.h"
#include "snapwing/elasticity/taylor_tape.h"

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

/// The part of a tangent that is the same at every deformation, which a cell adds once for all of its particles:
///   dP = a dF + b tr(dF) I + c dF^T
struct SharedTangent {
  double a = 0, b = 0, c = 0;  ///< [Pa]
};

/// The part that follows the deformation, in the form that assembly is fast with:
///   dP = b (Q : dF) Q + c Q dF^T Q,   Q = F^-T
template <int D>
struct CompactTangent {
  double b = 0, c = 0;  ///< [Pa]
  Matrix<D> q = Matrix<D>::Zero();
};

/// Quantities per reference volume. Only what the asked order covers is filled.
template <int D>
struct Response {
  double energy = 0;                             ///< W [J/m3]
  Matrix<D> stress = Matrix<D>::Zero();          ///< P = dW/dF [Pa]
  bool compact = true;                           ///< what follows the deformation is in `tangent`, else in `full`
  CompactTangent<D> tangent;                     ///< [Pa]
  FullTangent<D> full = FullTangent<D>::Zero();  ///< [Pa], symmetric
  double det_f = 1;                              ///< det of the deformation gradient that the law sees
};

/// dP for a change dF of the deformation gradient: the law's shared part and what a response has beside it.
template <int D>
Matrix<D> tangentTimes(const SharedTangent& shared, const Response<D>& response, const Matrix<D>& d_f);
/// The same as a matrix.
template <int D>
FullTangent<D> fullTangent(const SharedTangent& shared, const Response<D>& response);

/// A law W(F, density). Thread-safe: const and without state.
template <int D>
class ConstitutiveModel {
 public:
  virtual ~ConstitutiveModel() = default;
  /// What a density makes of the law: worked out once per cell, not once per particle.
  virtual DensityInterpolation::Value prepare(double density) const = 0;
  /// What all deformations share of the tangent of an order; a response holds the rest.
  virtual SharedTangent shared(const DensityInterpolation::Value& /*cell*/, Order /*order*/) const { return {}; }
  /// Whether shared() is the whole tangent of a cell, P = tangent : (F - I), at any order and deformation.
  virtual bool linear(const DensityInterpolation::Value& /*cell*/) const { return false; }
  /// @param f     deformation gradient [1]
  /// @param cell  of prepare()
  /// @return false if the energy is infinite there (det F <= 0); `out` then holds only det_f
  virtual bool evaluatePrepared(const Matrix<D>& f, const DensityInterpolation::Value& cell, Order order,
                                Response<D>& out) const = 0;
  /// The same for a density in [0, 1].
  bool evaluate(const Matrix<D>& f, double density, Order order, Response<D>& out) const {
    return evaluatePrepared(f, prepare(density), order, out);
  }
  /// Explicit derivatives by the density at fixed F: dW/drho and dP/drho. Same return value as evaluatePrepared().
  virtual bool densityDerivative(const Matrix<D>& f, const DensityInterpolation::Value& cell, double& d_energy,
                                 Matrix<D>& d_stress) const = 0;
  /// Whether evaluateLanes() gives what an order asks for.
  virtual bool inLanes(Order /*order*/) const { return false; }
  /// evaluatePrepared() for points side by side, with all that TANGENT asks for.
  virtual void evaluateLanes(const PointLanes<D>& /*points*/, ResponseLanes<D>& /*out*/) const {}
  /// P of solid material as a function of F, both by columns: arguments and results of the tape. A cell's own stress is
  /// stiffness * mix * P(I + mix H) and a part that is linear in H. Default: nothing, the law has no series.
  virtual void writeStress(TaylorTape& /*tape*/) const {}
};

}  // namespace snapwing::elasticity
