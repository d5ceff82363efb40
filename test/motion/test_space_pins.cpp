// Terms of pins and hubs in space: derivatives, and moments on the whole; one linkage on a tumbling ring against
// equations of Lagrange's kind.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "one_mode.h"
#include "ring_with_linkage.h"
#include "snapwing/common/error.h"
#include "snapwing/motion/stepper.h"
#include "snapwing/motion/wing_assembly.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"
#include "support/term_check.h"

namespace snapwing::motion {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::RingWithLinkage;

constexpr double L = 0.05;

Directions directionsOf(int first_entry) {
  const solver::Rotation rotation{first_entry, L, {}};
  const auto along = [&](int k) { return solver::SpacePoint::direction(Vector3d::Unit(k), rotation); };
  return {along(0), along(1), along(2)};
}

Matrix3d about(const Vector3d& axis, double angle) { return Eigen::AngleAxisd(angle, axis.normalized()).matrix(); }

void setEntries(const Matrix3d& r, int first, VectorXd& y) {
  const Matrix3d e = L * (r - Matrix3d::Identity());
  for (int k = 0; k < 9; ++k) y(first + k) = e(k);
}

/// Entries of two bodies that share their z axis and stand at an angle; each vector of them a little too short, as in
/// the middle of a step.
VectorXd bodiesAt(const Matrix3d& common, double angle, double stretch = 1) {
  VectorXd y = VectorXd::Zero(18);
  setEntries(stretch * common * about(Vector3d::UnitZ(), angle), 0, y);
  setEntries(stretch * common, 9, y);
  return y;
}

/// Moment of a gradient by the entries of bodies, w(y) = sum of columns x their slopes: 0 for what a rotation of all
/// leaves as it is.
Vector3d momentOnEntries(const VectorXd& y, const VectorXd& gradient, const std::vector<int>& firsts) {
  Vector3d sum = Vector3d::Zero();
  for (const int first : firsts) {
    for (int j = 0; j < 3; ++j) {
      const Vector3d column = y.segment<3>(first + 3 * j) + L * Vector3d::Unit(j);
      sum += column.cross(gradient.segment<3>(first + 3 * j));
    }
  }
  return sum;
}

VectorXd gradientOf(const solver::Term& term, const VectorXd& y, const solver::Step* step) {
  solver::Sum sum;
  solver::HessianLayout layout(static_cast<int>(y.size()));
  std::vector<int> places;
  for (const auto& couple : term.couples()) places.push_back(layout.addCouple(couple));
  sum.reset(layout, 0, solver::Order::STRESS);
  sum.couples = &places;
  term.evaluate({y, VectorXd(), step}, solver::Order::STRESS, sum);
  return sum.gradient;
}

const Matrix3d TILTED = about({1, 2, -1}, 2.1), FURTHER = about({0.3, -1, 0.5}, 0.12) * TILTED;

TEST(SpaceAngle, ItsTermsPassTheBatteryAndTurnNothingAsAWhole) {
  const auto angle = std::make_shared<const SpaceAngle>(directionsOf(0), directionsOf(9));
  EXPECT_NEAR(angle->at(bodiesAt(TILTED, 0.7)), 0.7, 1e-12);
  EXPECT_NEAR(angle->at(bodiesAt(TILTED, -2.9, 0.98)), -2.9, 1e-12);
  const VectorXd start = bodiesAt(TILTED, 0.4);
  const solver::Step step = test::stepFrom(start);
  const std::vector<VectorXd> places{bodiesAt(FURTHER, 0.47), bodiesAt(TILTED, 0.36), bodiesAt(FURTHER, 0.4)};
  const PinFriction pin("pin", angle, 2e-4, 0.6);
  const TurningDrag air("air", angle, 5e-5);
  const AngleEnergy flexure("flexure", angle, SmoothCurve({-0.1, 0.2, 0.5, 1}, {1e-4, 0, 3e-4, 2e-3}));
  for (const solver::Term* term : std::initializer_list<const solver::Term*>{&pin, &air, &flexure}) {
    test::TermCase c{solver::HessianLayout(18), places};
    c.step = &step;
    c.scale = 1e-5;
    test::checkTerm(*term, c);
    const bool in_step = term != &flexure;
    for (const VectorXd& y : places) {
      const VectorXd gradient = gradientOf(*term, y, &step), where = in_step ? VectorXd(0.5 * (start + y)) : y;
      EXPECT_LT(momentOnEntries(where, gradient, {0, 9}).norm(), 1e-13 * L * gradient.norm()) << term->name();
      EXPECT_GT(gradient.norm(), 0);
    }
  }
  EXPECT_GT(gradientOf(pin, places[0], &step).dot(places[0] - start), 0) << "takes energy";
  EXPECT_THROW(PinFriction("pin", angle, -1, 1), common::Error);
}

TEST(SpaceAngle, InItsPlaneItIsThePlanesAngle) {
  const SpaceAngle space(directionsOf(0), directionsOf(9));
  const TurningAngle plane("pin", {{0, 1, L}, {9, 10, L}});
  const VectorXd from = bodiesAt(about(Vector3d::UnitZ(), 0.3), 0.5),
                 y = bodiesAt(about(Vector3d::UnitZ(), 0.35), 0.56);
  EXPECT_NEAR(space.at(y), plane.at(y), 1e-14);
  EXPECT_NEAR(space.between(from, y), plane.between(from, y), 1e-14);
}

/// Four nodes about the axle, which moves as well, then the crank's entries.
struct HubCase {
  static constexpr double R = 0.004, K = 20;
  static constexpr int POINT = 12, CRANK = 15, FULL = 24;
  std::array<Vector3d, 4> rest;
  std::array<double, 4> weight{1, 0.7, 1.2, 0.9};
  VectorXd gradient = VectorXd::Zero(FULL);
  HubCase() {
    double square = 0;
    for (int n = 0; n < 4; ++n) {
      rest[n] = Vector3d(R * std::cos(1.6 * n + 0.3), R * std::sin(1.6 * n + 0.3), (n % 2 == 0 ? 1 : -1) * 0.002);
      square += weight[n] * rest[n].head<2>().squaredNorm();
    }
    for (int n = 0; n < 4; ++n) {
      gradient.segment<2>(3 * n) = weight[n] / square * Vector2d(-rest[n](1), rest[n](0));
    }
  }
  SpaceHub hub() const {
    Eigen::Matrix3Xd x = Eigen::Matrix3Xd::Zero(3, 15), y = x;
    Vector3d rest_x = Vector3d::Zero(), rest_y = rest_x;
    std::vector<int> coordinates;
    for (int n = 0; n < 4; ++n) {
      const double by_x = gradient(3 * n + 1), by_y = -gradient(3 * n);
      x.middleCols<3>(3 * n) = by_x * Matrix3d::Identity(), y.middleCols<3>(3 * n) = by_y * Matrix3d::Identity();
      x.rightCols<3>() -= by_x * Matrix3d::Identity(), y.rightCols<3>() -= by_y * Matrix3d::Identity();
      rest_x += by_x * rest[n], rest_y += by_y * rest[n];
    }
    for (int k = 0; k < 15; ++k) coordinates.push_back(k);
    return {"hub", {rest_x, coordinates, x}, {rest_y, coordinates, y}, directionsOf(CRANK), K};
  }
  VectorXd posed(const Matrix3d& arm, const Matrix3d& crank, const Vector3d& moved) const {
    VectorXd y(FULL);
    for (int n = 0; n < 4; ++n) y.segment<3>(3 * n) = arm * rest[n] + moved - rest[n];
    y.segment<3>(POINT) = moved;
    setEntries(crank, CRANK, y);
    return y;
  }
};

TEST(SpaceHub, PassesTheBatteryAndTurnsNothingAsAWhole) {
  const HubCase c;
  const SpaceHub hub = c.hub();
  const Vector3d moved(0.3, -0.2, 0.5);
  const auto turned = [](double angle) { return about(Vector3d::UnitZ(), angle); };
  const VectorXd twisted = c.posed(TILTED * turned(0.9), TILTED * turned(0.87), moved);
  EXPECT_NEAR(hub.twist(twisted), 0.03, 1e-12);
  const std::vector<VectorXd> places{twisted, c.posed(turned(0.2), turned(0.3), moved),
                                     c.posed(FURTHER * turned(0.5), TILTED * turned(0.5), 0 * moved)};
  test::checkTerm(hub, {solver::HessianLayout(HubCase::FULL), places});
  for (const VectorXd& y : places) {
    const VectorXd gradient = gradientOf(hub, y, nullptr);
    Vector3d moment = momentOnEntries(y, gradient, {HubCase::CRANK}), force = gradient.segment<3>(HubCase::POINT);
    moment += Vector3d(y.segment<3>(HubCase::POINT)).cross(force);
    for (int n = 0; n < 4; ++n) {
      const Vector3d own = gradient.segment<3>(3 * n);
      moment += (c.rest[n] + y.segment<3>(3 * n)).cross(own);
      force += own;
    }
    EXPECT_LT(force.norm(), 1e-12 * gradient.norm());
    EXPECT_LT(moment.norm(), 1e-12 * L * gradient.norm());
  }
  // In the plane it is the plane's term.
  const HubTerm plane("hub", c.gradient, {0, 3, 6, 9}, HubCase::POINT, {HubCase::CRANK, HubCase::CRANK + 1, L},
                      HubCase::K);
  EXPECT_NEAR(hub.twist(places[1]), plane.twist(places[1]), 1e-12);
  EXPECT_LT((gradientOf(hub, places[1], nullptr).head<2>() - gradientOf(plane, places[1], nullptr).head<2>()).norm(),
            1e-12 * gradientOf(plane, places[1], nullptr).norm());
}

/// The same of the house's parts: full coordinates c of ring and bars, then their E.
struct LinkageProblem {
  WingAssembly wings;
  std::shared_ptr<const solver::TermProblem> problem;
  static constexpr int RING = 12, BARS = 21, FULL = 48;

  explicit LinkageProblem(const std::shared_ptr<const WingLinkage>& linkage) {
    WingAssembly::Wing wing;
    wing.ring_in_space = directionsOf(RING);
    wings = WingAssembly(linkage, {wing}, 3, 3, BARS);
    const Vector3d point = RingWithLinkage::ringPoint();
    const auto on_ring = [&](int, const Vector2d& at, int axis) {
      const Vector3d way = Vector3d(at(0), at(1), 0) - point;
      std::vector<std::pair<int, double>> terms{{axis, 1.0}};
      for (int j = 0; j < 3; ++j) terms.emplace_back(RING + axis + 3 * j, way(j) / L);
      return terms;
    };
    const std::vector<Vector3d> free{Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
    std::vector<solver::Rotation> rotations{{RING, L, free}};
    for (const solver::Rotation& bar : wings.rotations()) rotations.push_back(bar);
    const solver::SplitEquations split = solver::splitEquations(FULL, 0, wings.equations(on_ring), false, RING, 4, 9);
    solver::TermProblem::Parts parts{solver::HessianLayout(FULL), nullptr, {}, 1, 0, 0};
    parts.coordinates = std::make_shared<const solver::Coordinates>(split.eliminated, 3, rotations);
    parts.constraints = wings.chains(split.kept, 1);
    EXPECT_EQ(parts.constraints->count(), 12);
    EXPECT_EQ(solver::redundantRows(*parts.coordinates, split.kept, 0), parts.constraints->redundant());
    parts.terms.push_back(
        std::make_shared<solver::RigidInertiaTerm>("ring", 3, 0, rotations[0], RingWithLinkage::ringMass()));
    for (const auto& bar : wings.inertia()) parts.terms.push_back(bar);
    problem = std::make_shared<const solver::TermProblem>(std::move(parts));
  }
  /// Rates of the full coordinates at (V, W, q'), with the ring as at rest.
  VectorXd rates(const RingWithLinkage& like, double q, const RingWithLinkage::Vector7& xi) const {
    VectorXd v(FULL);
    for (int body = 0; body < 4; ++body) {
      Eigen::Matrix<double, 3, 4> own = Eigen::Matrix<double, 3, 4>::Zero();
      for (int unit = 0; unit < 7; ++unit) own += xi(unit) * like.velocity(body, q, unit);
      v.segment<3>(3 * body) = own.col(3);
      for (int j = 0; j < 3; ++j) v.segment<3>(RING + 9 * body + 3 * j) = L * own.col(j);
    }
    return v;
  }
};

TEST(SpacePins, ATumblingRingWithAnOpeningLinkageFollowsLagrangesEquations) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::WingTable wing_table = *vehicle::wingTableOf(vehicle, vehicle::armTableOf(vehicle));
  const auto linkage = std::make_shared<const WingLinkage>(wing_table, vehicle.wing.layout_file, 1, 0);
  const LinkageProblem house(linkage);
  const RingWithLinkage like(*linkage);
  const double q = 0.3, until = 0.04;
  RingWithLinkage::Vector7 xi;
  xi << 0.2, -0.4, 0.1, 6, 11, -4, 12;
  RingWithLinkage::State state;
  state.q = q;
  state.momentum = like.mass(q) * xi;
  const RingWithLinkage::State end = like.after(state, until, 800), coarse = like.after(state, until, 400);
  EXPECT_LT((end.r - coarse.r).norm() + std::abs(end.q - coarse.q), 1e-8) << "the reference is converged";
  EXPECT_GT(end.q - q, 0.2);
  EXPECT_GT((end.r - Matrix3d::Identity()).norm(), 0.4);

  std::array<double, 2> off{};
  for (int k = 0; k < 2; ++k) {
    StepperSettings settings;
    settings.largest_step = k == 0 ? 5e-4 : 2.5e-4;
    settings.relative_tolerance = 1e-12;
    Stepper stepper(house.problem, Scheme(SchemeKind::MIDPOINT), settings);
    VectorXd turned = VectorXd::Zero(12);
    turned.tail<9>() = house.wings.turned(q);
    VectorXd y = VectorXd::Zero(LinkageProblem::FULL);
    house.wings.pose(q, y);
    const VectorXd z = house.problem->coordinates().freePart(y, turned);
    MotionState s = stepper.start(z, VectorXd(), house.rates(like, q, xi));
    const double kinetic = 0.5 * xi.dot(like.mass(q) * xi);
    EXPECT_NEAR(s.kinetic, kinetic, 1e-9 * kinetic);
    while (s.time < until) stepper.step(s, until, [](double, double) { return VectorXd(); });
    EXPECT_NEAR(s.kinetic, kinetic, 1e-9 * kinetic) << "no force does work";
    Matrix3d r = Matrix3d::Identity();
    for (int e = 0; e < 9; ++e) r(e) += s.y(LinkageProblem::RING + e) / L;
    const double wing = linkage->at(end.q).wing;
    const Vector3d ring = end.x + end.r * RingWithLinkage::ringPoint() - RingWithLinkage::ringPoint();
    off[k] =
        (r - end.r).norm() + std::abs(house.wings.wingAngle(s.y, 0, wing) - wing) + (s.y.head<3>() - ring).norm() / L;
  }
  EXPECT_LT(off[1], 2e-3);
  EXPECT_NEAR(std::log2(off[0] / off[1]), 2, 0.2) << off[0] << " " << off[1];
}

}  // namespace
}  // namespace snapwing::motion
