#include "snapwing/scene/scene_problem.h"

#include <algorithm>
#include <cmath>

#include "scene_constraints.h"
#include "scene_inertia.h"
#include "scene_sensitivity_of.h"
#include "scene_vtu.h"
#include "scene_weight.h"
#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"
#include "snapwing/solver/load_term.h"

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
    solver::SplitEquations split = constraints.split(constraints.equations());
    std::vector<solver::Rotation> rotations = constraints.rotations(split.of_rotation);
    rigid_ = !rotations.empty();
    auto coordinates = std::make_shared<const solver::Coordinates>(split.eliminated, D, std::move(rotations));
    solver::TermProblem::Parts parts = solver::solidParts<D>(cells_, std::move(coordinates), threads, forceFloor());
    const Eigen::VectorXd constant = constraints.constantLoad();
    loads_ = std::make_shared<const solver::LoadTerm>(constant.isZero(0) ? Eigen::VectorXd() : constant,
                                                      constraints.loads());
    weight_ = std::make_shared<Weight<D>>(scene_, cells);
    given_ = givenInertia<D>(scene_, constraints);
    findPoints(constraints);
    parts.terms.insert(parts.terms.end(), {loads_, weight_});
    if (split.kept.count() > 0) parts.constraints = keep(std::move(split.kept), parts);
    problem_ = std::make_shared<const solver::TermProblem>(std::move(parts));
  }

  const solver::Problem& problem() const override { return *problem_; }
  const solver::TermProblem& terms() const override { return *problem_; }
  std::shared_ptr<const solver::TermProblem> sharedTerms() const override { return problem_; }
  std::shared_ptr<const solver::Term> inertia(mpm::MassKind kind) const override {
    auto mass = std::make_shared<const mpm::Mass<D>>(*cells_, massDensities(), geometry_->rules(), kind);
    if (given_.empty()) return std::make_shared<const solver::InertiaTerm<D>>(std::move(mass));
    return std::make_shared<const SceneInertia<D>>(std::move(mass), given_);
  }
  BodyMass bodyMass(int body) const override { return scene::bodyMass<D>(scene_, *geometry_, body); }
  const mpm::Discretisation<2>* planar() const override { return only<2>(*cells_); }
  const mpm::Discretisation<3>* volumetric() const override { return only<3>(*cells_); }
  double multiplicity() const override { return multiplicity_; }
  const std::string& symmetry() const override { return symmetry_; }
  int cellCount() const override { return cells_->cellCount(); }
  double droppedShare() const override { return geometry_->droppedShare(); }
  SceneVolume volume() const override {
    return {multiplicity_ * geometry_->volume(), multiplicity_ * geometry_->bodyVolume()};
  }
  void setDensities(const std::vector<double>& densities) override {
    cells_->setDensities(densities);
    weight_->update();
  }

  std::vector<double> monitors(const Eigen::VectorXd& z, double p) const override {
    const Eigen::VectorXd u = full(z, p);
    std::vector<double> values;
    for (int k = 0; k < static_cast<int>(scene_.monitors.size()); ++k) values.push_back(monitor(k, u));
    return values;
  }

  mpm::MovingMass movingMass(const Eigen::VectorXd& z, double p, const Eigen::VectorXd& slope) const override {
    const solver::Coordinates& coordinates = problem_->coordinates();
    solver::Coordinates::Place place;
    if (rigid_) coordinates.at(z, Eigen::VectorXd::Constant(1, p), nullptr, place);  // else rates do not depend on it
    const Eigen::VectorXd rate = coordinates.push(place, slope, Eigen::VectorXd::Ones(1));
    Point3 axis = Point3::Zero();
    if (!scene_.ports.empty()) {
      const ScenePort& port = scene_.ports.front();
      axis = -(scene_.bodies[port.body].frame.rotation * port.direction);
    }
    mpm::MovingMass sum = mpm::movingMass<D>(*cells_, massDensities(), inWorld(rate.head(cells_->dofCount())),
                                             axis.head<D>(), geometry_->rules());
    int term = 0;
    for (const SceneBody& body : scene_.bodies) {
      if (body.hasCells()) continue;
      sum.mass += body.given.mass;
      sum.kinetic += 2 * given_[term].kineticEnergy(rate);
      sum.coupled += axis.dot(body.frame.rotation * given_[term].momentum(rate));
      ++term;
    }
    for (double* value : {&sum.mass, &sum.kinetic, &sum.coupled}) *value *= multiplicity_;
    return sum;
  }

  double monitor(int number, const Eigen::VectorXd& u, Eigen::VectorXd* gradient = nullptr) const override {
    const SceneMonitor& m = scene_.monitors[number];
    if (gradient != nullptr) gradient->setZero(cells_->dofCount());
    if (!scene_.bodies[m.body].hasCells()) return ofGiven(number, u);
    return m.radius > 0 ? rotation(m, u, gradient) : displacement(m, u, gradient);
  }

  std::unique_ptr<SceneSensitivity> sensitivity(const solver::Equilibrium& x) const override {
    if (rigid_) {
      throw common::Error("scene '" + scene_.name +
                          "' has rigid bodies or cylinder pins; allowed for sensitivities: scenes without");
    }
    SensitivityParts<D> parts{*this, scene_, mirror_, *problem_, *cells_, *loads_, *weight_, {}};
    const int dofs = cells_->dofCount();
    parts.monitors = Eigen::MatrixXd::Zero(dofs, static_cast<int>(scene_.monitors.size()));
    for (int k = 0; k < parts.monitors.cols(); ++k) {
      Eigen::VectorXd gradient;
      monitor(k, x.at.place.y, &gradient);
      parts.monitors.col(k) = gradient;
    }
    return std::make_unique<SceneSensitivityOf<D>>(std::move(parts), x);
  }

  std::string vtu(const Eigen::VectorXd& z, double p) const override { return vtuOf(full(z, p)); }
  std::string vtuOf(const Eigen::VectorXd& u) const override { return vtuText(*cells_, u, frames()); }

 private:
  template <int Wanted, int Given>
  static const mpm::Discretisation<Wanted>* only(const mpm::Discretisation<Given>& solid) {
    if constexpr (Wanted == Given) return &solid;
    return nullptr;
  }
  std::vector<double> massDensities() const {
    std::vector<double> density;
    for (const SceneBody& body : scene_.bodies) density.push_back(body.material.mass_density);
    return density;
  }

  /// What a penalty is measured against: of bodies that deform, else what loads at a lever's end resist with.
  double stiffnessAtRest(const solver::TermProblem& problem) const {
    const double elastic = solver::meanStiffness(problem);
    if (elastic > 0) return elastic;
    solver::Evaluation rest;
    problem.evaluate(Eigen::VectorXd::Zero(problem.freeCount()), Eigen::VectorXd::Zero(1), solver::Order::STRESS, rest);
    return rest.force_scale > 0 ? rest.force_scale / scene_.cell_size : 1;
  }

  /// Equations beside the terms.
  std::shared_ptr<const solver::Constraints> keep(solver::LinearRows rows,
                                                  const solver::TermProblem::Parts& parts) const {
    constexpr double PENALTY = 100, GAP = 1e-10;  // of the mean stiffness of a node, of a cell
    constexpr double CURVED = 1;     // in the place of PENALTY: a steep valley that bends takes small steps
    constexpr double TRAVEL = 0.01;  // cells
    const solver::Enforcement enforcement =
        scene_.enforcement == solver::Enforcement::ELIMINATION ? solver::Enforcement::MULTIPLIERS : scene_.enforcement;
    const auto deforms = [](const SceneBody& b) { return !b.rigid; };
    // Against weight alone, where nothing deforms, steepness is what holds the joints.
    const bool curved =
        parts.coordinates->rotationCount() > 0 && std::any_of(scene_.bodies.begin(), scene_.bodies.end(), deforms);
    const double stiffness = stiffnessAtRest(solver::TermProblem(parts));
    const int redundant = solver::redundantRows(*parts.coordinates, rows, TRAVEL * scene_.cell_size);
    return std::make_shared<const solver::Constraints>(
        std::move(rows), enforcement, (curved ? CURVED : PENALTY) * stiffness, GAP * scene_.cell_size, redundant);
  }

  Eigen::VectorXd full(const Eigen::VectorXd& z, double p) const {
    return problem_->coordinates().expand(z, Eigen::VectorXd::Constant(1, p));
  }
  std::vector<Frame> frames() const {
    std::vector<Frame> all;
    for (const SceneBody& body : scene_.bodies) all.push_back(body.frame);
    return all;
  }
  /// Nodal vectors in the axes of their bodies, turned into those of the world.
  Eigen::VectorXd inWorld(Eigen::VectorXd u) const {
    const auto moved = [](const SceneBody& body) { return body.frame.moved(); };
    if (std::none_of(scene_.bodies.begin(), scene_.bodies.end(), moved)) return u;
    for (int node = 0; node < cells_->nodeCount(); ++node) {
      const Frame& frame = scene_.bodies[cells_->nodeBody(node)].frame;
      if (!frame.moved()) continue;
      u.segment<D>(D * node) = (frame.rotation.template topLeftCorner<D, D>() * u.segment<D>(D * node)).eval();
    }
    return u;
  }
  /// Where the monitors of bodies without cells look.
  void findPoints(const Constraints<D>& constraints) {
    for (const SceneMonitor& m : scene_.monitors) {
      const bool cells = scene_.bodies[m.body].hasCells();
      points_.push_back(cells ? typename Constraints<D>::Weights() : constraints.pointWeights(m.body, m.at.head<D>()));
      rotations_.push_back(cells ? solver::Rotation() : constraints.groupOf(m.body).rotation);
    }
  }

  double forceFloor() const {
    // Rounding of the deformation gradient times the stiffest modulus: no residual can be told from zero below that.
    double stiffest = 0;
    for (const SceneBody& b : scene_.bodies)
      if (!b.rigid) stiffest = std::max(stiffest, b.material.lambda() + 2 * b.material.mu());
    const auto filled = [](const SceneBody& b) { return b.hasCells(); };
    const double thickness = std::find_if(scene_.bodies.begin(), scene_.bodies.end(), filled)->thickness;
    const double across = D == 2 ? thickness : scene_.cell_size;
    return 1e-13 * stiffest * scene_.cell_size * across;
  }

  /// Of a body without cells: no gradient, as there are no sensitivities with rigid bodies.
  double ofGiven(int number, const Eigen::VectorXd& u) const {
    const SceneMonitor& m = scene_.monitors[number];
    if (m.radius > 0) {
      const auto entry = [&](int i, int j) { return u(rotations_[number].first + i + D * j); };
      return common::atan2(entry(1, 0) - entry(0, 1), 2 * rotations_[number].length + entry(0, 0) + entry(1, 1));
    }
    double value = 0;
    for (const auto& [node, weight] : points_[number]) {
      value += weight * m.direction.head<D>().dot(u.segment<D>(D * node));
    }
    return value;
  }

  double displacement(const SceneMonitor& m, const Eigen::VectorXd& u, Eigen::VectorXd* gradient) const {
    const Vector<D> at = m.at.head<D>(), direction = m.direction.head<D>();
    const auto nodes = cells_->interpolate(m.body, at);
    if (nodes.empty()) {
      throw common::Error("monitor '" + m.name + "' lies outside of body '" + scene_.bodies[m.body].name + "'");
    }
    for (const auto& [node, weight] : nodes) {
      if (gradient != nullptr) gradient->segment<D>(D * node) += weight * direction;
    }
    return cells_->displacementAt(m.body, at, u).dot(direction);
  }

  double rotation(const SceneMonitor& m, const Eigen::VectorXd& u, Eigen::VectorXd* gradient) const {
    const mpm::Discretisation<D>& solid = *cells_;
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
    return common::atan2(sine, cosine);
  }

  Mirror mirror_;
  Scene scene_;
  double multiplicity_ = 1;
  std::string symmetry_;
  std::unique_ptr<SceneCells<D>> geometry_;
  std::shared_ptr<mpm::Discretisation<D>> cells_;  ///< the problem's own
  std::shared_ptr<const solver::TermProblem> problem_;
  std::shared_ptr<const solver::LoadTerm> loads_;
  std::shared_ptr<Weight<D>> weight_;
  std::vector<solver::RigidInertiaTerm> given_;           ///< of bodies without cells
  std::vector<typename Constraints<D>::Weights> points_;  ///< per monitor, of those
  std::vector<solver::Rotation> rotations_;
  bool rigid_ = false;
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
