#include "snapwing/solver/rigid_inertia_term.h"

#include <limits>
#include <utility>

namespace snapwing::solver {

RigidInertiaTerm::RigidInertiaTerm(std::string name, int dimension, int centre, const Rotation& rotation,
                                   const RigidMass& mass)
    : name_(std::move(name)), dimension_(dimension), length_(rotation.length) {
  const int d = dimension;
  block_ = Eigen::MatrixXd::Zero(1 + d, 1 + d);
  block_(0, 0) = mass.mass;
  block_.col(0).tail(d) = mass.first.head(d) / length_;
  block_.row(0).tail(d) = mass.first.head(d).transpose() / length_;
  block_.bottomRightCorner(d, d) = mass.second.topLeftCorner(d, d) / (length_ * length_);
  for (int i = 0; i < d; ++i) {
    std::vector<int>& own = couples_.emplace_back(1, centre + i);
    for (int j = 0; j < d; ++j) own.push_back(rotation.first + i + d * j);
  }
}

Eigen::VectorXd RigidInertiaTerm::pick(const Eigen::VectorXd& full, int component) const {
  Eigen::VectorXd own(1 + dimension_);
  for (int k = 0; k <= dimension_; ++k) own(k) = full(couples_[component][k]);
  return own;
}

void RigidInertiaTerm::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr) return;
  const Step& step = *at.step;
  double squared = 0, size = 0;
  for (int i = 0; i < dimension_; ++i) {
    size += pick(at.y, i).squaredNorm();
    const Eigen::VectorXd away = pick(at.y, i) - pick(step.y0, i) - step.h * pick(step.v0, i);
    const Eigen::VectorXd force = step.kappa * (block_ * away);
    sum.energy += 0.5 * force.dot(away);
    squared += force.squaredNorm();
    if (order == Order::ENERGY) continue;
    for (int k = 0; k <= dimension_; ++k) sum.gradient(couples_[i][k]) += force(k);
    if (!elasticity::withTangent(order)) continue;
    int place = (*sum.couples)[i];
    for (int b = 0; b <= dimension_; ++b) {
      for (int a = b; a <= dimension_; ++a) sum.hessian[place++] += step.kappa * block_(a, b);
    }
  }
  sum.noteForce(std::sqrt(squared));
  sum.noteRounding(std::numeric_limits<double>::epsilon() * step.kappa * block_.norm() * std::sqrt(size));
}

Eigen::Vector3d RigidInertiaTerm::momentum(const Eigen::VectorXd& v) const {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int i = 0; i < dimension_; ++i) p(i) = block_.row(0).dot(pick(v, i));
  return p;
}

Eigen::Vector3d RigidInertiaTerm::angularMomentum(const Eigen::VectorXd& y, const Eigen::VectorXd& v) const {
  // Positions are c + (L + E) X / L: the rows of [c_i, L delta_ij + E_ij] take the part of the displacements.
  Eigen::MatrixXd x(dimension_, 1 + dimension_), rate(dimension_, 1 + dimension_);
  for (int i = 0; i < dimension_; ++i) {
    x.row(i) = pick(y, i).transpose();
    x(i, 1 + i) += length_;
    rate.row(i) = pick(v, i).transpose();
  }
  const Eigen::MatrixXd w = x * block_ * rate.transpose();  // sum of m x v^T
  Eigen::Vector3d l = Eigen::Vector3d::Zero();
  l(2) = w(0, 1) - w(1, 0);
  if (dimension_ == 3) {
    l(0) = w(1, 2) - w(2, 1);
    l(1) = w(2, 0) - w(0, 2);
  }
  return l;
}

double RigidInertiaTerm::kineticEnergy(const Eigen::VectorXd& v) const {
  double energy = 0;
  for (int i = 0; i < dimension_; ++i) energy += 0.5 * pick(v, i).dot(block_ * pick(v, i));
  return energy;
}

}  // namespace snapwing::solver
