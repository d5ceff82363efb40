// A clamped beam that has buckled, ringing about its second state: frequencies in closed form (Nayfeh, Kreider and
// Anderson, AIAA J. 1995; docs/references.md).
#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/solver/equilibrium.h"
#include "solid_motion.h"

namespace snapwing::motion {
namespace {

constexpr double SPAN = 1, THICKNESS = 0.01, MODULUS = 1e6, DENSITY = 1000;
const double GYRATION = THICKNESS / std::sqrt(12.0);
const double UNIT =
    std::sqrt(MODULUS * GYRATION * GYRATION / DENSITY) / (SPAN * SPAN);  // [rad/s] of w L^2 sqrt(rho A/EI)

class Buckled {
 public:
  /// @param rise  of the middle, in radii of gyration
  explicit Buckled(double rise) {
    scene::Scene s = test::planarScene("beam", mpm::makeBox(test::boxOf(0, SPAN, 0, THICKNESS)), THICKNESS / 2,
                                       {MODULUS, 0.0, DENSITY}, 1.0);
    s.supports.push_back({"left", 0, test::boxOf(0, 0, 0, THICKNESS), {0, 1}, {}});
    scene::ScenePort port;
    port.name = "right";
    port.region = test::boxOf(SPAN, SPAN, 0, THICKNESS);
    port.direction = {-1, 0, 0};
    s.ports.push_back(port);
    s.control_is_length = true;
    scene::SceneMonitor middle;
    middle.name = "middle";
    middle.at = {SPAN / 2, THICKNESS / 2, 0};
    middle.direction = {0, 1, 0};
    s.monitors.push_back(middle);
    scene_ = scene::compileScene(s, 1);
    solver_ = std::make_unique<solver::EquilibriumSolver>(scene_->problem(), solver::NewtonSettings{});
    // Shortening of a shallow buckled beam; then by secants to the wanted rise.
    const double pi2 = M_PI * M_PI;
    double shortening = GYRATION * GYRATION * pi2 / SPAN * (rise * rise / 4 + 4);
    x_ = solver_->start(guess(rise, shortening), shortening);
    for (int k = 0; k < 4; ++k) {
      x_.p(0) = shortening;
      EXPECT_TRUE(solver_->minimise(x_).converged());
      const double found = scene_->monitors(x_.z, shortening)[0] / GYRATION;
      shortening += GYRATION * GYRATION * pi2 / SPAN * (rise * rise - found * found) / 4;
    }
    EXPECT_NEAR(scene_->monitors(x_.z, x_.p(0))[0] / GYRATION, rise, 1e-4 * rise);
    solver_->linearise(x_);
    EXPECT_EQ(x_.negative_pivots, 0);
    problem_ = test::inTime(*scene_);
  }

  /// Smallest frequency among motions of a parity, by inverse iteration, and its mode (full coordinates). [rad/s]
  double frequency(bool symmetric, Eigen::VectorXd& mode) {
    const solver::Reduction& linear = problem_->coordinates().linear();
    const mpm::Discretisation<2>& solid = *scene_->planar();
    Eigen::VectorXd full = Eigen::VectorXd::Zero(solid.dofCount());
    for (int n = 0; n < solid.nodeCount(); ++n) {
      const double x = solid.position(n).x() / SPAN;
      full(2 * n + 1) = (1 - std::cos(2 * M_PI * x)) * (symmetric ? 1 : std::sin(2 * M_PI * x));
    }
    Eigen::VectorXd z = linear.freePart(full), lambda, next;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(1);
    double square = 0;
    // Few: rounding brings the other parity in, which grows where its frequency is lower.
    for (int k = 0; k < 5; ++k) {
      const Eigen::VectorXd v = linear.expandDirection(z, none);
      const Eigen::VectorXd force = linear.restrictToFree(momentumOf(*problem_, v));
      solver_->system().solve(force, Eigen::VectorXd(), next, lambda);
      square = z.dot(force) / next.dot(force);  // Rayleigh's, as z nears the mode
      z = next / next.norm();
    }
    mode = linear.expandDirection(z, none);
    return std::sqrt(square);
  }

  /// The same by swinging in that mode: twice the time between zeros of the motion along it. [rad/s]
  double ringing(const Eigen::VectorXd& mode, double expected) const {
    const double h = 2 * M_PI / expected / 100;
    Stepper stepper(problem_, Scheme(SchemeKind::MIDPOINT), test::equalSteps(h, 1e-9));
    const double largest = mode.cwiseAbs().maxCoeff();
    const Eigen::VectorXd rate = 1e-3 * THICKNESS * expected / largest * mode;
    MotionState state = stepper.start(x_.z, x_.p, rate);
    const Eigen::VectorXd start = state.y, along = momentumOf(*problem_, mode);
    std::vector<double> zeros;
    for (double before = 0; zeros.size() < 3;) {
      const double from = state.time;
      stepper.step(state, from + h, test::constantControl(x_.p(0)));
      const double now = along.dot(state.y - start);
      if (from > 0 && before * now < 0) zeros.push_back(from + h * before / (before - now));
      before = now;
      if (state.time > 30 / expected) return 0;
    }
    return 2 * M_PI / (zeros[2] - zeros[0]);
  }

 private:
  Eigen::VectorXd guess(double rise, double shortening) const {
    const mpm::Discretisation<2>& solid = *scene_->planar();
    Eigen::VectorXd y(solid.dofCount());
    for (int n = 0; n < solid.nodeCount(); ++n) {
      const Eigen::Vector2d x = solid.position(n);
      const double k = 2 * M_PI / SPAN, w = 0.5 * rise * GYRATION;
      y.segment<2>(2 * n) =
          Eigen::Vector2d(-shortening * x(0) / SPAN - (x(1) - THICKNESS / 2) * w * k * std::sin(k * x(0)),
                          w * (1 - std::cos(k * x(0))));
    }
    return scene_->terms().coordinates().linear().freePart(y);
  }

  std::unique_ptr<scene::CompiledScene> scene_;
  std::unique_ptr<solver::EquilibriumSolver> solver_;
  std::shared_ptr<const solver::TermProblem> problem_;
  solver::Equilibrium x_;
};

TEST(BuckledBeam, RingsAboutItsSecondState) {
  for (const auto& [rise, symmetric] : {std::pair{2.0, 15.9279}, std::pair{4.0, 30.7067}}) {
    Buckled beam(rise);
    Eigen::VectorXd mode;
    const double even = beam.frequency(true, mode);
    EXPECT_NEAR(even / UNIT, symmetric, 0.01 * symmetric) << rise;
    EXPECT_NEAR(beam.ringing(mode, even), even, 2e-3 * even) << "in time";
    const double odd = beam.frequency(false, mode);
    EXPECT_NEAR(odd / UNIT, 44.3627, 0.01 * 44.3627) << "whatever the rise";
    EXPECT_NEAR(beam.ringing(mode, odd), odd, 2e-3 * odd) << "in time";
  }
}

}  // namespace
}  // namespace snapwing::motion
