#include "snapwing/elasticity/saint_venant_kirchhoff.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "snapwing/elasticity/green_strain.h"

namespace snapwing::elasticity {

namespace {

/// A symmetric tangent without its negative eigenvalues, or with their magnitudes. Matrices of a size that the compiler
/// does not know, since it takes a minute to unroll those of 9 x 9.
Eigen::MatrixXd madePositive(const Eigen::MatrixXd& tangent, Order order) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(tangent);
  Eigen::VectorXd kept = eigen.eigenvalues();
  for (double& value : kept) value = order == Order::ABSOLUTE ? std::abs(value) : std::max(value, 0.0);
  return eigen.eigenvectors() * kept.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

template <int D>
SaintVenantKirchhoff<D>::SaintVenantKirchhoff(const Material& material, const DensityInterpolation& interpolation,
                                              Plane plane)
    : interpolation_(interpolation) {
  material.validate();
  interpolation.validate();
  mu_ = material.mu();
  lambda_ = material.lambda();
  if (D == 2 && plane == Plane::STRESS) lambda_ = 2 * mu_ * lambda_ / (lambda_ + 2 * mu_);
}

template <int D>
double SaintVenantKirchhoff<D>::energyOf(const Matrix<D>& strain) const {
  return 0.5 * lambda_ * strain.trace() * strain.trace() + mu_ * strain.squaredNorm();
}

template <int D>
Matrix<D> SaintVenantKirchhoff<D>::secondStress(const Matrix<D>& strain) const {
  return lambda_ * strain.trace() * Matrix<D>::Identity() + 2 * mu_ * strain;
}

template <int D>
Matrix<D> SaintVenantKirchhoff<D>::stressChange(const Matrix<D>& h, const Matrix<D>& d_f) const {
  const Matrix<D> f = Matrix<D>::Identity() + h;
  const Matrix<D> d_strain = 0.5 * (d_f.transpose() * f + f.transpose() * d_f);
  return d_f * secondStress(greenStrain<D>(h)) + f * secondStress(d_strain);
}

template <int D>
bool SaintVenantKirchhoff<D>::evaluatePrepared(const Matrix<D>& f, const DensityInterpolation::Value& m, Order order,
                                               Response<D>& out) const {
  const Matrix<D> h = f - Matrix<D>::Identity(), mixed = m.mix * h, linear = 0.5 * (h + h.transpose());
  const double rest = 1 - m.mix * m.mix;
  out.det_f = (Matrix<D>::Identity() + mixed).determinant();
  const Matrix<D> strain = greenStrain<D>(mixed);
  out.energy = m.stiffness * (energyOf(strain) + rest * energyOf(linear));
  if (order == Order::ENERGY) return true;
  out.stress =
      m.stiffness * (m.mix * (Matrix<D>::Identity() + mixed) * secondStress(strain) + rest * secondStress(linear));
  if (order == Order::STRESS) return true;
  out.compact = false;
  FullTangent<D> curved, straight;
  for (int l = 0; l < D; ++l) {
    for (int k = 0; k < D; ++k) {
      Matrix<D> unit = Matrix<D>::Zero();
      unit(k, l) = 1;
      const Matrix<D> one = stressChange(mixed, unit), other = secondStress(0.5 * (unit + unit.transpose()));
      curved.col(k + D * l) = Eigen::Map<const Eigen::Matrix<double, D * D, 1>>(one.data());
      straight.col(k + D * l) = Eigen::Map<const Eigen::Matrix<double, D * D, 1>>(other.data());
    }
  }
  if (order != Order::TANGENT) curved = madePositive(curved, order);
  out.full = m.stiffness * (m.mix * m.mix * curved + rest * straight);
  return true;
}

template <int D>
bool SaintVenantKirchhoff<D>::densityDerivative(const Matrix<D>& f, const DensityInterpolation::Value& m,
                                                double& d_energy, Matrix<D>& d_stress) const {
  const Matrix<D> h = f - Matrix<D>::Identity(), mixed = m.mix * h, linear = 0.5 * (h + h.transpose());
  const Matrix<D> strain = greenStrain<D>(mixed), stress = (Matrix<D>::Identity() + mixed) * secondStress(strain);
  const Matrix<D> linear_stress = secondStress(linear);
  const double rest = 1 - m.mix * m.mix, linear_energy = energyOf(linear);
  d_energy = m.stiffness_slope * (energyOf(strain) + rest * linear_energy) +
             m.stiffness * m.mix_slope * (stress.cwiseProduct(h).sum() - 2 * m.mix * linear_energy);
  d_stress = m.stiffness_slope * (m.mix * stress + rest * linear_stress) +
             m.stiffness * m.mix_slope * (stress + m.mix * stressChange(mixed, h) - 2 * m.mix * linear_stress);
  return true;
}

/// P = F S, S = lambda tr(G) I + 2 mu G, G = (F^T F - I) / 2.
template <int D>
void SaintVenantKirchhoff<D>::writeStress(TaylorTape& tape) const {
  std::vector<TaylorTape::Product> trace;  // lambda/2 tr(F^T F)
  for (int k = 0; k < D * D; ++k) trace.push_back({0.5 * lambda_, k, k});
  TaylorTape::Node second[D][D];
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j <= i; ++j) {
      std::vector<TaylorTape::Product> sum = i == j ? trace : std::vector<TaylorTape::Product>();
      for (int k = 0; k < D; ++k) sum.push_back({mu_, k + D * i, k + D * j});
      second[i][j] = second[j][i] = tape.sum(sum, {}, i == j ? -mu_ - 0.5 * D * lambda_ : 0.0);
    }
  }
  for (int j = 0; j < D; ++j) {
    for (int i = 0; i < D; ++i) {
      std::vector<TaylorTape::Product> sum;
      for (int k = 0; k < D; ++k) sum.push_back({1, i + D * k, second[k][j]});
      tape.result(sum, {});
    }
  }
}

template class SaintVenantKirchhoff<2>;
template class SaintVenantKirchhoff<3>;

}  // namespace snapwing::elasticity
