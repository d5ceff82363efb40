#include "snapwing/solver/rotation.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"

namespace snapwing::solver {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The D x D part of a 3 x 3 matrix, by columns.
template <int D>
Eigen::VectorXd entries(const Matrix3d& m) {
  Eigen::VectorXd result(D * D);
  for (int j = 0; j < D; ++j) {
    for (int i = 0; i < D; ++i) result(i + D * j) = m(i, j);
  }
  return result;
}

/// Value, first and second derivative of sum_k (-x)^k / (2k + offset)!: sin t / t (offset 1), (1 - cos t) / t^2
/// (offset 2), x = t^2. The largest term below t = 2 pi is 13, so at most two digits cancel.
std::array<double, 3> series(double x, int offset) {
  std::array<double, 3> sum{};
  double coefficient = offset == 1 ? 1.0 : 0.5;
  std::array<double, 3> power{1, 0, 0};  // x^k, k x^(k-1), k (k-1) x^(k-2)
  for (int k = 0; k < 40; ++k) {
    for (int d = 0; d < 3; ++d) sum[d] += coefficient * power[d];
    power = {power[0] * x, power[1] * x + power[0], power[2] * x + 2 * power[1]};
    coefficient /= -(2.0 * k + offset + 1) * (2.0 * k + offset + 2);
  }
  return sum;
}

RotationValue sized(int count, int params) {
  RotationValue v;
  v.value = Eigen::VectorXd::Zero(count);
  v.slope = Eigen::MatrixXd::Zero(count, params);
  v.second.assign(count, Eigen::MatrixXd::Zero(params, params));
  return v;
}

template <int D>
RotationValue rotateAboutAxis(const Rotation& rotation, double s) {
  const Matrix3d k = skewOf(rotation.axes[0]);
  const Eigen::VectorXd first = entries<D>(k), square = entries<D>(k * k);
  const double angle = s / rotation.length, sine = common::sin(angle), cosine = common::cos(angle);
  const double half = common::sin(0.5 * angle);
  RotationValue v = sized(D * D, 1);
  v.value = rotation.length * (sine * first + 2 * half * half * square);
  v.slope.col(0) = cosine * first + sine * square;
  for (int e = 0; e < D * D; ++e) v.second[e](0, 0) = (-sine * first(e) + cosine * square(e)) / rotation.length;
  return v;
}

RotationValue rotateFreely(const Rotation& rotation, const Vector3d& s) {
  const double length = rotation.length;
  const Vector3d t = s / length;
  const double x = t.squaredNorm();
  const std::array<double, 3> a = series(x, 1), b = series(x, 2);
  const Matrix3d k = skewOf(t), m = k * k;
  const auto unit = [](int i) { return Vector3d(Vector3d::Unit(i)); };
  const auto dm = [&](int i) {
    return Matrix3d(unit(i) * t.transpose() + t * unit(i).transpose() - 2 * t(i) * Matrix3d::Identity());
  };
  RotationValue v = sized(9, 3);
  v.value = length * entries<3>(a[0] * k + b[0] * m);
  for (int i = 0; i < 3; ++i) {
    v.slope.col(i) = entries<3>(2 * t(i) * (a[1] * k + b[1] * m) + a[0] * skewOf(unit(i)) + b[0] * dm(i));
    for (int j = 0; j < 3; ++j) {
      const double same = i == j ? 1 : 0;
      const Matrix3d d2m =
          unit(i) * unit(j).transpose() + unit(j) * unit(i).transpose() - 2 * same * Matrix3d::Identity();
      const Matrix3d d2 = (4 * t(i) * t(j) * a[2] + 2 * same * a[1]) * k +
                          (4 * t(i) * t(j) * b[2] + 2 * same * b[1]) * m +
                          2 * t(i) * (a[1] * skewOf(unit(j)) + b[1] * dm(j)) +
                          2 * t(j) * (a[1] * skewOf(unit(i)) + b[1] * dm(i)) + b[0] * d2m;
      const Eigen::VectorXd flat = entries<3>(d2) / length;
      for (int e = 0; e < 9; ++e) v.second[e](i, j) = flat(e);
    }
  }
  return v;
}

}  // namespace

Matrix3d skewOf(const Vector3d& n) {
  Matrix3d k;
  k << 0, -n(2), n(1), n(2), 0, -n(0), -n(1), n(0), 0;
  return k;
}

namespace {

/// Entries of M R_ref, in place.
void refer(Eigen::Ref<Eigen::VectorXd> entries, int d, const Matrix3d& reference) {
  Matrix3d m = Matrix3d::Zero();
  for (int j = 0; j < d; ++j) {
    for (int i = 0; i < d; ++i) m(i, j) = entries(i + d * j);
  }
  m = (m * reference).eval();
  for (int j = 0; j < d; ++j) {
    for (int i = 0; i < d; ++i) entries(i + d * j) = m(i, j);
  }
}

/// exp(s/L) - 1 becomes exp(s/L) R_ref - 1.
void refer(const Rotation& rotation, int d, const Matrix3d& reference, RotationValue& v) {
  for (int i = 0; i < d; ++i) v.value(i + d * i) += rotation.length;
  refer(v.value, d, reference);
  for (int i = 0; i < d; ++i) v.value(i + d * i) -= rotation.length;
  for (Eigen::Index k = 0; k < v.slope.cols(); ++k) {
    refer(v.slope.col(k), d, reference);
    for (Eigen::Index l = 0; l < v.slope.cols(); ++l) {
      Eigen::VectorXd second(d * d);
      for (int e = 0; e < d * d; ++e) second(e) = v.second[e](k, l);
      refer(second, d, reference);
      for (int e = 0; e < d * d; ++e) v.second[e](k, l) = second(e);
    }
  }
}

}  // namespace

RotationValue rotate(const Rotation& rotation, int dimension, const Eigen::VectorXd& s, const Matrix3d* reference) {
  RotationValue v;
  if (rotation.axes.empty()) {
    v = sized(dimension * dimension, 0);
  } else if (dimension == 2) {
    v = rotateAboutAxis<2>(rotation, s(0));
  } else {
    v = rotation.axes.size() == 1 ? rotateAboutAxis<3>(rotation, s(0)) : rotateFreely(rotation, s);
  }
  if (reference != nullptr) refer(rotation, dimension, *reference, v);
  return v;
}

template <int D>
std::vector<Vector3d> openAxes(const Rotation& rotation, const std::vector<Equation>& equations,
                               std::vector<Vector3d> allowed, const std::string& name) {
  if (equations.empty() || allowed.empty()) return allowed;
  const int count = static_cast<int>(equations.size()), axes = static_cast<int>(allowed.size());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count, D * D);
  for (int n = 0; n < count; ++n) {
    for (const auto& [dof, value] : equations[n].terms) rows(n, dof - rotation.first) += value;
    rows.row(n) /= rows.row(n).cwiseAbs().maxCoeff();
  }
  Eigen::MatrixXd effect(count, axes);
  for (int a = 0; a < axes; ++a) effect.col(a) = rows * entries<D>(skewOf(allowed[a]));
  Eigen::FullPivLU<Eigen::MatrixXd> lu(effect);
  lu.setThreshold(1e-8);
  const int open = axes - static_cast<int>(lu.rank());
  if (open == 0) return {};
  const auto unchanged = [&](const Vector3d& a, const Vector3d& b) {
    return (rows * entries<D>(skewOf(a) * skewOf(b) + skewOf(b) * skewOf(a))).cwiseAbs().maxCoeff() < 1e-8;
  };
  bool exact = open != 2;
  if (open == axes) {
    for (const Vector3d& a : allowed) {
      for (const Vector3d& b : allowed) exact = exact && unchanged(a, b);
    }
    if (exact) return allowed;
  } else if (open == 1) {
    Vector3d axis = Vector3d::Zero();
    const Eigen::VectorXd kernel = lu.kernel().col(0);
    for (int a = 0; a < axes; ++a) axis += kernel(a) * allowed[a];
    axis.normalize();
    if (unchanged(axis, axis)) return {axis};
  }
  throw common::Error("'" + equations[0].name + "' lets the rigid '" + name +
                      "' turn along a curve, or only at first order; allowed: constraints that leave it free, hold its "
                      "rotation, or leave one axis");
}

template std::vector<Vector3d> openAxes<2>(const Rotation&, const std::vector<Equation>&, std::vector<Vector3d>,
                                           const std::string&);
template std::vector<Vector3d> openAxes<3>(const Rotation&, const std::vector<Equation>&, std::vector<Vector3d>,
                                           const std::string&);

}  // namespace snapwing::solver
