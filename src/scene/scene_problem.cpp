#include "snapwing/scene/scene_problem.h"

#include <algorithm>
#include <cmath>

#include "scene_constraints.h"
#include "scene_sensitivity_of.h"
#include "scene_vtu.h"
#include "scene_weight.h"
#include "snapwing/common/error.h"
#include "snapwing/solver/rigid_motion.h"
#include "snapwing/solver/tied_problem.h"

namespace snapwing::scene {

namespace {

using mpm::Vector;

template <int D>
class CompiledSceneOf : public CompiledScene {
 public:
  CompiledSceneOf(const Scene& scene, int threads) : mirror_(findMirrors(scene)), scene_(halved(scene, mirror_)) {
    geometry_ = std::make_unique<SceneCells<D>>(scene_, mirror_);
    const SceneCells<D>& cells = *geometry_;
    cells_ = cells.solid();
    multiplicity_ = scene.copies * cells.multiplicity();
    for (const SceneSupport& plane : scene.symmetry) symmetry_ += (symmetry_.empty() ? "" : ", ") + plane.name;
    for (int axis = 0; axis < D; ++axis) {
      if (mirror_.has(axis)) symmetry_ += (symmetry_.empty() ? "" : ", ") + mirror_.name(axis);
    }
    if (symmetry_.empty()) symmetry_ = "none";
    const Constraints<D> constraints(scene_, cells);
    const std::vector<solver::Equation> equations = constraints.equations();
    std::vector<solver::Equation> eliminated = equations;
    if (scene.drive != solver::Drive::ELIMINATION) {
      const auto tie = [](const solver::Equation& e) { return e.tie; };
      eliminated.erase(std::remove_if(eliminated.begin(), eliminated.end(), tie), eliminated.end());
    }
    solver::Reduction reduction(constraints.dofCount(), 1, eliminated, constraints.keptFrom());
    std::vector<solver::Turning> turnings = constraints.turnings(reduction.unresolved());
    auto solid = std::make_shared<solver::SolidProblem<D>>(cells.solid(), std::move(reduction), constraints.loads(),
                                                           threads, forceFloor());
    solid_ = solid;
    constant_load_ = constraints.constantLoad();
    weight_ = std::make_unique<Weight<D>>(scene_, cells);
    setDeadLoad();
    if (scene.drive != solver::Drive::ELIMINATION) {
      tie(equations, !turnings.empty());
    } else if (!turnings.empty()) {
      turning_ = std::make_unique<solver::TurningProblem<D>>(solid_, std::move(turnings));
    }
  }

  const solver::Problem& problem() const override {
    if (tied_) return *tied_;
    if (turning_) return *turning_;
    return *solid_;
  }
  double multiplicity() const override { return multiplicity_; }
  const std::string& symmetry() const override { return symmetry_; }
  int cellCount() const override { return solid_->solid().cellCount(); }
  double droppedShare() const override { return geometry_->droppedShare(); }
  SceneVolume volume() const override {
    return {multiplicity_ * geometry_->volume(), multiplicity_ * geometry_->bodyVolume()};
  }
  void setDensities(const std::vector<double>& densities) override {
    cells_->setDensities(densities);
    setDeadLoad();
  }

  std::vector<double> monitors(const Eigen::VectorXd& z, double p) const override {
    const Eigen::VectorXd u = displacements(z, p);
    std::vector<double> values;
    for (int k = 0; k < static_cast<int>(scene_.monitors.size()); ++k) values.push_back(monitor(k, u));
    return values;
  }

  mpm::MovingMass movingMass(const Eigen::VectorXd& z, double p, const Eigen::VectorXd& slope) const override {
    constexpr double H = 1e-6;  // [m] displacements are linear in z and p but for rigid rotations
    const Eigen::VectorXd rate = (displacements(z + H * slope, p + H) - displacements(z - H * slope, p - H)) / (2 * H);
    std::vector<double> density;
    for (const SceneBody& body : scene_.bodies) density.push_back(body.material.mass_density);
    Vector<D> axis = Vector<D>::Zero();
    if (!scene_.ports.empty()) axis = -scene_.ports.front().direction.template head<D>();
    mpm::MovingMass sum = mpm::movingMass<D>(solid_->solid(), density, rate, axis, geometry_->rules());
    for (double* value : {&sum.mass, &sum.kinetic, &sum.coupled}) *value *= multiplicity_;
    return sum;
  }

  double monitor(int number, const Eigen::VectorXd& u, Eigen::VectorXd* gradient = nullptr) const override {
    const SceneMonitor& m = scene_.monitors[number];
    if (gradient != nullptr) gradient->setZero(solid_->solid().dofCount());
    return m.radius > 0 ? rotation(m, u, gradient) : displacement(m, u, gradient);
  }

  Eigen::VectorXd weightByDensity(const Eigen::VectorXd& v) const override { return weight_->densitySlope(v); }
  std::unique_ptr<SceneSensitivity> sensitivity(const solver::Equilibrium& x) const override {
    if (turning_) {
      throw common::Error("scene '" + scene_.name +
                          "' has rigid bodies or cylinder pins; allowed for sensitivities: scenes without");
    }
    SensitivityParts<D> parts{scene_, mirror_, *solid_, *weight_, tied_.get(), {}};
    const int dofs = solid_->solid().dofCount();
    parts.monitors = Eigen::MatrixXd::Zero(dofs, static_cast<int>(scene_.monitors.size()));
    for (int k = 0; k < parts.monitors.cols(); ++k) {
      Eigen::VectorXd gradient;
      monitor(k, x.at.displacements, &gradient);
      parts.monitors.col(k) = gradient;
    }
    return std::make_unique<SceneSensitivityOf<D>>(std::move(parts), x);
  }

  std::string vtu(const Eigen::VectorXd& z, double p) const override {
    return vtuText(solid_->solid(), displacements(z, p));
  }

 private:
  void setDeadLoad() {
    Eigen::VectorXd load = constant_load_;
    weight_->addTo(load);
    solid_->setDeadLoad(load.isZero(0) ? Eigen::VectorXd() : load);
  }

  /// Ports and joints as equations beside the problem.
  void tie(const std::vector<solver::Equation>& equations, bool rigid) {
    if (rigid) {
      throw common::Error("drive is '" + solver::driveName(scene_.drive) +
                          "' in a scene with rigid bodies or cylinder pins, whose rotation makes ties nonlinear; "
                          "allowed: elimination");
    }
    constexpr double PENALTY = 100, GAP = 1e-10;  // of the mean stiffness of a node, of a cell
    tied_ = std::make_unique<solver::TiedProblem>(
        solid_, solver::makeTies(solid_->solid().dofCount(), 1, equations, solid_->reduction()), scene_.drive,
        PENALTY * solver::meanStiffness(*solid_), GAP * scene_.cell_size);
  }

  Eigen::VectorXd displacements(const Eigen::VectorXd& z, double p) const {
    const Eigen::VectorXd controls = Eigen::VectorXd::Constant(1, p);
    const Eigen::VectorXd all = solid_->reduction().expand(turning_ ? turning_->innerCoordinates(z) : z, controls);
    return all.head(solid_->solid().dofCount());
  }

  double forceFloor() const {
    // Rounding of the deformation gradient times the stiffest modulus: no residual can be told from zero below that.
    double stiffest = 0;
    for (const SceneBody& b : scene_.bodies)
      if (!b.rigid) stiffest = std::max(stiffest, b.material.lambda() + 2 * b.material.mu());
    const double across = D == 2 ? scene_.bodies[0].thickness : scene_.cell_size;
    return 1e-13 * stiffest * scene_.cell_size * across;
  }

  double displacement(const SceneMonitor& m, const Eigen::VectorXd& u, Eigen::VectorXd* gradient) const {
    const Vector<D> at = m.at.head<D>(), direction = m.direction.head<D>();
    const auto nodes = solid_->solid().interpolate(m.body, at);
    if (nodes.empty()) {
      throw common::Error("monitor '" + m.name + "' lies outside of body '" + scene_.bodies[m.body].name + "'");
    }
    for (const auto& [node, weight] : nodes) {
      if (gradient != nullptr) gradient->segment<D>(D * node) += weight * direction;
    }
    return solid_->solid().displacementAt(m.body, at, u).dot(direction);
  }

  double rotation(const SceneMonitor& m, const Eigen::VectorXd& u, Eigen::VectorXd* gradient) const {
    const mpm::Discretisation<D>& solid = solid_->solid();
    double sine = 0, cosine = 0;
    Eigen::VectorXd d_sine = Eigen::VectorXd::Zero(solid.dofCount()), d_cosine = d_sine;
    for (int node = 0; node < solid.nodeCount(); ++node) {
      const Eigen::Vector2d rest = solid.position(node).template head<2>() - m.at.head<2>();
      if (solid.nodeBody(node) != m.body || rest.norm() > m.radius * (1 + 1e-9)) continue;
      const Eigen::Vector2d moved = rest + u.template segment<2>(D * node);
      sine += rest(0) * moved(1) - rest(1) * moved(0);
      cosine += rest.dot(moved);
      d_sine.segment<2>(D * node) = Eigen::Vector2d(-rest(1), rest(0));
      d_cosine.segment<2>(D * node) = rest;
    }
    if (gradient != nullptr) {
      *gradient = (cosine * d_sine - sine * d_cosine) / (sine * sine + cosine * cosine);
    }
    return std::atan2(sine, cosine);
  }

  Mirror mirror_;
  Scene scene_;
  double multiplicity_ = 1;
  std::string symmetry_;
  std::unique_ptr<SceneCells<D>> geometry_;
  std::shared_ptr<mpm::Discretisation<D>> cells_;  ///< the problem's own
  std::shared_ptr<solver::SolidProblem<D>> solid_;
  Eigen::VectorXd constant_load_;  ///< [N] besides the weight
  std::unique_ptr<Weight<D>> weight_;
  std::unique_ptr<solver::TiedProblem> tied_;           ///< if ports and joints are kept as equations
  std::unique_ptr<solver::TurningProblem<D>> turning_;  ///< if something is rigid
};

}  // namespace

std::unique_ptr<CompiledScene> compileScene(const Scene& scene, int threads) {
  if (scene.kernel == SceneKernel::QUADRATIC && scene.particles < 3) {
    throw common::Error(
        "particles is " + std::to_string(scene.particles) +
        "; allowed with the quadratic kernel: 3 .. 16 (fewer leave motions of cut cells without energy)");
  }
  if (scene.dimension == 2) return std::make_unique<CompiledSceneOf<2>>(scene, threads);
  return std::make_unique<CompiledSceneOf<3>>(scene, threads);
}

}  // namespace snapwing::scene
