// Interrupted runs go on with the same bits; measured rungs are chosen as asked.
#include <gtest/gtest.h>

#include <filesystem>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/scene/rung.h"
#include "snapwing/statics/checkpoint.h"
#include "support/paths.h"

namespace snapwing::statics {
namespace {

scene::Scene coarseBeam() {
  scene::Scene scene = scene::loadScene(test::sourceDir() + "/config/scenes/snap_beam.yaml");
  scene.kernel = scene::SceneKernel::LINEAR_REDUCED;
  scene.cell_size = 8e-4;
  scene.steps = 28;
  return scene;
}

TEST(Checkpoint, AResumedRunHasTheSameBits) {
  const scene::Scene scene = coarseBeam();
  const auto compiled = scene::compileScene(scene, 1);
  const std::string file = ::testing::TempDir() + "snapwing_beam.checkpoint", hash = traceHash(scene, "");
  TraceSettings settings;
  settings.method = TraceMethod::AUTOMATIC;
  const SceneCurve whole = traceScene(scene, *compiled, settings, {});
  ASSERT_EQ(whole.path.status, solver::SolveStatus::CONVERGED);
  settings.reached = [&](const SceneCurve& sofar) { saveCheckpoint(sofar, hash, file); };
  const SceneCurve part =
      traceScene(scene, *compiled, settings, [](double, double control) { return control > 12e-3; });
  ASSERT_EQ(part.path.status, solver::SolveStatus::CANCELLED);
  ASSERT_LT(part.path.points.size(), whole.path.points.size());
  const SceneCurve known = loadCheckpoint(file, hash);
  EXPECT_EQ(known.path.points.size(), part.path.points.size());
  settings.resume = &known;
  const SceneCurve rest = traceScene(scene, *scene::compileScene(scene, 1), settings, {});
  ASSERT_EQ(rest.path.status, solver::SolveStatus::CONVERGED) << rest.path.message;
  EXPECT_EQ(rest.csv(scene), whole.csv(scene));
  ASSERT_EQ(rest.path.points.size(), whole.path.points.size());
  for (std::size_t k = 0; k < whole.path.points.size(); ++k) {
    EXPECT_TRUE(rest.path.points[k].solution == whole.path.points[k].solution) << k;
    EXPECT_EQ(rest.path.points[k].force, whole.path.points[k].force) << k;
  }
}

TEST(Checkpoint, AnotherSceneOrADamagedFileIsRefused) {
  scene::Scene scene = coarseBeam();
  const std::string file = ::testing::TempDir() + "snapwing_other.checkpoint", hash = traceHash(scene, "");
  saveCheckpoint({}, hash, file);
  EXPECT_NO_THROW(loadCheckpoint(file, hash));
  scene.steps = 29;
  EXPECT_THROW(loadCheckpoint(file, traceHash(scene, "")), common::FileError);
  std::string bytes = common::readFile(file);
  bytes.back() ^= 1;
  common::writeFileAtomically(file, bytes);
  EXPECT_THROW(loadCheckpoint(file, hash), common::FileError);
  EXPECT_THROW(loadCheckpoint(file + ".none", hash), common::FileError);
}

TEST(Rung, ResolutionIsASizeOrAFactor) {
  EXPECT_DOUBLE_EQ(scene::cellSizeFor("0.4mm", 1), 4e-4);
  EXPECT_DOUBLE_EQ(scene::cellSizeFor("5e-4", 1), 5e-4);
  EXPECT_DOUBLE_EQ(scene::cellSizeFor("x2", 1e-3), 5e-4);
  for (const char* bad : {"", "x", "x0", "-1mm", "fine", "1e9"})
    EXPECT_THROW(scene::cellSizeFor(bad, 1e-3), common::Error) << bad;
}

TEST(Rung, TheCheapestRowMeasuredOnThisContentIsTaken) {
  const std::string folder = ::testing::TempDir() + "snapwing_trade";
  std::filesystem::create_directories(folder);
  common::writeFileAtomically(
      folder + "/beam.csv",
      "# measured\nseconds,scene,content_sha256,rung,kernel,cell_size_m,error_percent\n"
      "0.5,\"beam, long\",ab,planar,quadratic,4e-4,0.24\n0.05,beam,ab,planar,linear_reduced,8e-4,2.3\n"
      "0.2,beam,ab,planar,linear_reduced,4e-4,0.41\n9,other,cd,planar,linear,1e-3,1\n1,beam,ab,planar,linear,1e-3,-\n");
  common::writeFileAtomically(folder + "/unrelated.csv", "a,b\n1,2\n");
  common::writeFileAtomically(folder + "/by_name.csv", "scene,rung,kernel,cell_size_m,error,seconds\nbeam,a,b,1,1,1\n");
  const std::vector<scene::TradeRow> rows = scene::loadTrade(folder);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows.front().scene, "beam, long");
  scene::Scene scene;
  scene.name = "whatever it is called";
  scene.content_sha256 = "ab";
  EXPECT_EQ(scene::chooseRow(rows, scene, 0.03, {}).seconds, 0.05);
  EXPECT_EQ(scene::chooseRow(rows, scene, 0.005, {}).seconds, 0.2);
  EXPECT_EQ(scene::chooseRow(rows, scene, {}, 0.3).seconds, 0.2);
  EXPECT_EQ(scene::chooseRow(rows, scene, {}, 10.0).kernel, "quadratic");
  EXPECT_THROW(scene::chooseRow(rows, scene, 0.001, {}), common::Error);
  scene.name = "beam";
  for (const char* unmeasured : {"ef", ""}) {
    scene.content_sha256 = unmeasured;
    EXPECT_THROW(scene::chooseRow(rows, scene, 0.1, {}), common::Error) << unmeasured;
  }
  EXPECT_TRUE(scene::loadTrade(folder + "/none").empty());
  const std::string other = ::testing::TempDir() + "snapwing_trade_wrong",
                    head = "seconds,scene,content_sha256,rung,kernel,cell_size_m,error";
  std::filesystem::create_directories(other);
  for (const std::string& text :
       {head + "\n0,5,beam,ab,planar,linear,4e-4,0.1\n", head + ",error\n0.5,beam,ab,planar,linear,4e-4,1\n"}) {
    common::writeFileAtomically(other + "/beam.csv", text);
    EXPECT_THROW(scene::loadTrade(other), common::FileError) << text;
  }
}

/// A part that changed under the same name is another scene; a name, a comment or finer cells are not.
TEST(Rung, ContentAndInputsAreWhatTheySay) {
  const std::string folder = ::testing::TempDir();
  const auto load = [&](const std::string& more, const std::string& density) {
    common::writeFileAtomically(folder + "content.csv", density);
    const std::string text =
        "scene: a\nlength_unit: mm\ndimension: 2\nplane: strain\nkernel: linear\n" + more +
        "bodies: {b: {material: {youngs_modulus: 1.0e+6, poisson_ratio: 0.3}, thickness: 1, "
        "density: {file: content.csv, length: 2, height: 1}}}\nsupports: [{name: s, region: {x: [0, 0]}, hold: xy}]\n"
        "ports: [{name: p, region: {x: [2, 2]}, direction: [1, 0], cross_motion: held}]\npath: {to: 1, steps: 4}\n";
    common::writeFileAtomically(folder + "content.yaml", text);
    return scene::loadScene(folder + "content.yaml");
  };
  const scene::Scene first = load("cell_size: 1\n", "i,j,rho\n0,0,1\n1,0,1\n");
  const scene::Scene finer = load("# finer\ncell_size: 0.5\n", "i,j,rho\n0,0,1\n1,0,1\n");
  const scene::Scene softer = load("cell_size: 1\n", "i,j,rho\n0,0,1\n1,0,0.5\n");
  EXPECT_EQ(first.named_files, std::vector<std::string>{folder + "content.csv"});
  EXPECT_EQ(first.content_sha256, finer.content_sha256);
  EXPECT_NE(first.sha256, finer.sha256);
  EXPECT_NE(first.content_sha256, softer.content_sha256);
  EXPECT_NE(first.sha256, softer.sha256);
  EXPECT_NE(traceHash(first, ""), traceHash(softer, ""));
}

TEST(Rung, ASolidAndItsSlice) {
  const scene::Scene planar = coarseBeam();
  const scene::Scene solid = scene::asVolumetric(planar);
  EXPECT_EQ(solid.dimension, 3);
  EXPECT_EQ(scene::asPlanar(solid, elasticity::Plane::STRESS).kernel, scene::SceneKernel::LINEAR);
  scene::Scene bounded = solid;
  bounded.supports[0].region.low(2) = 0;
  EXPECT_THROW(scene::asPlanar(bounded, elasticity::Plane::STRAIN), common::Error);
}

}  // namespace
}  // namespace snapwing::statics
