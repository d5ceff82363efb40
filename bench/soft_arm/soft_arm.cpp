#include "soft_arm.h"

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/statics/path.h"

namespace snapwing::bench {

namespace {
constexpr double FRICTION_SPEED = 0.02;  // [m/s] as in the lumped model

struct Force {
  double value, slope;
};
Force drag(double k, double v) { return {k * std::abs(v) * v, 2 * k * std::abs(v)}; }
Force coulomb(double f, double v) {
  const double r = 1 / std::hypot(v, FRICTION_SPEED);
  return {f * v * r, f * FRICTION_SPEED * FRICTION_SPEED * r * r * r};
}
}  // namespace

SoftArm::SoftArm(const scene::CompiledScene& arm, double mass_density, int arms,
                 const vehicle::VehicleParameters& parameters, bool boom)
    : arm_(arm), problem_(arm.terms()), arms_(arms), p_(parameters), cholesky_(problem_.pattern()) {
  assembleMass(mass_density);
  // The vehicle file counts the arms in the total: the rigid ring is what they leave.
  ring_mass_ = (p_.ring_mass + (boom ? p_.boom_mass : 0)) / arms - mass_rr_;
  ring_drag_ = (p_.ring_drag + (boom ? p_.boom_drag : 0)) / arms;
  friction_ = boom ? p_.boom_friction / arms : 0;
}

void SoftArm::assembleMass(double mass_density) {
  const mpm::Discretisation<2>& solid = *arm_.planar();
  const solver::Reduction& reduction = problem_.coordinates().linear();
  const solver::SparsePattern& pattern = problem_.pattern();
  const Eigen::VectorXd b =
      reduction.expandDirection(Eigen::VectorXd::Zero(problem_.freeCount()), Eigen::VectorXd::Ones(1));
  Eigen::VectorXd e = Eigen::VectorXd::Zero(solid.dofCount());
  for (int node = 0; node < solid.nodeCount(); ++node) e(2 * node + 1) = 1;
  Eigen::VectorXd mb = Eigen::VectorXd::Zero(solid.dofCount()), me = mb;
  mass_.assign(pattern.entries(), 0.0);
  for (int c = 0; c < solid.cellCount(); ++c) {
    const mpm::Cell& cell = solid.cell(c);
    const mpm::QuadratureRule<2>& rule = solid.rule(solid.terms(cell.kind).front().rule);
    const int* nodes = solid.cellNodes(c);
    for (int i = 0; i < rule.stencil; ++i) {
      for (int j = 0; j < rule.stencil; ++j) {
        double m = 0;
        for (int q = 0; q < rule.size(); ++q) m += rule.weight[q] * rule.valueOf(q)[i] * rule.valueOf(q)[j];
        m *= mass_density * cell.density * cell.measure;
        for (int axis = 0; axis < 2; ++axis) {
          const int row = 2 * nodes[i] + axis, column = 2 * nodes[j] + axis;
          mb(row) += m * b(column);
          me(row) += m * e(column);
          for (const auto& [zr, fr] : reduction.terms(row)) {
            for (const auto& [zc, fc] : reduction.terms(column)) {
              if (zr >= zc) mass_[pattern.find(zr, zc)] += fr * fc * m;
            }
          }
        }
      }
    }
  }
  mass_zu_ = reduction.restrictToFree(mb);
  mass_zr_ = reduction.restrictToFree(me);
  mass_uu_ = b.dot(mb);
  mass_ur_ = b.dot(me);
  mass_rr_ = e.dot(me);
}

SoftArm::Bordered SoftArm::momentum(const Eigen::VectorXd& z, double u, double r) const {
  Bordered m;
  m.rz = problem_.pattern().multiply(mass_, z) + u * mass_zu_ + r * mass_zr_;
  m.ru = mass_zu_.dot(z) + mass_uu_ * u + mass_ur_ * r;
  m.rr = mass_zr_.dot(z) + mass_ur_ * u + mass_rr_ * r;
  return m;
}

SoftState SoftArm::start(double travel) const {
  std::vector<double> targets;
  const int count = std::max(1, static_cast<int>(std::ceil(std::abs(travel) / 1e-3)));
  for (int k = 0; k <= count; ++k) targets.push_back(travel * k / count);
  const statics::PathResult path =
      statics::PathFollower(problem_, {}).follow(Eigen::VectorXd::Zero(problem_.freeCount()), targets);
  if (path.status != solver::SolveStatus::CONVERGED) throw common::Error("soft arm: " + path.message);
  SoftState state;
  state.z = path.points.back().solution;
  state.z_rate = Eigen::VectorXd::Zero(problem_.freeCount());
  state.travel = travel;
  return state;
}

double SoftArm::energy(const SoftState& s) const {
  solver::Evaluation at;
  problem_.evaluate(s.z, Eigen::VectorXd::Constant(1, s.travel), solver::Order::ENERGY, at);
  const Bordered m = momentum(s.z_rate, s.travel_rate, s.ring_speed);
  const double centre = s.ring_speed - s.travel_rate;
  const double kinetic = m.rz.dot(s.z_rate) + m.ru * s.travel_rate + m.rr * s.ring_speed +
                         ring_mass_ * s.ring_speed * s.ring_speed + p_.centre_mass / arms_ * centre * centre;
  return arms_ * (0.5 * kinetic + at.energy);
}

// Unknown is the configuration at the middle of the step, x = x0 + dt/2 v; v1 = 2 v - v0.
bool SoftArm::step(SoftState* s, double demand, double dt) {
  const double wanted = demand * p_.max_thrust;
  const double lag = wanted > s->thrust ? p_.time_constant_up : p_.time_constant_down;
  const double decay = -std::expm1(-dt / lag);
  const double mean = (wanted + (s->thrust - wanted) * decay * lag / dt) / arms_;
  const double h = 0.5 * dt, centre_mass = p_.centre_mass / arms_, centre_drag = p_.centre_drag / arms_;
  const double damping = p_.damping / arms_;
  const Bordered before = momentum(s->z_rate, s->travel_rate, s->ring_speed);
  Eigen::VectorXd vz = s->z_rate;  // rates at the middle
  double vu = s->travel_rate, vr = s->ring_speed;
  solver::Evaluation at;
  Eigen::VectorXd tangent_z, tangent_p;
  for (int iteration = 0; iteration < 30; ++iteration) {
    problem_.evaluate(s->z + h * vz, Eigen::VectorXd::Constant(1, s->travel + h * vu), solver::Order::TANGENT, at);
    if (!at.finite) return false;
    problem_.controlTangent(at, Eigen::VectorXd::Ones(1), tangent_z, tangent_p);
    const Bordered now = momentum(vz, vu, vr);
    const double vc = vr - vu;
    const Force dc = drag(centre_drag, vc), dr = drag(ring_drag_, vr), rub = coulomb(friction_, vr);
    // Rates of momentum: 2 (M v - M v0) / dt.
    const Eigen::VectorXd rz = (now.rz - before.rz) / h + at.residual;
    const double centre = centre_mass * (vc - (s->ring_speed - s->travel_rate)) / h + dc.value;
    const double ru = (now.ru - before.ru) / h + at.control_force(0) + damping * vu - centre;
    const double rr =
        (now.rr - before.rr) / h + ring_mass_ * (vr - s->ring_speed) / h + dr.value + rub.value + centre - mean;
    std::vector<double> matrix(at.hessian.size());
    for (std::size_t k = 0; k < matrix.size(); ++k) matrix[k] = mass_[k] / h + h * at.hessian[k];
    if (!cholesky_.factorize(matrix) && cholesky_.factorizeIndefinite(matrix) < 0) return false;
    Eigen::MatrixXd right(rz.size(), 3);
    right.col(0) = rz;
    right.col(1) = mass_zu_ / h + h * tangent_z;
    right.col(2) = mass_zr_ / h;
    const Eigen::MatrixXd x = cholesky_.solve(right);
    const double ac = centre_mass / h + dc.slope;
    Eigen::Matrix2d a;
    a << mass_uu_ / h + h * tangent_p(0) + damping + ac, mass_ur_ / h - ac, mass_ur_ / h - ac,
        (mass_rr_ + ring_mass_) / h + dr.slope + rub.slope + ac;
    a -= right.rightCols(2).transpose() * x.rightCols(2);
    const Eigen::Vector2d b = Eigen::Vector2d(ru, rr) - right.rightCols(2).transpose() * x.col(0);
    const Eigen::Vector2d border = -a.partialPivLu().solve(b);
    const Eigen::VectorXd dz = -x.col(0) - x.rightCols(2) * border;
    vz += dz;
    vu += border(0);
    vr += border(1);
    ++iterations_;
    const double moves = h * std::max(dz.cwiseAbs().maxCoeff(), border.cwiseAbs().maxCoeff());
    if (!std::isfinite(moves)) return false;
    if (moves < 1e-11) {  // [m]
      s->z += dt * vz;
      s->travel += dt * vu;
      s->ring += dt * vr;
      s->z_rate = 2 * vz - s->z_rate;
      s->travel_rate = 2 * vu - s->travel_rate;
      s->ring_speed = 2 * vr - s->ring_speed;
      s->thrust += (wanted - s->thrust) * decay;
      s->time += dt;
      return true;
    }
  }
  return false;
}

}  // namespace snapwing::bench
