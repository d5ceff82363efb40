// Terms of points in space: the battery of terms, and closed forms.
#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/solver/point_terms.h"
#include "support/term_check.h"

namespace snapwing::solver {
namespace {

using Eigen::Vector3d;

constexpr double LENGTH = 0.05;

/// Two rigid bodies: c of both, then E of both.
const Rotation ONE{6, LENGTH, {}}, OTHER{15, LENGTH, {}};
SpacePoint pointOf(bool first, const Vector3d& at) {
  return {at, first ? 0 : 3, first ? ONE : OTHER, first ? Vector3d(0, 0.02, 0) : Vector3d(0.01, 0, 0)};
}

Eigen::VectorXd somewhere(unsigned seed, double size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Eigen::VectorXd y(24);
  for (double& value : y) value = uniform(random);
  return y;
}

Step stepFrom(unsigned seed) {
  Step step;
  step.h = 2e-3;
  step.kappa = 2 / (step.h * step.h);
  step.y0 = somewhere(seed, 2e-3);
  step.v0 = somewhere(seed + 1, 0.5);
  return step;
}

test::TermCase caseOf(const Step* step) {
  test::TermCase out{HessianLayout(24), {}};
  for (unsigned k = 0; k < 4; ++k) out.y.push_back(somewhere(40 + k, 4e-3));
  out.p = Eigen::VectorXd::Constant(1, 3.0);
  out.step = step;
  return out;
}

TEST(PointTerms, AreTerms) {
  const Step step = stepFrom(3);
  const SpacePoint a = pointOf(true, {0.03, 0.08, 0}), b = pointOf(false, {0.02, -0.05, 0.04});
  test::checkTerm(PointDrag("drag", a, 0.7), caseOf(&step));
  test::checkTerm(StrutStop("stop", SpacePoint::between(a, b), 0.2, 400), caseOf(nullptr));
  test::checkTerm(StrutStop("stop", SpacePoint::between(a, b), 0.01, 400), caseOf(nullptr));
  Propeller::Data data;
  data.moment = 0.02, data.full_thrust = 9, data.no_thrust_speed = 20;
  Propeller::Data plain = data;
  plain.no_thrust_speed = 0;
  test::TermCase thrust = caseOf(&step);
  thrust.energy_depends_on_control = true;
  test::checkTerm(Propeller("propeller", a, ONE, plain), thrust);
}

/// What two points do to each other has no resultant and no moment about the middle of the step, and takes energy.
TEST(StrutDamper, PullsAlongTheMiddleLine) {
  const Step step = stepFrom(7);
  const SpacePoint a = pointOf(true, {0.03, 0.08, 0}), b = pointOf(false, {0.02, -0.05, 0.04});
  const StrutDamper damper("damper", SpacePoint::between(a, b), 5);
  HessianLayout layout(24);
  std::vector<int> places;
  for (const auto& couple : damper.couples()) places.push_back(layout.addCouple(couple));
  Sum sum;
  sum.reset(layout, 1, Order::TANGENT);
  sum.couples = &places;
  const Eigen::VectorXd y = somewhere(9, 3e-3), p = Eigen::VectorXd::Zero(1);
  damper.evaluate({y, p, &step}, Order::TANGENT, sum);
  // Forces on the bodies: of c, then the first moments that E holds.
  const Eigen::VectorXd& g = sum.gradient;
  const Eigen::VectorXd middle = 0.5 * (y + step.y0);
  EXPECT_LT((g.segment<3>(0) + g.segment<3>(3)).norm(), 1e-14 * g.norm());
  Vector3d moment = (Vector3d(0, 0.02, 0) + middle.segment<3>(0)).cross(g.segment<3>(0)) +
                    (Vector3d(0.01, 0, 0) + middle.segment<3>(3)).cross(g.segment<3>(3));
  for (int body = 0; body < 2; ++body) {
    for (int j = 0; j < 3; ++j) {
      const int at = 6 + 9 * body + 3 * j;
      moment += (LENGTH * Vector3d::Unit(j) + middle.segment<3>(at)).cross(g.segment<3>(at));
    }
  }
  EXPECT_LT(moment.norm(), 1e-14 * 0.1 * g.norm());
  EXPECT_GT(g.dot(y - step.y0), 0);
  const SpacePoint line = SpacePoint::between(a, b);
  const Vector3d mean = (line.at(y) + line.at(step.y0)).normalized();
  const double rate = mean.dot(line.at(y) - line.at(step.y0)) / step.h;
  EXPECT_NEAR(g.dot(y - step.y0), 5 * rate * rate * step.h, 1e-12 * g.norm());
  EXPECT_NEAR(sum.energy, 0.5 * step.h * 5 * rate * rate, 1e-15);
}

TEST(Propeller, GivesItsThrustAndMomentAndLosesWithSpeed) {
  Propeller::Data data;
  data.moment = 0.02, data.full_thrust = 9, data.no_thrust_speed = 20;
  const Vector3d hub(0.1, 0.02, 0);
  const Propeller propeller("propeller", pointOf(true, hub), ONE, data);
  HessianLayout layout(24);
  std::vector<int> places;
  for (const auto& couple : propeller.couples()) places.push_back(layout.addCouple(couple));
  Step step;
  step.h = 1e-3;
  step.y0 = step.v0 = Eigen::VectorXd::Zero(24);
  Eigen::VectorXd y = step.y0;
  y(1) = 5 * step.h;  // 5 m/s along the axis
  const Eigen::VectorXd p = Eigen::VectorXd::Constant(1, 4.0);
  Sum sum;
  sum.reset(layout, 1, Order::STRESS);
  sum.couples = &places;
  propeller.evaluate({y, p, &step}, Order::STRESS, sum);
  const double wanted = 4 - std::sqrt(4.0 * 9) * 5 / 20;
  EXPECT_NEAR(-sum.gradient(1), wanted, 1e-12);
  // Work of a small turn w: of the thrust at its arm, and of the moment about the axis.
  const Vector3d w(0.3, -0.7, 0.2);
  Eigen::VectorXd turn = Eigen::VectorXd::Zero(24);
  for (int j = 0; j < 3; ++j) turn.segment<3>(6 + 3 * j) = LENGTH * w.cross(Vector3d::Unit(j));
  const Vector3d arm = hub - Vector3d(0, 0.02, 0);
  EXPECT_NEAR(-sum.gradient.dot(turn), w.dot(arm.cross(Vector3d(0, wanted, 0))) + 0.02 * 4 * w(1), 1e-12);
}

TEST(PointTerms, RefuseBadNumbers) {
  const SpacePoint a = pointOf(true, Vector3d::Zero());
  EXPECT_THROW(PointDrag("drag", a, -1), common::Error);
  EXPECT_THROW(StrutDamper("damper", a, -1), common::Error);
  EXPECT_THROW(StrutStop("stop", a, 0, 1), common::Error);
  EXPECT_THROW(StrutStop("stop", a, 1, 0), common::Error);
  Propeller::Data data;
  data.axis = Vector3d(0, 2, 0);
  EXPECT_THROW(Propeller("propeller", a, ONE, data), common::Error);
  data.axis = Vector3d::UnitY(), data.full_thrust = 0;
  EXPECT_THROW(Propeller("propeller", a, ONE, data), common::Error);
}

}  // namespace
}  // namespace snapwing::solver
