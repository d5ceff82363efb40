// Solids in time against published and exact answers: CSM3 with our law, a deep beam under a step load (NAFEMS 5T), a
// manufactured solution, and the dynamic snap of a shallow arch.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "snapwing/common/error.h"
#include "snapwing/solver/elastic_term.h"
#include "snapwing/solver/load_term.h"
#include "snapwing/solver/material_damping.h"
#include "solid_motion.h"

namespace snapwing::motion {
namespace {

using solver::Order;
using solver::Term;
const double PI = std::acos(-1.0);

/// Displacement of a point through a scene's monitors, at full coordinates.
double monitorAt(const scene::CompiledScene& scene, int number, const Eigen::VectorXd& y) {
  return scene.monitor(number, y.head(scene.planar()->dofCount()));
}

void addMonitor(scene::Scene& scene, double x, double y, const mpm::Point3& direction) {
  scene::SceneMonitor m;
  m.name = "at " + std::to_string(x) + " " + std::to_string(direction.y());
  m.at = {x, y, 0};
  m.direction = direction;
  scene.monitors.push_back(m);
}

/// Smallest value of a parabola through three equally spaced ones, and its place after the first.
std::pair<double, double> lowest(double a, double b, double c, double h) {
  const double slope = (c - a) / 2, curvature = a - 2 * b + c, s = -slope / curvature;
  return {b + slope * s + 0.5 * curvature * s * s, h * (1 + s)};
}

/// The beam of CSM1 and CSM3 of Turek and Hron with our neo-Hookean law. Its end is the arc of a cylinder, which begins
/// 0 to 1.01 mm before the rectangle of .35 m; a straight end .8 mm before it has the same static deflection.
scene::Scene csmBeam() {
  constexpr double BEFORE = 0.0008;
  scene::Scene scene = test::planarScene("csm", mpm::makeBox(test::boxOf(-BEFORE, 0.35, 0, 0.02)), 0.0025,
                                         {2 * 0.5e6 * 1.4, 0.4, 1000}, 1.0);
  scene.supports.push_back({"cylinder", 0, test::boxOf(-BEFORE, -BEFORE, -1, 1), {0, 1}});
  scene.gravity = {0, -2, 0};
  addMonitor(scene, 0.35, 0.01, {1, 0, 0});
  addMonitor(scene, 0.35, 0.01, {0, 1, 0});
  return scene;
}

/// docs/references.md: ux -7.161, uy -66.110 mm at rest.
TEST(Solids, BeamOfCsm1HangsAsTheReferenceSays) {
  const auto compiled = scene::compileScene(csmBeam(), 1);
  Stepper stepper(test::inTime(*compiled), Scheme(SchemeKind::BACKWARD_EULER), test::equalSteps(1));
  MotionState state = stepper.start(Eigen::VectorXd::Zero(stepper.problem().freeCount()), Eigen::VectorXd::Zero(1));
  for (int k = 0; k < 30; ++k) stepper.step(state, state.time + 1, test::constantControl(0));
  EXPECT_NEAR(monitorAt(*compiled, 1, state.y), -0.066110, 0.002 * 0.066110);
  EXPECT_NEAR(monitorAt(*compiled, 0, state.y), -0.007161, 0.003 * 0.007161);
}

/// Released from rest under gravity, undamped. docs/references.md: first minimum of uy(A) -129.65 +- .1 mm at .4583 +-
/// .0005 s, ux -29.18 +- .05 mm.
TEST(Solids, ReleasedBeamOfCsm3SwingsAsTheReferenceSays) {
  const auto compiled = scene::compileScene(csmBeam(), 1);
  constexpr double H = 0.005;
  Stepper stepper(test::inTime(*compiled), Scheme(SchemeKind::MIDPOINT), test::equalSteps(H));
  MotionState state = stepper.start(Eigen::VectorXd::Zero(stepper.problem().freeCount()), Eigen::VectorXd::Zero(1));
  double uy[3] = {0, 0, 0}, ux[3] = {0, 0, 0}, imbalance = 0, stored = 0;
  while (state.time < 0.6) {
    const StepAccount account = stepper.step(state, 0.6, test::constantControl(0));
    imbalance += account.imbalance, stored = std::max(stored, account.stored);
    uy[0] = uy[1], uy[1] = uy[2], uy[2] = monitorAt(*compiled, 1, state.y);
    ux[0] = ux[1], ux[1] = ux[2], ux[2] = monitorAt(*compiled, 0, state.y);
    if (uy[1] < uy[0] && uy[1] < uy[2]) break;
  }
  const auto [least, after] = lowest(uy[0], uy[1], uy[2], H);
  EXPECT_NEAR(least, -0.12965, 0.003 * 0.12965);
  EXPECT_NEAR(state.time - 2 * H + after, 0.4583, 0.005 * 0.4583);
  EXPECT_NEAR(ux[1], -0.02918, 0.005 * 0.02918);
  EXPECT_LT(std::abs(imbalance), 1e-3 * stored);
}

/// NAFEMS 5T: deep simply supported beam, 10 x 2 x 2 m, suddenly loaded with 1e6 N/m, Rayleigh 5.36 M + 7.46e-5 K.
/// Peak 1.043 mm at .0117 s, static .538 mm (NAFEMS R0016). Half of it, supported at the middle of
/// its end.
TEST(Solids, DeepBeamUnderAStepLoadPeaksAsNafems5T) {
  scene::Scene scene = test::planarScene("5T", mpm::makeBox(test::boxOf(0, 5, 0, 2)), 0.25, {200e9, 0.3, 8000}, 2.0,
                                         elasticity::Plane::STRESS);
  scene.supports = {{"end", 0, test::boxOf(0, 0, 0.75, 1.25), {1}}, {"middle", 0, test::boxOf(5, 5, -1, 3), {0}}};
  scene::SceneLoad load;
  load.name = "step";
  load.body = 0;
  load.region = test::boxOf(0, 5, 2, 2);
  load.force = {0, -5e6, 0};
  load.constant = true;
  scene.loads.push_back(load);
  addMonitor(scene, 5, 1, {0, 1, 0});
  const auto compiled = scene::compileScene(scene, 1);
  const auto solid =
      std::dynamic_pointer_cast<const solver::ElasticTerm<2>>(compiled->sharedTerms()->terms().front())->sharedSolid();
  const auto mass = std::make_shared<const mpm::Mass<2>>(*solid, std::vector<double>{8000.0});
  const auto damping =
      std::make_shared<const solver::RayleighTerm<2>>(solid, mass, 5.36, 7.46e-5, solver::LaggedTangent::EXACT);
  constexpr double H = 2e-4;
  Stepper stepper(test::inTime(*compiled, {damping}), Scheme(SchemeKind::MIDPOINT), test::equalSteps(H));
  MotionState state = stepper.start(Eigen::VectorXd::Zero(stepper.problem().freeCount()), Eigen::VectorXd::Zero(1));
  double u[3] = {0, 0, 0};
  while (state.time < 0.03) {
    stepper.step(state, 0.03, test::constantControl(0));
    u[0] = u[1], u[1] = u[2], u[2] = monitorAt(*compiled, 0, state.y);
    if (u[1] < u[0] && u[1] < u[2] && state.time > 0.006) break;
  }
  const auto [least, after] = lowest(u[0], u[1], u[2], H);
  EXPECT_NEAR(least, -1.043e-3, 0.02 * 1.043e-3);
  EXPECT_NEAR(state.time - 2 * H + after, 0.0117, 0.02 * 0.0117);
}

/// u1 = A sin(2 pi X) sin(c pi t), u2 = A sin(2 pi Y) sin(c pi t + pi) on the unit square solves our law with these
/// body forces per mass (Wallstedt and Guilkey 2008).
struct Manufactured {
  double amplitude = 0.02, mu = 1e4 / 2.6, lambda = 1e4 * 0.3 / (1.3 * 0.4), density = 1000;
  double c() const { return std::sqrt(1e4 / density); }
  Eigen::Vector2d displacement(double x, double y, double t) const {
    return {amplitude * std::sin(2 * PI * x) * std::sin(c() * PI * t),
            amplitude * std::sin(2 * PI * y) * std::sin(c() * PI * t + PI)};
  }
  Eigen::Vector2d rate(double x, double y, double t) const {
    return c() * PI *
           Eigen::Vector2d(amplitude * std::sin(2 * PI * x) * std::cos(c() * PI * t),
                           amplitude * std::sin(2 * PI * y) * std::cos(c() * PI * t + PI));
  }
  Eigen::Vector2d bodyForce(double x, double y, double t) const {
    const Eigen::Vector2d u = displacement(x, y, t);
    const double f1 = 1 + 2 * PI * amplitude * std::cos(2 * PI * x) * std::sin(c() * PI * t),
                 f2 = 1 + 2 * PI * amplitude * std::cos(2 * PI * y) * std::sin(c() * PI * t + PI);
    const auto force = [&](double value, double own) {
      const double k = lambda * (std::log(f1 * f2) - 1) - mu;
      return PI * PI * value * (4 * mu / density - c() * c() - 4 * k / (density * own * own));
    };
    return {force(u(0), f1), force(u(1), f2)};
  }
};

/// Body force per mass as a dead load at the time that the control states.
class TimedBodyForce : public Term {
 public:
  TimedBodyForce(const Manufactured& of, std::shared_ptr<const mpm::Discretisation<2>> solid)
      : of_(of), solid_(std::move(solid)) {}
  std::string name() const override { return "body force"; }
  Role role() const override { return Role::LOAD; }
  void evaluate(const solver::Point& at, Order order, solver::Sum& sum) const override {
    const Eigen::VectorXd load = loadAt(at.p(0));
    sum.energy -= load.dot(at.y);
    if (order == Order::ENERGY) return;
    sum.gradient -= load;
    sum.noteForce(load.norm());
  }

 private:
  Eigen::VectorXd loadAt(double time) const {
    Eigen::VectorXd load = Eigen::VectorXd::Zero(solid_->dofCount());
    for (int c = 0; c < solid_->cellCount(); ++c) {
      const mpm::QuadratureRule<2>& rule = solid_->rule(solid_->terms(solid_->cell(c).kind).front().rule);
      const auto& grid = solid_->grid(0);
      const Eigen::Vector2d corner =
          grid.cellCentre(solid_->cellAt(c)) - Eigen::Vector2d::Constant(0.5 * grid.cell_size);
      for (int q = 0; q < rule.size(); ++q) {
        const Eigen::Vector2d x = corner + grid.cell_size * rule.local[q];
        const Eigen::Vector2d force =
            of_.density * solid_->cell(c).measure * rule.weight[q] * of_.bodyForce(x(0), x(1), time);
        for (int a = 0; a < rule.stencil; ++a) {
          load.segment<2>(2 * solid_->cellNodes(c)[a]) += rule.valueOf(q)[a] * force;
        }
      }
    }
    return load;
  }
  Manufactured of_;
  std::shared_ptr<const mpm::Discretisation<2>> solid_;
};

struct ManufacturedEnd {
  Eigen::VectorXd found, exact;  ///< at the nodes
  double error() const { return rms(found - exact); }
  static double rms(const Eigen::VectorXd& d) { return d.norm() / std::sqrt(d.size() / 2.0); }
};

ManufacturedEnd manufacturedEnd(const Scheme& scheme, int cells, int steps) {
  const Manufactured exact;
  scene::Scene scene = test::planarScene("manufactured", mpm::makeBox(test::boxOf(0, 1, 0, 1)), 1.0 / cells,
                                         {1e4, 0.3, exact.density}, 1.0);
  scene.kernel = scene::SceneKernel::LINEAR;
  scene.supports = {{"left", 0, test::boxOf(0, 0, -1, 2), {0}},
                    {"right", 0, test::boxOf(1, 1, -1, 2), {0}},
                    {"low", 0, test::boxOf(-1, 2, 0, 0), {1}},
                    {"high", 0, test::boxOf(-1, 2, 1, 1), {1}}};
  const auto compiled = scene::compileScene(scene, 1);
  const auto solid =
      std::dynamic_pointer_cast<const solver::ElasticTerm<2>>(compiled->sharedTerms()->terms().front())->sharedSolid();
  Stepper stepper(test::inTime(*compiled, {std::make_shared<const TimedBodyForce>(exact, solid)}), scheme,
                  test::equalSteps(1, 1e-11));
  Eigen::VectorXd rate(solid->dofCount()), end(solid->dofCount());
  const double last = 0.4 / exact.c();
  for (int n = 0; n < solid->nodeCount(); ++n) {
    const Eigen::Vector2d x = solid->position(n);
    rate.segment<2>(2 * n) = exact.rate(x(0), x(1), 0);
    end.segment<2>(2 * n) = exact.displacement(x(0), x(1), last);
  }
  MotionState state =
      stepper.start(Eigen::VectorXd::Zero(stepper.problem().freeCount()), Eigen::VectorXd::Zero(1), rate);
  const double share = scheme.kind() == SchemeKind::BACKWARD_EULER ? 1.0 : 0.5;
  const ControlOf clock = [&](double from, double h) { return Eigen::VectorXd::Constant(1, from + share * h); };
  for (int k = 0; k < steps; ++k) stepper.step(state, last * (k + 1) / steps, clock);
  return {state.y, end};
}

TEST(Solids, ManufacturedSolutionHasItsOrders) {
  for (const SchemeKind kind : {SchemeKind::MIDPOINT, SchemeKind::AVERAGE_FORCE}) {
    const Scheme scheme(kind);
    const double coarse = manufacturedEnd(scheme, 8, 40).error(), fine = manufacturedEnd(scheme, 16, 80).error();
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2) << schemeName(kind) << ", cells and steps together";
  }
  // In time alone: differences between runs on the same cells.
  for (const auto& [kind, order] : {std::pair{SchemeKind::BACKWARD_EULER, 1.0}, std::pair{SchemeKind::MIDPOINT, 2.0},
                                    std::pair{SchemeKind::AVERAGE_FORCE, 2.0}}) {
    Eigen::VectorXd ends[3];
    for (int k = 0; k < 3; ++k) ends[k] = manufacturedEnd(Scheme(kind), 8, 20 << k).found;
    const double first = ManufacturedEnd::rms(ends[1] - ends[0]), second = ManufacturedEnd::rms(ends[2] - ends[1]);
    EXPECT_NEAR(std::log2(first / second), order, 0.2) << schemeName(kind) << ", steps alone";
  }
}

/// A sine of a rise h over a span, of constant thickness along its normal.
class SineArch : public mpm::Shape {
 public:
  SineArch(double span, double rise, double thickness) : span_(span), rise_(rise), half_(0.5 * thickness) {}
  bool contains(const mpm::Point3& point) const override {
    double x = point.x();  // foot of the normal, by Newton's method
    for (int i = 0; i < 4; ++i) {
      const double k = PI / span_, y = rise_ * std::sin(k * x), dy = rise_ * k * std::cos(k * x),
                   ddy = -rise_ * k * k * std::sin(k * x);
      const double f = (x - point.x()) + (y - point.y()) * dy, df = 1 + dy * dy + (y - point.y()) * ddy;
      x -= f / df;
    }
    if (x < -half_ || x > span_ + half_) return false;  // beyond the pins, so that they hold whole sections
    const double dx = x - point.x(), dy = rise_ * std::sin(PI * x / span_) - point.y();
    return dx * dx + dy * dy <= half_ * half_;
  }
  mpm::Box bounds() const override { return test::boxOf(-2 * half_, span_ + 2 * half_, -2 * half_, rise_ + half_); }

 private:
  double span_, rise_, half_;
};

struct Arch {
  std::unique_ptr<scene::CompiledScene> scene;
  std::shared_ptr<const solver::TermProblem> problem;
  double unit = 1;  ///< [N/m] that p = 1 stands for: EI r pi^4 / L^4
};

/// Pinned shallow arch of rise e r, loaded by p sin(pi x / L) per length through the control.
Arch archOf(double e) {
  constexpr double SPAN = 1, THICKNESS = 0.02, MODULUS = 1e6;
  const double r = THICKNESS / std::sqrt(12.0);
  scene::Scene scene = test::planarScene("arch", std::make_shared<SineArch>(SPAN, e * r, THICKNESS), THICKNESS / 2,
                                         {MODULUS, 0.0, 1000}, 1.0);
  scene.particles = 6;
  for (const double x : {0.0, SPAN}) {
    scene.pins.push_back({x == 0 ? "left" : "right", 0, x, 0.0, scene::PinKind::MEAN, 0.5 * THICKNESS});
  }
  addMonitor(scene, 0.5 * SPAN, e * r, {0, 1, 0});
  Arch arch;
  arch.scene = scene::compileScene(scene, 1);
  const mpm::Discretisation<2>& solid = *arch.scene->planar();
  arch.unit = MODULUS * std::pow(THICKNESS, 3) / 12 * r * std::pow(PI / SPAN, 4);
  // Mass of unit density per thickness: nodal forces of a load that is spread over it.
  const mpm::Mass<2> spread(solid, {1 / THICKNESS});
  Eigen::VectorXd sine = Eigen::VectorXd::Zero(solid.dofCount());
  for (int n = 0; n < solid.nodeCount(); ++n) sine(2 * n + 1) = -std::sin(PI * solid.position(n).x() / SPAN);
  Eigen::MatrixXd load = arch.unit * spread.multiply(sine);
  arch.problem = test::inTime(*arch.scene, {std::make_shared<const solver::LoadTerm>(Eigen::VectorXd(), load)});
  return arch;
}

/// Does it snap under a load that is put on at once, within three periods of the straight beam?
bool snapsUnder(const Arch& arch, double p, double rise) {
  Stepper stepper(arch.problem, Scheme(SchemeKind::MIDPOINT), test::equalSteps(0.02, 1e-7));
  MotionState state = stepper.start(Eigen::VectorXd::Zero(arch.problem->freeCount()), Eigen::VectorXd::Constant(1, p));
  // Straight beam: w = pi^2 sqrt(EI / (rho A L^4)).
  const double period = 2 * PI / (PI * PI * std::sqrt(1e6 * 0.02 * 0.02 / 12 / 1000));
  while (state.time < 3 * period) {
    stepper.step(state, 3 * period, test::constantControl(p));
    if (monitorAt(*arch.scene, 0, state.y) < -1.5 * rise) return true;
  }
  return false;
}

/// Least step load that snaps, in units of p: exact in one mode for e <= 4 (docs/references.md). 1 % below stays, 1 %
/// above snaps. The solid is a little stiffer or softer than the beam (cut cells, shear, t/L = .02): judged against the
/// static limit of the same solid, whose ratio to the step limit is exact too.
TEST(Solids, ShallowArchSnapsUnderAStepLoadAtItsDynamicLimit) {
  for (const auto& [e, exact] : {std::pair{2.5, 2.25}, std::pair{4.0, 6.208251}}) {
    const Arch arch = archOf(e);
    const double rise = e * 0.02 / std::sqrt(12.0);
    EXPECT_FALSE(snapsUnder(arch, 0.99 * exact, rise)) << e;
    EXPECT_TRUE(snapsUnder(arch, 1.01 * exact, rise)) << e;
  }
}

}  // namespace
}  // namespace snapwing::motion
