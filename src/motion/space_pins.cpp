#include "snapwing/motion/space_pins.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "couple.h"
#include "snapwing/common/require.h"

namespace snapwing::motion {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using solver::Order;
using solver::SpacePoint;

ProductDifference::ProductDifference(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
                                     const SpacePoint& d) {
  for (const SpacePoint* vector : {&a, &b, &c, &d}) {
    coordinates_.insert(coordinates_.end(), vector->coordinates().begin(), vector->coordinates().end());
  }
  std::sort(coordinates_.begin(), coordinates_.end());
  coordinates_.erase(std::unique(coordinates_.begin(), coordinates_.end()), coordinates_.end());
  a_ = spread(a), b_ = spread(b), c_ = spread(c), d_ = spread(d);
  const MatrixXd half = a_.matrix.transpose() * b_.matrix - c_.matrix.transpose() * d_.matrix;
  curvature_ = half + half.transpose();
}

ProductDifference::Affine ProductDifference::spread(const SpacePoint& vector) const {
  Affine out{vector.rest(), Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(coordinates_.size()))};
  for (std::size_t k = 0; k < vector.coordinates().size(); ++k) {
    const auto found = std::lower_bound(coordinates_.begin(), coordinates_.end(), vector.coordinates()[k]);
    out.matrix.col(found - coordinates_.begin()) = vector.matrix().col(static_cast<Eigen::Index>(k));
  }
  return out;
}

VectorXd ProductDifference::pick(const VectorXd& y) const {
  VectorXd own(static_cast<Eigen::Index>(coordinates_.size()));
  for (Eigen::Index k = 0; k < own.size(); ++k) own(k) = y(coordinates_[k]);
  return own;
}

double ProductDifference::at(const VectorXd& own) const {
  return a_.at(own).dot(b_.at(own)) - c_.at(own).dot(d_.at(own));
}

VectorXd ProductDifference::slope(const VectorXd& own) const {
  return a_.matrix.transpose() * b_.at(own) + b_.matrix.transpose() * a_.at(own) - c_.matrix.transpose() * d_.at(own) -
         d_.matrix.transpose() * c_.at(own);
}

namespace {

SpacePoint none() { return {Eigen::Vector3d::Zero(), {}, Eigen::Matrix3Xd(3, 0)}; }

/// Sine and cosine need the same coordinates, in the same order: each product names those of all.
SpacePoint withAll(const SpacePoint& vector, const SpacePoint& other) {
  std::vector<int> coordinates = vector.coordinates();
  for (const int more : other.coordinates()) {
    if (std::find(coordinates.begin(), coordinates.end(), more) == coordinates.end()) coordinates.push_back(more);
  }
  Eigen::Matrix3Xd matrix = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(coordinates.size()));
  matrix.leftCols(vector.matrix().cols()) = vector.matrix();
  return {vector.rest(), std::move(coordinates), std::move(matrix)};
}

VectorXd middle(const VectorXd& from, const VectorXd& y) { return 0.5 * (from + y); }

}  // namespace

SpaceAngle::SpaceAngle(const Directions& body, const Directions& relative_to)
    : sine_(body.x, withAll(relative_to.y, relative_to.x), none(), none()),
      cosine_(body.x, withAll(relative_to.x, relative_to.y), none(), none()) {}

double SpaceAngle::at(const VectorXd& y) const {
  const VectorXd own = sine_.pick(y);
  return std::atan2(sine_.at(own), cosine_.at(own));
}

VectorXd SpaceAngle::slope(const VectorXd& y) const {
  const VectorXd own = sine_.pick(y);
  const double s = sine_.at(own), c = cosine_.at(own);
  return (c * sine_.slope(own) - s * cosine_.slope(own)) / (s * s + c * c);
}

MatrixXd SpaceAngle::curvature(const VectorXd& y) const {
  const VectorXd own = sine_.pick(y);
  const double s = sine_.at(own), c = cosine_.at(own), square = s * s + c * c;
  const VectorXd by_s = sine_.slope(own), by_c = cosine_.slope(own);
  const MatrixXd mixed = by_s * by_c.transpose();
  return (c * sine_.curvature() - s * cosine_.curvature()) / square +
         (2 * s * c * (by_c * by_c.transpose() - by_s * by_s.transpose()) +
          (s * s - c * c) * (mixed + mixed.transpose())) /
             (square * square);
}

double SpaceAngle::between(const VectorXd& from, const VectorXd& y) const {
  return 2 * std::remainder(at(middle(from, y)) - at(from), 2 * M_PI);
}

VectorXd SpaceAngle::slopeOver(const VectorXd& from, const VectorXd& y) const { return slope(middle(from, y)); }

MatrixXd SpaceAngle::curvatureOver(const VectorXd& from, const VectorXd& y) const {
  return 0.5 * curvature(middle(from, y));
}

SpaceHub::SpaceHub(std::string name, const SpacePoint& moment_x, const SpacePoint& moment_y, const Directions& crank,
                   double stiffness)
    : name_(std::move(name)),
      sine_(moment_x, crank.y, moment_y, crank.x),
      cosine_(moment_x, crank.x, SpacePoint(-moment_y.rest(), moment_y.coordinates(), -moment_y.matrix()), crank.y),
      stiffness_(stiffness) {
  common::Require("term '" + name_ + "'")(stiffness > 0 && std::isfinite(stiffness), "stiffness", stiffness, "> 0 N m");
}

double SpaceHub::twist(const VectorXd& y) const {
  const VectorXd own = sine_.pick(y);
  return std::atan2(sine_.at(own), cosine_.at(own));
}

void SpaceHub::evaluate(const solver::Point& at, Order order, solver::Sum& sum) const {
  const VectorXd own = sine_.pick(at.y);
  const double g = sine_.at(own), energy = 0.5 * stiffness_ * g * g, force = stiffness_ * g;
  sum.energy += energy;
  sum.stored += energy;
  if (order == Order::ENERGY) return;
  const VectorXd slope = sine_.slope(own);
  for (Eigen::Index k = 0; k < slope.size(); ++k) sum.gradient(sine_.coordinates()[k]) += force * slope(k);
  sum.noteForce(std::abs(force) * slope.norm());
  sum.noteRounding(std::numeric_limits<double>::epsilon() * stiffness_ * slope.norm());
  if (!elasticity::withTangent(order)) return;
  MatrixXd block = stiffness_ * slope * slope.transpose();
  if (order == Order::TANGENT) block += force * sine_.curvature();
  addCouple(block, sum);
}

}  // namespace snapwing::motion
