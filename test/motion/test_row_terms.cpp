// Terms of one linear function through the battery of terms, and against closed forms.
#include <cmath>

#include "one_mode.h"
#include "snapwing/common/error.h"
#include "support/term_check.h"

namespace snapwing::motion {
namespace {

using solver::Row;
using test::only;

const Row ROW({{0, 1.0}, {2, -0.7}});

test::TermCase placesOf(const solver::Step* step) {
  test::TermCase c{solver::HessianLayout(3), {}};
  c.y = {Eigen::Vector3d(0.01, 0.3, -0.02), Eigen::Vector3d(-0.02, 0.1, 0.01)};
  c.step = step;
  return c;
}

TEST(RowTerms, AreTerms) {
  solver::Step step;
  step.h = 2e-3, step.kappa = 5e5;
  step.y0 = Eigen::Vector3d(0.005, 0, 0.003);
  step.v0 = Eigen::Vector3d(1, -2, 0.5);
  const test::TermCase c = placesOf(&step);
  checkTerm(solver::RowInertia("mass", ROW, 0.3), c);
  checkTerm(solver::RowSpring("spring", ROW, 300), c);
  checkTerm(solver::RowDamper("damper", ROW, 2.8), c);
  checkTerm(solver::RowDrag("drag", ROW, 0.02, 3), c);
  checkTerm(solver::RowFriction("friction", ROW, 0.05, 5.0), c);
  checkTerm(solver::RowStop("stop", ROW, 0.0, 1e4), c);
  checkTerm(solver::RowStopLoss("loss", ROW, 0.01, 1e4, 0.2, 0.4), c);
}

TEST(RowTerms, RefuseNumbersThatNothingHas) {
  EXPECT_THROW(Row(std::vector<std::pair<int, double>>{}), common::Error);
  EXPECT_THROW(Row({{0, 1.0}, {0, 2.0}}), common::Error);
  EXPECT_THROW(Row({{-1, 1.0}}), common::Error);
  EXPECT_THROW(solver::RowInertia("mass", ROW, -1), common::Error);
  EXPECT_THROW(solver::RowDamper("damper", ROW, NAN), common::Error);
  EXPECT_THROW(solver::RowStop("stop", ROW, 0, 0), common::Error);
  EXPECT_THROW(solver::RowStopLoss("stop", ROW, 0, 1, 1, 1.5), common::Error);
  EXPECT_THROW(solver::RowFriction("friction", ROW, 1, 0), common::Error);
}

/// A mass that strikes a stop leaves it with the restitution's share of its speed.
TEST(RowStop, GivesBackItsRestitution) {
  for (const double restitution : {0.3, 0.7, 1.0}) {
    const double mass = 0.4, stiffness = 1e5;
    const auto problem = test::pointMasses(
        1, {std::make_shared<solver::RowInertia>("mass", only(0), mass),
            std::make_shared<solver::RowStop>("stop", only(0), 0.0, stiffness),
            std::make_shared<solver::RowStopLoss>("loss", only(0), 0.0, stiffness, mass, restitution)});
    StepperSettings settings;
    settings.largest_step = 1e-5;
    Stepper stepper(problem, Scheme(SchemeKind::MIDPOINT), settings);
    MotionState state =
        stepper.start(Eigen::VectorXd::Constant(1, 0.01), Eigen::VectorXd(), Eigen::VectorXd::Constant(1, -5.0));
    while (state.time < 0.02) stepper.step(state, 0.02, test::nothing());
    EXPECT_NEAR(state.v(0), 5 * restitution, 0.02 * 5) << restitution;
  }
}

/// Falls against its drag to the speed at which they balance, and loses what the account says.
TEST(RowDrag, EndsAtTheTerminalSpeedAndTheAccountCloses) {
  const double mass = 0.5, k = 0.2, weight = 4.9;
  class Weight : public solver::Term {
   public:
    std::string name() const override { return "weight"; }
    Role role() const override { return Role::LOAD; }
    void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override {
      sum.energy += 4.9 * at.y(0);
      if (order != solver::Order::ENERGY) sum.gradient(0) += 4.9;
    }
  };
  const auto problem =
      test::pointMasses(1, {std::make_shared<solver::RowInertia>("mass", only(0), mass),
                            std::make_shared<solver::RowDrag>("drag", only(0), k), std::make_shared<Weight>()});
  StepperSettings settings;
  settings.largest_step = 1e-2;
  settings.relative_tolerance = 1e-12;
  Stepper stepper(problem, Scheme(SchemeKind::MIDPOINT), settings);
  MotionState state = stepper.start(Eigen::VectorXd::Zero(1), Eigen::VectorXd());
  double imbalance = 0;
  while (state.time < 5) imbalance += stepper.step(state, 5, test::nothing()).imbalance;
  EXPECT_NEAR(state.v(0), -std::sqrt(weight / k), 1e-6);
  EXPECT_LT(std::abs(imbalance), 1e-9);
}

}  // namespace
}  // namespace snapwing::motion
