// The neo-Hookean law at a point in plain numbers, without calls or branches: one point alone, or several side by side
// in the compiler's vectors, with the same bits. Private to the layer.
#pragma once

#include <cmath>

#include "snapwing/common/elementary.h"
#include "snapwing/elasticity/neo_hookean.h"

namespace snapwing::elasticity {

/// det F of F = I + h and what follows from it; no digits cancel at small h.
struct Volume {
  double minors;     ///< det F - 1 - tr h
  double det;        ///< where it is not positive, z and beyond are those of F = I
  double z, beyond;  ///< ln det F, and what det F - 1 has beyond it
};

template <int D>
inline Volume volumeAt(const double (&h)[D * D]) {
  Volume v;
  double trace = 0;
  for (int i = 0; i < D; ++i) trace += h[i + D * i];
  if constexpr (D == 2) {
    v.minors = h[0] * h[3] - h[1] * h[2];
  } else {
    const double first = h[4] * h[8] - h[5] * h[7], second = h[1] * h[8] - h[2] * h[7];
    const double third = h[1] * h[5] - h[2] * h[4];
    v.minors = (h[0] * h[4] - h[1] * h[3]) + first + (h[8] * h[0] - h[6] * h[2]) +
               (h[0] * first - h[3] * second + h[6] * third);
  }
  v.det = 1 + (trace + v.minors);
  const common::LogOnePlus log = common::logOnePlus(v.det > 0 ? trace + v.minors : 0);
  v.z = log.value;
  v.beyond = log.beyond;
  return v;
}

/// F^-T of F = I + h by columns.
template <int D>
inline void invertTransposed(const double (&h)[D * D], double det, double (&q)[D * D]) {
  double f[D * D];
  for (int k = 0; k < D * D; ++k) f[k] = h[k] + (k % (D + 1) == 0 ? 1.0 : 0.0);
  const double inverse = 1 / det;
  if constexpr (D == 2) {
    q[0] = f[3] * inverse, q[1] = -f[2] * inverse;
    q[2] = -f[1] * inverse, q[3] = f[0] * inverse;
  } else {
    for (int i = 0; i < D; ++i) {
      for (int j = 0; j < D; ++j) {
        const int i1 = (i + 1) % D, i2 = (i + 2) % D, j1 = (j + 1) % D, j2 = (j + 2) % D;
        q[i + D * j] = (f[i1 + D * j1] * f[i2 + D * j2] - f[i1 + D * j2] * f[i2 + D * j1]) * inverse;
      }
    }
  }
}

/// Where four terms of a series are near the solution, Halley's rule ends within a round or two.
constexpr double NEAR = 0.25;

/// Plane stress: the root t of mu (e^2t - 1) + lambda (z + t) = 0, monotone and convex in t.
struct ThicknessStretch {
  double t = 0;
  double grown = 0, beyond = 0;  ///< e^2t - 1, and half of it less t

  /// First terms of t in powers of z.
  static double guess(const NeoHookeanModuli& m, double z) {
    const double slope = 2 * m.mu + m.lambda, k = 2 * m.mu / slope, t = -m.lambda * z / slope;
    const double third = k * (2 * k - 2 / 3.), fourth = k * (k * (10 / 3. - 5 * k) - 1 / 3.);
    return t + t * t * (-k + t * (third + t * fourth));
  }
  /// A step of Halley's rule, whose error is the cube of the one before. @return whether it was exact to rounding
  bool refine(const NeoHookeanModuli& m, double z) {
    const common::ExpLessOne e = common::expLessOne(2 * t);
    const double stretch = 2 * m.mu * (e.value + 1), slope = stretch + m.lambda;
    const double newton = (m.mu * e.value + m.lambda * (z + t)) / slope;
    const double step = newton / (1 - newton * stretch / slope);
    // e^2t changes by so little that two terms tell it, and nothing cancels at small t.
    t -= step;
    beyond = 0.5 * e.beyond + step * ((e.value + 1) * step - e.value);
    grown = 2 * (beyond + t);
    return std::abs(step * step * step) <= 1e-17 * std::abs(t);
  }
  /// From anywhere: Newton's rule from above cannot overshoot.
  void search(const NeoHookeanModuli& m, double z);
  /// Whatever it takes.
  void find(const NeoHookeanModuli& m, double z) {
    t = guess(m, z);
    const bool near = std::abs(t) < NEAR;
    if (!near || (!refine(m, z) && !refine(m, z))) search(m, z);
  }
};

/// g(z) + mu z and the derivatives g', g'' of the function of z = ln J beside mu/2 |F|^2.
struct VolumeEnergy {
  VolumeEnergy(const NeoHookeanModuli& m, double z)
      : g(0.5 * m.lambda * z * z), slope(-m.log_mu + m.lambda * z), curvature(m.lambda) {}
  VolumeEnergy(const NeoHookeanModuli& m, double z, const ThicknessStretch& e) {
    const double sum = z + e.t, stretch = 2 * m.mu * (e.grown + 1);
    g = m.mu * e.beyond + 0.5 * m.lambda * sum * sum;
    slope = -m.mu + m.lambda * sum;
    curvature = m.lambda * stretch / (stretch + m.lambda);
  }
  double g, slope, curvature;
};

template <int D>
struct PointResponse {
  double energy, stress[D * D], b, c, q[D * D];
};

/// The hyperelastic part at F = I + h.
template <int D>
inline PointResponse<D> hyperelasticAt(const NeoHookeanModuli& m, const double (&h)[D * D], const Volume& volume,
                                       const VolumeEnergy& v) {
  PointResponse<D> r;
  invertTransposed<D>(h, volume.det, r.q);
  double squared = 0;
  for (int k = 0; k < D * D; ++k) squared += h[k] * h[k];
  // mu/2 (|F|^2 - D) - mu ln J, with the first orders cancelled by hand.
  r.energy = 0.5 * m.mu * squared + m.log_mu * (volume.beyond - volume.minors) + v.g;
  for (int k = 0; k < D * D; ++k) {
    r.stress[k] = m.mu * (h[k] + (k % (D + 1) == 0 ? 1.0 : 0.0)) + v.slope * r.q[k];
  }
  r.b = v.curvature;
  r.c = -v.slope;
  return r;
}

/// Mixes the linear law in: from the hyperelastic response at I + mix h to that of the cell at I + h.
template <int D>
inline void mixLinear(const NeoHookeanModuli& m, const double (&h)[D * D], double stiffness, double mix,
                      PointResponse<D>& r) {
  const double rest = 1 - mix * mix;
  double trace = 0, squared = 0, linear[D * D];
  for (int i = 0; i < D; ++i) trace += h[i + D * i];
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j < D; ++j) {
      const double twice = h[i + D * j] + h[j + D * i];
      squared += twice * twice;
      linear[i + D * j] = m.mu * twice + (i == j ? m.linear_lambda * trace : 0.0);
    }
  }
  r.energy = stiffness * (r.energy + rest * (0.25 * m.mu * squared + 0.5 * m.linear_lambda * trace * trace));
  for (int k = 0; k < D * D; ++k) r.stress[k] = stiffness * (mix * r.stress[k] + rest * linear[k]);
  r.b *= stiffness * mix * mix;
  r.c *= stiffness * mix * mix;
}

}  // namespace snapwing::elasticity
