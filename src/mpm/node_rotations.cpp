// How far a solid has turned at each node.
#include <Eigen/LU>
#include <cmath>

#include "centre_gradients.h"
#include "snapwing/common/elementary.h"

namespace snapwing::mpm {

namespace {

/// Orthogonal part of f by Newton's iteration [Higham 1986]; I where f has no positive determinant.
template <int D>
elasticity::Matrix<D> polarRotation(const elasticity::Matrix<D>& f) {
  constexpr int MOST = 30;
  constexpr double EXACT = 1e-12;
  if (!(f.determinant() > 0)) return elasticity::Matrix<D>::Identity();
  elasticity::Matrix<D> rotation = f;
  for (int k = 0; k < MOST; ++k) {
    const elasticity::Matrix<D> next = 0.5 * (rotation + rotation.inverse().transpose());
    const double change = (next - rotation).norm();
    rotation = next;
    if (change < EXACT) return rotation;
  }
  return elasticity::Matrix<D>::Identity();
}

}  // namespace

template <int D>
std::vector<elasticity::Matrix<D>> Discretisation<D>::nodeRotations(const Eigen::VectorXd& u) const {
  std::vector<elasticity::Matrix<D>> mean(static_cast<std::size_t>(nodeCount()), elasticity::Matrix<D>::Zero());
  eachCentreGradient(*this, u, [&](int cell, const elasticity::Matrix<D>& f) {
    for (int a = 0; a < stencil_; ++a) mean[cellNodes(cell)[a]] += cells_[cell].density * f;
  });
  for (elasticity::Matrix<D>& f : mean) {
    // Newton's iteration ends in few rounds from about unit size.
    const double size = common::pow(std::abs(f.determinant()), 1.0 / D);
    f = size > 0 ? polarRotation<D>(f / size) : elasticity::Matrix<D>::Identity();
  }
  return mean;
}

template std::vector<elasticity::Matrix<2>> Discretisation<2>::nodeRotations(const Eigen::VectorXd&) const;
template std::vector<elasticity::Matrix<3>> Discretisation<3>::nodeRotations(const Eigen::VectorXd&) const;

}  // namespace snapwing::mpm
