#pragma once
/// Second-order forward differentiation: a number that carries its exact gradient and Hessian with respect to N
/// independent variables. Small N only (cost grows as N^2 per operation).

#include <Eigen/Core>
#include <cmath>

namespace snapwing::design {

/// value, gradient (N), Hessian (N x N, symmetric, full).
template <int N>
struct Jet {
  using Gradient = Eigen::Matrix<double, N, 1>;
  using Hessian = Eigen::Matrix<double, N, N>;
  double value = 0;
  Gradient gradient = Gradient::Zero();
  Hessian hessian = Hessian::Zero();

  Jet() = default;
  Jet(double constant) : value(constant) {}  // NOLINT: constants mix freely with jets
  /// The i-th independent variable. @param i  0 .. N-1
  static Jet variable(double at, int i) {
    Jet jet(at);
    jet.gradient[i] = 1;
    return jet;
  }
};

/// f(a) from f, f', f'' at a.value.
template <int N>
Jet<N> chain(const Jet<N>& a, double f, double df, double ddf) {
  Jet<N> r(f);
  r.gradient = df * a.gradient;
  r.hessian = df * a.hessian + ddf * a.gradient * a.gradient.transpose();
  return r;
}

template <int N>
Jet<N> operator+(const Jet<N>& a, const Jet<N>& b) {
  Jet<N> r(a.value + b.value);
  r.gradient = a.gradient + b.gradient;
  r.hessian = a.hessian + b.hessian;
  return r;
}

template <int N>
Jet<N> operator-(const Jet<N>& a) {
  return chain(a, -a.value, -1, 0);
}

template <int N>
Jet<N> operator-(const Jet<N>& a, const Jet<N>& b) {
  Jet<N> r(a.value - b.value);
  r.gradient = a.gradient - b.gradient;
  r.hessian = a.hessian - b.hessian;
  return r;
}

template <int N>
Jet<N> operator*(const Jet<N>& a, const Jet<N>& b) {
  Jet<N> r(a.value * b.value);
  r.gradient = a.value * b.gradient + b.value * a.gradient;
  const typename Jet<N>::Hessian cross = a.gradient * b.gradient.transpose();
  r.hessian = a.value * b.hessian + b.value * a.hessian + cross + cross.transpose();
  return r;
}

template <int N>
Jet<N> operator/(const Jet<N>& a, const Jet<N>& b) {
  const double i = 1 / b.value;
  return a * chain(b, i, -i * i, 2 * i * i * i);
}

// Mixed with plain numbers: a conversion would not be deduced.
template <int N>
Jet<N> operator+(const Jet<N>& a, double b) {
  return a + Jet<N>(b);
}
template <int N>
Jet<N> operator+(double a, const Jet<N>& b) {
  return Jet<N>(a) + b;
}
template <int N>
Jet<N> operator-(const Jet<N>& a, double b) {
  return a - Jet<N>(b);
}
template <int N>
Jet<N> operator-(double a, const Jet<N>& b) {
  return Jet<N>(a) - b;
}
template <int N>
Jet<N> operator*(double a, const Jet<N>& b) {
  return chain(b, a * b.value, a, 0);
}
template <int N>
Jet<N> operator*(const Jet<N>& a, double b) {
  return b * a;
}
template <int N>
Jet<N> operator/(const Jet<N>& a, double b) {
  return (1 / b) * a;
}
template <int N>
Jet<N> operator/(double a, const Jet<N>& b) {
  return Jet<N>(a) / b;
}

/// Square root; at 0 the derivatives are infinite, so the caller keeps away from it.
template <int N>
Jet<N> sqrt(const Jet<N>& a) {
  const double s = std::sqrt(a.value);
  return chain(a, s, 0.5 / s, -0.25 / (s * a.value));
}

template <int N>
Jet<N> sin(const Jet<N>& a) {
  const double s = std::sin(a.value), c = std::cos(a.value);
  return chain(a, s, c, -s);
}

template <int N>
Jet<N> cos(const Jet<N>& a) {
  const double s = std::sin(a.value), c = std::cos(a.value);
  return chain(a, c, -s, -c);
}

/// Angle of (x, y) in (-pi, pi].
template <int N>
Jet<N> atan2(const Jet<N>& y, const Jet<N>& x) {
  // d atan2 = (x dy - y dx) / (x^2 + y^2); differentiated once more for the Hessian.
  const double q = 1 / (x.value * x.value + y.value * y.value);
  Jet<N> r(std::atan2(y.value, x.value));
  r.gradient = q * (x.value * y.gradient - y.value * x.gradient);
  const typename Jet<N>::Gradient dlog = 2 * q * (x.value * x.gradient + y.value * y.gradient);
  const typename Jet<N>::Hessian cross =
      q * (y.gradient * x.gradient.transpose() - x.gradient * y.gradient.transpose());
  r.hessian = q * (x.value * y.hessian - y.value * x.hessian) + cross - r.gradient * dlog.transpose();
  // The true Hessian is symmetric; the two product terms are so only together.
  r.hessian = (0.5 * (r.hessian + r.hessian.transpose())).eval();
  return r;
}

inline double valueOf(double a) { return a; }
template <int N>
double valueOf(const Jet<N>& a) {
  return a.value;
}

}  // namespace snapwing::design
