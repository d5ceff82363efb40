// `snapwing design wing CONFIG -o DIR`: the wing's linkage from a settings file to layout, table and parts.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>

#include "commands.h"
#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/common/vehicle.h"
#include "snapwing/design/wing_blade.h"
#include "snapwing/design/wing_elastic_problem.h"
#include "snapwing/design/wing_layout.h"
#include "snapwing/design/wing_parts.h"
#include "snapwing/design/wing_table.h"

namespace snapwing::tools {

namespace {

using namespace design;  // NOLINT: a command is all about one floor

struct Options {
  std::string settings;
  std::string folder = ".";
  std::string rung = "rigid";
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

/// The arms' energy barrier on the way back, of the whole vehicle [J]; NaN where there is no table.
double barrierOf(const common::Vehicle& vehicle) {
  if (!std::filesystem::exists(vehicle.arm.table_file)) return std::numeric_limits<double>::quiet_NaN();
  return common::curveFeatures(common::loadForceTable(vehicle.arm.table_file)).barrier_back;
}

/// Elastic bars over the table's travel: fills the stored energy and says how far the rigid bars are off.
void compare(const WingSettings& s, const WingDesign& d, const common::Vehicle& vehicle, const std::string& rung,
             WingTable* table) {
  const bool solid = rung == "solid";
  const auto linkage = (solid ? solidRung(s.bars) : beamRung(s.bars))(d.linkage);
  const RungComparison c = compareRungs(*linkage, table->arm_rotation);
  if (!c.converged) {
    std::cout << "  elastic rung: " << c.message << "; no stored energy in the table\n";
    table->provenance["stored_energy"] = "none: " + c.message;
    return;
  }
  table->stored_energy = c.stored_energy;
  table->provenance["stored_energy"] =
      std::string("elastic ") + (solid ? "solids" : "beams") + " with friction at the pins";
  std::cout << "  elastic rung (" << (solid ? "solids" : "beams") << "): tip within " << 1e3 * c.largest_tip_error
            << " mm and wing within " << c.largest_rotation_error << " rad of the rigid rung, branch "
            << (c.same_branch ? "kept" : "CHANGED") << ", " << (c.stable ? "stable" : "NOT STABLE")
            << ", largest stress " << 1e-6 * c.largest_stress << " MPa, " << 1e3 * c.seconds_per_state
            << " ms a state\n";
  const double barrier = barrierOf(vehicle);
  std::cout << "  stored energy of two wings at most " << 2e3 * c.largest_energy
            << " mJ; the arms' barrier on the way back is " << 1e3 * barrier << " mJ: ratio "
            << 2 * c.largest_energy / barrier << "\n";
}

/// Work of friction in both wings on one way over the travel. [J]
double frictionWork(const WingBlade& blade, const WingSettings& s, const WingTable& table) {
  double work = 0;
  for (std::size_t i = 1; i < table.travel.size(); ++i) {
    const double u = 0.5 * (table.travel[i - 1] + table.travel[i]), step = table.travel[i] - table.travel[i - 1];
    for (const WingSide side : {WingSide::LEFT, WingSide::RIGHT}) {
      work += step * blade.frictionForce(s.motion->rotation(u), s.motion->slope(u), side).value_or(0);
    }
  }
  return work;
}

void writeResults(const Options& options, const WingSettings& s, const WingDesign& d) {
  const std::filesystem::path folder(options.folder);
  std::filesystem::create_directories(folder);
  const common::Vehicle vehicle = common::loadVehicle(s.vehicle_file);
  const WingLayout layout = layoutOf(s, d, vehicle, options.rung);
  const double largest = s.motion->travelAt(s.targets[1].arm_rotation);
  auto table = tabulate(d.linkage, *s.motion, largest, options.points);
  if (!table) throw common::Error("wing table: the loop opens within the travel although the design was accepted");
  table->provenance["command"] = "snapwing design wing --rung " + options.rung;
  table->provenance["snapwing_version"] = common::version();
  table->provenance["settings_sha256"] = common::sha256OfFile(s.file);
  compare(s, d, vehicle, options.rung, &*table);
  const WingBlade blade(layout);
  const MassProperties mass = blade.massAt(*blade.poseAt(0, WingSide::LEFT));
  std::cout << "  one wing weighs " << 1e3 * mass.mass << " g; friction of both takes "
            << 1e3 * frictionWork(blade, s, *table) << " mJ on one way\n";
  saveWing(layout, s, d, (folder / "wing.yaml").string());
  saveWingTable(*table, (folder / "wing_table.h5").string());
  saveParts(layout, (folder / "parts").string());
  std::cout << "  wrote wing.yaml, wing_table.h5 and parts to " << options.folder << "\n";
}

WingDesign designOn(const WingSettings& settings, const std::string& rung) {
  if (rung == "rigid") return designWing(RigidWingProblem(settings));
  return designWing(ElasticWingProblem(settings, rung == "solid" ? solidRung(settings.bars) : beamRung(settings.bars)));
}

void run(const Options& options, int* exit_code) {
  const WingSettings settings = loadWingSettings(options.settings);
  const WingDesign design = designOn(settings, options.rung);
  report(settings, design);
  if (design.status != WingStatus::DESIGNED) {
    *exit_code = 1;
    return;
  }
  writeResults(options, settings, design);
}

}  // namespace

void addDesignWingCommand(CLI::App& app, int& exit_code) {
  CLI::App* command = designCommand(app)->add_subcommand("wing", "Joint positions of the folding wing's linkage");
  auto options = std::make_shared<Options>();
  command->add_option("settings", options->settings, "Settings, e.g. config/designs/wing_paper.yaml")->required();
  command->add_option("-o,--output", options->folder, "Folder for wing.yaml, wing_table.h5 and parts")
      ->capture_default_str();
  command
      ->add_option("--rung", options->rung,
                   "Bars that the design is made on: rigid, elastic (beams) or solid; elastic ones check it anyway")
      ->check(CLI::IsMember({"rigid", "elastic", "solid"}))
      ->capture_default_str();
  command->add_option("--points", options->points, "Points of the table over the travel")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  int* code = &exit_code;
  command->callback([options, code] { run(*options, code); });
}

}  // namespace snapwing::tools
