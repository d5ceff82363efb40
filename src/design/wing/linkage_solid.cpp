#include "snapwing/design/wing/linkage_solid.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "linkage_solid_joints.h"
#include "snapwing/common/error.h"

namespace snapwing::design {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector4d;
using Eigen::VectorXd;

namespace {

constexpr double FORCE_TOLERANCE = 1e-12;  ///< of E times the section
constexpr double STIFFNESS_LENGTH = 0.01;  ///< [m] weight of the joints: as stiff as this much of a bar
constexpr double ENERGY_FLOOR = 1e-15;     ///< of E times the volume: energies of single cells round at that size
constexpr double GAP_TOLERANCE = 1e-13;    ///< [m] times the joints' weight: an error of 1e-11 E times the section

template <int D>
double vonMises(const elasticity::Matrix<D>& cauchy) {
  Matrix3d s = Matrix3d::Zero();
  s.topLeftCorner<D, D>() = cauchy;
  s -= s.trace() / 3 * Matrix3d::Identity();
  return std::sqrt(1.5) * s.norm();
}

template <int D>
class SolidLinkage : public LinkageModel {
 public:
  SolidLinkage(const FourBar& layout, const WingBars& bars, const SolidSettings& s)
      : layout_(layout),
        settings_(s),
        mesh_(layout, bars, s),
        joints_(layout, bars, s, mesh_),
        equilibrium_(mesh_.solid(), joints_.rows(), joints_.names(), solverSettings(bars, s, mesh_.volume())) {}

  ElasticState solve(double theta, const ElasticState* guess) const override;
  ElasticSensitivity sensitivity(const ElasticState& state) const override;
  Vector4d gradient(const ElasticState& state, const StateSlopes& L) const override;
  const FourBar& layout() const override { return layout_; }
  int unknowns() const override { return mesh_.solid()->dofCount(); }

 private:
  static solver::JointSettings solverSettings(const WingBars& bars, const SolidSettings& s, double volume) {
    const double EA = bars.youngs_modulus * bars.width * bars.thickness;
    solver::JointSettings solver;
    solver.enforcement = s.solver;
    solver.max_iterations = s.max_iterations;
    solver.force_tolerance = FORCE_TOLERANCE * EA;
    solver.energy_floor = ENERGY_FLOOR * bars.youngs_modulus * volume;
    solver.gap_tolerance = GAP_TOLERANCE;
    solver.stiffness = EA / STIFFNESS_LENGTH;
    solver.threads = s.threads;
    return solver;
  }
  VectorXd rigidGuess(const FourBarPose& pose, double theta) const;
  void describe(const solver::JointResult& result, double rotation_near, ElasticState* state) const;
  double largestStress(const VectorXd& u) const;
  /// What the derivatives start from: tangent at the state and the change of both equations by X at fixed u, lambda.
  struct Linearised {
    solver::Evaluation at;
    mpm::MapDerivative<D> map;
    MatrixXd forces, rows;
  };
  Linearised linearise(const ElasticState& state) const;
  NodeWeights wingPiece() const { return mesh_.difference(COUPLER_BAR, 1, settings_.grip); }
  /// Derivative of the wing's rotation: Im(dz / (1 + z)), z = Du / d. As a vector that acts on Du, and by X.
  Vector2d rotationOnPiece(const ElasticState& state) const;
  Eigen::RowVector4d rotationByX(const ElasticState& state) const;

  FourBar layout_;
  SolidSettings settings_;
  SolidMesh<D> mesh_;
  SolidJoints<D> joints_;
  mutable solver::JointEquilibrium<D> equilibrium_;  ///< its factor changes with every solve
};

template <int D>
VectorXd SolidLinkage<D>::rigidGuess(const FourBarPose& pose, double theta) const {
  const double angles[SOLID_BARS] = {layout_.crank_sign * theta, pose.wing_rotation, pose.wing_rotation,
                                     pose.rocker_rotation};
  const Vector2d from[SOLID_BARS] = {Vector2d::Zero(), layout_.joint1, layout_.joint1, layout_.auxiliary};
  const Vector2d to[SOLID_BARS] = {Vector2d::Zero(), pose.joint1, pose.joint1, layout_.auxiliary};
  VectorXd u = VectorXd::Zero(unknowns());
  for (int node = 0; node < mesh_.solid()->nodeCount(); ++node) {
    const int bar = mesh_.solid()->nodeBody(node);
    const Vector2d rest = mesh_.rest(node);
    u.segment<2>(D * node) = to[bar] + Eigen::Rotation2Dd(angles[bar]) * (rest - from[bar]) - rest;
  }
  return u;
}

template <int D>
ElasticState SolidLinkage<D>::solve(double theta, const ElasticState* guess) const {
  ElasticState state;
  state.theta = theta;
  const auto pose = poseAt(layout_, theta);
  const bool given = guess != nullptr && guess->q.size() == unknowns();
  VectorXd start = VectorXd::Zero(unknowns());
  if (given) {
    start = guess->q;
  } else if (pose) {
    start = rigidGuess(*pose, theta);
  }
  const solver::JointResult result = equilibrium_.solve(joints_.friction(theta), joints_.driven(theta), start);
  state.iterations = result.iterations;
  state.message = result.message;
  switch (result.status) {
    case solver::JointStatus::CONVERGED:
      state.status = ElasticStatus::CONVERGED;
      break;
    case solver::JointStatus::RANK_DEFICIENT:
      state.status = ElasticStatus::RANK_DEFICIENT;
      return state;
    default:
      state.status = ElasticStatus::NOT_CONVERGED;
      state.message += " at theta = " + std::to_string(theta) + " rad";
      if (!result.u.allFinite() || !result.at.finite) return state;
  }
  describe(result, pose ? pose->wing_rotation : given ? guess->wing_rotation : 0, &state);
  return state;
}

template <int D>
void SolidLinkage<D>::describe(const solver::JointResult& result, double near, ElasticState* state) const {
  const VectorXd& u = result.u;
  state->q = u;
  state->forces = result.multipliers;
  state->energy = result.at.elastic_energy;
  state->joint1 = layout_.joint1 + gathered<D>(mesh_.at(COUPLER_BAR, 0), u);
  state->joint2 = layout_.joint2 + gathered<D>(mesh_.at(COUPLER_BAR, 1), u);
  state->tip = layout_.tip + gathered<D>(mesh_.at(EDGE_BAR, 1), u);
  const Complex z = complexOf(gathered<D>(wingPiece(), u)) / mesh_.bar(COUPLER_BAR).piece(2 * settings_.grip);
  const double angle = std::arg(1.0 + z);
  state->wing_rotation = angle + 2 * M_PI * std::round((near - angle) / (2 * M_PI));
  state->constraint_residual = result.constraint_residual;
  state->stable = result.stable;
  state->largest_stress = largestStress(u);
}

template <int D>
double SolidLinkage<D>::largestStress(const VectorXd& u) const {
  const auto& solid = *mesh_.solid();
  double worst = 0;
  elasticity::Response<D> response;
  for (int c = 0; c < solid.cellCount(); ++c) {
    const mpm::Term& term = solid.terms(solid.cell(c).kind).front();
    const auto& rule = solid.rule(term.rule);
    const int middle = rule.size() / 2;
    elasticity::Matrix<D> f = elasticity::Matrix<D>::Identity();
    for (int a = 0; a < solid.stencil(); ++a) {
      const Eigen::Map<const mpm::Vector<D>> slope(rule.slopeOf(middle) + D * a);
      f += u.segment<D>(D * solid.cellNodes(c)[a]) * slope.transpose();
    }
    if (!solid.model(term.model).evaluate(f, 1, elasticity::Order::STRESS, response)) continue;
    worst = std::max(worst, vonMises<D>(response.stress * f.transpose() / f.determinant()));
  }
  return worst;
}

template <int D>
typename SolidLinkage<D>::Linearised SolidLinkage<D>::linearise(const ElasticState& state) const {
  if (state.status != ElasticStatus::CONVERGED) throw common::Error("solid linkage: no derivative without equilibrium");
  Linearised l;
  l.at = equilibrium_.linearise(state.q);
  l.map = mpm::mapDerivative<D>(*mesh_.solid(), state.q, mesh_.rates());
  l.forces = l.map.force + joints_.forcesByX(state.theta, state.forces);
  l.rows = joints_.rowsByX(state.theta, state.q);
  return l;
}

template <int D>
Vector2d SolidLinkage<D>::rotationOnPiece(const ElasticState& state) const {
  const Complex d = mesh_.bar(COUPLER_BAR).piece(2 * settings_.grip);
  const Complex k = 1.0 / (d + complexOf(gathered<D>(wingPiece(), state.q)));
  return {k.imag(), k.real()};  // Im(k (x + i y)) = Im(k) x + Re(k) y
}

template <int D>
Eigen::RowVector4d SolidLinkage<D>::rotationByX(const ElasticState& state) const {
  const Complex d = mesh_.bar(COUPLER_BAR).piece(2 * settings_.grip);
  const ComplexSlopes slopes = mesh_.bar(COUPLER_BAR).pieceSlopes(2 * settings_.grip);
  const Complex moved = complexOf(gathered<D>(wingPiece(), state.q));
  Eigen::RowVector4d by_X;
  for (int k = 0; k < 4; ++k) by_X[k] = std::imag(-moved * slopes[k] / (d * (d + moved)));
  return by_X;
}

template <int D>
ElasticSensitivity SolidLinkage<D>::sensitivity(const ElasticState& state) const {
  const Linearised l = linearise(state);
  MatrixXd du, dlambda;
  equilibrium_.solveTangent(l.at, -l.forces, -l.rows, &du, &dlambda);
  ElasticSensitivity s;
  const Vector2d on_piece = rotationOnPiece(state);
  s.wing_rotation = rotationByX(state);
  for (int k = 0; k < 4; ++k) {
    s.joint1.col(k) = gathered<D>(mesh_.at(COUPLER_BAR, 0), du.col(k));
    s.joint2.col(k) = gathered<D>(mesh_.at(COUPLER_BAR, 1), du.col(k));
    s.tip.col(k) = gathered<D>(mesh_.at(EDGE_BAR, 1), du.col(k));
    s.wing_rotation[k] += on_piece.dot(gathered<D>(wingPiece(), du.col(k)));
  }
  s.joint1.leftCols<2>() += Eigen::Matrix2d::Identity();
  s.joint2.rightCols<2>() += Eigen::Matrix2d::Identity();
  s.energy = l.map.energy.transpose() + l.at.sum.solids[0].gradient.transpose() * du;
  return s;
}

template <int D>
Vector4d SolidLinkage<D>::gradient(const ElasticState& state, const StateSlopes& L) const {
  const Linearised l = linearise(state);
  VectorXd L_u = L.energy * l.at.sum.solids[0].gradient;
  scatter<D>(mesh_.at(COUPLER_BAR, 0), L.joint1, L_u);
  scatter<D>(mesh_.at(COUPLER_BAR, 1), L.joint2, L_u);
  scatter<D>(mesh_.at(EDGE_BAR, 1), L.tip, L_u);
  scatter<D>(wingPiece(), L.wing_rotation * rotationOnPiece(state), L_u);
  Vector4d L_X = L.energy * l.map.energy + L.wing_rotation * rotationByX(state).transpose();
  L_X.head<2>() += L.joint1;
  L_X.tail<2>() += L.joint2;
  MatrixXd y, z;
  equilibrium_.solveTangent(l.at, L_u, VectorXd::Zero(l.rows.rows()), &y, &z);
  return L_X - l.forces.transpose() * y.col(0) - l.rows.transpose() * z.col(0);
}

}  // namespace

void SolidSettings::validate() const {
  const auto demand = [](bool good, const char* key, double value, const char* allowed) {
    if (!good) throw common::SettingError("solid linkage", key, std::to_string(value), allowed);
  };
  demand(dimension == 2 || dimension == 3, "dimension", dimension, "2 or 3");
  demand(cells_along >= 1 && cells_along <= 400, "cells_along", cells_along, "1 to 400");
  demand(cells_across >= 1 && cells_across <= 100, "cells_across", cells_across, "1 to 100");
  demand(cells_through >= 1 && cells_through <= 40, "cells_through", cells_through, "1 to 40");
  demand(overhang > 0 && overhang <= 1, "overhang", overhang, "above 0 to 1");
  demand(driver > 0 && driver <= 10, "driver", driver, "above 0 to 10");
  demand(grip > 0 && grip <= overhang, "grip", grip, "above 0 to the overhang");
  demand(max_iterations >= 1, "max_iterations", max_iterations, "at least 1");
  demand(threads >= 1, "threads", threads, "at least 1");
  for (const GroundPin& pin : ground_pins) {
    demand(pin.body >= 0 && pin.body <= 2, "ground_pins.body", pin.body, "0, 1, 2");
    demand(pin.bar >= 0 && pin.bar <= (pin.body == 1 ? 1 : 0), "ground_pins.bar", pin.bar, "a bar of that body");
    demand(pin.fraction >= 0 && pin.fraction <= 1, "ground_pins.fraction", pin.fraction, "0 to 1");
  }
}

std::unique_ptr<LinkageModel> makeSolidLinkage(const FourBar& layout, const WingBars& bars,
                                               const SolidSettings& settings) {
  layout.validate();
  settings.validate();
  if (settings.dimension == 3) return std::make_unique<SolidLinkage<3>>(layout, bars, settings);
  return std::make_unique<SolidLinkage<2>>(layout, bars, settings);
}

}  // namespace snapwing::design
