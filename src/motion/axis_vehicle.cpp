#include "snapwing/motion/axis_vehicle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "arm_bodies.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/solver/load_term.h"
#include "snapwing/solver/row_terms.h"

namespace snapwing::motion {

using solver::Row;
using solver::Term;
using vehicle::Mount;

namespace {

constexpr double FRICTION_SPEED = 0.02;  // [m/s] as in the lumped model
constexpr double CURVE_STEP = 0.002;     // [m]

}  // namespace

AxisVehicle::AxisVehicle(const vehicle::Vehicle& vehicle, const vehicle::VehicleParameters& parameters,
                         const vehicle::Trial& trial, const AxisSettings& settings,
                         const std::optional<vehicle::WingTable>& wing)
    : trial_(trial), settings_(settings), stop_(vehicle.limits.travel_min) {
  settings_.wing_forces.rest_stop = settings.wing_stop.value_or(vehicle.wing.stop.value);
  trial.validate();
  memory_known_ = !vehicle.material.relaxation.terms.empty();
  if (settings.relaxation) {
    for (const auto& term : vehicle.material.relaxation.terms) {
      series_.branches.push_back({term.share.value + settings.relaxation_share * term.share.plus_minus,
                                  term.time.value + settings.relaxation_time * term.time.plus_minus});
    }
    series_.validate();
  }
  if (settings.hand) {
    if (trial.mount != Mount::HELD)
      throw common::Error("hand is given with mount " + vehicle::mountName(trial.mount) + "; allowed: held");
    hand_.emplace(*settings.hand);
  }
  arms_ = vehicle.arm.count;
  groups_ = {arms_};
  if (trial.wings.value_or(false)) addWings(vehicle, parameters, wing);
  std::vector<double> shares;
  for (const int arms : groups_) shares.push_back(arms / static_cast<double>(groups_.front()));
  scene_ = scene::compileScene(armBodies(vehicle, parameters.force_scale, settings, series_, shares), settings.threads);
  strain_ = std::make_shared<const ArmStrain>(*scene_);
  curve_ = std::make_unique<StaticCurve>(*scene_, vehicle.limits.travel_max, CURVE_STEP, settings.cancelled);
  if (!curve_->bistable()) {
    throw common::Error("vehicle '" + vehicle.name +
                        "': its arm has no second equilibrium up to limits.travel_max at " +
                        "these cells; a trial needs a bistable one");
  }
  share_ = 1 / (groups_.front() * scene_->multiplicity());
  nodes_ = scene_->terms().coordinates().fullCount();
  const bool held = trial.mount == Mount::HELD;
  placeWings();
  ring_ = held ? -1 : nodes_ + wings_.count();
  centre_ = nodes_ + wings_.count() + (held ? 0 : 1);
  solver::TermProblem::Parts parts{layout(), {}, {}, settings.threads, scene_->terms().forceFloor(), 0};
  join(parts);
  parts.terms = {scene_->terms().terms().front(), scene_->inertia(settings.mass)};
  problem_ = std::make_shared<const solver::TermProblem>(parts);
  const Eigen::VectorXd arm_up = armUp();
  arm_mass_ = arm_up.dot(momentumOf(*problem_, arm_up)) / share_;
  const double carried = arm_mass_ + wings_.mass() / share_;
  if (!(parameters.ring_mass > carried)) {
    throw common::Error("masses.total leaves " + common::toText(parameters.ring_mass) +
                        " kg for ring, arms and wings; allowed: more than the arms' and wings' " +
                        common::toText(carried) + " kg");
  }
  const std::vector<std::shared_ptr<const Term>> bars = wings_.inertia();
  parts.terms.insert(parts.terms.end(), bars.begin(), bars.end());
  problem_ = std::make_shared<const solver::TermProblem>(parts);
  Eigen::VectorXd up = arm_up;
  wings_.markUp(up);
  const Eigen::VectorXd moved = momentumOf(*problem_, up);
  for (const auto& more : {bodies(parameters, carried), wingForces()}) {
    parts.terms.insert(parts.terms.end(), more.begin(), more.end());
  }
  rest_of_damping_ = restOfDamping(parameters);
  parts.terms.push_back(damping(rest_of_damping_));
  if (!series_.empty()) parts.terms.push_back(memory());
  parts.terms.push_back(loads(parameters, carried, moved));
  problem_ = std::make_shared<const solver::TermProblem>(std::move(parts));
}

/// Thrust on the ring by the control, and weight of all against the axis.
std::shared_ptr<const Term> AxisVehicle::loads(const vehicle::VehicleParameters& p, double carried,
                                               const Eigen::VectorXd& moved) const {
  Eigen::VectorXd dead = -trial_.gravity * moved;
  Eigen::MatrixXd thrust = Eigen::MatrixXd::Zero(centre_ + 1, controlCount());
  if (ring_ >= 0) {
    const double boom = trial_.mount == Mount::BOOM ? p.boom_mass : 0;
    dead(ring_) -= share_ * trial_.gravity * (p.ring_mass - carried + boom);
    dead(ring_) += share_ * trial_.push;
    thrust(ring_, 0) = share_;
  }
  dead(centre_) -= share_ * trial_.gravity * p.centre_mass;
  if (hand_) {  // seen from the ring, which stands still, the hand's acceleration is a weight
    thrust.col(1) = -moved;
    thrust(centre_, 1) -= share_ * p.centre_mass;
  }
  return std::make_shared<const solver::LoadTerm>(std::move(dead), std::move(thrust));
}

/// Which arms differ: those with a wing, and left from right if their friction does.
void AxisVehicle::addWings(const vehicle::Vehicle& vehicle, const vehicle::VehicleParameters& p,
                           const std::optional<vehicle::WingTable>& wing) {
  if (!wing) throw common::Error("wings is on, and the vehicle has none; allowed: off");
  if (trial_.mount == Mount::BOOM) vehicle::refuseWingsOnBoom("trial");
  if (arms_ < 2) throw common::Error("wings is on with arm.count 1; allowed: at least 2 arms");
  linkage_ = std::make_shared<const WingLinkage>(*wing, vehicle.wing.layout_file, p.wing_inertia, p.wing_friction);
  const bool even = settings_.friction_left * linkage_->frictionMoment(true) ==
                    settings_.friction_right * linkage_->frictionMoment(false);
  groups_ = even ? std::vector<int>{2} : std::vector<int>{1, 1};
  if (arms_ > 2) groups_.push_back(arms_ - 2);
}

void AxisVehicle::placeWings() {
  if (!linkage_) return;
  std::vector<WingAssembly::Wing> wings;
  const auto arms = static_cast<std::size_t>(groups_.front() == 2 ? 1 : 2);
  for (std::size_t k = 0; k < arms; ++k) {
    const bool left = k == 0;
    wings.push_back({left, groups_[k] * share_, left ? settings_.friction_left : settings_.friction_right});
  }
  wings_ = WingAssembly(linkage_, std::move(wings), settings_.dimension, nodes_);
}

std::vector<std::shared_ptr<const Term>> AxisVehicle::wingForces() {
  std::vector<std::shared_ptr<const Term>> out = wings_.pins();
  for (int wing = 0; wing < wings_.wingCount(); ++wing) {
    for (const auto& term : wings_.forces(wing, settings_.wing_forces)) out.push_back(term);
    if (settings_.wings_follow_travel) {
      out.push_back(wings_.travelHub(wing, travelRow(), staticRotation(), settings_.hub_stiffness));
      continue;
    }
    Eigen::VectorXd gradient;
    scene_->monitor(wing, Eigen::VectorXd::Zero(nodes_), &gradient);
    hubs_.push_back(wings_.hub(wing, gradient, settings_.hub_stiffness));
    out.push_back(hubs_.back());
  }
  return out;
}

/// Coordinates, and what of the wings' closed chains is kept as equations.
void AxisVehicle::join(solver::TermProblem::Parts& parts) const {
  std::vector<solver::Equation> equations = armEquations();
  const std::vector<solver::Equation> more = wings_.equations([&](int, const Eigen::Vector2d&, int axis) {
    const bool carried = ring_ >= 0 && axis == 1;
    return carried ? std::vector<std::pair<int, double>>{{ring_, 1.0}} : std::vector<std::pair<int, double>>{};
  });
  equations.insert(equations.end(), more.begin(), more.end());
  const int entries = settings_.dimension * settings_.dimension;
  const int first = linkage_ ? wings_.firstEntry() : nodes_;
  const solver::SplitEquations split =
      solver::splitEquations(centre_ + 1, controlCount(), equations, false, first, wings_.rotationCount(), entries);
  parts.coordinates =
      std::make_shared<const solver::Coordinates>(split.eliminated, settings_.dimension, wings_.rotations());
  parts.constraints = wings_.chains(split.kept, share_);
}

/// Node blocks of the arm; ring and centre are coupled by terms alone.
solver::HessianLayout AxisVehicle::layout() const {
  solver::HessianLayout layout(centre_ + 1);
  if (settings_.dimension == 2) {
    layout.addRegion(0, scene_->planar()->pattern());
  } else {
    layout.addRegion(0, scene_->volumetric()->pattern());
  }
  return layout;
}

Eigen::VectorXd AxisVehicle::armUp() const {
  Eigen::VectorXd up = Eigen::VectorXd::Zero(centre_ + 1);
  for (int k = 1; k < nodes_; k += settings_.dimension) up(k) = 1;
  return up;
}

Eigen::VectorXd AxisVehicle::allUp() const {
  Eigen::VectorXd up = armUp();
  wings_.markUp(up);
  up(centre_) = 1;
  if (ring_ >= 0) up(ring_) = 1;
  return up;
}

Row AxisVehicle::travelRow() const {
  return ring_ >= 0 ? Row({{ring_, 1.0}, {centre_, -1.0}}) : Row({{centre_, -1.0}});
}

/// The scene's equations hold in the ring's frame: y_i - e_i r = sum T_ij (y_j - e_j r) + B_i (r - c), with e_i = 1
/// along the axis, r and c the places of ring and centre.
std::vector<solver::Equation> AxisVehicle::armEquations() const {
  const solver::Reduction& own = scene_->terms().coordinates().linear();
  const Eigen::VectorXd by_control =
      own.expandDirection(Eigen::VectorXd::Zero(own.freeCount()), Eigen::VectorXd::Ones(1));
  const auto along = [&](int dof) { return dof % settings_.dimension == 1 ? 1.0 : 0.0; };
  std::vector<int> free_of_dof(nodes_, -1);
  for (int z = 0; z < own.freeCount(); ++z) free_of_dof[own.dofOfFree(z)] = z;
  std::vector<solver::Equation> equations;
  for (int dof = 0; dof < nodes_; ++dof) {
    if (free_of_dof[dof] >= 0) continue;
    solver::Equation equation;
    equation.name = "the arm's supports";
    equation.terms.emplace_back(dof, 1.0);
    double of_ring = -along(dof) - by_control(dof);
    for (const auto& [z, factor] : own.terms(dof)) {
      const int other = own.dofOfFree(z);
      equation.terms.emplace_back(other, -factor);
      of_ring += factor * along(other);
    }
    if (ring_ >= 0 && of_ring != 0) equation.terms.emplace_back(ring_, of_ring);
    if (by_control(dof) != 0) equation.terms.emplace_back(centre_, by_control(dof));
    if (settings_.in_space && ofAxle(*scene_, dof)) equations.push_back(alongAxle(own, dof));
    equations.push_back(std::move(equation));
  }
  return equations;
}

std::vector<std::shared_ptr<const Term>> AxisVehicle::bodies(const vehicle::VehicleParameters& p,
                                                             double carried) const {
  std::vector<std::shared_ptr<const Term>> terms;
  const auto row = [](int coordinate) { return Row({{coordinate, 1.0}}); };
  const bool boom = trial_.mount == Mount::BOOM;
  if (ring_ >= 0) {
    const double mass = p.ring_mass - carried + (boom ? p.boom_mass : 0);
    terms.push_back(std::make_shared<solver::RowInertia>("ring", row(ring_), share_ * mass));
    terms.push_back(std::make_shared<solver::RowDrag>("drag of the ring", row(ring_),
                                                      share_ * (p.ring_drag + (boom ? p.boom_drag : 0))));
    if (boom) {
      terms.push_back(std::make_shared<solver::RowFriction>("friction of the boom", row(ring_),
                                                            share_ * p.boom_friction, FRICTION_SPEED));
    }
  }
  terms.push_back(std::make_shared<solver::RowInertia>("centre", row(centre_), share_ * p.centre_mass));
  terms.push_back(std::make_shared<solver::RowDrag>("drag of the centre", row(centre_), share_ * p.centre_drag));
  const Row travel = travelRow();
  const double reduced = ring_ < 0 ? p.centre_mass : p.ring_mass * p.centre_mass / (p.ring_mass + p.centre_mass);
  const double stiffness = share_ * settings_.stop_stiffness;
  terms.push_back(std::make_shared<solver::RowStop>("upper stop", travel, stop_, stiffness));
  terms.push_back(std::make_shared<solver::RowStopLoss>("loss of the stop", travel, stop_, stiffness, share_ * reduced,
                                                        settings_.stop_restitution));
  return terms;
}

vehicle::ForceTable AxisVehicle::staticTable() const {
  vehicle::ForceTable table = curve_->table();
  table.arm_count = arms_;
  const double each = groups_.front() / static_cast<double>(arms_);  // of the problem, that one arm is
  for (std::vector<double>* values : {&table.force, &table.stiffness, &table.energy}) {
    for (double& value : *values) value *= each * scene_->multiplicity();
  }
  for (std::size_t k = 0; k < curve_->points().size(); ++k) {
    const StaticPoint& point = curve_->points()[k];
    const mpm::MovingMass moved = scene_->movingMass(point.z, point.control, point.slope);
    table.kinetic_mass[k] = each * moved.kinetic;
    table.coupled_mass[k] = each * moved.coupled;
    table.mass = each * moved.mass;
    table.rotation[k] = scene_->monitors(point.z, point.control).front();
  }
  return table;
}

/// Of the (first) arm by the travel, with its slope.
SmoothCurve AxisVehicle::staticRotation() const {
  constexpr double H = 1e-6;  // [m]
  std::vector<double> travel, rotation, slope;
  for (const StaticPoint& point : curve_->points()) {
    const auto at = [&](double shift) {
      return scene_->monitors(point.z + shift * point.slope, point.control + shift).front();
    };
    travel.push_back(point.control);
    rotation.push_back(at(0));
    slope.push_back((at(H) - at(-H)) / (2 * H));
  }
  return {travel, rotation, slope};
}

vehicle::WingTable AxisVehicle::staticWingTable() const {
  constexpr int POINTS = 161;
  if (!linkage_) throw common::Error("a trial without wings has no table of them; allowed: wings on");
  const SmoothCurve curve = staticRotation();
  std::vector<double> travel, rotation, slope;
  for (int k = 0; k < POINTS; ++k) {
    travel.push_back(curve_->points().back().control * k / (POINTS - 1));
    const SmoothCurve::Value now = curve.at(travel.back());
    rotation.push_back(now.value), slope.push_back(now.first);
  }
  return linkage_->tableOn(travel, rotation, slope);
}

/// Steps that keep no motion end where the vehicle accelerates as a whole and nothing else moves.
MotionState AxisVehicle::start(vehicle::Mode mode, double thrust, bool* held) const {
  if (mode == vehicle::Mode::UNKNOWN) throw common::Error("start is unknown; allowed: F or Q");
  constexpr int STEPS = 80;
  constexpr double H = 0.02;       // [s] long against the travel's period: each step takes most of what is left
  constexpr double STILL = 1e-10;  // [m] what a step moves when nothing is left
  const StaticPoint rest = mode == vehicle::Mode::FIXED_WING ? curve_->points().front() : curve_->at(curve_->second());
  const Eigen::VectorXd load = Eigen::VectorXd::Unit(controlCount(), 0) * thrust;
  Eigen::VectorXd together = allUp();
  if (ring_ < 0) together.setZero();  // a held ring moves with nobody
  StepperSettings settings;
  settings.largest_step = H;
  Stepper stepper(problem_, Scheme(SchemeKind::BACKWARD_EULER), settings);
  const ControlOf control = [&](double, double) { return load; };
  const solver::Coordinates& coordinates = problem_->coordinates();
  /// At rest but for the initial speed of all. @param turned  of the wings' bars beyond what they are in `like`
  const auto at = [&](const Eigen::VectorXd& full, const Eigen::VectorXd& turned, const MotionState* like) {
    MotionState out = stepper.start(coordinates.freePart(full, turned), load, trial_.initial_speed * together,
                                    like != nullptr ? like->references : nullptr);
    if (like != nullptr) out.multipliers = like->multipliers;
    return out;
  };
  Eigen::VectorXd y = Eigen::VectorXd::Zero(centre_ + 1);
  y.head(nodes_) = scene_->terms().coordinates().expand(rest.z, Eigen::VectorXd::Constant(1, rest.control));
  y(centre_) = -rest.control;
  const MotionState unloaded = at(y, wings_.turned(scene_->monitors(rest.z, rest.control).front()), nullptr);
  const Eigen::VectorXd as_they_are = Eigen::VectorXd::Zero(wings_.rotationCount());
  MotionState state = unloaded;
  double acceleration = 0;  // of the whole
  for (int k = 0; k < STEPS; ++k) {
    // So much slower at the step's start that it has the initial speed in the step: drag is that of the start.
    MotionState from = k == 0 ? state : at(state.y - ringPosition(state) * together, as_they_are, &state);
    from.v -= H * acceleration * together;
    from.kinetic = stepper.kineticEnergy(from.v);
    stepper.step(from, H, control);
    const double faster = ring_ < 0 ? 0 : ringSpeed(from) - trial_.initial_speed;
    acceleration += faster / H;
    const Eigen::VectorXd moved = from.y - state.y;
    const bool still =
        std::abs(faster) * H < STILL &&
        (moved - (ringPosition(from) - ringPosition(state)) * together).lpNorm<Eigen::Infinity>() < STILL;
    state = from;
    if (still) break;
  }
  state = at(state.y - ringPosition(state) * together, as_they_are, &state);
  const double found = travel(state);
  const bool exists = mode == vehicle::Mode::FIXED_WING ? found < curve_->barrier() : found > curve_->barrier();
  if (held != nullptr) *held = exists;
  return exists ? state : unloaded;
}

Eigen::VectorXd AxisVehicle::inRingFrame(const MotionState& s) const {
  Eigen::VectorXd u = s.y.head(nodes_);
  for (Eigen::Index k = 1; k < u.size(); k += settings_.dimension) u(k) -= ringPosition(s);
  return u;
}

double AxisVehicle::armRotation(const MotionState& s) const { return scene_->monitor(0, inRingFrame(s)); }

double AxisVehicle::wingAngle(const MotionState& s, bool left) const {
  if (!linkage_) return std::numeric_limits<double>::quiet_NaN();
  const int wing = left ? 0 : wings_.wingCount() - 1;
  return wings_.wingAngle(s.y, wing, linkage_->guessAt(scene_->monitor(wing, inRingFrame(s))).wing);
}

double AxisVehicle::hubTwist(const MotionState& s) const {
  double largest = 0;
  for (const auto& hub : hubs_) largest = std::max(largest, std::abs(hub->twist(s.y)));
  return largest;
}

RigidMotions AxisVehicle::rigidMotions() const {
  if (ring_ < 0) return {};
  return [up = allUp()](const Eigen::VectorXd&) { return Eigen::MatrixXd(up); };
}

Eigen::VectorXd AxisVehicle::controls(double from, double h, double thrust) const {
  Eigen::VectorXd out = Eigen::VectorXd::Unit(controlCount(), 0) * thrust;
  if (hand_) out(1) = hand_->meanAcceleration(from, h);
  return out;
}

double AxisVehicle::lowerBarrier() const {
  const vehicle::CurveFeatures features = vehicle::curveFeatures(curve_->table());
  return std::min(features.barrier_forward, features.barrier_back) / share_;
}

AxisSample AxisVehicle::sample(const MotionState& s) const {
  AxisSample out;
  out.time = s.time;
  const double carried = hand_ ? hand_->speed(s.time) : 0;
  out.ring_position = ringPosition(s) + (hand_ ? hand_->position(s.time) : 0);
  out.ring_speed = ringSpeed(s) + carried;
  out.centre_speed = centreSpeed(s) + carried;
  out.travel = travel(s);
  out.travel_rate = travelRate(s);
  out.arm_rotation = armRotation(s);
  if (linkage_) {
    out.wing_left = wingAngle(s, true), out.wing_right = wingAngle(s, false);
    out.hub_twist = hubTwist(s);
  }
  strain_->record(s.y.head(nodes_), out);
  out.kinetic = s.kinetic / share_;
  out.stored = s.stored / share_;
  return out;
}

double AxisVehicle::commonSpeed(const MotionState& s, const Stepper& stepper) const {
  const Eigen::VectorXd up = allUp();
  return up.dot(stepper.momentum(s.v)) / up.dot(stepper.momentum(up));
}

double AxisVehicle::relativeKinetic(const MotionState& s, const Stepper& stepper) const {
  if (ring_ < 0) return s.kinetic / share_;
  const Eigen::VectorXd up = allUp(), moved = stepper.momentum(up);
  const double momentum = moved.dot(s.v);
  return (s.kinetic - momentum * momentum / (2 * moved.dot(up))) / share_;
}

std::string AxisVehicle::vtu(const MotionState& s) const {
  const Eigen::VectorXd u = inRingFrame(s);
  return scene_->vtu(scene_->terms().coordinates().linear().freePart(u), travel(s));
}

std::vector<std::string> AxisVehicle::leftOut() const {
  std::vector<std::string> out{
      "motion across the thrust axis and rotation of the vehicle: arms without and with wings, or "
      "left and right ones, move alike among themselves",
      "friction of the arms' axles beyond the damping ratio",
      "thrust that falls with airspeed, battery sag, yaw moment of the propellers"};
  if (series_.empty()) {
    out.push_back(std::string("memory of the material (material.relaxation is ") +
                  (memory_known_ ? "off" : "not given") + "): a slow curve, a snap and a rest have one modulus");
  }
  if (linkage_) {
    for (const std::string& what : wings_.leftOut(settings_.wing_forces)) out.push_back(what);
  } else {
    out.push_back("wings and their linkage");
  }
  if (trial_.mount == Mount::BOOM) {
    out.push_back("the boom's turning: no centripetal load on centre and arms (freedom: six)");
  }
  if (hand_) out.push_back("the hand's own speed in the drag of the centre");
  if (settings_.dimension == 2) out.push_back("what a solid's thickness does beyond plane stress (rung volumetric)");
  return out;
}

}  // namespace snapwing::motion
