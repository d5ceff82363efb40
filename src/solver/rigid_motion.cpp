#include "snapwing/solver/rigid_motion.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "snapwing/common/error.h"

namespace snapwing::solver {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d skew(const Vector3d& n) {
  Matrix3d k;
  k << 0, -n(2), n(1), n(2), 0, -n(0), -n(1), n(0), 0;
  return k;
}

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

TurningValue sized(int count, int params) {
  TurningValue v;
  v.value = Eigen::VectorXd::Zero(count);
  v.slope = Eigen::MatrixXd::Zero(count, params);
  v.second.assign(count, Eigen::MatrixXd::Zero(params, params));
  return v;
}

template <int D>
TurningValue turnAboutAxis(const Turning& turning, double s) {
  const Matrix3d k = skew(turning.axes[0]);
  const Eigen::VectorXd first = entries<D>(k), square = entries<D>(k * k);
  const double angle = s / turning.length, sine = std::sin(angle), cosine = std::cos(angle);
  TurningValue v = sized(D * D, 1);
  v.value = turning.length * (sine * first + 2 * std::pow(std::sin(0.5 * angle), 2) * square);
  v.slope.col(0) = cosine * first + sine * square;
  for (int e = 0; e < D * D; ++e) v.second[e](0, 0) = (-sine * first(e) + cosine * square(e)) / turning.length;
  return v;
}

TurningValue turnFreely(const Turning& turning, const Vector3d& s) {
  const double length = turning.length;
  const Vector3d t = s / length;
  const double x = t.squaredNorm();
  const std::array<double, 3> a = series(x, 1), b = series(x, 2);
  const Matrix3d k = skew(t), m = k * k;
  const auto unit = [](int i) { return Vector3d(Vector3d::Unit(i)); };
  const auto dm = [&](int i) {
    return Matrix3d(unit(i) * t.transpose() + t * unit(i).transpose() - 2 * t(i) * Matrix3d::Identity());
  };
  TurningValue v = sized(9, 3);
  v.value = length * entries<3>(a[0] * k + b[0] * m);
  for (int i = 0; i < 3; ++i) {
    v.slope.col(i) = entries<3>(2 * t(i) * (a[1] * k + b[1] * m) + a[0] * skew(unit(i)) + b[0] * dm(i));
    for (int j = 0; j < 3; ++j) {
      const double same = i == j ? 1 : 0;
      const Matrix3d d2m =
          unit(i) * unit(j).transpose() + unit(j) * unit(i).transpose() - 2 * same * Matrix3d::Identity();
      const Matrix3d d2 = (4 * t(i) * t(j) * a[2] + 2 * same * a[1]) * k +
                          (4 * t(i) * t(j) * b[2] + 2 * same * b[1]) * m +
                          2 * t(i) * (a[1] * skew(unit(j)) + b[1] * dm(j)) +
                          2 * t(j) * (a[1] * skew(unit(i)) + b[1] * dm(i)) + b[0] * d2m;
      const Eigen::VectorXd flat = entries<3>(d2) / length;
      for (int e = 0; e < 9; ++e) v.second[e](i, j) = flat(e);
    }
  }
  return v;
}

}  // namespace

template <int D>
TurningValue turn(const Turning& turning, const Eigen::VectorXd& s) {
  if (turning.axes.empty()) return sized(D * D, 0);
  if (turning.axes.size() == 1) return turnAboutAxis<D>(turning, s(0));
  return turnFreely(turning, s);
}

template <>
TurningValue turn<2>(const Turning& turning, const Eigen::VectorXd& s) {
  return turning.axes.empty() ? sized(4, 0) : turnAboutAxis<2>(turning, s(0));
}

template <int D>
std::vector<Vector3d> openAxes(const Turning& turning, const std::vector<Equation>& equations,
                               std::vector<Vector3d> allowed, const std::string& name) {
  if (equations.empty() || allowed.empty()) return allowed;
  const int count = static_cast<int>(equations.size()), axes = static_cast<int>(allowed.size());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count, D * D);
  for (int n = 0; n < count; ++n) {
    for (const auto& [dof, value] : equations[n].terms) rows(n, dof - turning.first) += value;
    rows.row(n) /= rows.row(n).cwiseAbs().maxCoeff();
  }
  Eigen::MatrixXd effect(count, axes);
  for (int a = 0; a < axes; ++a) effect.col(a) = rows * entries<D>(skew(allowed[a]));
  Eigen::FullPivLU<Eigen::MatrixXd> lu(effect);
  lu.setThreshold(1e-8);
  const int open = axes - static_cast<int>(lu.rank());
  if (open == 0) return {};
  const auto unchanged = [&](const Vector3d& a, const Vector3d& b) {
    return (rows * entries<D>(skew(a) * skew(b) + skew(b) * skew(a))).cwiseAbs().maxCoeff() < 1e-8;
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

template <int D>
TurningProblem<D>::TurningProblem(std::shared_ptr<const SolidProblem<D>> inner, std::vector<Turning> turnings)
    : inner_(std::move(inner)) {
  const int count = inner_->freeCount();
  std::map<int, int> inner_of_dof;
  for (int y = 0; y < count; ++y) inner_of_dof[inner_->reduction().dofOfFree(y)] = y;
  plain_.assign(count, 0);
  for (const Turning& turning : turnings) {
    Group group;
    group.turning = turning;
    for (int e = 0; e < D * D; ++e) {
      group.inner.push_back(inner_of_dof.at(turning.first + e));
      plain_[group.inner.back()] = -1;
    }
    groups_.push_back(group);
  }
  for (int& own : plain_) {
    if (own == 0) own = free_++;
  }
  for (Group& group : groups_) {
    group.first = free_;
    group.jacobian = jacobian_size_;
    free_ += group.params();
    jacobian_size_ += D * D * group.params();
  }
  buildPattern();
}

template <int D>
typename TurningProblem<D>::Users TurningProblem<D>::users() const {
  Users result(plain_.size());
  for (std::size_t y = 0; y < plain_.size(); ++y) {
    if (plain_[y] >= 0) result[y] = {{plain_[y], 0}};
  }
  for (const Group& g : groups_) {
    for (int e = 0; e < D * D; ++e) {
      for (int k = 0; k < g.params(); ++k) {
        result[g.inner[e]].emplace_back(g.first + k, g.jacobian + e * g.params() + k);
      }
    }
  }
  return result;
}

template <int D>
void TurningProblem<D>::buildPattern() {
  const Users of = users();
  const SparsePattern& inner = inner_->pattern();
  std::vector<std::vector<int>> rows(free_);
  const auto each = [&](const auto& visit) {
    for (int c = 0; c < inner.size; ++c) {
      for (int k = inner.start[c]; k < inner.start[c + 1]; ++k) {
        const int r = inner.row[k];
        for (const auto& [row, row_slope] : of[r]) {
          for (const auto& [column, column_slope] : of[c]) {
            // A diagonal entry meets each pair twice; an entry off the diagonal stands for two.
            if (r == c && row < column) continue;
            visit(std::max(row, column), std::min(row, column), k, row_slope, column_slope,
                  r != c && row == column ? 2 : 1);
          }
        }
      }
    }
  };
  each([&](int row, int column, int, int, int, int) { rows[column].push_back(row); });
  for (const Group& g : groups_) {
    for (int a = 0; a < g.params(); ++a) {
      for (int b = 0; b <= a; ++b) rows[g.first + b].push_back(g.first + a);
    }
  }
  pattern_.size = free_;
  pattern_.start.assign(1, 0);
  for (std::vector<int>& column : rows) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    pattern_.row.insert(pattern_.row.end(), column.begin(), column.end());
    pattern_.start.push_back(pattern_.entries());
  }
  each([&](int row, int column, int source, int row_slope, int column_slope, double times) {
    items_.push_back({pattern_.find(row, column), source, row_slope, column_slope, times});
  });
}

template <int D>
std::vector<TurningValue> TurningProblem<D>::turnAll(const Eigen::VectorXd& z) const {
  std::vector<TurningValue> values;
  for (const Group& g : groups_) values.push_back(turn<D>(g.turning, z.segment(g.first, g.params())));
  return values;
}

template <int D>
Eigen::VectorXd TurningProblem<D>::innerCoordinates(const Eigen::VectorXd& z) const {
  Eigen::VectorXd y(static_cast<Eigen::Index>(plain_.size()));
  for (std::size_t k = 0; k < plain_.size(); ++k) {
    if (plain_[k] >= 0) y(k) = z(plain_[k]);
  }
  for (const Group& g : groups_) {
    const TurningValue v = turn<D>(g.turning, z.segment(g.first, g.params()));
    for (int e = 0; e < D * D; ++e) y(g.inner[e]) = v.value(e);
  }
  return y;
}

template <int D>
std::vector<double> TurningProblem<D>::jacobian(const std::vector<TurningValue>& values) const {
  std::vector<double> flat(jacobian_size_, 1.0);
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    const int params = groups_[n].params();
    for (int e = 0; e < D * D; ++e) {
      for (int k = 0; k < params; ++k) flat[groups_[n].jacobian + e * params + k] = values[n].slope(e, k);
    }
  }
  return flat;
}

template <int D>
Eigen::VectorXd TurningProblem<D>::pullBack(const Eigen::VectorXd& inner,
                                            const std::vector<TurningValue>& values) const {
  Eigen::VectorXd own = Eigen::VectorXd::Zero(free_);
  for (std::size_t y = 0; y < plain_.size(); ++y) {
    if (plain_[y] >= 0) own(plain_[y]) = inner(y);
  }
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    const Group& g = groups_[n];
    for (int e = 0; e < D * D; ++e) {
      own.segment(g.first, g.params()) += inner(g.inner[e]) * values[n].slope.row(e).transpose();
    }
  }
  return own;
}

template <int D>
void TurningProblem<D>::pullBackHessian(const Eigen::VectorXd& inner_residual, const std::vector<TurningValue>& values,
                                        bool projected, std::vector<double>& hessian) const {
  const std::vector<double> slope = jacobian(values);
  std::vector<double> own(pattern_.entries(), 0.0);
  for (const Item& i : items_) own[i.target] += i.times * slope[i.row] * slope[i.column] * hessian[i.source];
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    const Group& g = groups_[n];
    const int params = g.params();
    if (params == 0) continue;
    Eigen::MatrixXd geometric = Eigen::MatrixXd::Zero(params, params);
    for (int e = 0; e < D * D; ++e) geometric += inner_residual(g.inner[e]) * values[n].second[e];
    if (projected) {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(geometric);
      geometric =
          eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
    }
    for (int a = 0; a < params; ++a) {
      for (int b = 0; b <= a; ++b) own[pattern_.find(g.first + a, g.first + b)] += geometric(a, b);
    }
  }
  hessian.swap(own);
}

template <int D>
void TurningProblem<D>::evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order,
                                 Evaluation& out) const {
  inner_->evaluate(innerCoordinates(z), p, order, out);
  out.coordinates = z;
  if (order == Order::ENERGY || !out.finite) return;
  const std::vector<TurningValue> values = turnAll(z);
  if (order != Order::STRESS) pullBackHessian(out.residual, values, order == Order::PROJECTED, out.hessian);
  out.residual = pullBack(out.residual, values);
}

template <int D>
void TurningProblem<D>::controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                                       Eigen::VectorXd& control_part) const {
  Eigen::VectorXd inner;
  inner_->controlTangent(at, dp, inner, control_part);
  free_part = pullBack(inner, turnAll(at.coordinates));
}

template TurningValue turn<3>(const Turning&, const Eigen::VectorXd&);
template std::vector<Vector3d> openAxes<2>(const Turning&, const std::vector<Equation>&, std::vector<Vector3d>,
                                           const std::string&);
template std::vector<Vector3d> openAxes<3>(const Turning&, const std::vector<Equation>&, std::vector<Vector3d>,
                                           const std::string&);
template class TurningProblem<2>;
template class TurningProblem<3>;

}  // namespace snapwing::solver
