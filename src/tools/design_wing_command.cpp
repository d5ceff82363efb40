// `snapwing design wing CONFIG -o DIR`: the wing's linkage from a settings file to layout, table and parts.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.h"
#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/common/vehicle.h"
#include "snapwing/design/wing_layout.h"
#include "snapwing/design/wing_table.h"

namespace snapwing::tools {

namespace {

using namespace design;  // NOLINT: a command is all about one floor

struct Options {
  std::string settings;
  std::string folder = ".";
  int points = 161;
};

void report(const WingSettings& s, const WingDesign& d) {
  std::cout << "wing '" << s.name << "': " << nameOf(d.status) << "\n  " << d.message << "\n";
  std::cout << "  " << d.samples << " layouts sampled, " << d.runs << " local runs, " << d.evaluations
            << " evaluations, " << d.seconds << " s\n";
  if (d.status != WingStatus::DESIGNED) return;
  std::cout << "  X1 = (" << 1e3 * d.linkage.joint1.x() << ", " << 1e3 * d.linkage.joint1.y() << ") mm, X2 = ("
            << 1e3 * d.linkage.joint2.x() << ", " << 1e3 * d.linkage.joint2.y() << ") mm\n";
  for (const WingState& state : d.states) {
    std::cout << "  arm " << state.arm_rotation << " rad: wing " << state.pose.wing_rotation << " rad (error "
              << state.rotation_error << "), tip residual " << 1e3 * state.tip_residual << " mm\n";
  }
  std::cout << "  joints " << 1e3 * d.separation << " mm apart (s1 " << 1e3 * s.separation << "), X2.x "
            << 1e3 * d.joint2_x << " mm (s2 " << 1e3 * s.wall_joint2_x << "), X1.y " << 1e3 * d.joint1_y << " mm (s3 "
            << 1e3 * s.wall_joint1_y << ")\n";
}

void writeResults(const Options& options, const WingSettings& s, const WingDesign& d) {
  const std::filesystem::path folder(options.folder);
  std::filesystem::create_directories(folder);
  const WingLayout layout = layoutOf(s, d, common::loadVehicle(s.vehicle_file), "rigid");
  saveWing(layout, s, d, (folder / "wing.yaml").string());
  const double largest = s.motion->travelAt(s.targets[1].arm_rotation);
  auto table = tabulate(d.linkage, *s.motion, largest, options.points);
  if (!table) throw common::Error("wing table: the loop opens within the travel although the design was accepted");
  table->provenance["command"] = "snapwing design wing";
  table->provenance["snapwing_version"] = common::version();
  table->provenance["settings_sha256"] = common::sha256OfFile(s.file);
  saveWingTable(*table, (folder / "wing_table.h5").string());
  std::cout << "  wrote wing.yaml and wing_table.h5 to " << options.folder << "\n";
}

void run(const Options& options, int* exit_code) {
  const WingSettings settings = loadWingSettings(options.settings);
  const WingDesign design = designWing(RigidWingProblem(settings));
  report(settings, design);
  if (design.status != WingStatus::DESIGNED) {
    *exit_code = 1;
    return;
  }
  writeResults(options, settings, design);
}

/// The parent `design`, which other design commands may have added before.
CLI::App* parent(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    if (command->get_name() == "design") return command;
  }
  CLI::App* design = app.add_subcommand("design", "Design a part of the vehicle");
  design->require_subcommand(1);
  return design;
}

}  // namespace

void addDesignWingCommand(CLI::App& app, int& exit_code) {
  CLI::App* command = parent(app)->add_subcommand("wing", "Joint positions of the folding wing's linkage");
  auto options = std::make_shared<Options>();
  command->add_option("settings", options->settings, "Settings, e.g. config/designs/wing_paper.yaml")->required();
  command->add_option("-o,--output", options->folder, "Folder for wing.yaml and wing_table.h5")->capture_default_str();
  command->add_option("--points", options->points, "Points of the table over the travel")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  int* code = &exit_code;
  command->callback([options, code] { run(*options, code); });
}

}  // namespace snapwing::tools
