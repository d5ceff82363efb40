#include "snapwing/motion/space_vehicle.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "arm_bodies.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/require.h"
#include "snapwing/solver/elastic_term.h"
#include "snapwing/solver/load_term.h"
#include "snapwing/solver/material_damping.h"
#include "snapwing/solver/prony_term.h"
#include "snapwing/solver/rigid_inertia_term.h"
#include "snapwing/solver/row_terms.h"

namespace snapwing::motion {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using solver::Term;
using vehicle::Mount;

namespace {

constexpr double FRICTION_SPEED = 0.02;  // [m/s] as on the axis
constexpr double STRUT = 0.1;            // [m] from ring and housing to where the line between them is measured

Matrix3d aboutY(double angle) {
  const double quarter = angle / (0.5 * std::acos(-1.0));
  const bool whole = std::abs(quarter - std::round(quarter)) < 1e-12;  // exact: rounding would couple more coordinates
  const double c = whole ? std::round(std::cos(angle)) : std::cos(angle),
               s = whole ? std::round(std::sin(angle)) : std::sin(angle);
  Matrix3d r;
  r << c, 0, s, 0, 1, 0, -s, 0, c;
  return r;
}

/// An axle's line must be held in all directions: one that slides does so along a direction that turns, which is no
/// linear equation.
AxisSettings inSpace(AxisSettings settings) {
  settings.in_space = true;
  return settings;
}

/// The start and the static curve along the axis are those without wings: at rest they load nothing.
vehicle::Trial withoutWings(vehicle::Trial trial) {
  trial.wings = false;
  return trial;
}

AxisSettings wholeThickness(AxisSettings settings) {
  settings = inSpace(std::move(settings));
  settings.whole_thickness = true;
  return settings;
}

}  // namespace

void SpaceSettings::validate(int rotors) const {
  const common::Require require("space");
  if (!rotor_scale.empty() && static_cast<int>(rotor_scale.size()) != rotors) {
    throw common::Error("propellers.scale has " + std::to_string(rotor_scale.size()) +
                        " values; allowed: " + std::to_string(rotors) + ", one for each rotor");
  }
  for (const double scale : rotor_scale) require.within("scale", scale, 0, 2);
  require(std::isfinite(rotor_angle), "angle", rotor_angle, "finite");
  require.notNegative("moment_per_thrust", moment_per_thrust, " m");
  require.notNegative("no_thrust_speed", no_thrust_speed, " m/s");
  require.within("sag", sag, 0, 0.9);
  require(std::isfinite(gravity_across), "gravity_across", gravity_across, "finite");
}

SpaceVehicle::SpaceVehicle(const vehicle::Vehicle& vehicle, const vehicle::VehicleParameters& parameters,
                           const vehicle::Trial& trial, const AxisSettings& settings, const SpaceSettings& space,
                           const std::optional<vehicle::WingTable>& wing)
    : trial_(trial), space_(space), axis_(vehicle, parameters, withoutWings(trial), inSpace(settings)) {
  if (settings.dimension != 3) throw common::Error("rung is planar with freedom six; allowed: volumetric");
  if (settings.hand) throw common::Error("hand is given with freedom six; allowed: with freedom axis");
  if (settings.damping != DampingLaw::TRAVEL && settings.damping != DampingLaw::KELVIN_VOIGT) {
    throw common::Error("damping is " + dampingName(settings.damping) +
                        " with freedom six, which damps rigid rotations; allowed: travel, kelvin_voigt");
  }
  rotors_ = vehicle.rotors.count;
  arms_ = vehicle.arm.count;
  space.validate(rotors_);
  max_thrust_ = parameters.max_thrust;
  stop_ = vehicle.limits.travel_min;
  stop_stiffness_ = settings.stop_stiffness, restitution_ = settings.stop_restitution;
  half_ = 0.5 * vehicle.arm.domain_length;
  rotor_radius_ = vehicle.geometry.ring_radius;
  housing_height_ = vehicle.geometry.housing_height;
  boom_ = onBoom() ? vehicle.boom.length.value : 0;
  scene::Scene scene = armBodies(vehicle, parameters.force_scale, wholeThickness(settings), axis_.series(),
                                 std::vector<double>(static_cast<std::size_t>(arms_), 1.0));
  for (int arm = 0; arm < arms_; ++arm) {
    turned_.push_back(aboutY(2 * std::acos(-1.0) * arm / arms_));
    origin_.emplace_back(turned_.back() * Vector3d(vehicle.geometry.housing_radius, 0, 0));
    scene.bodies[arm].frame = {turned_.back(), origin_.back()};
  }
  scene_ = scene::compileScene(scene, settings.threads);
  strain_ = std::make_shared<const ArmStrain>(*scene_);
  nodes_ = scene_->terms().coordinates().fullCount();
  per_arm_ = nodes_ / arms_;
  axle_ = {vehicle.arm.pin_x, vehicle.arm.pin_y, 0};
  placeBodies(vehicle);
  if (trial.wings.value_or(false)) addWings(vehicle, parameters, settings, wing);
  full_ = nodes_ + 24 + wings_.count();
  findArrows();
  hub_ = pointOf(ring_, ring_centre_);
  strut_ = solver::SpacePoint::between(pointOf(ring_, ring_centre_ + STRUT * Vector3d::UnitY()),
                                       pointOf(housing_, housing_.centre - STRUT * Vector3d::UnitY()));
  solver::HessianLayout layout(full_);
  layout.addRegion(0, scene_->volumetric()->pattern());
  solver::TermProblem::Parts parts{std::move(layout), {}, {}, settings.threads, scene_->terms().forceFloor(), 0};
  join(parts);
  parts.terms = {scene_->terms().terms().front(), scene_->inertia(settings.mass)};
  for (const auto& term : bodies(parameters)) parts.terms.push_back(term);
  problem_ = std::make_shared<const solver::TermProblem>(parts);
  const Eigen::VectorXd up = rigidRates(Eigen::VectorXd::Zero(full_), Vector3d::UnitY(), Vector3d::Zero());
  mass_ = up.dot(momentumOf(*problem_, up));
  for (const auto& term : wingForces(settings)) parts.terms.push_back(term);
  for (const auto& term : forces(parameters)) parts.terms.push_back(term);
  for (const auto& term : propellers(parameters)) parts.terms.push_back(term);
  auto solid = std::dynamic_pointer_cast<const solver::ElasticTerm<3>>(parts.terms.front())->sharedSolid();
  if (axis_.materialTime() > 0) {
    parts.terms.push_back(std::make_shared<const solver::KelvinVoigtTerm<3>>(solid, axis_.materialTime()));
  }
  if (!axis_.series().empty()) parts.terms.push_back(std::make_shared<solver::PronyTerm<3>>(solid, axis_.series()));
  parts.terms.push_back(weight());
  problem_ = std::make_shared<const solver::TermProblem>(std::move(parts));
}

/// The ring as a thin one of the file's radius with all that is not housing or arm on it, the housing as a cylinder.
void SpaceVehicle::placeBodies(const vehicle::Vehicle& vehicle) {
  const vehicle::ArmSettings& arm = vehicle.arm;
  ring_centre_ = {0, arm.pin_y + vehicle.geometry.axle_below_ring, 0};
  ring_.centre = ring_centre_ - boom_ * Vector3d::UnitX();  // on a boom: its axis
  housing_.centre = {0, 0.5 * (arm.clamp_y_low + arm.clamp_y_high), 0};
  const std::vector<Vector3d> free = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  ring_.centre_at = nodes_, housing_.centre_at = nodes_ + 3;
  ring_.rotation = {nodes_ + 6, onBoom() ? boom_ : vehicle.geometry.ring_radius, free};
  housing_.rotation = {nodes_ + 15, vehicle.geometry.housing_radius, free};
  if (onBoom()) ring_.rotation.axes = {Vector3d::UnitZ()};
  if (trial_.mount == Mount::HELD) ring_.rotation.axes.clear();
}

/// One wing each way along the first arm. On a boom their pins' axes lie along the boom's, so that bars turn about one
/// axis; a ring that is free takes them along.
void SpaceVehicle::addWings(const vehicle::Vehicle& vehicle, const vehicle::VehicleParameters& p,
                            const AxisSettings& settings, const std::optional<vehicle::WingTable>& wing) {
  if (!wing) throw common::Error("wings is on, and the vehicle has none; allowed: off");
  if (arms_ % 2 != 0) {
    throw common::Error("wings is on with arm.count " + std::to_string(arms_) +
                        " and freedom six; allowed: an even number, so that two arms are opposite");
  }
  if (settings.wings_follow_travel) {
    throw common::Error("wings_follow is travel with freedom six; allowed: arm");
  }
  wing_forces_ = settings.wing_forces;
  wing_forces_.rest_stop = settings.wing_stop.value_or(vehicle.wing.stop.value);
  linkage_ = std::make_shared<const WingLinkage>(*wing, vehicle.wing.layout_file, p.wing_inertia, p.wing_friction);
  std::vector<WingAssembly::Wing> wings{{true, 1, settings.friction_left}, {false, 1, settings.friction_right}};
  const int bars = static_cast<int>(3 * wings.size());
  // Places of the bars before all rotations, which must follow each other.
  for (RigidBody* body : {&ring_, &housing_}) body->rotation.first += 3 * bars;
  for (int side = 0; side < 2; ++side) {
    if (trial_.mount == Mount::FREE) {
      wings[side].ring_in_space = ringDirections(armOfWing(side));
    } else {
      wings[side].ring = ringTurningAbout(armOfWing(side));
    }
  }
  wings_ = WingAssembly(linkage_, std::move(wings), 3, nodes_ + 6, nodes_ + 6 + 3 * bars + 18);
}

/// In the axes of an arm along or against the first one.
Turning SpaceVehicle::ringTurningAbout(int arm) const {
  const int first = ring_.rotation.first;
  return {first, first + 1, ring_.rotation.length, arm == 0 ? 1.0 : -1.0};
}

Directions SpaceVehicle::ringDirections(int arm) const {
  const auto along = [&](int k) {
    return solver::SpacePoint::direction(turned_[arm].col(k), ring_.rotation).inAxes(turned_[arm]);
  };
  return {along(0), along(1), along(2)};
}

std::vector<std::shared_ptr<const Term>> SpaceVehicle::wingForces(const AxisSettings& settings) {
  std::vector<std::shared_ptr<const Term>> terms = wings_.pins();
  const mpm::Discretisation<3>& solid = *scene_->volumetric();
  Eigen::VectorXd from_axle(nodes_);
  for (int node = 0; node < solid.nodeCount(); ++node) from_axle.segment<3>(3 * node) = solid.position(node) - axle_;
  for (int wing = 0; wing < wings_.wingCount(); ++wing) {
    for (const auto& term : wings_.forces(wing, wing_forces_)) terms.push_back(term);
    Eigen::VectorXd gradient;
    scene_->monitor(armOfWing(wing), Eigen::VectorXd::Zero(nodes_), &gradient);
    hubs_.push_back(wings_.hub(wing, gradient, settings.hub_stiffness, from_axle));
    terms.push_back(hubs_.back());
  }
  return terms;
}

/// Coordinates, and what of the wings' closed chains is kept as equations.
void SpaceVehicle::join(solver::TermProblem::Parts& parts) const {
  std::vector<solver::Rotation> rotations{ring_.rotation, housing_.rotation};
  for (const solver::Rotation& bar : wings_.rotations()) rotations.push_back(bar);
  const solver::SplitEquations split = solver::splitEquations(full_, rotors_, equations(), false, ring_.rotation.first,
                                                              static_cast<int>(rotations.size()), 9);
  parts.coordinates = std::make_shared<const solver::Coordinates>(split.eliminated, 3, rotations);
  parts.constraints = wings_.chains(split.kept, 1);
}

void SpaceVehicle::findArrows() {
  const mpm::Discretisation<3>& solid = *scene_->volumetric();
  for (int node = 0; node < solid.nodeCount(); ++node) {
    const int arm = solid.nodeBody(node);
    arrows_.push_back({3 * node, arm, origin_[arm] + turned_[arm] * solid.position(node), true});
  }
  for (const RigidBody* body : {&ring_, &housing_}) {
    arrows_.push_back({body->centre_at, -1, body->centre, true});
    for (int j = 0; j < 3; ++j) {
      arrows_.push_back({body->rotation.first + 3 * j, -1, body->rotation.length * Vector3d::Unit(j), false});
    }
  }
  const std::vector<solver::Rotation> bars = wings_.rotations();
  for (int bar = 0; bar < static_cast<int>(bars.size()); ++bar) {
    const int wing = bar / 3, arm = armOfWing(wing);
    arrows_.push_back({wings_.place(wing, bar % 3), arm, origin_[arm] + turned_[arm] * axle_, true});
    for (int j = 0; j < 3; ++j) {
      arrows_.push_back({bars[bar].first + 3 * j, arm, turned_[arm] * bars[bar].length * Vector3d::Unit(j), false});
    }
  }
}

void SpaceVehicle::addFollowing(const Followed& at, double factor, const RigidBody& body,
                                std::map<int, double>& terms) const {
  const Vector3d way = (at.rest - body.centre) / body.rotation.length;
  for (int i = 0; i < 3; ++i) {
    const double share = factor * turned_[at.arm](i, at.axis);
    if (share == 0) continue;
    terms[body.centre_at + i] += share;
    for (int j = 0; j < 3; ++j) terms[body.rotation.first + i + 3 * j] += share * way(j);
  }
}

/// The scene's equations hold relative to the ring at the axles, and to the housing where it clamps the arms.
std::vector<solver::Equation> SpaceVehicle::equations() const {
  const solver::Reduction& own = scene_->terms().coordinates().linear();
  std::vector<bool> is_free(nodes_, false);
  for (int z = 0; z < own.freeCount(); ++z) is_free[own.dofOfFree(z)] = true;
  std::vector<solver::Equation> list;
  const auto follow = [&](const solver::Equation& in_scene, const RigidBody& body) {
    std::map<int, double> terms;
    for (const auto& [dof, factor] : in_scene.terms) {
      terms[dof] += factor;
      addFollowing({arrows_[dof / 3].rest, arrows_[dof / 3].arm, dof % 3}, -factor, body, terms);
    }
    solver::Equation& equation = list.emplace_back();
    equation.name = in_scene.name;
    for (const auto& [coordinate, value] : terms) {
      if (std::abs(value) > 1e-13) equation.terms.emplace_back(coordinate, value);
    }
  };
  for (int dof = 0; dof < nodes_; ++dof) {
    if (is_free[dof]) continue;
    const bool clamped = scene_->volumetric()->position(dof / 3)(0) < half_;
    const RigidBody& body = clamped ? housing_ : ring_;
    solver::Equation equation;
    equation.name = clamped ? "the housing's clamp" : "an arm's axle";
    equation.terms.emplace_back(dof, 1.0);
    for (const auto& [z, factor] : own.terms(dof)) equation.terms.emplace_back(own.dofOfFree(z), -factor);
    follow(equation, body);
    if (!clamped && dof % 3 == 0) follow(alongAxle(own, dof), body);
  }
  for (int i = 0; i < 3 && trial_.mount != Mount::FREE; ++i) {
    solver::Equation equation;
    equation.name = onBoom() ? "the boom's axis" : "the ring is held";
    equation.terms = {{ring_.centre_at + i, 1.0}};
    list.push_back(std::move(equation));
  }
  const auto on_ring = [&](int wing, const Eigen::Vector2d& at, int axis) {
    const int arm = armOfWing(wing);
    std::map<int, double> terms;
    addFollowing({origin_[arm] + turned_[arm] * (axle_ + Vector3d(at(0), at(1), 0)), arm, axis}, 1, ring_, terms);
    std::vector<std::pair<int, double>> kept(terms.begin(), terms.end());
    kept.erase(std::remove_if(kept.begin(), kept.end(), [](const auto& t) { return std::abs(t.second) < 1e-13; }),
               kept.end());
    return kept;
  };
  for (solver::Equation& equation : wings_.equations(on_ring)) list.push_back(std::move(equation));
  return list;
}

solver::SpacePoint SpaceVehicle::pointOf(const RigidBody& body, const Vector3d& at) const {
  return {at, body.centre_at, body.rotation, body.centre};
}

Vector3d SpaceVehicle::rotorPlace(int rotor) const {
  const double angle = space_.rotor_angle + 2 * std::acos(-1.0) * rotor / rotors_;
  return ring_centre_ + aboutY(angle) * Vector3d(rotor_radius_, 0, 0);
}

/// The boom's inertia about its axis as a mass at its tip, as in the model along the axis.
std::vector<std::shared_ptr<const Term>> SpaceVehicle::bodies(const vehicle::VehicleParameters& p) const {
  const auto ring = [&](double mass, double radius, double height) {
    const double across = mass * (radius * radius / 2 + height * height / 12);
    return Matrix3d(Vector3d(across, mass * radius * radius, across).asDiagonal());
  };
  const double boom = onBoom() ? p.boom_mass : 0, ring_mass = p.ring_mass - axis_.armMass() - wings_.mass();
  std::vector<std::shared_ptr<const Term>> terms;
  terms.push_back(std::make_shared<solver::RigidInertiaTerm>(
      "ring", 3, ring_.centre_at, ring_.rotation,
      solver::RigidMass::of(ring_mass + boom, ring_centre_ - ring_.centre, ring(ring_mass, rotor_radius_, 0))));
  const double r = housing_.rotation.length;  // a solid cylinder: half the moment of a thin one
  terms.push_back(std::make_shared<solver::RigidInertiaTerm>(
      "housing", 3, housing_.centre_at, housing_.rotation,
      solver::RigidMass::of(p.centre_mass, Vector3d::Zero(),
                            ring(p.centre_mass, r / std::sqrt(2.0), housing_height_))));
  for (const auto& bar : wings_.inertia()) terms.push_back(bar);
  return terms;
}

std::vector<std::shared_ptr<const Term>> SpaceVehicle::forces(const vehicle::VehicleParameters& p) const {
  std::vector<std::shared_ptr<const Term>> terms;
  if (trial_.mount != Mount::HELD) {
    terms.push_back(
        std::make_shared<solver::PointDrag>("drag of the ring", hub_, p.ring_drag + (onBoom() ? p.boom_drag : 0)));
  }
  terms.push_back(
      std::make_shared<solver::PointDrag>("drag of the centre", pointOf(housing_, housing_.centre), p.centre_drag));
  if (onBoom()) {
    const Turning turning{ring_.rotation.first, ring_.rotation.first + 1, ring_.rotation.length};
    terms.push_back(std::make_shared<PinFriction>("friction of the boom", std::vector<Turning>{turning},
                                                  p.boom_friction * boom_, FRICTION_SPEED / boom_));
  }
  const double rest = strut_.at(Eigen::VectorXd::Zero(full_)).norm();
  if (!(axis_.materialTime() > 0)) {
    terms.push_back(std::make_shared<solver::StrutDamper>("damping of the travel", strut_, axis_.travelDamping()));
  }
  const double reduced =
      trial_.mount == Mount::HELD ? p.centre_mass : p.ring_mass * p.centre_mass / (p.ring_mass + p.centre_mass);
  terms.push_back(std::make_shared<solver::StrutStop>("upper stop", strut_, rest + stop_, stop_stiffness_));
  terms.push_back(std::make_shared<solver::StrutDamper>(
      "loss of the stop", strut_, solver::stopDamping("loss of the stop", stop_stiffness_, reduced, restitution_),
      rest + stop_));
  return terms;
}

std::vector<std::shared_ptr<const Term>> SpaceVehicle::propellers(const vehicle::VehicleParameters& p) const {
  std::vector<std::shared_ptr<const Term>> terms;
  for (int rotor = 0; rotor < rotors_; ++rotor) {
    solver::Propeller::Data data;
    data.control = rotor;
    data.moment = rotor % 2 == 0 ? space_.moment_per_thrust : -space_.moment_per_thrust;
    data.full_thrust = p.max_thrust / rotors_;
    data.no_thrust_speed = space_.no_thrust_speed;
    terms.push_back(std::make_shared<solver::Propeller>("propeller " + std::to_string(rotor + 1),
                                                        pointOf(ring_, rotorPlace(rotor)), ring_.rotation, data));
  }
  return terms;
}

std::shared_ptr<const Term> SpaceVehicle::weight() const {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(full_);
  const Eigen::VectorXd field =
      rigidRates(none, Vector3d(-space_.gravity_across, -trial_.gravity, 0), Vector3d::Zero());
  Eigen::VectorXd load = momentumOf(*problem_, field);
  if (trial_.push != 0) {
    Eigen::VectorXd push = none;
    hub_.addTo(trial_.push * Vector3d::UnitY(), push);
    load += push;
  }
  return std::make_shared<solver::LoadTerm>(load, Eigen::MatrixXd());
}

Eigen::VectorXd SpaceVehicle::controls(double, double, double thrust) const {
  Eigen::VectorXd out(rotors_);
  const double each = thrust / rotors_ * (1 - space_.sag * thrust / max_thrust_);
  for (int rotor = 0; rotor < rotors_; ++rotor) {
    out(rotor) = each * (space_.rotor_scale.empty() ? 1.0 : space_.rotor_scale[rotor]);
  }
  return out;
}

/// Displacements of an arm from those of the model along the axis, which may be half of its thickness.
Eigen::VectorXd SpaceVehicle::wholeArm(const Eigen::VectorXd& along) const {
  const mpm::Discretisation<3>&half = *axis_.scene().volumetric(), &whole = *scene_->volumetric();
  using Key = std::array<long, 3>;
  const auto keyOf = [](const Vector3d& x) {
    return Key{std::lround(1e7 * x(0)), std::lround(1e7 * x(1)), std::lround(1e7 * x(2))};
  };
  std::map<Key, int> nodes;
  for (int node = 0; node < half.nodeCount(); ++node) nodes[keyOf(half.position(node))] = node;
  Eigen::VectorXd out(per_arm_);
  for (int node = 0; node < per_arm_ / 3; ++node) {
    Vector3d place = whole.position(node);
    auto found = nodes.find(keyOf(place));
    const bool mirrored = found == nodes.end();
    if (mirrored) {
      place(2) = -place(2);
      found = nodes.find(keyOf(place));
      if (found == nodes.end()) {
        throw common::Error(
            "solid.cell_size: the cells are not symmetric about the arm's middle plane; allowed: half the thicknesses "
            "divided by a whole number");
      }
    }
    Vector3d u = along.segment<3>(3 * found->second);
    if (mirrored) u(2) = -u(2);
    out.segment<3>(3 * node) = u;
  }
  return out;
}

MotionState SpaceVehicle::start(vehicle::Mode mode, double thrust, bool* held) const {
  const MotionState along = axis_.start(mode, (1 - space_.sag * thrust / max_thrust_) * thrust, held);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(full_);
  for (int arm = 0; arm < arms_; ++arm) y.segment(arm * per_arm_, per_arm_) = wholeArm(along.y);
  y(housing_.centre_at + 1) = -axis_.travel(along);
  const Vector3d speed(0, trial_.initial_speed, 0),
      turn = boom_ > 0 ? Vector3d(0, 0, trial_.initial_speed / boom_) : Vector3d::Zero();
  const Vector3d velocity = boom_ > 0 ? Vector3d(-turn.cross(ring_.centre)) : speed;
  const StepperSettings settings;
  const Stepper stepper(problem_, Scheme(SchemeKind::MIDPOINT), settings);
  const solver::Coordinates& coordinates = problem_->coordinates();
  const auto turning = static_cast<Eigen::Index>(ring_.rotation.axes.size() + housing_.rotation.axes.size());
  const double crank = linkage_ ? scene_->monitor(0, y.head(nodes_)) : 0;
  wings_.pose(crank, y);  // elimination may have kept the bars' places and not the ring's
  const Eigen::VectorXd bars = wings_.turned(crank);
  Eigen::VectorXd turned = Eigen::VectorXd::Zero(turning + bars.size());
  turned.tail(bars.size()) = bars;
  const Eigen::VectorXd z = coordinates.freePart(y, turned), load = controls(0, 0, thrust);
  return stepper.start(z, load, rigidRates(coordinates.expand(z, load), velocity, turn));
}

}  // namespace snapwing::motion
