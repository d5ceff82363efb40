#include "snapwing/elasticity/neo_hookean.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "neo_hookean_point.h"
#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"

namespace snapwing::elasticity {

template <int D>
NeoHookean<D>::NeoHookean(const Material& material, const DensityInterpolation& interpolation, Plane plane, Part part)
    : interpolation_(interpolation), plane_stress_(D == 2 && plane == Plane::STRESS) {
  material.validate();
  interpolation.validate();
  if (plane_stress_ && part != Part::ALL) throw common::Error("plane stress takes only the whole energy");
  NeoHookeanModuli& m = moduli_;
  m.mu = part == Part::VOLUME ? 0 : material.mu();
  m.log_mu = m.mu;
  m.lambda = part == Part::SHEAR ? 0 : material.lambda();
  m.linear_lambda = plane_stress_ ? 2 * m.mu * m.lambda / (m.lambda + 2 * m.mu) : m.lambda;
}

void ThicknessStretch::search(const NeoHookeanModuli& m, double z) {
  t = -m.lambda * z / (2 * m.mu + m.lambda);
  if (t > NEAR) t = std::min(t, 0.5 * common::log1p(-m.lambda * z / m.mu));
  for (int i = 0; i < 60; ++i) {
    grown = common::expm1(2 * t);
    const double step = (m.mu * grown + m.lambda * (z + t)) / (2 * m.mu * (grown + 1) + m.lambda);
    t -= step;
    if (step * step <= 1e-17 * std::abs(t)) break;
  }
  grown = common::expm1(2 * t);
  beyond = 0.5 * grown - t;
}

namespace {

template <int D>
VolumeEnergy volumeEnergy(const NeoHookeanModuli& m, bool plane_stress, double z) {
  if (!plane_stress) return VolumeEnergy(m, z);
  ThicknessStretch e;
  e.find(m, z);
  return VolumeEnergy(m, z, e);
}

template <int D>
void toResponse(const PointResponse<D>& from, Response<D>& out) {
  using Values = Eigen::Map<const Matrix<D>>;
  out.energy = from.energy;
  out.stress = Values(from.stress);
  out.compact = true;
  out.tangent.b = from.b;
  out.tangent.c = from.c;
  out.tangent.q = Values(from.q);
}

}  // namespace

template <int D>
bool NeoHookean<D>::hyperelastic(const Matrix<D>& f, Response<D>& out) const {
  double h[D * D];
  Eigen::Map<Matrix<D>>{h} = f - Matrix<D>::Identity();
  const Volume volume = volumeAt<D>(h);
  out.det_f = volume.det;
  if (!(volume.det > 0)) return false;
  toResponse<D>(hyperelasticAt<D>(moduli_, h, volume, volumeEnergy<D>(moduli_, plane_stress_, volume.z)), out);
  return true;
}

template <int D>
double NeoHookean<D>::linearEnergy(const Matrix<D>& h) const {
  const double trace = h.trace();
  return 0.25 * moduli_.mu * (h + h.transpose()).squaredNorm() + 0.5 * moduli_.linear_lambda * trace * trace;
}

template <int D>
Matrix<D> NeoHookean<D>::linearStress(const Matrix<D>& h) const {
  return moduli_.mu * (h + h.transpose()) + moduli_.linear_lambda * h.trace() * Matrix<D>::Identity();
}

/// Closed form in the frame of the singular values s: d scaling modes from a d x d matrix, and for each pair of axes a
/// twist, mu + g'/(s_i s_j), and a flip, mu - g'/(s_i s_j).
template <int D>
FullTangent<D> NeoHookean<D>::projected(const Matrix<D>& f, Order order) const {
  using Vector = Eigen::Matrix<double, D, 1>;
  const Eigen::JacobiSVD<Matrix<D>> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector s = svd.singularValues();
  const double mu = moduli_.mu;
  const VolumeEnergy v = volumeEnergy<D>(moduli_, plane_stress_, common::log(f.determinant()));
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
      scaling(i, j) = v.curvature / (s(i) * s(j)) + (i == j ? mu - v.slope / (s(i) * s(i)) : 0.0);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix<D>> eigen(scaling);
  for (int i = 0; i < D; ++i) add(eigen.eigenvectors().col(i).asDiagonal(), eigen.eigenvalues()(i));
  for (int i = 0; i < D; ++i) {
    for (int j = i + 1; j < D; ++j) {
      Matrix<D> mode = Matrix<D>::Zero();
      mode(i, j) = mode(j, i) = std::sqrt(0.5);
      add(mode, mu - v.slope / (s(i) * s(j)));
      mode(i, j) = -mode(i, j);
      add(mode, mu + v.slope / (s(i) * s(j)));
    }
  }
  return result;
}

template <int D>
SharedTangent NeoHookean<D>::linearTangent(const DensityInterpolation::Value& m) const {
  const double rest = 1 - m.mix * m.mix, shear = m.stiffness * rest * moduli_.mu;
  return {shear, m.stiffness * rest * moduli_.linear_lambda, shear};
}

template <int D>
SharedTangent NeoHookean<D>::shared(const DensityInterpolation::Value& m, Order order) const {
  if (order != Order::TANGENT) return {};  // projections are of the whole tangent
  SharedTangent result = linearTangent(m);
  result.a = m.stiffness * m.mix * m.mix * moduli_.mu + result.a;
  return result;
}

template <int D>
bool NeoHookean<D>::evaluatePrepared(const Matrix<D>& f, const DensityInterpolation::Value& cell, Order order,
                                     Response<D>& out) const {
  double h[D * D], mixed[D * D];
  Eigen::Map<Matrix<D>>{h} = f - Matrix<D>::Identity();
  for (int k = 0; k < D * D; ++k) mixed[k] = cell.mix * h[k];
  const Volume volume = volumeAt<D>(mixed);
  out.det_f = volume.det;
  if (!(volume.det > 0)) return false;
  PointResponse<D> r = hyperelasticAt<D>(moduli_, mixed, volume, volumeEnergy<D>(moduli_, plane_stress_, volume.z));
  mixLinear<D>(moduli_, h, cell.stiffness, cell.mix, r);
  toResponse<D>(r, out);
  if (withTangent(order) && order != Order::TANGENT) {
    const Eigen::Map<const Matrix<D>> change(mixed);
    out.full = cell.stiffness * cell.mix * cell.mix * projected(Matrix<D>::Identity() + change, order) +
               fullTangent<D>(linearTangent(cell), Response<D>());
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
  d_stress = m.stiffness_slope * (m.mix * r.stress + rest * linear_stress) +
             m.stiffness * m.mix_slope *
                 (r.stress + m.mix * tangentTimes<D>({moduli_.mu, 0, 0}, r, h) - 2 * m.mix * linear_stress);
  return true;
}

/// P = mu F + g'(ln J) / J cof F.
template <int D>
void NeoHookean<D>::writeStress(TaylorTape& tape) const {
  using Node = TaylorTape::Node;
  std::vector<Node> cofactor;  // by columns, as F
  std::vector<double> sign(D * D, 1.0);
  if constexpr (D == 2) {
    cofactor = {3, 2, 1, 0};
    sign = {1, -1, -1, 1};
  } else {
    for (int j = 0; j < D; ++j) {
      for (int i = 0; i < D; ++i) {
        const int i1 = (i + 1) % D, i2 = (i + 2) % D, j1 = (j + 1) % D, j2 = (j + 2) % D;
        cofactor.push_back(tape.sum({{1, i1 + D * j1, i2 + D * j2}, {-1, i1 + D * j2, i2 + D * j1}}));
      }
    }
  }
  std::vector<TaylorTape::Product> first_column;
  for (int i = 0; i < D; ++i) first_column.push_back({sign[i], i, cofactor[i]});
  const Node det = tape.sum(first_column);
  std::vector<TaylorTape::Share> slope;  // g' + log_mu
  if (plane_stress_ || moduli_.lambda != 0) {
    const Node log = tape.log(det);
    slope.push_back({moduli_.lambda, log});
    if (plane_stress_) slope.push_back({moduli_.lambda, tape.exponentialRoot(moduli_.mu, moduli_.lambda, log)});
  }
  const Node pressure = tape.quotient(slope, -moduli_.log_mu, det);
  for (int k = 0; k < D * D; ++k) tape.result({{sign[k], pressure, cofactor[k]}}, {{moduli_.mu, k}});
}

template class NeoHookean<2>;
template class NeoHookean<3>;

}  // namespace snapwing::elasticity
