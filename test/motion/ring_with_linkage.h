#pragma once
/// Equations of motion of a rigid ring that tumbles in space with one wing's linkage on it.

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>

#include "snapwing/motion/wing_linkage.h"
#include "snapwing/solver/rigid_inertia_term.h"

namespace snapwing::test {

/// A ring with one linkage, and nothing else: the ring as a rigid body about a point beside the axle, its axes those of
/// the linkage. Kinetic energy as a form of (V, W, q'): velocity of the axle's place and angular velocity in the ring's
/// axes, rate of the crank.
class RingWithLinkage {
 public:
  explicit RingWithLinkage(const motion::WingLinkage& linkage) : linkage_(linkage) {}

  static solver::RigidMass ringMass() {
    return solver::RigidMass::of(0.06, Eigen::Vector3d(0.01, 0.005, -0.02),
                                 Eigen::Vector3d(2e-4, 3.5e-4, 2.4e-4).asDiagonal());
  }
  static Eigen::Vector3d ringPoint() { return {-0.1, 0.02, 0.015}; }

  /// Place of each body (ring, crank, wing, rocker) in the ring's axes: [rotation, origin; 0, 1].
  std::array<Eigen::Matrix4d, 4> places(double q) const {
    const motion::LinkagePose pose = linkage_.at(q);
    const auto turned = [](double angle, const Eigen::Vector2d& x) -> Eigen::Vector2d {
      return Eigen::Rotation2Dd(angle) * x;
    };
    const Eigen::Vector2d pin1 = turned(q, linkage_.joint1());
    const std::array<double, 3> angles{q, pose.wing, pose.rocker};
    const std::array<Eigen::Vector2d, 3> origins{Eigen::Vector2d::Zero(), pin1 - turned(pose.wing, linkage_.joint1()),
                                                 linkage_.auxiliary() - turned(pose.rocker, linkage_.auxiliary())};
    std::array<Eigen::Matrix4d, 4> out;
    out.fill(Eigen::Matrix4d::Identity());
    out[0].topRightCorner<3, 1>() = ringPoint();
    for (int k = 0; k < 3; ++k) {
      out[k + 1].topLeftCorner<3, 3>() = Eigen::AngleAxisd(angles[k], Eigen::Vector3d::UnitZ()).matrix();
      out[k + 1].topRightCorner<2, 1>() = origins[k];
    }
    return out;
  }
  /// Velocities of a bar's points per rate of the crank: [x; 1] -> velocity.
  Eigen::Matrix<double, 3, 4> byTheCrank(int bar, double q) const {
    const motion::LinkagePose pose = linkage_.at(q);
    const std::array<double, 3> rates{1, pose.wing_rate, pose.rocker_rate};
    const std::array<Eigen::Matrix4d, 4> now = places(q);
    const Eigen::Matrix3d k = solver::skewOf(Eigen::Vector3d::UnitZ());
    const auto way = [](const Eigen::Vector2d& x) { return Eigen::Vector3d(x(0), x(1), 0); };
    const auto across = [&](int of, const Eigen::Vector2d& x) -> Eigen::Vector3d {
      return rates[of] * (k * (now[of + 1].topLeftCorner<3, 3>() * way(x)));
    };
    Eigen::Matrix<double, 3, 4> out;
    out.leftCols<3>() = rates[bar] * k * now[bar + 1].topLeftCorner<3, 3>();
    out.col(3).setZero();
    if (bar == 1) out.col(3) = across(0, linkage_.joint1()) - across(1, linkage_.joint1());
    if (bar == 2) out.col(3) = -across(2, linkage_.auxiliary());
    return out;
  }
  /// Velocities of a body's points per unit of (V, W, q'): [x; 1] -> velocity.
  Eigen::Matrix<double, 3, 4> velocity(int body, double q, int unit) const {
    Eigen::Matrix<double, 3, 4> out = Eigen::Matrix<double, 3, 4>::Zero();
    if (unit < 3) {
      out(unit, 3) = 1;
    } else if (unit == 6) {
      if (body > 0) out = byTheCrank(body - 1, q);
    } else {
      out = solver::skewOf(Eigen::Vector3d::Unit(unit - 3)) * places(q)[body].topRows<3>();
    }
    return out;
  }
  using Matrix7 = Eigen::Matrix<double, 7, 7>;
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  Matrix7 mass(double q) const {
    Matrix7 m = Matrix7::Zero();
    for (int body = 0; body < 4; ++body) {
      const solver::RigidMass own =
          body == 0 ? ringMass() : linkage_.mass(static_cast<motion::WingLinkage::Body>(body - 1));
      Eigen::Matrix4d g;
      g << own.second, own.first, own.first.transpose(), own.mass;
      std::array<Eigen::Matrix<double, 3, 4>, 7> units;
      for (int a = 0; a < 7; ++a) units[a] = velocity(body, q, a);
      for (int a = 0; a < 7; ++a) {
        for (int b = 0; b < 7; ++b) m(a, b) += (units[a] * g * units[b].transpose()).trace();
      }
    }
    return m;
  }
  struct State {
    Vector7 momentum;  ///< dT/d(V, W, q')
    double q = 0;
    Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
    Eigen::Vector3d x = Eigen::Vector3d::Zero();  ///< of the axle's place
    State plus(double h, const State& rate) const {
      return {momentum + h * rate.momentum, q + h * rate.q, r + h * rate.r, x + h * rate.x};
    }
  };
  /// Lagrange's equation of q, and those of a rigid body's momenta in axes that move with it.
  State rateOf(const State& s) const {
    constexpr double H = 1e-4;
    const Vector7 xi = mass(s.q).ldlt().solve(s.momentum);
    const Eigen::Vector3d v = xi.head<3>(), w = xi.segment<3>(3), p = s.momentum.head<3>(),
                          l = s.momentum.segment<3>(3);
    State out;
    out.momentum.head<3>() = p.cross(w);
    out.momentum.segment<3>(3) = l.cross(w) + p.cross(v);
    out.momentum(6) = 0.5 * xi.dot((mass(s.q + H) - mass(s.q - H)) * xi) / (2 * H);
    out.q = xi(6);
    out.r = s.r * solver::skewOf(w);
    out.x = s.r * v;
    return out;
  }
  State after(State s, double seconds, int steps) const {
    const double h = seconds / steps;
    for (int k = 0; k < steps; ++k) {
      const State a = rateOf(s), b = rateOf(s.plus(h / 2, a)), c = rateOf(s.plus(h / 2, b)), d = rateOf(s.plus(h, c));
      s = s.plus(h / 6, a).plus(h / 3, b).plus(h / 3, c).plus(h / 6, d);
    }
    return s;
  }

 private:
  const motion::WingLinkage& linkage_;
};

}  // namespace snapwing::test
