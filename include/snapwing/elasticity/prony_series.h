#pragma once
/// Relaxation of a material as a sum of exponentials (generalised Maxwell model, Prony series):
///   E(t) / E_fast = slow + sum_k share_k exp(-t / time_k),   slow = 1 - sum_k share_k,
/// with E_fast the modulus at once and slow E_fast that after a long rest. [Simo and Hughes, Computational
/// Inelasticity, 1998, section 10.3]. Poisson's ratio does not relax.

#include <vector>

namespace snapwing::elasticity {

struct PronySeries {
  struct Branch {
    double share = 0;  ///< of the fast modulus [1] > 0
    double time = 0;   ///< [s] > 0
  };
  std::vector<Branch> branches;

  bool empty() const { return branches.empty(); }
  /// Slow modulus / fast modulus [1], in (0, 1].
  double slow() const;
  /// E(t) / E_fast [1]. @param t  [s] >= 0
  double relaxation(double t) const;
  /// Real and imaginary part of the modulus under exp(i omega t), over the fast one [1]. @param omega  [rad/s] >= 0
  double storage(double omega) const;
  double loss(double omega) const;
  /// Loss modulus / omega, over the slow modulus [s]: the beta of a Kelvin-Voigt law with the same loss there.
  double viscousTime(double omega) const;
  /// @throws common::Error naming the branch, its value and its range
  void validate() const;
};

/// What a branch's elastic strain q does in a step of h = x time during which the strain grows evenly by d:
///   q1 = decay q0 + mean d;  its mean over the step is mean q0 + ramp d, and the loss over (modulus)
///   first q0^2 + 2 mixed q0 d + last d^2, a quadratic form that is never negative.
struct RelaxationStep {
  double decay = 1;   ///< exp(-x)
  double mean = 1;    ///< (1 - exp(-x)) / x
  double ramp = 0.5;  ///< (1 - mean) / x
  double first = 0, mixed = 0, last = 0;
  /// @param x  > 0: length of the step / time of the branch
  explicit RelaxationStep(double x);
};

}  // namespace snapwing::elasticity
