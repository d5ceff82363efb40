#pragma once
/// Pins and hubs of bars that rotate in space, as functions of directions that are fixed in the bodies. Directions are
/// affine in the full coordinates (solver::SpacePoint), so that a function of their scalar products does not change
/// when all bodies rotate together, also in the middle of a step, where directions are shorter than 1: forces of such
/// terms conserve the angular momentum of a step that conserves it.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "snapwing/motion/wing_terms.h"
#include "snapwing/solver/point_terms.h"

namespace snapwing::motion {

/// Three unit directions of a body: those of its axes x, y and z at rest.
struct Directions {
  solver::SpacePoint x, y, z;
};

/// Sum of products of two vectors each, a . b - c . d, affine vectors in one list of coordinates.
class ProductDifference {
 public:
  ProductDifference(const solver::SpacePoint& a, const solver::SpacePoint& b, const solver::SpacePoint& c,
                    const solver::SpacePoint& d);
  const std::vector<int>& coordinates() const { return coordinates_; }
  double at(const Eigen::VectorXd& own) const;              ///< @param own  values of coordinates()
  Eigen::VectorXd slope(const Eigen::VectorXd& own) const;  ///< by coordinates()
  const Eigen::MatrixXd& curvature() const { return curvature_; }
  Eigen::VectorXd pick(const Eigen::VectorXd& y) const;  ///< values of coordinates()

 private:
  struct Affine {
    Eigen::Vector3d rest;
    Eigen::Matrix3Xd matrix;
    Eigen::Vector3d at(const Eigen::VectorXd& own) const { return rest + matrix * own; }
  };
  Affine spread(const solver::SpacePoint& vector) const;
  std::vector<int> coordinates_;
  Affine a_, b_, c_, d_;
  Eigen::MatrixXd curvature_;
};

/// Angle of one body relative to another about the z of both: atan2(x . y_0, x . x_0), x of the first body, x_0 and y_0
/// of the second. In a step its change is twice that to the middle of the step, where its slope is taken as well.
class SpaceAngle : public PinAngle {
 public:
  SpaceAngle(const Directions& body, const Directions& relative_to);
  const std::vector<int>& coordinates() const override { return sine_.coordinates(); }
  double at(const Eigen::VectorXd& y) const override;
  Eigen::VectorXd slope(const Eigen::VectorXd& y) const override;
  Eigen::MatrixXd curvature(const Eigen::VectorXd& y) const override;
  double between(const Eigen::VectorXd& from, const Eigen::VectorXd& y) const override;
  Eigen::VectorXd slopeOver(const Eigen::VectorXd& from, const Eigen::VectorXd& y) const override;
  Eigen::MatrixXd curvatureOver(const Eigen::VectorXd& from, const Eigen::VectorXd& y) const override;

 private:
  ProductDifference sine_, cosine_;
};

/// HubTerm in space: k/2 g^2, g = P . y - Q . x, with x and y of the crank, P and Q the moments of the arm's nodes
/// about the axle, P = sum w X r / N, Q = sum w Y r / N, N = sum w (X^2 + Y^2), r a node's position from the axle, X
/// and Y its components at rest. In the plane it equals HubTerm's g.
class SpaceHub : public Hub {
 public:
  /// @param moment_x, moment_y  P and Q [1]; @param crank  its directions; @param stiffness  k [N m] > 0
  /// @throws common::Error
  SpaceHub(std::string name, const solver::SpacePoint& moment_x, const solver::SpacePoint& moment_y,
           const Directions& crank, double stiffness);
  std::string name() const override { return name_; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {sine_.coordinates()}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;
  double twist(const Eigen::VectorXd& y) const override;

 private:
  std::string name_;
  ProductDifference sine_, cosine_;  ///< of the angle from the crank to the nodes
  double stiffness_;
};

}  // namespace snapwing::motion
