// Joints between rigid bodies and closed chains of them, as a user writes them: closed forms, every way of enforcing
// constraints, dead points.
#include <gtest/gtest.h>

#include <cmath>

#include "scene_text.h"
#include "snapwing/common/error.h"

namespace snapwing::scene {
namespace {

const std::vector<std::string> ENFORCEMENTS = {"elimination", "augmented_lagrangian", "multipliers"};

std::string header(int dimension, const std::string& enforcement, double cell) {
  return "scene: chain\nlength_unit: mm\ndimension: " + std::to_string(dimension) +
         (dimension == 2 ? "\nplane: strain\n" : "\n") + "kernel: linear\ncell_size: " + std::to_string(cell) +
         "\nuse_symmetry: false\ndrive: " + enforcement + "\n";
}
std::string rigidBox(const std::string& name, const std::string& x, const std::string& y) {
  return "  " + name + ":\n    material: {rigid: true, mass_density: 2000}\n    thickness: 4\n" +
         "    shape: {box: {x: " + x + ", y: " + y + "}}\n";
}

/// Two rods that hang in pins, pulled sideways at the lower end of the second.
std::string doublePendulum(int dimension, const std::string& enforcement) {
  const std::string zero = dimension == 2 ? "" : ", 0";
  return header(dimension, enforcement, 2) + "gravity: [0, -9.81" + zero + "]\nbodies:\n" +
         rigidBox("upper", "[-2, 2]", "[-32, 2]") + rigidBox("lower", "[-2, 2]", "[-62, -28]") +
         "pins:\n  - {name: nail, body: upper, at: [0, 0], kind: line}\n" +
         (dimension == 3 ? "supports:\n  - {name: wall, body: upper, region: {x: [-2, -2], y: [2, 2], z: [-2, -2]}, "
                           "hold: z}\n"
                         : "") +
         "joints:\n  - {name: elbow, first: upper, second: lower, at: [0, -30]}\n"
         "loads:\n  - {name: pull, body: lower, region: {y: [-62, -62]}, force: [0.02, 0" +
         zero + "]}\nmonitors:\n  - {name: first, body: upper, at: [0, -16" + zero +
         "], radius: 8}\n"
         "  - {name: second, body: lower, at: [0, -45" +
         zero + "], radius: 8}\npath: {to: 1, steps: 4}\n";
}

TEST(RigidChain, TwoBodiesInAPinHangAsTheClosedFormSays) {
  const double weight = 2000 * 9.81 * 4e-3 * 34e-3 * 4e-3;
  const auto angle = [&](double force, double lever, double moment) { return std::atan(force * lever / moment); };
  for (const int dimension : {2, 3}) {
    for (const std::string& enforcement : ENFORCEMENTS) {
      SCOPED_TRACE(enforcement + ", " + std::to_string(dimension));
      const statics::SceneCurve curve = trace(sceneFromText(doublePendulum(dimension, enforcement)));
      ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
      for (std::size_t k = 0; k < curve.path.points.size(); ++k) {
        const double force = 0.02 * curve.path.points[k].control;
        EXPECT_NEAR(curve.monitors[k][0], angle(force, 30, 15 * weight + 30 * weight), 1e-8);
        EXPECT_NEAR(curve.monitors[k][1], angle(force, 32, 15 * weight), 1e-8);
        EXPECT_TRUE(curve.path.points[k].stable);
      }
      EXPECT_GT(curve.monitors.back()[0], 0.1);
    }
  }
}

/// A parallelogram of rods under a soft arm: its rods hang as plumb lines, whatever the arm does, and its lower bar
/// keeps parallel to the arm's end.
std::string fourBarOnAnArm(const std::string& enforcement) {
  return header(2, enforcement, 2) +
         "gravity: [0, -9.81]\nbodies:\n"
         "  arm:\n    material: {youngs_modulus: 2.0e+7, poisson_ratio: 0.3}\n    thickness: 4\n"
         "    shape: {box: {x: [0, 40], y: [-2, 2]}}\n" +
         rigidBox("top", "[40, 84]", "[-2, 2]") + rigidBox("left", "[42, 46]", "[-32, 2]") +
         rigidBox("right", "[78, 82]", "[-32, 2]") + rigidBox("bottom", "[42, 82]", "[-32, -28]") +
         "supports:\n  - {name: wall, body: arm, region: {x: [0, 0]}, hold: xy}\n"
         "joints:\n  - {name: weld, first: arm, second: top, region: {x: [40, 40]}}\n"
         "  - {name: top left, first: top, second: left, at: [44, 0]}\n"
         "  - {name: top right, first: top, second: right, at: [80, 0]}\n"
         "  - {name: bottom left, first: bottom, second: left, at: [44, -30]}\n"
         "  - {name: bottom right, first: bottom, second: right, at: [80, -30]}\n"
         "loads:\n  - {name: pull, body: bottom, region: {x: [42, 42], y: [-32, -28]}, force: [-0.03, 0]}\n"
         "monitors:\n  - {name: top, body: top, at: [62, 0], radius: 12}\n"
         "  - {name: left, body: left, at: [44, -15], radius: 8}\n"
         "  - {name: right, body: right, at: [80, -15], radius: 8}\n"
         "  - {name: bottom, body: bottom, at: [62, -30], radius: 12}\n"
         "  - {name: sag, body: top, at: [82, 0], direction: [0, 1]}\npath: {to: 1, steps: 4}\n";
}

TEST(RigidChain, ClosedFourBarHangsOnASoftArm) {
  const double rod = 2000 * 9.81 * 34e-3 * 4e-3 * 4e-3, bar = 2000 * 9.81 * 40e-3 * 4e-3 * 4e-3;
  std::vector<statics::SceneCurve> curves;
  for (const std::string& enforcement : ENFORCEMENTS) {
    SCOPED_TRACE(enforcement);
    curves.push_back(trace(sceneFromText(fourBarOnAnArm(enforcement))));
    const statics::SceneCurve& curve = curves.back();
    ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
    for (std::size_t k = 0; k < curve.path.points.size(); ++k) {
      const double pull = 0.03 * curve.path.points[k].control;
      const std::vector<double>& m = curve.monitors[k];
      // By virtual work in the rods' angle: pull 30 cos = (2 rod 15 + bar 30) sin.
      EXPECT_NEAR(m[1], -std::atan(30 * pull / (2 * 15 * rod + 30 * bar)), 1e-8);
      EXPECT_NEAR(m[2], m[1], 1e-10) << "the rods stay parallel";
      EXPECT_NEAR(m[3], m[0], 1e-10) << "and so do the bars";
      EXPECT_LT(m[4], -3e-3) << "the arm bends";
      EXPECT_TRUE(curve.path.points[k].stable);
    }
    EXPECT_LT(curve.path.iterations, (enforcement == "augmented_lagrangian" ? 60 : 12) * 5);
  }
  for (const std::size_t other : {1u, 2u}) {
    for (std::size_t k = 0; k < curves[0].path.points.size(); ++k) {
      const auto &a = curves[0].path.points[k], &b = curves[other].path.points[k];
      EXPECT_NEAR(a.force, b.force, 1e-9 * std::abs(curves[0].path.points.back().force)) << "at " << a.control;
      EXPECT_NEAR(a.energy, b.energy, 1e-9 * a.energy);
      for (std::size_t m = 0; m < curves[0].monitors[k].size(); ++m) {
        EXPECT_NEAR(curves[0].monitors[k][m], curves[other].monitors[k][m], 1e-9);
      }
    }
  }
}

/// A vehicle's ring and housing are rigid, its arm is glued to one and joined to the other.
TEST(RigidChain, QuarterVehicleIsTheSameWhateverEnforcesItsJoints) {
  Scene vehicle = loadScene(SCENES + "quarter_vehicle.yaml");
  vehicle.cell_size = 2e-3;
  vehicle.steps = 10;
  statics::TraceSettings tight;
  tight.newton.relative_tolerance = 1e-12;
  std::vector<statics::SceneCurve> curves;
  for (const std::string& enforcement : ENFORCEMENTS) {
    vehicle.enforcement = solver::enforcementFromName(enforcement);
    // Penalties round at 1e-10 N.
    if (enforcement == "augmented_lagrangian") tight.newton.relative_tolerance = 1e-9;
    if (enforcement == "multipliers") tight.newton.relative_tolerance = 1e-12;
    const auto compiled = compileScene(vehicle, 1);
    EXPECT_EQ(compiled->problem().constraints() != nullptr, enforcement != "elimination");
    curves.push_back(statics::traceScene(vehicle, *compiled, tight, {}));
    ASSERT_EQ(curves.back().path.status, solver::SolveStatus::CONVERGED) << enforcement << curves.back().path.message;
    EXPECT_LT(curves.back().path.iterations, (enforcement == "augmented_lagrangian" ? 60 : 8) * 10) << enforcement;
  }
  double peak = 0;
  for (const auto& p : curves[0].path.points) peak = std::max(peak, std::abs(p.force));
  for (const std::size_t other : {1u, 2u}) {
    for (std::size_t k = 0; k < curves[0].path.points.size(); ++k) {
      const auto &a = curves[0].path.points[k], &b = curves[other].path.points[k];
      EXPECT_NEAR(a.force, b.force, (other == 1 ? 1e-8 : 1e-9) * peak) << ENFORCEMENTS[other] << " at " << a.control;
      EXPECT_EQ(a.negative_pivots, b.negative_pivots) << ENFORCEMENTS[other] << " at " << a.control;
    }
  }
}

/// The two rods let go sideways, in steps of a time integration that a user builds on the scene: no way of enforcing
/// the elbow loses energy, and all move alike.
TEST(RigidChain, TwoBodiesInAPinSwing) {
  constexpr double H = 1e-3;
  std::vector<Eigen::VectorXd> ends;
  for (const std::string& enforcement : {ENFORCEMENTS[0], ENFORCEMENTS[2]}) {
    SCOPED_TRACE(enforcement);
    const auto compiled = compileScene(sceneFromText(doublePendulum(2, enforcement)), 1);
    const auto problem = compiled->sharedTerms()->with({compiled->inertia(mpm::MassKind::CONSISTENT)});
    EXPECT_EQ(problem->constraints() != nullptr, enforcement == "multipliers");
    const solver::Coordinates& coordinates = problem->coordinates();
    auto context = std::make_shared<solver::StepContext>();
    solver::StepProblem step(problem, context, nullptr);
    solver::NewtonSettings newton;
    newton.relative_tolerance = 1e-12;
    solver::EquilibriumSolver solver(step, newton);
    constexpr double PULLED = 1;  // let go into the full pull
    solver::Equilibrium x = solver.start(Eigen::VectorXd::Zero(problem->freeCount()), PULLED);
    std::shared_ptr<const solver::References> references;
    Eigen::VectorXd y = coordinates.expand(x.z, x.p), v = Eigen::VectorXd::Zero(y.size());
    solver::Evaluation rest;
    problem->evaluate(x.z, x.p, solver::Order::ENERGY, rest);
    const double potential = rest.energy;
    double kinetic = 0;
    for (int k = 0; k < 200; ++k) {
      context = std::make_shared<solver::StepContext>();
      context->step = {H, 2 / (H * H), y, v, x.p, {{0.5, 1.0}}};
      auto start = std::make_shared<solver::Coordinates::Place>();
      coordinates.at(x.z, x.p, references.get(), *start);
      context->mean_with = start;
      step.setStep(context, references);
      const solver::NewtonResult result = solver.minimise(x);
      ASSERT_TRUE(result.converged()) << "step " << k << ": " << result.message;
      v = 2 * (x.at.place.y - y) / H - v;
      y = x.at.place.y;
      references = coordinates.renew(x.z, references.get());
    }
    // Kinetic energy as that of a step from here with no force: kappa / 2 |h v|^2 of the mass.
    auto still = std::make_shared<solver::StepContext>();
    still->step = {H, 1 / (H * H), y, v, x.p, {}};
    solver::Evaluation with, without;
    problem->evaluateAt(x.z, x.p, references.get(), still.get(), solver::Order::ENERGY, with);
    problem->evaluateAt(x.z, x.p, references.get(), nullptr, solver::Order::ENERGY, without);
    kinetic = with.energy - without.energy;
    EXPECT_GT(kinetic, 1e-5);
    EXPECT_NEAR(kinetic + without.energy, potential, 1e-8 * kinetic);
    ends.push_back(y);
  }
  EXPECT_LT((ends[0] - ends[1]).norm(), 1e-8 * ends[0].norm());
}

/// Rods in one line with their pins could fold either way: there is no equilibrium that constraints tell there.
TEST(RigidChain, DeadPointIsNamed) {
  const std::string text =
      header(2, "elimination", 2) +
      "bodies:\n  arm:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.3}\n    thickness: 4\n"
      "    shape: {box: {x: [0, 40], y: [-2, 2]}}\n" +
      rigidBox("top", "[40, 84]", "[-2, 2]") + rigidBox("crank", "[42, 66]", "[-2, 2]") +
      rigidBox("coupler", "[62, 106]", "[-2, 2]") + rigidBox("rocker", "[72, 106]", "[-2, 2]") +
      "supports:\n  - {name: wall, body: arm, region: {x: [0, 0]}, hold: xy}\n"
      "joints:\n  - {name: weld, first: arm, second: top, region: {x: [40, 40]}}\n"
      "  - {name: crank shaft, first: top, second: crank, at: [44, 0]}\n"
      "  - {name: crank pin, first: crank, second: coupler, at: [64, 0]}\n"
      "  - {name: rocker pin, first: coupler, second: rocker, at: [104, 0]}\n"
      "  - {name: rocker shaft, first: rocker, second: top, at: [74, 0]}\n"
      "loads:\n  - {name: pull, body: coupler, region: {x: [106, 106]}, force: [0, 0.01]}\n"
      "path: {to: 1, steps: 2}\n";
  const statics::SceneCurve curve = trace(sceneFromText(text));
  EXPECT_EQ(curve.path.status, solver::SolveStatus::SINGULAR);
  EXPECT_NE(curve.path.message.find("dead point: 'rocker shaft'"), std::string::npos) << curve.path.message;
}

/// A port that turns a rigid body on a nail: y of its place moves by the control.
TEST(RigidChain, PortTurnsABodyOnItsNail) {
  for (const std::string& enforcement : ENFORCEMENTS) {
    SCOPED_TRACE(enforcement);
    const std::string text =
        header(2, enforcement, 1) +
        "bodies:\n  strip:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.3}\n    thickness: 2\n"
        "    shape: {box: {x: [0, 6], y: [0, 1]}}\n" +
        rigidBox("block", "[6, 12]", "[0, 1]") +
        "joints:\n  - {name: low, first: strip, second: block, at: [6, 0]}\n"
        "  - {name: high, first: strip, second: block, at: [6, 1]}\n"
        "pins:\n  - {name: nail, body: block, at: [8, 0.5], kind: line}\n"
        "supports:\n  - {name: wall, body: strip, region: {x: [0, 0]}, hold: xy}\n"
        "ports:\n  - {name: push, body: block, region: {x: [12, 12], y: [0, 0]}, direction: [0, 1], cross_motion: "
        "free}\n"
        "monitors:\n  - {name: turn, body: block, at: [9, 0.5], radius: 2}\npath: {to: 1.5, steps: 6}\n";
    const Scene scene = sceneFromText(text);
    const statics::SceneCurve curve = trace(scene);
    ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
    for (std::size_t k = 0; k < curve.path.points.size(); ++k) {
      const double turn = curve.monitors[k][0];
      EXPECT_NEAR(4e-3 * std::sin(turn) - 0.5e-3 * (std::cos(turn) - 1), curve.path.points[k].control, 1e-12);
    }
    EXPECT_GT(curve.monitors.back()[0], 0.3);
    // The force is the slope of the energy by the travel.
    const auto& p = curve.path.points;
    EXPECT_NEAR((p[6].energy - p[4].energy) / (p[6].control - p[4].control), p[5].force, 0.02 * p[5].force);
  }
}

}  // namespace
}  // namespace snapwing::scene
