#pragma once
/// Isotropic elastic constants and their ranges.

namespace snapwing::elasticity {

/// How a planar body behaves across its thickness.
enum class Plane {
  STRAIN,  ///< no stretch across
  STRESS,  ///< free to stretch across: P33 = 0
};

struct Material {
  double youngs_modulus = 0;  ///< E [Pa], > 0
  double poisson_ratio = 0;   ///< nu [1], 0 <= nu < 0.5
  double mass_density = 0;    ///< [kg/m3], >= 0 (0: weightless)

  double mu() const { return youngs_modulus / (2 * (1 + poisson_ratio)); }  ///< [Pa]
  /// [Pa]
  double lambda() const { return youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio)); }

  /// @throws common::Error naming the constant, its value and its range
  void validate() const;
};

}  // namespace snapwing::elasticity
