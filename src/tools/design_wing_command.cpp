// `snapwing design wing CONFIG -o DIR`: the wing's linkage from a settings file to layout, table and parts.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>

#include "commands.h"
#include "numbers.h"
#include "snapwing/common/output_file.h"
#include "snapwing/design/wing/wing_outcome.h"

namespace snapwing::tools {

namespace {

using namespace design;  // NOLINT: a command is all about one layer

struct Options {
  std::string settings;
  std::string folder = ".";
  std::string rung;
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

void reportElastic(const WingOutcome& o, WingRung rung) {
  const RungComparison& c = o.comparison;
  if (!c.converged) {
    std::cout << "  elastic rung: " << c.message << "; no stored energy in the table\n";
    return;
  }
  std::cout << "  elastic rung (" << (rung == WingRung::SOLIDS ? "solids" : "beams") << "): tip within "
            << 1e3 * c.largest_tip_error << " mm and wing within " << c.largest_rotation_error
            << " rad of the rigid rung, branch " << (c.same_branch ? "kept" : "CHANGED") << ", "
            << (c.stable ? "stable" : "NOT STABLE") << ", largest stress " << 1e-6 * c.largest_stress << " MPa, "
            << 1e3 * c.seconds_per_state << " ms a state\n";
  std::cout << "  stored energy of two wings at most " << 2e3 * c.largest_energy
            << " mJ; the arms' barrier on the way back is " << 1e3 * o.barrier_back << " mJ: ratio "
            << 2 * c.largest_energy / o.barrier_back << "\n";
}

void reportMass(const WingOutcome& o) {
  const std::vector<double>& mass = o.table.kinetic_mass;
  std::cout << "  one wing weighs " << 1e3 * o.mass << " g; friction of both takes " << 1e3 * o.friction_work
            << " mJ on one way; both add " << mass.front() << " kg at rest, at most "
            << *std::max_element(mass.begin(), mass.end()) << " kg and " << mass.back()
            << " kg at the end to the inertia against u\n";
}

void reportClearance(const WingClearance& c) {
  std::cout << "  propellers: bars and leading edge at least " << 1e3 * c.bars << " mm away (arm at " << c.bars_at
            << " rad), blade at least " << 1e3 * c.blade << " mm (arm at " << c.blade_at << " rad)\n";
}

std::string name(const StackPlan& plan, int piece) { return plan.pieces[static_cast<std::size_t>(piece)].name; }

void reportLayers(const StackPlan& plan) {
  std::cout << "  overlapping pairs during the motion:";
  for (const Meeting& m : plan.over) {
    std::cout << (&m == &plan.over.front() ? " " : ", ") << name(plan, m.first) << " and " << name(plan, m.second);
  }
  std::cout << "\n";
  if (!plan.found) {
    std::cout << "  layers: NONE, the wing cannot be put together as drawn: " << plan.message << "\n";
    return;
  }
  std::cout << "  layers, from the ring outward:";
  for (int layer = 1; layer <= plan.layers; ++layer) {
    for (const PlacedPiece& piece : plan.pieces) {
      if (piece.layer != layer) continue;
      std::cout << (layer > 1 ? ", " : " ") << layer << " " << piece.name << " (z " << 1e3 * piece.z << " mm)";
    }
  }
  std::cout << "\n";
}

/// Exit code: 0 if the wing does what was asked for and can be built.
int reportVerdict(const WingOutcome& o) {
  std::cout << "  targets (wing rotations within " << WING_ROTATION_TOLERANCE << " rad, tips within "
            << 1e3 * WING_TIP_TOLERANCE << " mm): " << (o.targets_met ? "met" : "NOT MET") << "\n";
  return o.targets_met && o.stack.found ? 0 : 1;
}

void run(const Options& options, int* exit_code) {
  const WingSettings settings = loadWingSettings(options.settings);
  common::OutputFiles files;
  files.reads(options.settings, "the settings");
  files.reads(settings.named_files, "a file that the settings name");
  files.fills(options.folder, "--output");
  for (const char* name : {"wing.yaml", "wing_table.h5"}) files.writes(options.folder + "/" + name, "--output");
  WingJob job;
  job.folder = options.folder;
  job.rung = wingRungOf(options.rung.empty() ? settings.rung : options.rung);
  job.points = options.points;
  const WingOutcome outcome = designWingInto(settings, job);
  report(settings, outcome.design);
  if (outcome.design.status != WingStatus::DESIGNED) {
    *exit_code = 1;
    return;
  }
  reportElastic(outcome, job.rung);
  reportMass(outcome);
  reportClearance(outcome.clearance);
  reportLayers(outcome.stack);
  *exit_code = reportVerdict(outcome);
  std::cout << "  wrote wing.yaml, wing_table.h5 and parts to " << options.folder << "\n";
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
                   "Bars that the design is made on: rigid, elastic (beams) or solid, instead of the settings' own; "
                   "elastic ones check it anyway")
      ->check(CLI::IsMember({"rigid", "elastic", "solid"}));
  command->add_option("--points", options->points, "Points of the table over the travel")
      ->check(wholeNumber(2, 100000))
      ->capture_default_str();
  int* code = &exit_code;
  command->callback([options, code] { run(*options, code); });
}

}  // namespace snapwing::tools
