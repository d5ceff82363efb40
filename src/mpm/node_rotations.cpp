// How far a solid has turned at each node.
#include <Eigen/LU>
#include <cmath>

#include "snapwing/common/elementary.h"
#include "snapwing/mpm/discretisation.h"

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
  Eigen::VectorXd value;
  Eigen::Matrix<double, D, Eigen::Dynamic> slope;
  int body = -1;
  for (int c = 0; c < cellCount(); ++c) {
    if (cell_body_[c] != body) {
      body = cell_body_[c];
      grids_[body].weights(Vector<D>::Constant(0.5), value, slope);
    }
    elasticity::Matrix<D> f = elasticity::Matrix<D>::Identity();
    for (int a = 0; a < stencil_; ++a) f += u.template segment<D>(D * cellNodes(c)[a]) * slope.col(a).transpose();
    for (int a = 0; a < stencil_; ++a) mean[cellNodes(c)[a]] += cells_[c].density * f;
  }
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
