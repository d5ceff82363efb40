// `snapwing design arm CONFIG -o DIR`: optimises a bistable arm, checks it on new geometry and writes its parts.
#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "commands.h"
#include "design_into_command.h"
#include "numbers.h"
#include "snapwing/common/error.h"
#include "snapwing/common/folder_lock.h"
#include "snapwing/common/output_file.h"
#include "snapwing/design/arm/arm_outcome.h"

namespace snapwing::tools {

namespace {

using namespace design;  // NOLINT: a command is all about one layer

struct Options {
  std::string settings, folder = "arm_design", density, vehicle, into, wing;
  bool check_gradients = false, resume = false, quiet = false;
  double gradient_tolerance = 1e-4;
  int threads = 0;
  ValidationOptions validation;
};

volatile std::sig_atomic_t interrupted = 0;
void onInterrupt(int) { interrupted = 1; }

int checkGradients(const ArmDesignSettings& settings, double tolerance) {
  bool good = true;
  for (const double share : {0.0, 0.65}) {
    const GradientCheck check = checkArmGradients(settings, share);
    std::printf("gradients at share %.2f of the run (relative error against central differences)\n", share);
    if (!check.valid) {
      std::printf("  not checked: %s\n", check.message.c_str());
      return 1;
    }
    for (const GradientRow& row : check.rows) {
      std::printf("  %-48s %+.6e ", row.quantity.c_str(), row.derivative);
      for (std::size_t k = 0; k < check.steps.size(); ++k) {
        std::printf(" %.0e: %.1e", check.steps[k], row.relative_errors[k]);
      }
      std::printf("\n");
    }
    std::printf("  worst of the best: %.1e (allowed %.1e)\n", check.worst(), tolerance);
    good = good && check.worst() <= tolerance;
  }
  return good ? 0 : 1;
}

void showProgress(const ArmProgress& p) {
  std::printf(
      "%4d  f %+8.4f  violation %7.4f  volume %.3f (%.3f)  grey %.3f  change %.3f  %6.1f s  R:", p.report.iteration,
      p.report.objective, p.report.violation, p.volume, p.volume_bound, p.grey, p.report.change, p.report.seconds);
  for (const double force : p.forces) std::printf(" %+.3f", force);
  std::printf("\n");
  std::fflush(stdout);
}

void printCheck(const ArmCheck& check) {
  std::printf("post-check (forces are totals)\n");
  for (const ArmCheckCase& c : check.cases) {
    if (!c.traced) {
      std::printf("  %-18s not traced: %s\n", c.name.c_str(), c.message.c_str());
      continue;
    }
    char turned[40] = "";
    if (c.turns) std::snprintf(turned, sizeof turned, "rotation %.3f rad, ", c.rotation_second);
    std::printf("  %-18s peak %.3f N @ %.1f mm, valley %+.3f N @ %.1f mm, second %.1f mm, %s", c.name.c_str(),
                c.features.peak_force, 1e3 * c.features.peak_travel, c.features.valley_force,
                1e3 * c.features.valley_travel, 1e3 * c.features.second_travel, turned);
    std::printf("hysteresis %.2f %%, unstable %d, bistable %s\n", 100 * c.hysteresis_share, c.unstable_points,
                c.bistable ? "yes" : "no");
  }
  for (const ArmTarget& t : check.targets) {
    std::printf("  %-30s wanted %-18s %s %.4g .. %.4g  %s\n", t.name.c_str(), t.wanted.c_str(),
                t.converged ? "converges to" : "found", t.low, t.high, nameOf(t.verdict));
  }
  std::printf("bistable: %s\n", check.bistable ? "yes" : "no");
}

void printRun(const ArmRun& run) {
  std::printf("optimiser: %s %s, objective %.4f, violation %.4f, %d evaluations, %.1f s (%.1f s of all cores)\n",
              nameOf(run.result.status).c_str(), run.result.message.c_str(), run.result.objective, run.result.violation,
              run.evaluations, run.seconds, run.cpu_seconds);
  if (run.result.status == OptimizerStatus::CANCELLED) std::printf("cancelled; resume with --resume\n");
}

void printParts(const ArmPartsReport& parts) {
  std::printf("arm: %.2f cm3, %.1f g, %.1f x %.1f x %.1f mm, %d triangles, watertight %s\n", 1e6 * parts.volume,
              1e3 * parts.mass, 1e3 * parts.extent[0], 1e3 * parts.extent[1], 1e3 * parts.extent[2], parts.triangles,
              parts.watertight ? "yes" : "no");
}

/// What makes the vehicle fly this arm.
void printNext(const ArmDesignSettings& settings, const ArmOutcome& outcome) {
  const std::string vehicle = settings.vehicle.file;
  const std::filesystem::path folder = std::filesystem::absolute(vehicle).parent_path();
  const auto named = [&](const std::string& file) {
    return std::filesystem::absolute(file).lexically_relative(folder).string();
  };
  std::printf("to fly it, name in %s under arm\n  density_file: %s\n  table_file: %s\n", vehicle.c_str(),
              named(outcome.bodyFile()).c_str(), named(outcome.tableFile()).c_str());
}

ArmJob jobOf(const Options& options) {
  ArmJob job;
  job.folder = options.folder;
  job.resume = options.resume;
  job.progress = [&options](const ArmProgress& p) {
    if (!options.quiet) showProgress(p);
    return interrupted != 0;
  };
  job.checking = [&options](const std::string& name) {
    if (!options.quiet && !name.empty()) std::fprintf(stderr, "checking %s\n", name.c_str());
    return interrupted != 0;
  };
  job.warning = [](const std::string& text) {
    std::fprintf(stderr, "snapwing design arm: warning: %s\n", text.c_str());
  };
  job.optimized = printRun;
  job.checked = printCheck;
  job.printed = printParts;
  return job;
}

void checkFiles(const Options& options, const ArmDesignSettings& settings) {
  common::OutputFiles files;
  files.reads(options.settings, "the settings");
  files.reads(options.density, "the density that is to be checked");
  files.reads(settings.named_files, "a file that the settings name");
  files.fills(options.folder, "--output");
  for (const std::string& name : armOutcomeFiles()) files.writes(options.folder + "/" + name, "--output");
}

int runInto(const Options& options) {
  pipeline::DesignPipelineSettings settings;
  settings.vehicle_file = options.vehicle;
  settings.arm_settings = options.settings.empty() ? pipeline::armSettingsBeside(options.vehicle) : options.settings;
  settings.density = options.density;
  settings.wing_settings = options.wing;
  settings.folder = options.into;
  settings.threads = options.threads;
  settings.validation = options.validation.settings();
  return designInto(settings, options.validation, options.quiet);
}

int runCommand(const Options& options) {
  if (!options.into.empty()) return runInto(options);
  if (options.settings.empty()) throw common::Error("settings: not given; allowed: a settings file");
  ArmDesignSettings settings = loadArmDesignSettings(options.settings, options.vehicle);
  if (options.check_gradients) return checkGradients(settings, options.gradient_tolerance);
  interrupted = 0;
  const auto previous = std::signal(SIGINT, onInterrupt);
  if (options.threads > 0) settings.threads = options.threads;
  checkFiles(options, settings);
  common::makeFolder(options.folder);
  const common::FolderLock lock(options.folder);
  const ArmJob job = jobOf(options);
  const ArmOutcome outcome = options.density.empty()
                                 ? designArm(settings, job)
                                 : checkArmDensity(settings, loadDesignedDensity(settings, options.density), job);
  std::signal(SIGINT, previous);
  if (outcome.bistable && !settings.user_scene) printNext(settings, outcome);
  if (!outcome.bistable || !outcome.all_met) return 1;
  return outcome.status == OptimizerStatus::CANCELLED ? 1 : 0;
}

}  // namespace

void addDesignArmCommand(CLI::App& app, int& exit_code) {
  CLI::App* command =
      designCommand(app)->add_subcommand("arm", "Topology of the bistable arm, its check and its parts");
  auto options = std::make_shared<Options>();
  command->add_option("settings", options->settings,
                      "Settings, e.g. config/designs/arm_default.yaml; with --into default: arm_design.yaml beside the "
                      "vehicle file");
  CLI::Option* vehicle =
      command->add_option("--vehicle", options->vehicle, "Vehicle file in place of the one that the settings name");
  command->add_option("-o,--output", options->folder, "Folder for density, history, report, parts")
      ->capture_default_str();
  command->add_option("--density", options->density, "Do not optimise: check this density [CSV] and write its parts");
  command->add_flag("--check-gradients", options->check_gradients, "Only compare derivatives with differences");
  command->add_option("--gradient-tolerance", options->gradient_tolerance, "Largest relative error allowed")
      ->check(realNumber(1e-12, 1, "1"))
      ->capture_default_str();
  command->add_flag("--resume", options->resume, "Go on from the checkpoint in the output folder");
  command->add_option("--threads", options->threads, "At most; instead of the settings' own. Changes no bit")
      ->check(wholeNumber(1, 256));
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  CLI::App* way =
      command->add_option_group("to a vehicle that flies", "Tables, wing, plans, validation of the new arm");
  CLI::Option* into = way->add_option("--into", options->into,
                                      "Folder for all of it and a vehicle file that names it, instead of --output; the "
                                      "same command goes on with a run that was ended");
  into->needs(vehicle);
  for (const char* other : {"--output", "--check-gradients", "--resume"}) into->excludes(command->get_option(other));
  way->add_option("--wing", options->wing, "Settings of a new wing; default: the vehicle's own gets a new table")
      ->needs(into);
  options->validation.addGateTo(*way);
  command->footer(
      "Exit code: 0 good, 1 not (named) or stopped, 2 bad input; with --into those of `snapwing validate`: 0 passed, 1 "
      "failed, 3 undecided.");
  command->callback([options, &exit_code] { exit_code = runCommand(*options); });
}

}  // namespace snapwing::tools
