// An energy of one's own: a spring with play on a monitored point of a scene. own_term SCENE.yaml N_PER_M PLAY_M
// Traces the scene without and with it.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "snapwing/common/error.h"
#include "snapwing/scene/scene_problem.h"
#include "snapwing/statics/path.h"

namespace {

using namespace snapwing;

/// V = k/2 max(|g| - play, 0)^2 of a row g = row . y [m]. All that a term must say: name, role, what it couples, energy
/// with gradient and Hessian.
class SpringWithPlay : public solver::Term {
 public:
  SpringWithPlay(const Eigen::VectorXd& row, double stiffness, double play) : stiffness_(stiffness), play_(play) {
    for (int k = 0; k < row.size(); ++k) {
      if (row(k) != 0) coordinates_.push_back(k);
    }
    row_.resize(static_cast<Eigen::Index>(coordinates_.size()));
    for (std::size_t k = 0; k < coordinates_.size(); ++k) row_(static_cast<Eigen::Index>(k)) = row(coordinates_[k]);
  }
  std::string name() const override { return "spring with play"; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {coordinates_}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override {
    double g = 0;
    for (std::size_t k = 0; k < coordinates_.size(); ++k)
      g += row_(static_cast<Eigen::Index>(k)) * at.y(coordinates_[k]);
    const double over = std::max(std::abs(g) - play_, 0.0), force = std::copysign(stiffness_ * over, g);
    sum.energy += 0.5 * stiffness_ * over * over;
    sum.stored += 0.5 * stiffness_ * over * over;
    sum.noteForce(std::abs(force) * row_.norm());
    if (order == solver::Order::ENERGY) return;
    for (std::size_t k = 0; k < coordinates_.size(); ++k) {
      sum.gradient(coordinates_[k]) += force * row_(static_cast<Eigen::Index>(k));
    }
    if (elasticity::withTangent(order) && over > 0) sum.addRankOne(0, stiffness_, row_);
  }

 private:
  std::vector<int> coordinates_;
  Eigen::VectorXd row_;
  double stiffness_, play_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: own_term SCENE.yaml STIFFNESS_N_PER_M PLAY_M\n"), 2;
  try {
    const scene::Scene scene = scene::loadScene(argv[1]);
    if (scene.monitors.empty()) throw common::Error("the scene has no monitor for the spring to hang on");
    const auto compiled = scene::compileScene(scene, 1);
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(compiled->terms().coordinates().fullCount());
    Eigen::VectorXd row;
    compiled->monitor(0, rest, &row);
    const auto spring = std::make_shared<const SpringWithPlay>(row, std::atof(argv[2]), std::atof(argv[3]));
    const auto sprung = compiled->sharedTerms()->with({spring});
    std::vector<double> targets;
    for (int k = 0; k <= scene.steps; ++k) targets.push_back(scene.to * k / scene.steps);
    const Eigen::VectorXd start = Eigen::VectorXd::Zero(sprung->freeCount());
    const auto plain = statics::PathFollower(compiled->terms(), {}).follow(start, targets);
    const auto held = statics::PathFollower(*sprung, {}).follow(start, targets);
    std::printf("control,force_N,with_spring_N\n");
    for (std::size_t k = 0; k < std::min(plain.points.size(), held.points.size()); ++k) {
      std::printf("%.6g,%.6g,%.6g\n", plain.points[k].control, plain.points[k].force, held.points[k].force);
    }
    return plain.message.empty() && held.message.empty() ? 0 : 1;
  } catch (const common::Error& error) {
    return std::fprintf(stderr, "error: %s\n", error.what()), 2;
  }
}
