#include "linkage_elastic_model.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "snapwing/common/error.h"

namespace snapwing::design {

using Eigen::Matrix;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

/// u_a (2), theta_a, u_b (2), theta_b, X (4)  ->  d (2), theta_a, theta_b, D (2).
Matrix<double, 6, 10> elementMap(const BeamNode& a, const BeamNode& b) {
  Matrix<double, 6, 10> map = Matrix<double, 6, 10>::Zero();
  for (int k = 0; k < 2; ++k) {
    map(k, k) = -1;
    map(k, 3 + k) = 1;
    map(4 + k, 6 + k) = b.on1 - a.on1;
    map(4 + k, 8 + k) = b.on2 - a.on2;
  }
  map(2, 2) = 1;
  map(3, 5) = 1;
  return map;
}

void addMoment(VectorXd* f, const Attachment& at, double moment) {
  (*f)[3 * at.a + 2] += (1 - at.s) * moment;
  (*f)[3 * at.b + 2] += at.s * moment;
}

}  // namespace

ElasticLinkage::Model::Model(const FourBar& b, const WingBars& wing_bars, const ElasticSettings& s)
    : bar(b), bars(wing_bars), settings(s), section(wing_bars), mesh(b, s), rows(mesh) {
  row_scale = section.EA / 0.01;
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(rows.H.transpose());
  rank = static_cast<int>(qr.rank());
  const MatrixXd Q = qr.householderQ();
  free = Q.rightCols(size() - rank);
}

Vector2d ElasticLinkage::Model::restOf(int node) const {
  const BeamNode& n = mesh.nodes[static_cast<std::size_t>(node)];
  return n.constant + n.on1 * bar.joint1 + n.on2 * bar.joint2;
}

VectorXd ElasticLinkage::Model::driven(double theta) const {
  VectorXd h = VectorXd::Zero(rows.H.rows());
  const Vector2d port = restOf(mesh.port.a);
  h.head<2>() = Eigen::Rotation2Dd(bar.crank_sign * theta) * port - port;
  return h;
}

VectorXd ElasticLinkage::Model::friction(double theta) const {
  VectorXd f = VectorXd::Zero(size());
  const PinMoments M = frictionAt(bar, bars, theta);
  addMoment(&f, mesh.wing1, M.joint1);
  addMoment(&f, mesh.arm1, -M.joint1);
  addMoment(&f, mesh.wing2, M.joint2);
  addMoment(&f, mesh.rocker2, -M.joint2);
  addMoment(&f, mesh.auxiliary, M.auxiliary);
  addMoment(&f, mesh.axle, M.axle);
  return f;
}

bool ElasticLinkage::Model::rigidGuess(double theta, VectorXd* q) const {
  const auto pose = poseAt(bar, theta);
  if (!pose) return false;
  const double angles[3] = {bar.crank_sign * theta, pose->wing_rotation, pose->rocker_rotation};
  const Vector2d from[3] = {Vector2d::Zero(), bar.joint1, bar.auxiliary};
  const Vector2d to[3] = {Vector2d::Zero(), pose->joint1, bar.auxiliary};
  q->resize(size());
  for (int i = 0; i < static_cast<int>(mesh.nodes.size()); ++i) {
    const int body = mesh.body_of_node[static_cast<std::size_t>(i)];
    const Vector2d rest = restOf(i);
    q->segment<2>(3 * i) = to[body] + Eigen::Rotation2Dd(angles[body]) * (rest - from[body]) - rest;
    (*q)[3 * i + 2] = angles[body];
  }
  return true;
}

Matrix<double, 6, 1> ElasticLinkage::Model::elementVariables(const BeamElement& e, const VectorXd& q) const {
  Matrix<double, 6, 1> at;
  at << q.segment<2>(3 * e.b) - q.segment<2>(3 * e.a), q[3 * e.a + 2], q[3 * e.b + 2], restOf(e.b) - restOf(e.a);
  return at;
}

ElasticLinkage::Terms ElasticLinkage::Model::terms(const VectorXd& q, bool with_X) const {
  Terms t;
  t.gradient.setZero(size());
  t.hessian.setZero(size(), size());
  if (with_X) t.mixed.setZero(size(), 4);
  for (const BeamElement& e : mesh.elements) {
    const Jet<6> energy = elementEnergy(section, elementVariables(e, q));
    const auto map = elementMap(mesh.nodes[static_cast<std::size_t>(e.a)], mesh.nodes[static_cast<std::size_t>(e.b)]);
    const Matrix<double, 10, 1> g = map.transpose() * energy.gradient;
    const Matrix<double, 10, 10> H = map.transpose() * energy.hessian * map;
    t.energy += energy.value;
    const int at[2] = {3 * e.a, 3 * e.b};
    for (int i = 0; i < 2; ++i) {
      t.gradient.segment<3>(at[i]) += g.segment<3>(3 * i);
      for (int j = 0; j < 2; ++j) t.hessian.block<3, 3>(at[i], at[j]) += H.block<3, 3>(3 * i, 3 * j);
      if (with_X) t.mixed.block<3, 4>(at[i], 0) += H.block<3, 4>(3 * i, 6);
    }
    if (with_X) t.by_X += g.tail<4>();
  }
  return t;
}

Eigen::PartialPivLU<MatrixXd> ElasticLinkage::Model::saddle(const MatrixXd& K) const {
  const int n = size(), m = static_cast<int>(rows.H.rows());
  MatrixXd all = MatrixXd::Zero(n + m, n + m);
  all.topLeftCorner(n, n) = K;
  all.topRightCorner(n, m) = row_scale * rows.H.transpose();
  all.bottomLeftCorner(m, n) = row_scale * rows.H;
  return Eigen::PartialPivLU<MatrixXd>(all);
}

bool ElasticLinkage::Model::minimum(const MatrixXd& K) const {
  const MatrixXd reduced = free.transpose() * K * free;
  return Eigen::LLT<MatrixXd>(reduced).info() == Eigen::Success;
}

Vector2d ElasticLinkage::Model::displacement(const Attachment& at, const VectorXd& q) const {
  return (1 - at.s) * q.segment<2>(3 * at.a) + at.s * q.segment<2>(3 * at.b);
}

void ElasticLinkage::Model::describe(ElasticState* s) const {
  s->joint1 = bar.joint1 + displacement(mesh.wing1, s->q);
  s->joint2 = bar.joint2 + displacement(mesh.wing2, s->q);
  s->tip = bar.tip + s->q.segment<2>(3 * mesh.tip);
  s->wing_rotation = s->q[3 * mesh.wing2.b + 2];
  s->constraint_residual = (rows.H * s->q - driven(s->theta)).cwiseAbs().maxCoeff();
  s->largest_stress = 0;
  for (const BeamElement& e : mesh.elements) {
    s->largest_stress = std::max(s->largest_stress, elementStress(section, elementVariables(e, s->q)));
  }
  const Terms t = terms(s->q, false);
  s->energy = t.energy;
  s->stable = minimum(t.hessian);
}

}  // namespace snapwing::design
