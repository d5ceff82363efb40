// The arm problem: settings, gradients, a short run that goes the right way, resume, failures that are told.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "array_file.h"
#include "design_scene.h"
#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/arm/arm_check.h"
#include "snapwing/design/arm/arm_run.h"
#include "snapwing/design/arm/arm_topology.h"
#include "snapwing/design/design_program.h"
#include "support/paths.h"

namespace snapwing::design {
namespace {

const std::string DESIGNS = test::sourceDir() + "/config/designs/";

/// The default design on 4 mm cells, with robust variants, in a few iterations.
ArmDesignSettings coarse() {
  ArmDesignSettings s = loadArmDesignSettings(DESIGNS + "arm_default.yaml");
  s.stages = {{false, 0.004, 6, 0.05}};
  s.filter_radius = 0.008;
  s.sharpness_end = 16;  // the error of differences grows with its cube
  s.thresholds = {0.5, 0.6};
  s.volume = 0.9;  // out of the way: six iterations are too few for it
  s.slope_travels = {0.010, 0.022, 0.034};
  return s;
}

TEST(ArmSettings, ShippedFilesLoad) {
  for (const auto& entry : std::filesystem::directory_iterator(DESIGNS)) {
    if (entry.path().filename().string().rfind("arm_", 0) != 0) continue;
    EXPECT_FALSE(loadArmDesignSettings(entry.path()).name.empty()) << entry.path();
  }
}

TEST(ArmSettings, BadValuesAreNamed) {
  const std::string text = common::readFile(DESIGNS + "arm_default.yaml");
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    changed.replace(at, from.size(), to);
    const std::string path = ::testing::TempDir() + "arm_bad.yaml";
    const std::size_t vehicle = changed.find("../vehicles");
    changed.replace(vehicle, 11, test::sourceDir() + "/config/vehicles");
    std::ofstream(path) << changed;
    EXPECT_THROW(loadArmDesignSettings(path), common::SettingError) << to;
  };
  refused("bound: 0.55", "bound: 0.0");
  refused("cell_size: 0.002,", "cell_size: -1.0,");
  refused("method: mma", "method: guess");
  refused("thresholds: [0.5, 0.58, 0.42]", "thresholds: []");
  refused("valley_travels: [0.034, 0.038", "valley_travels: [0.044, 0.038");
  refused("rotation: [0.74, 0.87]", "rotation: [0.87, 0.74]");
  refused("rotation_travels: [0.055]", "");
  refused("rotation_travels: [0.055]", "rotation_travels: []");
  refused("valley_range: [0.034, 0.055]", "valley_range: [0.05, 0.03]");
  refused("valley_range: [0.034, 0.055]", "valley_range: [0.005, 0.05]");
  refused("valley_range: [0.034, 0.055]", "valley_range: [0.03]");
  refused("pin_patch: 0.004 ", "pin_patch: 0.004\n  surprise: 1 ");
}

TEST(ArmTopology, GradientsMatchDifferences) {
  for (const double share : {0.0, 0.7}) {
    ArmDesignSettings s = coarse();
    s.stages[0].iterations = 1001;  // only places `share` on the continuation
    const GradientCheck check = checkArmGradients(s, share);
    ASSERT_TRUE(check.valid) << check.message;
    EXPECT_GT(check.rows.size(), 10u);
    // The largest step's error falls with its square; 1e-6 leaves room for cancellation in R(a) - R(b).
    for (const GradientRow& row : check.rows) {
      EXPECT_LT(row.best(), 1e-6) << row.quantity;
      EXPECT_GT(row.relative_errors[0], 0) << row.quantity;
    }
  }
}

TEST(ArmTopology, ShortRunLowersViolationAndResumes) {
  const std::string folder = ::testing::TempDir() + "arm_resume";
  std::filesystem::remove_all(folder);
  ArmDesignSettings s = coarse();
  s.sharpness_end = 1;
  const ArmRun whole = runArmDesign(s, {});
  ASSERT_EQ(whole.history.size(), 6u);
  EXPECT_LT(whole.result.violation, whole.history.front().report.violation);
  ArmRunOptions options;
  options.folder = folder;
  options.progress = [](const ArmProgress& p) { return p.report.iteration == 3; };
  EXPECT_EQ(runArmDesign(s, options).result.status, OptimizerStatus::CANCELLED);
  options.progress = nullptr;
  options.resume = true;
  const ArmRun rest = runArmDesign(s, options);
  ASSERT_EQ(rest.history.size(), 6u);
  EXPECT_EQ(rest.field.value, whole.field.value);  // bit for bit
  EXPECT_TRUE(std::filesystem::exists(folder + "/history.csv"));
  EXPECT_TRUE(std::filesystem::exists(folder + "/history.h5"));
}

TEST(ArmTopology, ACheckpointOfAnotherProgramBeginsAnewAndSaysSo) {
  ArmDesignSettings s = coarse();
  s.sharpness_end = 1;
  ArmRunOptions options;
  options.folder = ::testing::TempDir() + "arm_other_program";
  options.progress = [](const ArmProgress& p) { return p.report.iteration == 2; };
  std::filesystem::remove_all(options.folder);
  runArmDesign(s, options);
  const std::string checkpoint = options.folder + "/checkpoint.h5";
  ArrayFile file = loadArrays(checkpoint);
  EXPECT_EQ(file.notes.at("program"), designProgram());
  file.notes["program"] = "0.1.0+aa";
  saveArrays(file, checkpoint);
  int first = -1;
  std::string warned;
  options.resume = true;
  options.progress = [&first](const ArmProgress& p) { return (first = p.report.iteration) >= 0; };
  options.warning = [&warned](const std::string& text) { warned += text; };
  runArmDesign(s, options);
  EXPECT_EQ(first, 0);
  EXPECT_NE(warned.find("was written by another program (0.1.0+aa, this is " + designProgram()), std::string::npos);
}

TEST(ArmTopology, ForeignCheckpointIsRefused) {
  const std::string folder = ::testing::TempDir() + "arm_foreign";
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/checkpoint.h5") << "no HDF5";
  ArmRunOptions options;
  options.folder = folder;
  options.resume = true;
  EXPECT_THROW(runArmDesign(coarse(), options), common::FileError);
}

TEST(ArmTopology, DomainThatDoesNotFitIsRefused) {
  EXPECT_THROW(armDomain(coarse().vehicle.arm, 0.003, 1), common::Error);
}

TEST(ArmCheck, AnUnsupportedDesignIsNotBistableAndNoError) {
  ArmDesignSettings s = coarse();
  s.check_cells = {0.004};
  const ArmShape nothing(std::vector<Loop>{{{0.05, 0.001}, {0.079, 0.001}, {0.079, 0.01}, {0.05, 0.01}}});
  const ArmCheck check = checkArm(s, nothing, {}, nullptr);
  EXPECT_FALSE(check.bistable);
  EXPECT_FALSE(check.cases.front().message.empty());
}

TEST(ArmCheck, SideBySideChangesNothingAndTellsEachCaseOnce) {
  ArmDesignSettings s = coarse();
  s.check_cells = {0.004, 0.002};
  s.check_offset = 0.0002;
  s.check_quadratic_cells = {0.004};
  s.check_volumetric_cells = {};
  s.check_step = 0.004;
  const mpm::DensityField field = loadDesignedDensity(s, test::sourceDir() + "/data/arms/arris_x220.csv");
  const ArmShape shape(field);
  const auto checked = [&](int threads, std::vector<std::string>& told) {
    s.threads = threads;
    return checkArm(s, shape, field, [&told](const std::string& name) {
      if (!name.empty()) told.push_back(name);
      return false;
    });
  };
  std::vector<std::string> names_one, names_three, names;
  const ArmCheck one = checked(1, names_one), three = checked(3, names_three);
  ASSERT_EQ(one.cases.size(), 6U);
  ASSERT_EQ(three.cases.size(), one.cases.size());
  for (std::size_t k = 0; k < one.cases.size(); ++k) {
    names.push_back(one.cases[k].name);
    EXPECT_EQ(one.cases[k].name, three.cases[k].name);
    EXPECT_TRUE(one.cases[k].traced) << one.cases[k].message;
    EXPECT_EQ(one.cases[k].table.force, three.cases[k].table.force) << names.back();
  }
  for (std::vector<std::string>* list : {&names, &names_one, &names_three}) std::sort(list->begin(), list->end());
  EXPECT_EQ(names_one, names);
  EXPECT_EQ(names_three, names);

  int asked = 0;
  const ArmCheck stopped = checkArm(s, shape, field, [&asked](const std::string&) { return ++asked > 5; });
  EXPECT_FALSE(stopped.complete);
  EXPECT_FALSE(stopped.bistable);
}

}  // namespace
}  // namespace snapwing::design
