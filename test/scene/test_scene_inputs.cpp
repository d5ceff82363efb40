// What scene files may say: each class of wrong entry is refused by key; pins, thickness, densities, joints and output.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "scene_text.h"
#include "snapwing/common/error.h"

namespace snapwing::scene {
namespace {

/// A scene in which every list has an entry.
const char* const FULL = R"(scene: full
length_unit: mm
dimension: 3
kernel: linear
cell_size: 1
copies: 2
use_symmetry: false
gravity: [0, -9.81, 0]
bodies:
  block:
    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.4, mass_density: 1000}
    thickness: 2
    thickness_in: [{region: {x: [0, 1]}, thickness: 1}]
    shape: {union: [{polygon: [{x: 0, y: 0}, {x: 4, y: 0}, {x: 4, y: 2}, {x: 0, y: 2}]}, {disc: {centre: [1, 1], radius: 0.5}}]}
  lever:
    material: {rigid: true, mass_density: 1000}
    shape: {cylinder: {from: [5, 1, -1], to: [5, 1, 1], radius: 1.5}}
supports:
  - {name: wall, body: block, region: {x: [0, 0]}, hold: xyz}
symmetry_planes:
  - {name: half, body: block, normal: z, at: 0}
pins:
  - {name: nail, body: block, at: [1, 1], kind: mean, radius: 0.8}
joints:
  - {name: glue, first: block, second: lever, region: {x: [4, 4]}}
ports:
  - {name: push, body: lever, region: {x: [6, 6]}, direction: [0, 1, 0], cross_motion: held}
loads:
  - {name: weight, body: block, region: {y: [2, 2]}, force: [0, -0.1, 0], constant: true}
monitors:
  - {name: tip, body: lever, at: [5, 1, 0], direction: [0, 1, 0]}
path: {to: 0.2, steps: 2}
)";

TEST(SceneInputs, TheFullSceneRuns) {
  const statics::SceneCurve curve = trace(sceneFromText(FULL));
  ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
  EXPECT_EQ(curve.multiplicity, 4);
  EXPECT_NEAR(curve.monitors.back()[0], 0.2e-3, 1e-12);
}

struct WrongEntry {
  const char *from, *to, *key;
};

class WrongScene : public ::testing::TestWithParam<WrongEntry> {};

TEST_P(WrongScene, IsRefusedByKey) {
  const WrongEntry& c = GetParam();
  std::string text = FULL;
  const std::size_t at = text.find(c.from);
  ASSERT_NE(at, std::string::npos) << c.from;
  text.replace(at, std::string(c.from).size(), c.to);
  try {
    sceneFromText(text);
    ADD_FAILURE() << c.to << " was accepted";
  } catch (const common::SettingError& e) {
    EXPECT_EQ(e.key(), c.key) << e.what();
    EXPECT_NE(std::string(e.what()).find("allowed"), std::string::npos) << e.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Keys, WrongScene,
    ::testing::Values(
        WrongEntry{"copies: 2", "copies: 0", "copies"},
        WrongEntry{"use_symmetry: false", "use_symmetry: maybe", "use_symmetry"},
        WrongEntry{"gravity: [0, -9.81, 0]", "gravity: [0, -9.81]", "gravity"},
        WrongEntry{"gravity: [0, -9.81, 0]", "gravity: [0, .nan, 0]", "gravity[1]"},
        WrongEntry{"thickness: 2\n", "thickness: -2\n", "bodies.block.thickness"},
        WrongEntry{"x: [0, 1]}, thickness: 1", "x: [1, 0]}, thickness: 1", "bodies.block.thickness_in[0].region.x"},
        WrongEntry{"x: [0, 1]}, thickness: 1", "x: [0, 1]}, thickness: 0", "bodies.block.thickness_in[0].thickness"},
        WrongEntry{"{x: 4, y: 2}, {x: 0, y: 2}]", "{x: 4, z: 2}, {x: 0, y: 2}]",
                   "bodies.block.shape.union[0].polygon[2].y"},
        WrongEntry{"radius: 0.5", "radius: 0", "bodies.block.shape.union[1].disc.radius"},
        WrongEntry{"to: [5, 1, 1]", "to: [5, 1, -1]", "bodies.lever.shape.cylinder.to"},
        WrongEntry{"rigid: true", "rigid: 7", "bodies.lever.material.rigid"},
        WrongEntry{"rigid: true, mass", "rigid: true, poisson_ratio: 0.3, mass", "bodies.lever.material.poisson_ratio"},
        WrongEntry{"hold: xyz", "hold: xw", "supports[0].hold"},
        WrongEntry{"body: block, region: {x: [0, 0]}", "body: blok, region: {x: [0, 0]}", "supports[0].body"},
        WrongEntry{"normal: z", "normal: xz", "symmetry_planes[0].normal"},
        WrongEntry{"kind: mean", "kind: glued", "pins[0].kind"},
        WrongEntry{"kind: mean, radius: 0.8", "kind: cylinder", "pins[0].radius"},
        WrongEntry{"second: lever", "second: block", "joints[0].second"},
        WrongEntry{"region: {x: [4, 4]}", "from: [4, 1], to: [4, 2, 0]", "joints[0].from"},
        WrongEntry{"direction: [0, 1, 0], cross", "direction: [0, 0, 0], cross", "ports[0].direction"},
        WrongEntry{"cross_motion: held", "cross_motion: some", "ports[0].cross_motion"},
        WrongEntry{", constant: true", "", "loads[0].constant"},
        WrongEntry{"force: [0, -0.1, 0]", "force: heavy", "loads[0].force"},
        WrongEntry{"at: [5, 1, 0], direction", "at: [5, 1], direction", "monitors[0].at"},
        WrongEntry{"steps: 2", "steps: 0", "path.steps"}, WrongEntry{"to: 0.2", "to: .inf", "path.to"},
        WrongEntry{"copies: 2", "copies: 2\ncolour: red", "colour"},
        WrongEntry{"shape: {cylinder: {from: [5, 1, -1], to: [5, 1, 1], radius: 1.5}}",
                   "density: {file: lever.bmp, length: 2, height: 1}\n    thickness: 1", "bodies.lever.density.file"},
        WrongEntry{"shape: {cylinder: {from: [5, 1, -1], to: [5, 1, 1], radius: 1.5}}",
                   "shape: {extrude: {z: [1, -1], shape: {disc: {centre: [0, 0], radius: 1}}}}",
                   "bodies.lever.shape.extrude.z"}));

std::string refusal(std::string text, const std::string& from, const std::string& to) {
  return reasonFor(text.replace(text.find(from), from.size(), to));
}

/// What only shows on the cells names the entry.
TEST(SceneInputs, MisplacedEntriesAreNamed) {
  const WrongEntry cases[] = {{"region: {x: [0, 0]}", "region: {x: [9, 9]}", "wall"},
                              {"at: [1, 1], kind", "at: [8, 1], kind", "nail"},
                              {"region: {x: [4, 4]}", "region: {x: [2, 2]}", "glue"},
                              {"region: {x: [4, 4]}", "from: [4, 1, 0], to: [4, 9, 0]", "glue"},
                              {"region: {x: [4, 4]}", "region: {x: [3, 4]}", "glue"},
                              {"region: {y: [2, 2]}, force", "region: {y: [1, 2]}, force", "weight"},
                              {"radius: 1.5", "radius: 0.01", "lever"}};
  for (const WrongEntry& c : cases) {
    EXPECT_NE(refusal(FULL, c.from, c.to).find(c.key), std::string::npos)
        << c.to << ": " << refusal(FULL, c.from, c.to);
  }
}

TEST(SceneInputs, QuadraticCutCellsNeedThreeParticles) {
  Scene scene = loadScene(SCENES + "snap_beam.yaml");
  scene.particles = 2;
  try {
    compileScene(scene, 1);
    ADD_FAILURE() << "was accepted";
  } catch (const common::Error& e) {
    EXPECT_NE(std::string(e.what()).find("particles is 2; allowed"), std::string::npos) << e.what();
  }
}

/// A block pulled off a mean pin: the mean displacement of the section is zero, that of its points is not.
TEST(SceneInputs, MeanPinHoldsTheMean) {
  std::string text = box("linear", 2,
                         "pins:\n  - {name: axle, at: [1, 1], kind: mean, radius: 0.9}\n"
                         "ports:\n  - {name: pull, region: {x: [3, 3]}, direction: [1, 0], cross_motion: free}\n"
                         "path: {to: 0.5, steps: 2}\nparticles: 16\nmonitors:\n");
  int count = 0;
  const int n = 24;
  for (int k = 0; k < n * n; ++k) {
    const int column = k % n, row = k / n;
    const double x = 0.1 + 1.8 * (column + 0.5) / n, y = 0.1 + 1.8 * (row + 0.5) / n;
    if (std::hypot(x - 1, y - 1) > 0.9) continue;
    text += "  - {name: m" + std::to_string(count++) + ", at: [" + std::to_string(x) + ", " + std::to_string(y) +
            "], direction: [1, 0]}\n";
  }
  const statics::SceneCurve curve = trace(sceneFromText(text));
  ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
  double mean = 0, largest = 0;
  for (const double u : curve.monitors.back()) {
    mean += u / count;
    largest = std::max(largest, std::abs(u));
  }
  EXPECT_GT(largest, 3e-5);
  EXPECT_LT(std::abs(mean), 0.05 * largest);
}

/// Two strips in a row, one half as thick: twice the stretch, and the force of springs in series at small strain.
TEST(SceneInputs, ThicknessDiffersByRegion) {
  for (const int dimension : {2, 3}) {
    const std::string zero = dimension == 3 ? ", 0" : "";
    std::string text = box(
        "linear", dimension,
        "supports:\n  - {name: wall, region: {x: [0, 0]}, hold: x}\n  - {name: foot, region: {y: [0, 0]}, hold: y}\n"
        "ports:\n  - {name: pull, region: {x: [3, 3]}, direction: [1, 0" +
            zero + "], cross_motion: free}\npath: {to: 3.0e-4, steps: 1}\n");
    const double whole = trace(sceneFromText(text)).path.points.back().force;
    text.replace(text.find("cell_size: 1"), 12, "cell_size: 1\nparticles: 4");
    text.replace(text.find("    shape:"), 0, "    thickness_in: [{region: {x: [0, 1]}, thickness: 1}]\n");
    text.replace(text.find("0.48"), 4, "0.0");
    std::string even = text;
    even.replace(even.find("    thickness_in: [{region: {x: [0, 1]}, thickness: 1}]\n"), 56, "");
    const double thick = trace(sceneFromText(even)).path.points.back().force;
    const double mixed = trace(sceneFromText(text)).path.points.back().force;
    EXPECT_GT(whole, 0);
    // 1 of 3 mm has half the section: 3 / (2 + 1 + 1). A solid is a little softer, since the flow narrows at the step.
    EXPECT_NEAR(mixed / thick, 0.75, dimension == 2 ? 1e-4 : 0.05);
    if (dimension == 3) {
      EXPECT_LT(mixed / thick, 0.75);
    }
  }
}

/// The same design as CSV numbers, whichever way the cells are averaged; void may be left out.
TEST(SceneInputs, AbsentBelowLeavesVoidOut) {
  std::string text;
  {
    std::ofstream file(test::ownFolder() + "absent.csv");
    file << "i,j,rho\n";
    for (int i = 0; i < 4; ++i) file << i << ",0," << (i == 3 ? 0.0 : 1.0) << "\n";
  }
  text =
      "scene: d\nlength_unit: mm\ndimension: 2\nplane: strain\nkernel: linear\ncell_size: 1\nbodies:\n  b:\n"
      "    material: {youngs_modulus: 1.0e+6, poisson_ratio: 0.3}\n    thickness: 1\n"
      "    density: {file: absent.csv, length: 4, height: 1, absent_below: 0.01}\n"
      "supports:\n  - {name: wall, region: {x: [0, 0]}, hold: xy}\n"
      "ports:\n  - {name: end, region: {x: [3, 3]}, direction: [1, 0], cross_motion: held}\npath: {to: 0.1, steps: "
      "1}\n";
  EXPECT_EQ(compileScene(sceneFromText(text), 1)->cellCount(), 3);
  text.replace(text.find(", absent_below: 0.01"), 20, "");
  EXPECT_EQ(compileScene(sceneFromText(text), 1)->cellCount(), 4);
}

/// VTU: cells, shared corners, their displacements and det F of a uniform stretch.
TEST(SceneInputs, VtuHoldsTheDeformedCells) {
  const Scene scene = sceneFromText(
      box("linear", 2,
          "supports:\n  - {name: left, region: {x: [0, 0]}, hold: x}\n  - {name: foot, region: {y: [0, 0]}, hold: y}\n"
          "ports:\n  - {name: pull, region: {x: [3, 3]}, direction: [1, 0], cross_motion: free}\npath: {to: 0.3, "
          "steps: 1}\n"));
  const auto compiled = compileScene(scene, 1);
  const statics::SceneCurve curve = statics::traceScene(scene, *compiled, {}, {});
  const statics::PathPoint& end = curve.path.points.back();
  const std::string text = compiled->vtu(end.solution, end.control);
  const auto numbers = [&](const std::string& name) {
    const std::size_t head = text.find("Name=\"" + name + "\""), from = text.find(">\n", head) + 2;
    std::istringstream words(text.substr(from, text.find("</DataArray>", from) - from));
    std::vector<double> values;
    for (double v; words >> v;) values.push_back(v);
    return values;
  };
  EXPECT_NE(text.find("NumberOfPoints=\"12\" NumberOfCells=\"6\""), std::string::npos);
  const std::vector<double> x = numbers("rest_position_m"), u = numbers("displacement_m"), det = numbers("det_f"),
                            cells = numbers("connectivity"), types = numbers("types");
  ASSERT_EQ(x.size(), 36u);
  ASSERT_EQ(cells.size(), 24u);
  for (std::size_t k = 0; k < 12; ++k) EXPECT_NEAR(u[3 * k], 0.1 * x[3 * k], 1e-8);
  for (const double t : types) EXPECT_EQ(t, 9);
  for (const double d : det) EXPECT_NEAR(d, det[0], 1e-6);
  EXPECT_GT(det[0], 1.0);
  for (int c = 0; c < 6; ++c) {
    double area = 0;
    for (int k = 0; k < 4; ++k) {
      const auto a = static_cast<std::size_t>(cells[4 * c + k]),
                 b = static_cast<std::size_t>(cells[4 * c + (k + 1) % 4]);
      area += 0.5 * (x[3 * a] * x[3 * b + 1] - x[3 * b] * x[3 * a + 1]);
    }
    EXPECT_NEAR(area, 1e-6, 1e-15) << "corners in order";
  }
}

/// A joint at a driven port: what the drive says already is dropped, a body that is held elsewhere contradicts it.
TEST(SceneInputs, JointAtADrivenPort) {
  std::string text =
      box("linear", 2,
          "  other:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.3}\n    thickness: 2\n"
          "    shape: {box: {x: [3, 5], y: [0, 2]}}\n"
          "joints:\n  - {name: glue, first: block, second: other, region: {x: [3, 3]}}\n"
          "supports:\n  - {name: wall, body: block, region: {x: [0, 0]}, hold: xy}\n"
          "  - {name: end, body: other, region: {x: [5, 5]}, hold: xy}\n"
          "ports:\n  - {name: push, body: block, region: {x: [3, 3]}, direction: [0, 1], cross_motion: held}\n"
          "path: {to: 0.2, steps: 2}\n");
  const statics::SceneCurve both = trace(sceneFromText(text));
  ASSERT_EQ(both.path.status, solver::SolveStatus::CONVERGED) << both.path.message;
  // Driving either side of the joint, or both, is the same.
  std::string other = text;
  other.replace(other.find("push, body: block"), 17, "push, body: other");
  EXPECT_NEAR(trace(sceneFromText(other)).path.points.back().force, both.path.points.back().force,
              1e-9 * both.path.points.back().force);
  EXPECT_NE(
      refusal(text, "end, body: other, region: {x: [5, 5]}", "end, body: other, region: {x: [3, 3]}").find("glue"),
      std::string::npos);
}

TEST(SceneInputs, QuarterVehicleIsFourArms) {
  Scene vehicle = loadScene(SCENES + "quarter_vehicle.yaml"), arm = loadScene(SCENES + "arm_planar.yaml");
  for (Scene* s : {&vehicle, &arm}) {
    s->cell_size = 2e-3;
    s->steps = 10;
    s->to = 30e-3;
    s->back = false;
  }
  const statics::SceneCurve a = trace(vehicle), b = trace(arm);
  ASSERT_EQ(a.path.status, solver::SolveStatus::CONVERGED) << a.path.message;
  for (std::size_t k = 0; k < b.path.points.size(); ++k) {
    EXPECT_NEAR(a.multiplicity * a.path.points[k].force, 4 * b.path.points[k].force, 1e-6);
    EXPECT_NEAR(a.monitors[k][0], b.monitors[k][0], 1e-7);
  }
}

TEST(SceneInputs, LatchIsBistableWithAndWithoutSymmetry) {
  Scene half = loadScene(SCENES + "bistable_latch.yaml");
  half.steps = 8;
  half.to = 6e-3;
  Scene whole = half;
  whole.use_symmetry = SymmetryUse::NONE;
  const statics::SceneCurve a = trace(half), b = trace(whole);
  ASSERT_EQ(a.path.status, solver::SolveStatus::CONVERGED) << a.path.message;
  ASSERT_EQ(b.path.status, solver::SolveStatus::CONVERGED) << b.path.message;
  EXPECT_EQ(a.multiplicity, 2);
  double least = 0;
  for (std::size_t k = 0; k < a.path.points.size(); ++k) {
    EXPECT_NEAR(2 * a.path.points[k].force, b.path.points[k].force, 1e-6);
    EXPECT_TRUE(b.path.points[k].stable) << "no asymmetric motion at " << b.path.points[k].control;
    least = std::min(least, b.path.points[k].force);
  }
  EXPECT_LT(least, -0.03) << "it must hold itself in the second state";
}

}  // namespace
}  // namespace snapwing::scene
