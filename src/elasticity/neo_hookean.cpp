#include "snapwing/elasticity/neo_hookean.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"

namespace snapwing::elasticity {

template <int D>
NeoHookean<D>::NeoHookean(const Material& material, const DensityInterpolation& interpolation, Plane plane, Part part)
    : interpolation_(interpolation), plane_stress_(D == 2 && plane == Plane::STRESS) {
  material.validate();
  interpolation.validate();
  if (plane_stress_ && part != Part::ALL) throw common::Error("plane stress takes only the whole energy");
  mu_ = part == Part::VOLUME ? 0 : material.mu();
  log_mu_ = mu_;
  lambda_ = part == Part::SHEAR ? 0 : material.lambda();
  linear_lambda_ = plane_stress_ ? 2 * mu_ * lambda_ / (lambda_ + 2 * mu_) : lambda_;
}

namespace {

/// Where four terms of a series are near the solution, Halley's rule ends within a round or two.
constexpr double NEAR = 0.25;

/// Plane stress: the root t of mu (e^2t - 1) + lambda (z + t) = 0, monotone and convex in t.
struct ThicknessStretch {
  double t = 0;
  double grown = 0, beyond = 0;  ///< e^2t - 1, and half of it less t

  /// First terms of t in powers of z.
  static double guess(double mu, double lambda, double z) {
    const double slope = 2 * mu + lambda, k = 2 * mu / slope, t = -lambda * z / slope;
    const double third = k * (2 * k - 2 / 3.), fourth = k * (k * (10 / 3. - 5 * k) - 1 / 3.);
    return t + t * t * (-k + t * (third + t * fourth));
  }
  /// A step of Halley's rule, whose error is the cube of the one before. @return whether it was exact to rounding
  bool refine(double mu, double lambda, double z) {
    const common::ExpLessOne e = common::expLessOne(2 * t);
    const double stretch = 2 * mu * (e.value + 1), slope = stretch + lambda;
    const double newton = (mu * e.value + lambda * (z + t)) / slope;
    const double step = newton / (1 - newton * stretch / slope);
    // e^2t changes by so little that two terms tell it, and nothing cancels at small t.
    t -= step;
    beyond = 0.5 * e.beyond + step * ((e.value + 1) * step - e.value);
    grown = 2 * (beyond + t);
    return std::abs(step * step * step) <= 1e-17 * std::abs(t);
  }
  /// From anywhere: Newton's rule from above cannot overshoot.
  void search(double mu, double lambda, double z) {
    t = -lambda * z / (2 * mu + lambda);
    if (t > NEAR) t = std::min(t, 0.5 * common::log1p(-lambda * z / mu));
    for (int i = 0; i < 60; ++i) {
      grown = common::expm1(2 * t);
      const double step = (mu * grown + lambda * (z + t)) / (2 * mu * (grown + 1) + lambda);
      t -= step;
      if (step * step <= 1e-17 * std::abs(t)) break;
    }
    grown = common::expm1(2 * t);
    beyond = 0.5 * grown - t;
  }
};

/// det(I + h) - 1 - tr h.
double beyondTrace(const Matrix<2>& h) { return h.determinant(); }
double beyondTrace(const Matrix<3>& h) { return 0.5 * (h.trace() * h.trace() - (h * h).trace()) + h.determinant(); }

}  // namespace

template <int D>
typename NeoHookean<D>::Volumetric NeoHookean<D>::volumetric(double z) const {
  if (!plane_stress_) return {0.5 * lambda_ * z * z, -log_mu_ + lambda_ * z, lambda_};
  ThicknessStretch e;
  e.t = ThicknessStretch::guess(mu_, lambda_, z);
  const bool near = std::abs(e.t) < NEAR;
  if (!near || (!e.refine(mu_, lambda_, z) && !e.refine(mu_, lambda_, z))) e.search(mu_, lambda_, z);
  const double squared = e.grown + 1, sum = z + e.t;
  return {mu_ * e.beyond + 0.5 * lambda_ * sum * sum, -mu_ + lambda_ * sum,
          lambda_ * 2 * mu_ * squared / (2 * mu_ * squared + lambda_)};
}

template <int D>
bool NeoHookean<D>::hyperelastic(const Matrix<D>& f, Response<D>& out) const {
  const Matrix<D> h = f - Matrix<D>::Identity();
  const double minors = beyondTrace(h), change = h.trace() + minors;
  out.det_f = 1 + change;
  if (!(out.det_f > 0)) return false;
  const Matrix<D> q = f.inverse().transpose();
  const common::LogOnePlus log_j = common::logOnePlus(change);
  const Volumetric v = volumetric(log_j.value);
  // mu/2 (|F|^2 - D) - mu ln J, with the first orders cancelled by hand.
  out.energy = 0.5 * mu_ * h.squaredNorm() + log_mu_ * (log_j.beyond - minors) + v.g;
  out.stress = mu_ * f + v.slope * q;
  out.compact = true;
  out.tangent.b = v.curvature;
  out.tangent.c = -v.slope;
  out.tangent.q = q;
  return true;
}

template <int D>
double NeoHookean<D>::linearEnergy(const Matrix<D>& h) const {
  const double trace = h.trace();
  return 0.25 * mu_ * (h + h.transpose()).squaredNorm() + 0.5 * linear_lambda_ * trace * trace;
}

template <int D>
Matrix<D> NeoHookean<D>::linearStress(const Matrix<D>& h) const {
  return mu_ * (h + h.transpose()) + linear_lambda_ * h.trace() * Matrix<D>::Identity();
}

/// Closed form in the frame of the singular values s: d scaling modes from a d x d matrix, and for each pair of axes a
/// twist, mu + g'/(s_i s_j), and a flip, mu - g'/(s_i s_j).
template <int D>
FullTangent<D> NeoHookean<D>::projected(const Matrix<D>& f, Order order) const {
  using Vector = Eigen::Matrix<double, D, 1>;
  const Eigen::JacobiSVD<Matrix<D>> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector s = svd.singularValues();
  const Volumetric v = volumetric(common::log(f.determinant()));
  FullTangent<D> result = FullTangent<D>::Zero();
  const auto add = [&](const Matrix<D>& mode, double value) {
    if (value <= 0 && order == Order::PROJECTED) return;
    value = std::abs(value);
    const Matrix<D> turned = svd.matrixU() * mode * svd.matrixV().transpose();
    const Eigen::Map<const Eigen::Matrix<double, D * D, 1>> vector(turned.data());
    result += value * vector * vector.transpose();
  };
  Matrix<D> scaling;
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j < D; ++j) {
      scaling(i, j) = v.curvature / (s(i) * s(j)) + (i == j ? mu_ - v.slope / (s(i) * s(i)) : 0.0);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix<D>> eigen(scaling);
  for (int i = 0; i < D; ++i) add(eigen.eigenvectors().col(i).asDiagonal(), eigen.eigenvalues()(i));
  for (int i = 0; i < D; ++i) {
    for (int j = i + 1; j < D; ++j) {
      Matrix<D> mode = Matrix<D>::Zero();
      mode(i, j) = mode(j, i) = std::sqrt(0.5);
      add(mode, mu_ - v.slope / (s(i) * s(j)));
      mode(i, j) = -mode(i, j);
      add(mode, mu_ + v.slope / (s(i) * s(j)));
    }
  }
  return result;
}

template <int D>
SharedTangent NeoHookean<D>::linearTangent(const DensityInterpolation::Value& m) const {
  const double rest = 1 - m.mix * m.mix, shear = m.stiffness * rest * mu_;
  return {shear, m.stiffness * rest * linear_lambda_, shear};
}

template <int D>
SharedTangent NeoHookean<D>::shared(const DensityInterpolation::Value& m, Order order) const {
  if (order != Order::TANGENT) return {};  // projections are of the whole tangent
  SharedTangent result = linearTangent(m);
  result.a = m.stiffness * m.mix * m.mix * mu_ + result.a;
  return result;
}

template <int D>
bool NeoHookean<D>::evaluatePrepared(const Matrix<D>& f, const DensityInterpolation::Value& m, Order order,
                                     Response<D>& out) const {
  const Matrix<D> h = f - Matrix<D>::Identity();
  const Matrix<D> mixed = Matrix<D>::Identity() + m.mix * h;
  if (m.mix == 0) {
    out = Response<D>();  // void: linear alone
  } else if (!hyperelastic(mixed, out)) {
    return false;
  }
  const double rest = 1 - m.mix * m.mix;
  out.energy = m.stiffness * (out.energy + (rest > 0 ? rest * linearEnergy(h) : 0.0));
  if (order == Order::ENERGY) return true;
  out.stress *= m.stiffness * m.mix;
  if (rest > 0) out.stress += m.stiffness * rest * linearStress(h);
  if (order == Order::STRESS) return true;
  const double scale = m.stiffness * m.mix * m.mix;
  out.tangent.b *= scale;
  out.tangent.c *= scale;
  if (order != Order::TANGENT) {
    out.full = scale * projected(mixed, order) + fullTangent<D>(linearTangent(m), Response<D>());
    out.compact = false;
  }
  return true;
}

template <int D>
bool NeoHookean<D>::densityDerivative(const Matrix<D>& f, const DensityInterpolation::Value& m, double& d_energy,
                                      Matrix<D>& d_stress) const {
  const Matrix<D> h = f - Matrix<D>::Identity();
  Response<D> r;
  if (!hyperelastic(Matrix<D>::Identity() + m.mix * h, r)) return false;
  const double rest = 1 - m.mix * m.mix, linear = linearEnergy(h);
  const Matrix<D> linear_stress = linearStress(h);
  d_energy = m.stiffness_slope * (r.energy + rest * linear) +
             m.stiffness * m.mix_slope * (r.stress.cwiseProduct(h).sum() - 2 * m.mix * linear);
  d_stress =
      m.stiffness_slope * (m.mix * r.stress + rest * linear_stress) +
      m.stiffness * m.mix_slope * (r.stress + m.mix * tangentTimes<D>({mu_, 0, 0}, r, h) - 2 * m.mix * linear_stress);
  return true;
}

template class NeoHookean<2>;
template class NeoHookean<3>;

}  // namespace snapwing::elasticity
