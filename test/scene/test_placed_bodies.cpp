// Bodies with frames, parts that are placed several times, and rigid bodies that are told by their mass.
#include <gtest/gtest.h>

#include <cmath>

#include "scene_text.h"
#include "snapwing/common/error.h"

namespace snapwing::scene {
namespace {

using Eigen::Matrix3d;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

void expectSame(const statics::SceneCurve& a, const statics::SceneCurve& b, double times, double share) {
  ASSERT_EQ(a.path.status, solver::SolveStatus::CONVERGED) << a.path.message;
  ASSERT_EQ(b.path.status, solver::SolveStatus::CONVERGED) << b.path.message;
  ASSERT_EQ(a.path.points.size(), b.path.points.size());
  double force = 0, stiffness = 0, energy = 0;
  for (const auto& p : a.path.points) {
    force = std::max(force, std::abs(p.force));
    stiffness = std::max(stiffness, std::abs(p.stiffness));
    energy = std::max(energy, std::abs(p.energy));
  }
  EXPECT_GT(force, 0);
  for (std::size_t k = 0; k < a.path.points.size(); ++k) {
    const auto &p = a.path.points[k], &q = b.path.points[k];
    EXPECT_NEAR(times * p.force, q.force, times * share * force) << "at " << p.control;
    EXPECT_NEAR(times * p.stiffness, q.stiffness, times * 100 * share * stiffness) << "at " << p.control;
    EXPECT_NEAR(times * p.energy, q.energy, times * share * energy) << "at " << p.control;
  }
}

statics::SceneCurve tight(const Scene& scene) {
  statics::TraceSettings settings;
  settings.newton.relative_tolerance = 1e-12;
  return statics::traceScene(scene, *compileScene(scene, 1), settings, {});
}

/// The shipped snap beam, with weight, and the same turned by 37 degrees in a world that is turned along.
TEST(Frame, ATurnedSnapBeamIsTheSame) {
  Scene plain = loadScene(SCENES + "snap_beam.yaml");
  plain.cell_size = 8e-4;
  plain.steps = 14;
  plain.bodies[0].material.mass_density = 1200;
  plain.gravity = Point3(0.3, -9.81, 0);
  Scene turned = plain;
  const double angle = 37 * std::acos(-1.0) / 180;
  turned.bodies[0].frame.rotation << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  turned.bodies[0].frame.origin = Point3(0.02, -0.03, 0);
  turned.gravity = turned.bodies[0].frame.rotation * plain.gravity;
  expectSame(tight(plain), tight(turned), 1, 1e-10);
}

/// A hub on a nail between strips that reach inwards: glued faces join bodies whose axes differ.
std::string wheel(const std::string& copies) {
  return "scene: wheel\nlength_unit: mm\ndimension: 2\nplane: strain\nkernel: linear\ncell_size: 1\nuse_symmetry: "
         "false\ngravity: [0, 0]\nbodies:\n"
         "  arm:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.3, mass_density: 1200}\n    thickness: 3\n"
         "    shape: {box: {x: [5, 20], y: [-1, 1]}}\n" +
         copies +
         "  hub:\n    material: {rigid: true, mass_density: 3000}\n    thickness: 3\n"
         "    shape: {box: {x: [-5, 5], y: [-5, 5]}}\n"
         "supports:\n  - {name: rim, body: arm, region: {x: [20, 20]}, hold: xy}\n"
         "joints:\n  - {name: glue, first: arm, second: hub, region: {x: [5, 5]}}\n"
         "pins:\n  - {name: nail, body: hub, at: [0, 0], kind: line}\n"
         "ports:\n  - {name: crank, body: hub, region: {x: [5, 5], y: [0, 0]}, direction: [0, 1], cross_motion: free}\n"
         "monitors:\n  - {name: turn, body: hub, at: [0, 0], radius: 4}\npath: {to: 1.5, steps: 6}\n";
}
std::string copiesAt(const std::vector<std::string>& rotations) {
  std::string text;
  for (const std::string& r : rotations) {
    text += "  arm_" + std::to_string(text.size()) + ": {copy_of: arm, frame: {rotation: " + r + "}}\n";
  }
  return text;
}

TEST(Frame, FourPlacedArmsAreFourTimesOne) {
  const statics::SceneCurve one = tight(sceneFromText(wheel("")));
  EXPECT_GT(one.monitors.back()[0], 0.2);
  expectSame(one,
             tight(sceneFromText(wheel(copiesAt({"1.5707963267948966", "3.141592653589793", "-1.5707963267948966"})))),
             4, 1e-10);
  expectSame(one, tight(sceneFromText(wheel(copiesAt({"2.0943951023931953", "4.1887902047863905"})))), 3, 1e-10);
}

/// Quarter turns couple no more coordinates than none.
TEST(Frame, QuarterTurnsAddNoEntries) {
  const auto turned = [&](const std::string& rotation) {
    return compileScene(sceneFromText(wheel(copiesAt({rotation}))), 1)->problem().pattern().entries();
  };
  EXPECT_EQ(turned("1.5707963267948966"), turned("0"));
  EXPECT_GE(turned("0.7"), turned("0"));
}

/// In space, with the arms' weight: a plate between four leaves is lifted.
std::string table(const std::string& copies) {
  return "scene: table\nlength_unit: mm\ndimension: 3\nkernel: linear_reduced\ncell_size: 2\nuse_symmetry: false\n"
         "gravity: [0, 0, -9.81]\nbodies:\n"
         "  arm:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.3, mass_density: 1200}\n"
         "    shape: {box: {x: [6, 20], y: [-2, 2], z: [-1, 1]}}\n" +
         copies +
         "  plate:\n    material: {rigid: true}\n    shape: {box: {x: [-6, 6], y: [-6, 6], z: [-1, 1]}}\n"
         "supports:\n  - {name: rim, body: arm, region: {x: [20, 20]}, hold: xyz}\n"
         "joints:\n  - {name: glue, first: arm, second: plate, region: {x: [6, 6]}}\n"
         "ports:\n  - {name: lift, body: plate, region: {z: [-1, -1]}, direction: [0, 0, 1], cross_motion: held}\n"
         "path: {to: 3, steps: 3}\n";
}

TEST(Frame, FourPlacedArmsInSpaceAreFourTimesOne) {
  const auto at = [](const std::string& angle) { return "[0, 0, " + angle + "]"; };
  const statics::SceneCurve one = tight(sceneFromText(table("")));
  expectSame(one, tight(sceneFromText(table(copiesAt({at("1.5707963267948966"), at("3.141592653589793"), at("0.7")})))),
             4, 1e-10);
}

/// A strip with a rigid block at its end, as in test_rigid.cpp: the block of cells, or told by its mass.
std::string stripAndBlock(int dimension, bool given) {
  const bool space = dimension == 3;
  const std::string zero = space ? ", 0" : "";
  const double mass = 2000 * 4e-3 * 1e-3 * 2e-3;
  const auto moment = [&](double a, double b) { return std::to_string(1e12 * mass / 12 * (a * a + b * b)) + "e-12"; };
  const std::string block =
      given
          ? "  block:\n    rigid: {mass: " + std::to_string(1e6 * mass) + "e-6, centre: [8, 0.5" + zero +
                "], inertia: " +
                (space ? "[" + moment(1e-3, 2e-3) + ", " + moment(4e-3, 2e-3) + ", " + moment(4e-3, 1e-3) + ", 0, 0, 0]"
                       : moment(4e-3, 1e-3)) +
                "}\n"
          : "  block:\n    material: {rigid: true, mass_density: 2000}\n    thickness: 2\n"
            "    shape: {box: {x: [6, 10], y: [0, 1]}}\n";
  const std::string place = given ? "at: [10, 0.5" + zero + "]" : "region: {x: [10, 10]}";
  return "scene: strip\nlength_unit: mm\ndimension: " + std::to_string(dimension) +
         (space ? "\n" : "\nplane: strain\n") +
         "kernel: linear\ncell_size: 1\nuse_symmetry: false\ngravity: [0, -9.81" + zero +
         "]\nbodies:\n"
         "  strip:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.3, mass_density: 1200}\n    thickness: 2\n"
         "    shape: {box: {x: [0, 6], y: [0, 1]}}\n" +
         block +
         (space ? "joints:\n  - {name: low, first: strip, second: block, at: [6, 0]}\n"
                  "  - {name: high, first: strip, second: block, from: [6, 1, -0.9], to: [6, 1, 0.9]}\n"
                : "joints:\n  - {name: low, first: strip, second: block, at: [6, 0]}\n"
                  "  - {name: high, first: strip, second: block, at: [6, 1]}\n") +
         "supports:\n  - {name: wall, body: strip, region: {x: [0, 0]}, hold: " + (space ? "xyz" : "xy") +
         "}\nloads:\n  - {name: end, body: block, " + place + ", force: [0, 0.12" + (space ? ", 0.02" : "") +
         "]}\nmonitors:\n  - {name: y, body: block, at: [9.5, 0.2" + zero + "], direction: [0, 1" + zero +
         "]}\n"
         "  - {name: turn, body: block, at: [8, 0.5" +
         zero + "], radius: 3}\npath: {to: 1, steps: 4}\n";
}

TEST(GivenMass, ABodyWithoutCellsMovesAsOneOfCells) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    const Scene cells = sceneFromText(stripAndBlock(dimension, false));
    const auto of_cells = compileScene(cells, 1);
    const Scene mass = sceneFromText(stripAndBlock(dimension, true));
    const auto of_mass = compileScene(mass, 1);
    statics::TraceSettings settings;
    settings.newton.relative_tolerance = 1e-12;
    const statics::SceneCurve a = statics::traceScene(cells, *of_cells, settings, {});
    const statics::SceneCurve b = statics::traceScene(mass, *of_mass, settings, {});
    expectSame(a, b, 1, 1e-9);
    const auto &p = a.path.points.back(), &q = b.path.points.back();
    EXPECT_GT(a.monitors.back()[1], 0.1);
    EXPECT_NEAR(a.monitors.back()[0], b.monitors.back()[0], 1e-9);
    // About z alone the best fit over nodes is the body's own angle.
    if (dimension == 2) {
      EXPECT_NEAR(a.monitors.back()[1], b.monitors.back()[1], 1e-9);
    }
    const mpm::MovingMass one = of_cells->movingMass(p.solution, p.control, p.slope),
                          other = of_mass->movingMass(q.solution, q.control, q.slope);
    EXPECT_NEAR(one.mass, other.mass, 1e-12 * one.mass);
    EXPECT_NEAR(one.kinetic, other.kinetic, 1e-7 * one.kinetic);
    EXPECT_LT(of_mass->problem().freeCount(), of_cells->problem().freeCount() + 1);
    // Inertia of the whole as a term: the same at one motion of all.
    const auto energy = [&](const CompiledScene& scene, const statics::PathPoint& at) {
      const solver::Coordinates& c = scene.terms().coordinates();
      solver::Step step;
      step.h = 1e-3, step.kappa = 1e6;
      const Eigen::VectorXd control = Eigen::VectorXd::Constant(1, at.control);
      step.y0 = c.expand(at.solution, control);
      step.v0 = Eigen::VectorXd::Zero(step.y0.size());
      const auto problem = scene.sharedTerms()->with({scene.inertia(mpm::MassKind::CONSISTENT)});
      auto context = std::make_shared<solver::StepContext>();
      context->step = step;
      solver::Evaluation moved;
      problem->evaluateAt(at.solution + 1e-2 * at.slope, control, nullptr, context.get(), solver::Order::TANGENT,
                          moved);
      solver::Evaluation statics;
      problem->evaluate(at.solution + 1e-2 * at.slope, control, solver::Order::TANGENT, statics);
      return moved.energy - statics.energy;
    };
    const double kinetic = energy(*of_cells, p);
    EXPECT_GT(kinetic, 0);
    EXPECT_NEAR(energy(*of_mass, q), kinetic, 1e-6 * kinetic);
  }
}

TEST(BodyMass, IsThatOfTheClosedForms) {
  const std::string turned = replaced(stripAndBlock(3, false), "    shape: {box: {x: [6, 10], y: [0, 1]}}\n",
                                      "    shape: {box: {x: [6, 10], y: [0, 1]}}\n"
                                      "    frame: {origin: [1, 2, 3], rotation: [0, 0, 0.6457718232379019]}\n");
  const double a = 4e-3, b = 1e-3, c = 2e-3, mass = 2000 * a * b * c;
  const Matrix3d own =
      Eigen::Vector3d(b * b + c * c, a * a + c * c, a * a + b * b).asDiagonal() * Matrix3d::Identity() * (mass / 12);
  const double angle = 37 * std::acos(-1.0) / 180;
  Matrix3d q;
  q << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  Scene scene = sceneFromText(turned);
  scene.joints.clear();  // they would have to meet the block where it is now
  const BodyMass block = compileScene(scene, 1)->bodyMass(1);
  EXPECT_NEAR(block.mass, mass, 1e-13 * mass);
  EXPECT_LT((block.centre - (q * Point3(8e-3, 0.5e-3, 0) + Point3(1e-3, 2e-3, 3e-3))).norm(), 1e-15);
  EXPECT_LT((block.inertia - q * own * q.transpose()).norm(), 1e-13 * own.norm());
  const auto planar = compileScene(sceneFromText(stripAndBlock(2, true)), 1);
  EXPECT_NEAR(planar->bodyMass(1).inertia(2, 2), mass / 12 * (a * a + b * b), 1e-6 * own.norm());
  EXPECT_NEAR(planar->bodyMass(0).mass, 1200 * 6e-3 * 1e-3 * 2e-3, 1e-18);
}

TEST(PlacedBodies, WhatMakesNoSenseIsRefusedByKeyValueAndRange) {
  const auto refused = [](const std::string& text, const std::vector<std::string>& words) {
    const std::string reason = reasonFor(text);
    for (const std::string& word : words) EXPECT_NE(reason.find(word), std::string::npos) << word << " in " << reason;
  };
  const std::string given = stripAndBlock(2, true), space = stripAndBlock(3, true);
  refused(replaced(given, "rigid: {mass: ", "rigid: {mass: -"), {"bodies.block.rigid.mass", "kg"});
  refused(replaced(given, "centre: [8, 0.5]", "centre: [8, 0.5], weight: 3"), {"bodies.block.rigid.weight"});
  refused(replaced(given, "at: [10, 0.5]", "region: {x: [10, 10]}"), {"loads[0].at"});
  const std::size_t moments = space.find("inertia: ["), end = space.find("]", moments) + 1;
  refused(std::string(space).replace(moments, end - moments, "inertia: [1, 1.0e-9, 1.0e-9, 0, 0, 0]"),
          {"bodies.block.rigid.inertia", "triangle"});
  refused(wheel("  other: {copy_of: nobody, frame: {rotation: 1}}\n"), {"bodies.other.copy_of", "'nobody'"});
  refused(wheel("  other: {copy_of: arm, frame: {rotation: 1, about: z}}\n"), {"bodies.other.frame.about"});
  refused(wheel("  other: {copy_of: arm, frame: {rotation: 100}}\n"), {"bodies.other.frame.rotation", "100", "20"});
  refused(wheel("  other: {copy_of: arm, frame: {rotation: 1}, thickness: 3}\n"), {"bodies.other.thickness"});
}

}  // namespace
}  // namespace snapwing::scene
