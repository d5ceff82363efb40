// Free flight: momenta and energy of soft and rigid bodies, and the spin that backward Euler loses.
#include <gtest/gtest.h>

#include <cmath>

#include "one_mode.h"
#include "solid_motion.h"

namespace snapwing::motion {
namespace {

/// An L of rubber in the plane, spinning and shaken, held by nothing.
struct SoftL {
  SoftL() {
    scene::Scene s = test::planarScene(
        "L", mpm::makeUnion({mpm::makeBox(test::boxOf(0, 0.08, 0, 0.02)), mpm::makeBox(test::boxOf(0, 0.02, 0, 0.06))}),
        0.01, {1e5, 0.3, 1200}, 0.01);
    scene = scene::compileScene(s, 1);
    problem = test::inTime(*scene);
  }
  /// Rates of a spin w about the origin, a common speed, and one that stretches it.
  Eigen::VectorXd rates(double w, double stretch) const {
    const mpm::Discretisation<2>& solid = *scene->planar();
    Eigen::VectorXd v(solid.dofCount());
    for (int n = 0; n < solid.nodeCount(); ++n) {
      const Eigen::Vector2d x = solid.position(n);
      v.segment<2>(2 * n) = Eigen::Vector2d(0.3 - w * x(1) + stretch * x(0), -0.2 + w * x(0));
    }
    return v;
  }
  /// Both translations and the rotation about the origin.
  Eigen::MatrixXd rigid(const Eigen::VectorXd& y) const {
    const mpm::Discretisation<2>& solid = *scene->planar();
    Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(y.size(), 3);
    for (int n = 0; n < solid.nodeCount(); ++n) {
      const Eigen::Vector2d x = solid.position(n) + y.segment<2>(2 * n);
      motions(2 * n, 0) = motions(2 * n + 1, 1) = 1;
      motions(2 * n, 2) = -x(1), motions(2 * n + 1, 2) = x(0);
    }
    return motions;
  }
  Eigen::Vector2d linear(const Stepper& stepper, const MotionState& s) const {
    const Eigen::VectorXd p = stepper.momentum(s.v);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (Eigen::Index k = 0; k < p.size(); k += 2) sum += p.segment<2>(k);
    return sum;
  }
  double angular(const Stepper& stepper, const MotionState& s) const {
    const Eigen::VectorXd p = stepper.momentum(s.v);
    double sum = 0;
    for (int n = 0; n < scene->planar()->nodeCount(); ++n) {
      const Eigen::Vector2d x = scene->planar()->position(n) + s.y.segment<2>(2 * n);
      sum += x(0) * p(2 * n + 1) - x(1) * p(2 * n);
    }
    return sum;
  }
  std::unique_ptr<scene::CompiledScene> scene;
  std::shared_ptr<const solver::TermProblem> problem;
};

struct Drift {
  double linear, angular, energy;  ///< largest, as shares of what there was
};

Drift fly(const Scheme& scheme, double h, int steps) {
  const SoftL body;
  Stepper stepper(body.problem, scheme, test::equalSteps(h, 1e-12),
                  [&](const Eigen::VectorXd& y) { return body.rigid(y); });
  MotionState state =
      stepper.start(Eigen::VectorXd::Zero(body.problem->freeCount()), Eigen::VectorXd::Zero(1), body.rates(8, 2));
  const Eigen::Vector2d p = body.linear(stepper, state);
  const double l = body.angular(stepper, state), e = state.kinetic + state.stored;
  Drift worst{0, 0, 0};
  for (int k = 0; k < steps; ++k) {
    stepper.step(state, state.time + h, test::constantControl(0));
    worst.linear = std::max(worst.linear, (body.linear(stepper, state) - p).norm() / p.norm());
    worst.angular = std::max(worst.angular, std::abs(body.angular(stepper, state) / l - 1));
    worst.energy = std::max(worst.energy, std::abs((state.kinetic + state.stored) / e - 1));
  }
  return worst;
}

TEST(FreeFlight, MidpointKeepsBothMomenta) {
  const Drift drift = fly(Scheme(SchemeKind::MIDPOINT), 1e-3, 400);
  EXPECT_LT(drift.linear, 1e-10);
  EXPECT_LT(drift.angular, 1e-10);
  EXPECT_GT(drift.energy, 1e-9) << "what the average force is for";
}

/// The factor is turned with the body: one that spins through 1.8 rad is factorised in hardly any step, and moves as
/// with a new factor in each.
TEST(FreeFlight, TurnedFactorServesASpinningBody) {
  const SoftL body;
  const auto spun = [&](bool keep_factor, int& factorizations) {
    StepperSettings settings = test::equalSteps(1e-3, 1e-9);
    settings.keep_factor = keep_factor;
    Stepper stepper(body.problem, Scheme(SchemeKind::MIDPOINT), settings);
    MotionState state =
        stepper.start(Eigen::VectorXd::Zero(body.problem->freeCount()), Eigen::VectorXd::Zero(1), body.rates(30, 0.2));
    for (int k = 0; k < 60; ++k)
      factorizations += stepper.step(state, state.time + 1e-3, test::constantControl(0)).factorizations;
    return state;
  };
  int kept = 0, always = 0;
  const MotionState turned = spun(true, kept), exact = spun(false, always);
  EXPECT_LT((turned.y - exact.y).norm(), 1e-8 * exact.y.norm());
  EXPECT_LT(kept, always / 10) << always;
}

TEST(FreeFlight, CorrectedMidpointKeepsMomentaAndEnergy) {
  const Drift drift = fly(Scheme(SchemeKind::CORRECTED_MIDPOINT), 1e-3, 1000);
  EXPECT_LT(drift.linear, 1e-10);
  EXPECT_LT(drift.angular, 1e-10);
  EXPECT_LT(drift.energy, 1e-8);
  EXPECT_GT(fly(Scheme(SchemeKind::MIDPOINT), 1e-3, 1000).energy, 5e-6) << "what the correction is for";
}

TEST(FreeFlight, AverageForceKeepsTheEnergy) {
  const Drift drift = fly(Scheme(SchemeKind::AVERAGE_FORCE, 4), 1e-3, 1000);
  EXPECT_LT(drift.linear, 1e-10);
  EXPECT_LT(drift.energy, 1e-8);
  // Its angular momentum drifts by the step's square: it cannot keep that of a turning soft body.
  const double coarse = fly(Scheme(SchemeKind::AVERAGE_FORCE, 4), 1e-3, 100).angular,
               fine = fly(Scheme(SchemeKind::AVERAGE_FORCE, 4), 5e-4, 200).angular;
  EXPECT_GT(coarse, 1e-9);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

/// Spring of a rest length between two points of the plane.
class Rod : public solver::Term {
 public:
  Rod(double stiffness, double length) : k_(stiffness), length_(length) {}
  std::string name() const override { return "rod"; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {{0, 1, 2, 3}}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override {
    const Eigen::Vector2d d = Eigen::Vector2d(length_, 0) + at.y.tail<2>() - at.y.head<2>();
    const double now = d.norm(), over = now - length_;
    sum.energy += 0.5 * k_ * over * over;
    sum.stored += 0.5 * k_ * over * over;
    if (order == solver::Order::ENERGY) return;
    const Eigen::Vector2d n = d / now, force = k_ * over * n;
    sum.gradient.head<2>() -= force;
    sum.gradient.tail<2>() += force;
    sum.noteForce(force.norm());
    sum.noteRounding(std::numeric_limits<double>::epsilon() * k_ * length_);
    if (!elasticity::withTangent(order)) return;
    Eigen::Vector4d along, across;
    along << -n, n;
    across << n(1), -n(0), -n(1), n(0);
    sum.addRankOne(0, k_, along);
    const double geometric = k_ * over / now;
    if (order == solver::Order::TANGENT || geometric > 0) sum.addRankOne(0, geometric, across);
  }

 private:
  double k_, length_;
};

/// Two masses on a stiff rod: in the stiff limit a step loses the share 1 - cos(t1), sin(t1) = 2 sin(t/2) cos(t/2 +
/// t1), t = w h (docs/references.md: .98768 % a step at t = .1, .24922 % at .05).
TEST(FreeFlight, BackwardEulerLosesTheSpinOfTheClosedForm) {
  const double mass = 1, length = 1;
  for (const auto& [t, loss] : {std::pair{0.1, 0.0098768}, std::pair{0.05, 0.0024922}}) {
    std::vector<std::shared_ptr<const solver::Term>> terms;
    for (int k = 0; k < 4; ++k) {
      terms.push_back(std::make_shared<solver::RowInertia>("mass", test::only(k), mass));
    }
    terms.push_back(std::make_shared<Rod>(1e10, length));
    const double h = 1e-3, w = t / h;
    Stepper stepper(test::pointMasses(4, terms), Scheme(SchemeKind::BACKWARD_EULER), test::equalSteps(h, 1e-12));
    Eigen::VectorXd v(4);
    v << 0, -0.5 * w, 0, 0.5 * w;
    MotionState state = stepper.start(Eigen::VectorXd::Zero(4), Eigen::VectorXd(), v);
    const auto spin = [&] {
      const Eigen::Vector2d d = Eigen::Vector2d(length, 0) + state.y.tail<2>() - state.y.head<2>(),
                            rate = state.v.tail<2>() - state.v.head<2>();
      return d(0) * rate(1) - d(1) * rate(0);
    };
    stepper.step(state, state.time + h, test::nothing());
    double before = spin();
    for (int k = 0; k < 3; ++k) {
      // The angle of a step follows the spin that is left: back to t for each.
      state.v *= w / (spin() / (length * length));
      before = spin();
      stepper.step(state, state.time + h, test::nothing());
    }
    EXPECT_NEAR(1 - spin() / before, loss, 0.05 * loss) << t;
  }
}

}  // namespace
}  // namespace snapwing::motion
