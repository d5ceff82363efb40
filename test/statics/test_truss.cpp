// The two-bar (von Mises) truss: limit loads, stability and path following against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "truss.h"

namespace snapwing::statics {
namespace {

using testing_scenes::LoadedTruss;
using testing_scenes::Truss;

TEST(Truss, LimitLoadIsTheClosedForm) {
  // P/EA at w, Green strain, from the closed form P = w (b - w)(2b - w) / L0^3.
  const struct {
    double rise, load, apex;
  } rows[] = {{.10, 3.791980e-4, .042264973}, {.25, 5.4912944e-3, .10566243}, {1.0, .1360827635, .42264973}};
  for (const auto& row : rows) {
    const Truss truss(row.rise, 100);
    std::vector<double> targets;
    for (int k = 0; k <= 400; ++k) targets.push_back(2.2 * row.rise * k / 400);
    const PathResult path = PathFollower(truss, {}).follow(Eigen::VectorXd::Zero(1), targets);
    ASSERT_EQ(path.status, solver::SolveStatus::CONVERGED) << path.message;
    double peak = 0, apex = 0, valley = 0;
    for (const PathPoint& p : path.points) {
      EXPECT_TRUE(p.stable);
      EXPECT_NEAR(p.force, truss.apexForce(p.solution(0)), 1e-11);
      if (p.solution(0) < row.rise && p.force > peak) peak = p.force, apex = p.solution(0);
      valley = std::min(valley, p.force);
    }
    EXPECT_NEAR(peak, row.load, 1e-4 * row.load);
    EXPECT_NEAR(apex, row.apex, 0.01 * row.rise);
    EXPECT_NEAR(valley, -row.load, 1e-4 * row.load);  // point symmetric about the flat state
  }
}

TEST(Truss, StiffnessIsTheSlopeOfTheForce) {
  const Truss truss(0.25, 1.0);
  std::vector<double> targets;
  for (int k = 0; k <= 2000; ++k) targets.push_back(0.6 * k / 2000);
  const PathResult path = PathFollower(truss, {}).follow(Eigen::VectorXd::Zero(1), targets);
  ASSERT_EQ(path.status, solver::SolveStatus::CONVERGED);
  for (std::size_t k = 1; k + 1 < path.points.size(); ++k) {
    const double slope = (path.points[k + 1].force - path.points[k - 1].force) / (targets[k + 1] - targets[k - 1]);
    EXPECT_NEAR(path.points[k].stiffness, slope, 2e-6);
  }
}

/// A soft driving spring snaps through: displacement control of its end cannot follow the branch, and must land on a
/// true, stable equilibrium of the far branch without any unstable point on the way.
TEST(Truss, SoftSpringSnapsToAStableState) {
  const Truss truss(0.25, 1e-2);
  std::vector<double> targets;
  for (int k = 0; k <= 300; ++k) targets.push_back(1.5 * k / 300);
  const PathResult path = PathFollower(truss, {}).follow(Eigen::VectorXd::Zero(1), targets);
  ASSERT_EQ(path.status, solver::SolveStatus::CONVERGED) << path.message;
  double largest_jump = 0;
  for (std::size_t k = 1; k < path.points.size(); ++k) {
    EXPECT_TRUE(path.points[k].stable);
    EXPECT_NEAR(path.points[k].force, truss.apexForce(path.points[k].solution(0)), 1e-8);
    largest_jump = std::max(largest_jump, path.points[k].solution(0) - path.points[k - 1].solution(0));
  }
  EXPECT_GT(largest_jump, 0.3);
}

/// There and back, the way back with what the way there found or without.
struct ThereAndBack {
  PathResult there, back;
  ThereAndBack(const Truss& truss, double farthest, bool remember) {
    std::vector<double> targets;
    for (int k = 0; k <= 300; ++k) targets.push_back(farthest * k / 300);
    there = PathFollower(truss, {}).follow(Eigen::VectorXd::Zero(1), targets);
    PathSettings settings;
    settings.known = [this, remember](double control) -> const PathPoint* {
      const auto same = [control](const PathPoint& point) { return point.control == control; };
      const auto found = std::find_if(there.points.begin(), there.points.end(), same);
      return remember && found != there.points.end() ? &*found : nullptr;
    };
    std::reverse(targets.begin(), targets.end());
    back = PathFollower(truss, settings).follow(there.points.back().solution, targets);
  }
};

TEST(Truss, TheWayBackTakesWhatTheWayThereFound) {
  const Truss truss(0.25, 100);
  const ThereAndBack fresh(truss, 0.55, false), known(truss, 0.55, true);
  ASSERT_EQ(known.back.status, solver::SolveStatus::CONVERGED) << known.back.message;
  ASSERT_EQ(known.back.points.size(), fresh.back.points.size());
  for (std::size_t k = 0; k < fresh.back.points.size(); ++k) {
    EXPECT_NEAR(known.back.points[k].force, fresh.back.points[k].force, 1e-11) << k;
    EXPECT_NEAR(known.back.points[k].stiffness, fresh.back.points[k].stiffness, 1e-7) << k;
    EXPECT_TRUE(known.back.points[k].stable) << k;
  }
  EXPECT_LT(4 * known.back.factorizations, fresh.back.factorizations);
  EXPECT_LT(4 * known.back.iterations, fresh.back.iterations);
}

/// A soft spring snaps at another control on its way back: what the way there found between the two is another branch.
TEST(Truss, TheWayBackKeepsToItsOwnBranch) {
  const Truss truss(0.25, 1e-2);
  const ThereAndBack fresh(truss, 1.5, false), known(truss, 1.5, true);
  ASSERT_EQ(known.back.status, solver::SolveStatus::CONVERGED) << known.back.message;
  ASSERT_EQ(known.back.points.size(), fresh.back.points.size());
  int apart = 0;
  for (std::size_t k = 0; k < fresh.back.points.size(); ++k) {
    EXPECT_NEAR(known.back.points[k].force, fresh.back.points[k].force, 1e-10) << k;
    const PathPoint& there = known.there.points[known.there.points.size() - 1 - k];
    ASSERT_EQ(there.control, known.back.points[k].control);
    apart += std::abs(there.force - known.back.points[k].force) > 1e-4 ? 1 : 0;
  }
  EXPECT_GT(apart, 20) << "hysteresis";
}

TEST(ArcLength, PassesBothLimitPointsOfTheLoadedTruss) {
  const LoadedTruss truss(0.25);
  ArcSettings settings;
  settings.first_step = 1e-4;
  settings.largest_step = 2e-4;
  settings.end = 8e-3;
  const ArcResult arc = followArc(truss, Eigen::VectorXd::Zero(1), 0, settings);
  ASSERT_EQ(arc.path.status, solver::SolveStatus::CONVERGED) << arc.path.message;
  ASSERT_EQ(arc.limit_points.size(), 2u);
  EXPECT_EQ(arc.crossings.size(), 2u);
  double peak = 0, valley = 0;
  for (const PathPoint& p : arc.path.points) {
    const double z = p.solution(0);
    EXPECT_NEAR(p.control, truss.apexForce(z), 1e-10);
    peak = std::max(peak, z < 0.25 ? p.control : 0);
    valley = std::min(valley, p.control);
    const bool between = z > 0.25 - 0.25 / std::sqrt(3.0) && z < 0.25 + 0.25 / std::sqrt(3.0);
    if (std::abs(p.control) < 5.4e-3) {
      EXPECT_EQ(p.negative_pivots, between ? 1 : 0) << z;
    }
  }
  EXPECT_NEAR(peak, 5.4912944e-3, 2e-5);
  EXPECT_NEAR(valley, -5.4912944e-3, 2e-5);
}

/// A soft spring makes the driven end snap back: displacement control has to jump there, arc length does not.
TEST(ArcLength, FollowsADisplacementSnapBack) {
  const Truss truss(0.25, 1e-2);
  ArcSettings settings;
  settings.first_step = 5e-3;
  settings.largest_step = 2e-2;
  settings.max_points = 3000;
  settings.end = 1.2;
  const ArcResult arc = followArc(truss, Eigen::VectorXd::Zero(1), 0, settings);
  ASSERT_EQ(arc.path.status, solver::SolveStatus::CONVERGED) << arc.path.message;
  EXPECT_EQ(arc.limit_points.size(), 2u);
  double largest_jump = 0;
  for (std::size_t k = 1; k < arc.path.points.size(); ++k) {
    EXPECT_NEAR(arc.path.points[k].force, truss.apexForce(arc.path.points[k].solution(0)), 1e-9);
    largest_jump =
        std::max(largest_jump, std::abs(arc.path.points[k].solution(0) - arc.path.points[k - 1].solution(0)));
  }
  EXPECT_LT(largest_jump, 0.05);
}

TEST(ArcLength, SaysWhenItRanOutOfPoints) {
  const Truss truss(0.25, 1e-2);
  ArcSettings settings;
  settings.first_step = 1e-3;
  settings.largest_step = 1e-3;
  settings.max_points = 20;
  settings.end = 1.2;
  const ArcResult arc = followArc(truss, Eigen::VectorXd::Zero(1), 0, settings);
  EXPECT_EQ(arc.path.status, solver::SolveStatus::ITERATION_LIMIT);
  EXPECT_EQ(arc.path.points.size(), 20u);
}

TEST(Truss, CancelStopsWithItsStatus) {
  const Truss truss(0.25, 100);
  PathSettings settings;
  settings.progress = [](int point) { return point == 3; };
  const PathResult path = PathFollower(truss, settings).follow(Eigen::VectorXd::Zero(1), {0, .1, .2, .3, .4, .5});
  EXPECT_EQ(path.status, solver::SolveStatus::CANCELLED);
  EXPECT_EQ(path.points.size(), 4u);
}

}  // namespace
}  // namespace snapwing::statics
