#include "snapwing/motion/wing_assembly.h"

#include <Eigen/Geometry>
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
  using Eigen::Vector3d;
  const std::vector<Vector3d> about_z{Vector3d::UnitZ()}, free{Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  std::vector<solver::Rotation> out;
  for (int wing = 0; wing < wingCount(); ++wing) {
    for (int body = 0; body < 3; ++body) out.push_back({entry(wing, body), LENGTH, inSpace() ? free : about_z});
  }
  return out;
}

Turning WingAssembly::turning(int wing, WingLinkage::Body body) const {
  const int first = entry(wing, body);
  return {first, first + 1, LENGTH};
}

Directions WingAssembly::directions(int wing, WingLinkage::Body body) const {
  const solver::Rotation rotation{entry(wing, body), LENGTH, {}};
  const auto along = [&](int k) { return solver::SpacePoint::direction(Eigen::Vector3d::Unit(k), rotation); };
  return {along(0), along(1), along(2)};
}

std::shared_ptr<const PinAngle> WingAssembly::byTheRing(int wing, WingLinkage::Body body) const {
  if (inSpace()) return std::make_shared<const SpaceAngle>(directions(wing, body), *wings_[wing].ring_in_space);
  std::vector<Turning> bodies{turning(wing, body)};
  if (wings_[wing].ring) bodies.push_back(*wings_[wing].ring);
  return std::make_shared<const TurningAngle>("wing", std::move(bodies));
}

std::shared_ptr<const PinAngle> WingAssembly::between(int wing, WingLinkage::Body body, WingLinkage::Body other) const {
  if (inSpace()) return std::make_shared<const SpaceAngle>(directions(wing, body), directions(wing, other));
  return std::make_shared<const TurningAngle>("wing", std::vector<Turning>{turning(wing, body), turning(wing, other)});
}

/// Displacement of a body's point: c + E X / L.
std::vector<std::pair<int, double>> WingAssembly::point(int wing, int body, const Eigen::Vector2d& at, int axis) const {
  std::vector<std::pair<int, double>> terms{{place(wing, body) + axis, 1.0}};
  for (int j = 0; j < 2; ++j) {
    if (at(j) != 0) terms.emplace_back(entry(wing, body) + axis + dimension_ * j, at(j) / LENGTH);
  }
  return terms;
}

/// Each body's z is the ring's, in all three components: two of them would leave the third open where the vehicle has
/// turned.
std::vector<Equation> WingAssembly::pinAxes(int wing, const std::string& of) const {
  const solver::SpacePoint& ring = wings_[wing].ring_in_space->z;
  std::vector<Equation> out;
  for (int body = 0; body < 3; ++body) {
    for (int axis = 0; axis < 3; ++axis) {
      Equation& equation = out.emplace_back();
      equation.name = "axis of the pins" + of;
      equation.terms.emplace_back(entry(wing, body) + axis + 3 * 2, 1.0);
      for (std::size_t k = 0; k < ring.coordinates().size(); ++k) {
        const double value = ring.matrix()(axis, static_cast<Eigen::Index>(k));
        if (value != 0) equation.terms.emplace_back(ring.coordinates()[k], -LENGTH * value);
      }
    }
  }
  return out;
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
    const int axes = inSpace() ? 3 : 2;
    for (int axis = 0; axis < axes; ++axis) {
      add("axle" + of, point(wing, WingLinkage::CRANK, axle, axis), on_ring(wing, axle, axis));
      add("auxiliary pin" + of, point(wing, WingLinkage::ROCKER, linkage_->auxiliary(), axis),
          on_ring(wing, linkage_->auxiliary(), axis));
      add("joint 1" + of, point(wing, WingLinkage::WING, linkage_->joint1(), axis),
          point(wing, WingLinkage::CRANK, linkage_->joint1(), axis));
    }
    const bool in_plane = dimension_ == 3 && !inSpace();
    for (int body = 0; in_plane && body < 3; ++body) add("plane" + of, {{place(wing, body) + 2, 1.0}}, {});
    for (int axis = 0; axis < axes; ++axis) {
      add("joint 2" + of, point(wing, WingLinkage::WING, linkage_->joint2(), axis),
          point(wing, WingLinkage::ROCKER, linkage_->joint2(), axis));
    }
    if (!inSpace()) continue;
    for (Equation& equation : pinAxes(wing, of)) out.push_back(std::move(equation));
  }
  return out;
}

std::shared_ptr<const solver::Constraints> WingAssembly::chains(const solver::LinearRows& kept, double share) const {
  constexpr double PENALTY = 10, GAP = 1e-12;  // [N/m] of the size of a bar's weight in long steps; [m]
  if (kept.count() == 0) return nullptr;
  // In space a linkage has 12 equations for nine rotations of bars, and moves in one way: of the three for each axis
  // one follows from the lengths, and joint 2 stays in the plane by itself.
  const int redundant = inSpace() ? 4 * wingCount() : 0;
  return std::make_shared<const solver::Constraints>(kept, solver::Enforcement::MULTIPLIERS, share * PENALTY, GAP,
                                                     redundant);
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
    const std::vector<std::pair<std::string, std::shared_ptr<const PinAngle>>> pins = {
        {"axle", byTheRing(wing, WingLinkage::CRANK)},
        {"joint 1", between(wing, WingLinkage::CRANK, WingLinkage::WING)},
        {"joint 2", between(wing, WingLinkage::WING, WingLinkage::ROCKER)},
        {"auxiliary pin", byTheRing(wing, WingLinkage::ROCKER)}};
    for (const auto& [name, angle] : pins) {
      out.push_back(std::make_shared<PinFriction>("friction of " + name + ", " + SIDES[w.left ? 1 : 0], angle, moment,
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
  const std::shared_ptr<const PinAngle> blade = byTheRing(wing, WingLinkage::WING),
                                        crank = byTheRing(wing, WingLinkage::CRANK);
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

namespace {

/// Sum over nodes of weight times position from the axle: positions at rest, less the axle's displacement.
solver::SpacePoint momentOf(const std::vector<int>& nodes, const std::vector<double>& weights,
                            const Eigen::VectorXd& positions, int axle) {
  Eigen::Vector3d rest = Eigen::Vector3d::Zero();
  std::vector<int> coordinates;
  Eigen::Matrix3Xd matrix = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(3 * nodes.size() + 3));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    rest += weights[k] * positions.segment<3>(nodes[k]);
    matrix.middleCols<3>(static_cast<Eigen::Index>(3 * k)) = weights[k] * Eigen::Matrix3d::Identity();
    matrix.rightCols<3>() -= weights[k] * Eigen::Matrix3d::Identity();
    for (int i = 0; i < 3; ++i) coordinates.push_back(nodes[k] + i);
  }
  for (int i = 0; i < 3; ++i) coordinates.push_back(axle + i);
  return {rest, std::move(coordinates), std::move(matrix)};
}

}  // namespace

std::shared_ptr<const Hub> WingAssembly::hub(int wing, const Eigen::VectorXd& rotation_at_rest, double stiffness,
                                             const Eigen::VectorXd& nodes) const {
  std::vector<int> near;
  std::vector<double> by_x, by_y;  // a rotation's slopes by x and y are -Y and X, weighed
  for (int k = 0; k + 1 < rotation_at_rest.size(); k += dimension_) {
    if (rotation_at_rest(k) == 0 && rotation_at_rest(k + 1) == 0) continue;
    near.push_back(k);
    by_x.push_back(rotation_at_rest(k + 1)), by_y.push_back(-rotation_at_rest(k));
  }
  const double own = wings_[wing].weight * stiffness;
  const int axle = place(wing, WingLinkage::CRANK);
  if (!inSpace()) {
    return std::make_shared<const HubTerm>("hub", rotation_at_rest, near, axle, turning(wing, WingLinkage::CRANK), own);
  }
  return std::make_shared<const SpaceHub>("hub", momentOf(near, by_x, nodes, axle), momentOf(near, by_y, nodes, axle),
                                          directions(wing, WingLinkage::CRANK), own);
}

std::shared_ptr<const Term> WingAssembly::travelHub(int wing, const solver::Row& travel, const SmoothCurve& curve,
                                                    double stiffness) const {
  return std::make_shared<const TravelHub>("hub on the travel", turning(wing, WingLinkage::CRANK), travel, curve,
                                           wings_[wing].weight * stiffness);
}

std::vector<std::string> WingAssembly::leftOut(const WingForces& of) const {
  std::vector<std::string> out{
      "folding of the blade: replaced by a rigid body, whose K differs from that of the wing's table by up to " +
          common::toText(std::round(1e3 * linkage_->bladeError()) / 10) + " % of the largest K",
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
  const int axes = inSpace() ? 3 : 1;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(axes * bodies());
  if (wingCount() == 0) return out;
  const LinkagePose pose = linkage_->at(crank);
  const Eigen::Vector3d about_z(crank, pose.wing, pose.rocker);
  for (int body = 0; body < bodies(); ++body) out(axes * body + axes - 1) = LENGTH * about_z(body % 3);
  return out;
}

void WingAssembly::pose(double crank, Eigen::VectorXd& y) const {
  if (wingCount() == 0) return;
  const LinkagePose pose = linkage_->at(crank);
  const Eigen::Rotation2Dd by_crank(crank), by_wing(pose.wing), by_rocker(pose.rocker);
  const Eigen::Vector2d &pin = linkage_->joint1(), &fixed = linkage_->auxiliary();
  for (int wing = 0; wing < wingCount(); ++wing) {
    y.segment<2>(place(wing, WingLinkage::CRANK)).setZero();
    y.segment<2>(place(wing, WingLinkage::WING)) = by_crank * pin - by_wing * pin;
    y.segment<2>(place(wing, WingLinkage::ROCKER)) = fixed - by_rocker * fixed;
  }
}

double WingAssembly::wingAngle(const Eigen::VectorXd& y, int wing, double expected) const {
  const double angle = byTheRing(wing, WingLinkage::WING)->at(y);
  return expected + std::remainder(angle - expected, 2 * M_PI);
}

}  // namespace snapwing::motion
