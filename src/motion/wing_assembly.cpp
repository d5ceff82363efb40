#include "snapwing/motion/wing_assembly.h"

#include <cmath>

#include "snapwing/common/plain_text.h"

namespace snapwing::motion {

using solver::Equation;
using solver::Term;

namespace {

constexpr double LENGTH = 0.05;  // [m] of rotations: that of the bars
/// [rad/s] friction is smooth below: a wing turns some 30 rad a metre of travel, the lumped model's rounding is .02
/// m/s.
constexpr double FRICTION_RATE = 0.6;
constexpr const char* SIDES[2] = {"right", "left"};

}  // namespace

WingAssembly::WingAssembly(std::shared_ptr<const WingLinkage> linkage, std::vector<Wing> wings, int dimension,
                           int first, int first_entry)
    : linkage_(std::move(linkage)),
      wings_(std::move(wings)),
      dimension_(dimension),
      first_(first),
      first_entry_(first_entry >= 0 ? first_entry : first + bodies() * dimension) {}

std::vector<solver::Rotation> WingAssembly::rotations() const {
  std::vector<solver::Rotation> out;
  for (int wing = 0; wing < wingCount(); ++wing) {
    for (int body = 0; body < 3; ++body) out.push_back({entry(wing, body), LENGTH, {Eigen::Vector3d::UnitZ()}});
  }
  return out;
}

Turning WingAssembly::turning(int wing, WingLinkage::Body body) const {
  const int first = entry(wing, body);
  return {first, first + 1, LENGTH};
}

std::vector<Turning> WingAssembly::byTheRing(int wing, WingLinkage::Body body) const {
  std::vector<Turning> out{turning(wing, body)};
  if (wings_[wing].ring) out.push_back(*wings_[wing].ring);
  return out;
}

/// Displacement of a body's point: c + E X / L.
std::vector<std::pair<int, double>> WingAssembly::point(int wing, int body, const Eigen::Vector2d& at, int axis) const {
  std::vector<std::pair<int, double>> terms{{place(wing, body) + axis, 1.0}};
  for (int j = 0; j < 2; ++j) {
    if (at(j) != 0) terms.emplace_back(entry(wing, body) + axis + dimension_ * j, at(j) / LENGTH);
  }
  return terms;
}

std::vector<Equation> WingAssembly::equations(const OnRing& on_ring) const {
  const Eigen::Vector2d axle = Eigen::Vector2d::Zero();
  std::vector<Equation> out;
  const auto add = [&](const std::string& name, std::vector<std::pair<int, double>> one,
                       const std::vector<std::pair<int, double>>& other) {
    for (const auto& [coordinate, value] : other) one.emplace_back(coordinate, -value);
    Equation equation;
    equation.terms = std::move(one);
    equation.name = name;
    out.push_back(std::move(equation));
  };
  for (int wing = 0; wing < wingCount(); ++wing) {
    const std::string of = " of the " + std::string(SIDES[wings_[wing].left ? 1 : 0]) + " wing";
    for (int axis = 0; axis < 2; ++axis) {
      add("axle" + of, point(wing, WingLinkage::CRANK, axle, axis), on_ring(wing, axle, axis));
      add("auxiliary pin" + of, point(wing, WingLinkage::ROCKER, linkage_->auxiliary(), axis),
          on_ring(wing, linkage_->auxiliary(), axis));
      add("joint 1" + of, point(wing, WingLinkage::WING, linkage_->joint1(), axis),
          point(wing, WingLinkage::CRANK, linkage_->joint1(), axis));
    }
    for (int body = 0; dimension_ == 3 && body < 3; ++body) add("plane" + of, {{place(wing, body) + 2, 1.0}}, {});
    for (int axis = 0; axis < 2; ++axis) {
      add("joint 2" + of, point(wing, WingLinkage::WING, linkage_->joint2(), axis),
          point(wing, WingLinkage::ROCKER, linkage_->joint2(), axis));
    }
  }
  return out;
}

std::shared_ptr<const solver::Constraints> WingAssembly::chains(const solver::LinearRows& kept, double share) {
  constexpr double PENALTY = 10, GAP = 1e-12;  // [N/m] of the size of a bar's weight in long steps; [m]
  if (kept.count() == 0) return nullptr;
  return std::make_shared<const solver::Constraints>(kept, solver::Enforcement::MULTIPLIERS, share * PENALTY, GAP);
}

std::vector<std::shared_ptr<const Term>> WingAssembly::inertia() const {
  constexpr const char* NAMES[3] = {"crank", "wing", "rocker"};
  const std::vector<solver::Rotation> turns = rotations();
  std::vector<std::shared_ptr<const Term>> out;
  for (int wing = 0; wing < wingCount(); ++wing) {
    for (int body = 0; body < 3; ++body) {
      solver::RigidMass mass = linkage_->mass(static_cast<WingLinkage::Body>(body));
      mass.mass *= wings_[wing].weight, mass.first *= wings_[wing].weight, mass.second *= wings_[wing].weight;
      out.push_back(std::make_shared<solver::RigidInertiaTerm>(NAMES[body], dimension_, place(wing, body),
                                                               turns[3 * wing + body], mass));
    }
  }
  return out;
}

std::vector<std::shared_ptr<const Term>> WingAssembly::pins() const {
  std::vector<std::shared_ptr<const Term>> out;
  for (int wing = 0; wing < wingCount(); ++wing) {
    const Wing& w = wings_[wing];
    const double moment = w.weight * w.friction * linkage_->frictionMoment(w.left);
    const Turning crank = turning(wing, WingLinkage::CRANK), blade = turning(wing, WingLinkage::WING),
                  rocker = turning(wing, WingLinkage::ROCKER);
    const std::vector<std::pair<std::string, std::vector<Turning>>> pins = {
        {"axle", byTheRing(wing, WingLinkage::CRANK)},
        {"joint 1", {crank, blade}},
        {"joint 2", {blade, rocker}},
        {"auxiliary pin", byTheRing(wing, WingLinkage::ROCKER)}};
    for (const auto& [name, bodies] : pins) {
      out.push_back(std::make_shared<PinFriction>("friction of " + name + ", " + SIDES[w.left ? 1 : 0], bodies, moment,
                                                  FRICTION_RATE));
    }
    if (linkage_->storedEnergy().empty()) continue;
    std::vector<double> energy = linkage_->storedEnergy();
    for (double& value : energy) value *= w.weight;
    out.push_back(std::make_shared<AngleEnergy>("flexures", byTheRing(wing, WingLinkage::CRANK),
                                                SmoothCurve(linkage_->rotations(), energy)));
  }
  return out;
}

std::vector<std::shared_ptr<const Term>> WingAssembly::forces(int wing, const WingForces& of) const {
  const double weight = wings_[wing].weight;
  const std::vector<Turning> blade = byTheRing(wing, WingLinkage::WING), crank = byTheRing(wing, WingLinkage::CRANK);
  // Cubics through these are k x^2 / 2 on one side of a stop and 0 on the other, straight where the bias acts.
  std::vector<std::shared_ptr<const Term>> out;
  if (of.rest_stop > 0) {
    const double k = weight * of.rest_stop;
    out.push_back(
        std::make_shared<AngleEnergy>("stop of the wing", blade, SmoothCurve({-1, 0, 3}, {0.5 * k, 0, 0}, {-k, 0, 0})));
  }
  if (of.fold_stop > 0) {
    const double k = weight * of.fold_stop, end = linkage_->rotations().back();
    out.push_back(std::make_shared<AngleEnergy>("stop of the fold", crank,
                                                SmoothCurve({end - 3, end, end + 1}, {0, 0, 0.5 * k}, {0, 0, k})));
  }
  if (of.fold_bias > 0) {
    const double moment = weight * of.fold_bias;
    out.push_back(std::make_shared<AngleEnergy>("bias of the fold", blade,
                                                SmoothCurve({0, M_PI}, {M_PI * moment, 0}, {-moment, -moment})));
  }
  if (of.air > 0) out.push_back(std::make_shared<TurningDrag>("air on the wing", blade, weight * of.air));
  return out;
}

std::shared_ptr<const HubTerm> WingAssembly::hub(int wing, const Eigen::VectorXd& rotation_at_rest,
                                                 double stiffness) const {
  std::vector<int> nodes;
  for (int k = 0; k + 1 < rotation_at_rest.size(); k += dimension_) {
    if (rotation_at_rest(k) != 0 || rotation_at_rest(k + 1) != 0) nodes.push_back(k);
  }
  return std::make_shared<const HubTerm>("hub", rotation_at_rest, nodes, place(wing, WingLinkage::CRANK),
                                         turning(wing, WingLinkage::CRANK), wings_[wing].weight * stiffness);
}

std::shared_ptr<const Term> WingAssembly::travelHub(int wing, const solver::Row& travel, const SmoothCurve& curve,
                                                    double stiffness) const {
  return std::make_shared<const TravelHub>("hub on the travel", turning(wing, WingLinkage::CRANK), travel, curve,
                                           wings_[wing].weight * stiffness);
}

std::vector<std::string> WingAssembly::leftOut(const WingForces& of) const {
  std::vector<std::string> out{
      "folding of the blade: replaced by a rigid body, whose K differs from that of the wing's table by up to " +
          common::toText(linkage_->bladeError()) + " of the largest K",
      "weight of the blade's film beyond that body, play of the pins, bending of the bars"};
  out.push_back(of.air > 0 ? "air loads on the wings, except still air against their rotation"
                           : "air loads on the wings");
  if (!(of.fold_bias > 0)) out.push_back("bias of the blade's central fold towards folded");
  if (!(of.fold_stop > 0)) out.push_back("a stop of the crank at the end of the wing's designed rotation");
  return out;
}

double WingAssembly::mass() const {
  double sum = 0;
  for (const Wing& wing : wings_) sum += wing.weight * linkage_->totalMass();
  return sum;
}

void WingAssembly::markUp(Eigen::VectorXd& up) const {
  for (int wing = 0; wing < wingCount(); ++wing) {
    for (int body = 0; body < 3; ++body) up(place(wing, body) + 1) = 1;
  }
}

Eigen::VectorXd WingAssembly::turned(double crank) const {
  Eigen::VectorXd out(bodies());
  if (wingCount() == 0) return out;
  const LinkagePose pose = linkage_->at(crank);
  for (int wing = 0; wing < wingCount(); ++wing) {
    out.segment<3>(3 * wing) = LENGTH * Eigen::Vector3d(crank, pose.wing, pose.rocker);
  }
  return out;
}

double WingAssembly::wingAngle(const Eigen::VectorXd& y, int wing, double expected) const {
  const double angle = TurningAngle("wing", byTheRing(wing, WingLinkage::WING)).at(y);
  return expected + std::remainder(angle - expected, 2 * M_PI);
}

}  // namespace snapwing::motion
