#include "snapwing/motion/wing_assembly.h"

#include <cmath>

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
                           int first)
    : linkage_(std::move(linkage)), wings_(std::move(wings)), dimension_(dimension), first_(first) {}

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

/// Displacement of a body's point: c + E X / L.
std::vector<std::pair<int, double>> WingAssembly::point(int wing, int body, const Eigen::Vector2d& at, int axis) const {
  std::vector<std::pair<int, double>> terms{{place(wing, body) + axis, 1.0}};
  for (int j = 0; j < 2; ++j) {
    if (at(j) != 0) terms.emplace_back(entry(wing, body) + axis + dimension_ * j, at(j) / LENGTH);
  }
  return terms;
}

std::vector<Equation> WingAssembly::equations(int ring) const {
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
      std::vector<std::pair<int, double>> carried;
      if (ring >= 0 && axis == 1) carried.emplace_back(ring, 1.0);
      add("axle" + of, point(wing, WingLinkage::CRANK, axle, axis), carried);
      add("auxiliary pin" + of, point(wing, WingLinkage::ROCKER, linkage_->auxiliary(), axis), carried);
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
        {"axle", {crank}}, {"joint 1", {crank, blade}}, {"joint 2", {blade, rocker}}, {"auxiliary pin", {rocker}}};
    for (const auto& [name, bodies] : pins) {
      out.push_back(std::make_shared<PinFriction>("friction of " + name + ", " + SIDES[w.left ? 1 : 0], bodies, moment,
                                                  FRICTION_RATE));
    }
    if (linkage_->storedEnergy().empty()) continue;
    std::vector<double> energy = linkage_->storedEnergy();
    for (double& value : energy) value *= w.weight;
    out.push_back(std::make_shared<AngleEnergy>("flexures", crank, SmoothCurve(linkage_->rotations(), energy)));
  }
  return out;
}

std::shared_ptr<const Term> WingAssembly::stop(int wing, double stiffness) const {
  const double k = wings_[wing].weight * stiffness;
  // A cubic through these is k angle^2 / 2 below 0.
  return std::make_shared<AngleEnergy>("stop of the wing", turning(wing, WingLinkage::WING),
                                       SmoothCurve({-1, 0, 3}, {0.5 * k, 0, 0}, {-k, 0, 0}));
}

std::shared_ptr<const HubTerm> WingAssembly::hub(int wing, const Eigen::VectorXd& rotation_at_rest, int carrier,
                                                 double stiffness) const {
  std::vector<int> nodes;
  for (int k = 0; k + 1 < rotation_at_rest.size(); k += dimension_) {
    if (rotation_at_rest(k) != 0 || rotation_at_rest(k + 1) != 0) nodes.push_back(k);
  }
  return std::make_shared<const HubTerm>("hub", rotation_at_rest, nodes, carrier, turning(wing, WingLinkage::CRANK),
                                         wings_[wing].weight * stiffness);
}

std::shared_ptr<const Term> WingAssembly::travelHub(int wing, const solver::Row& travel, const SmoothCurve& curve,
                                                    double stiffness) const {
  return std::make_shared<const TravelHub>("hub on the travel", turning(wing, WingLinkage::CRANK), travel, curve,
                                           wings_[wing].weight * stiffness);
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
  return expected + std::remainder(turning(wing, WingLinkage::WING).angle(y) - expected, 2 * M_PI);
}

}  // namespace snapwing::motion
