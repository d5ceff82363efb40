#include "snapwing/design/wing/wing_elastic_problem.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "wing_constraint_rows.h"

namespace snapwing::design {

using Eigen::Vector2d;
using Eigen::Vector4d;

LinkageFactory beamRung(const WingBars& bars, const ElasticSettings& settings) {
  return [=](const FourBar& layout) { return std::make_unique<ElasticLinkage>(layout, bars, settings); };
}

LinkageFactory solidRung(const WingBars& bars, const SolidSettings& settings) {
  return [=](const FourBar& layout) { return makeSolidLinkage(layout, bars, settings); };
}

ElasticWingProblem::ElasticWingProblem(const WingSettings& settings, LinkageFactory rung)
    : WingProblem(settings), rigid_(settings), rung_(rung ? std::move(rung) : beamRung(settings.bars)) {}

void ElasticWingProblem::add(const LinkageModel& linkage, const ElasticState& state, int i, bool derivatives,
                             WingEvaluation* e) const {
  const Vector2d miss = state.tip - settings_.tipTarget(i);
  const double turn = state.wing_rotation - settings_.wantedRotation(i);
  const double weight = settings_.rotation_weight * settings_.rotation_weight;
  const double alpha = i == 1 ? settings_.compliance_weight : 0;
  e->objective += miss.squaredNorm() + weight * turn * turn + alpha * state.energy;
  if (!derivatives) return;
  StateSlopes L;
  L.tip = 2 * miss;
  L.wing_rotation = 2 * weight * turn;
  L.energy = alpha;
  e->gradient += linkage.gradient(state, L);
}

void ElasticWingProblem::addSecond(const LinkageModel& linkage, const ElasticState& state, bool derivatives,
                                   WingEvaluation* e) const {
  const Vector2d between = state.joint1 - state.joint2;
  e->constraints[ROW_SEPARATION] = (settings_.separation - between.norm()) / CONSTRAINT_LENGTH;
  e->constraints[ROW_JOINT2_X] = (settings_.wall_joint2_x - state.joint2.x()) / CONSTRAINT_LENGTH;
  e->constraints[ROW_JOINT1_Y] = (state.joint1.y() - settings_.wall_joint1_y) / CONSTRAINT_LENGTH;
  if (!derivatives) return;
  const ElasticSensitivity s = linkage.sensitivity(state);
  e->jacobian.row(ROW_SEPARATION) = -between.normalized().transpose() * (s.joint1 - s.joint2) / CONSTRAINT_LENGTH;
  e->jacobian.row(ROW_JOINT2_X) = -s.joint2.row(0) / CONSTRAINT_LENGTH;
  e->jacobian.row(ROW_JOINT1_Y) = s.joint1.row(1) / CONSTRAINT_LENGTH;
}

WingEvaluation ElasticWingProblem::evaluate(const Vector4d& X, bool with_derivatives) const {
  WingEvaluation e = rigid_.evaluate(X, with_derivatives);
  e.objective = 0;
  e.gradient.setZero();
  const auto linkage = rung_(this->linkage(X));
  double rotation[2];
  Eigen::RowVector4d slope[2];
  for (int i = 0; i < 2; ++i) {
    const ElasticState state = linkage->reach(settings_.targets[i].arm_rotation);
    if (state.status != ElasticStatus::CONVERGED) {
      e.objective = std::numeric_limits<double>::infinity();
      return e;
    }
    rotation[i] = state.wing_rotation;
    add(*linkage, state, i, with_derivatives, &e);
    if (with_derivatives && settings_.dwell_weight > 0) slope[i] = linkage->sensitivity(state).wing_rotation;
    if (i == 1) addSecond(*linkage, state, with_derivatives, &e);
  }
  const double wanted = settings_.wantedRotation(1) - settings_.wantedRotation(0);
  const double excess = rotation[1] - rotation[0] - wanted, weight = settings_.dwell_weight * settings_.dwell_weight;
  e.objective += weight * excess * excess;
  if (weight > 0 && with_derivatives) e.gradient += 2 * weight * excess * (slope[1] - slope[0]).transpose();
  return e;
}

RungComparison compareRungs(const LinkageModel& linkage, const std::vector<double>& arm_rotation) {
  const auto begin = std::chrono::steady_clock::now();
  const FourBar& bar = linkage.layout();
  RungComparison c;
  c.arm_rotation = arm_rotation;
  for (const ElasticState& state : linkage.trace(arm_rotation)) {
    if (state.status != ElasticStatus::CONVERGED) {
      c.message = state.message;
      return c;
    }
    c.stored_energy.push_back(state.energy);
    c.largest_energy = std::max(c.largest_energy, state.energy);
    c.largest_stress = std::max(c.largest_stress, state.largest_stress);
    c.same_branch = c.same_branch && bar.branchOf(state.joint1, state.joint2) == bar.branch();
    c.stable = c.stable && state.stable;
    const auto pose = poseAt(bar, state.theta);
    if (!pose) {
      c.message = "the rigid loop does not close at " + std::to_string(state.theta) + " rad";
      return c;
    }
    c.largest_tip_error = std::max(c.largest_tip_error, (pose->tip - state.tip).norm());
    c.largest_rotation_error = std::max(c.largest_rotation_error, std::abs(pose->wing_rotation - state.wing_rotation));
  }
  c.converged = true;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  c.seconds_per_state = seconds / std::max<std::size_t>(1, arm_rotation.size());
  return c;
}

}  // namespace snapwing::design
