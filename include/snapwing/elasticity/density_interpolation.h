#pragma once
/// How stiffness follows the density of a cell.
///   s(rho)     = s_void + (1 - s_void) rho^p                      (modified SIMP)
///   gamma(rho) = (tanh(b eta) + tanh(b (rho^p - eta))) / (tanh(b eta) + tanh(b (1 - eta)))
/// gamma mixes the hyperelastic energy with a linear one so that nearly void cells may invert (det F <= 0):
///   W(H, rho) = s [ W_h(I + gamma H) + (1 - gamma^2) W_l(H) ],  H = F - I    (Wang, Lazarov, Sigmund, Jensen 2014)

namespace snapwing::elasticity {

struct DensityInterpolation {
  double void_stiffness = 1e-6;  ///< s(0), in (0, 1)
  double power = 3;              ///< p >= 1
  double sharpness = 500;        ///< b > 0
  double threshold = 0.01;       ///< eta, in (0, 1): rho^p above it counts as solid

  /// Below it the mix is taken as zero: what it changes in the tangent is in proportion to its cube, less than
  /// rounding.
  static constexpr double LINEAR_MIX = 1e-6;

  struct Value {
    double stiffness, stiffness_slope;  ///< s, ds/drho
    double mix, mix_slope;              ///< gamma, dgamma/drho; both zero below LINEAR_MIX
  };
  /// @param density  rho in [0, 1]
  Value at(double density) const;
  /// @throws common::Error naming the field
  void validate() const;
};

}  // namespace snapwing::elasticity
