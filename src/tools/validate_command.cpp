// `snapwing validate`: plans and arm of a vehicle on every rung, and a gate that can say no.
#include <cmath>
#include <cstdio>
#include <memory>

#include "commands.h"
#include "curve_options.h"
#include "numbers.h"
#include "snapwing/common/error.h"
#include "snapwing/common/output_file.h"
#include "snapwing/common/provenance.h"
#include "snapwing/validation/report.h"
#include "snapwing/vehicle/table_origin.h"

namespace snapwing::tools {

namespace {

constexpr int UNDECIDED = 3;  // exit code: nothing failed, but an error bar reaches across a limit

struct Options {
  std::string vehicle_file, folder;
  std::vector<std::string> plans;
  validation::ValidationSettings settings;
  bool no_volumetric = false, one_size = false, quiet = false;
};

void printChecks(const std::vector<validation::Check>& checks) {
  for (const validation::Check& c : checks) {
    if (c.verdict == validation::Verdict::TOLD) continue;
    std::printf("%-4s  %s", validation::verdictName(c.verdict).c_str(), c.name.c_str());
    if (std::isfinite(c.value)) std::printf(": %.4g", c.value);
    if (c.error > 0) std::printf(" +- %.2g", c.error);
    if (std::isfinite(c.value)) std::printf(" %s", c.unit.c_str());
    const bool bounded = !std::isnan(c.low) || !std::isnan(c.high);
    if (c.verdict != validation::Verdict::PASS && bounded) {
      std::printf(" (allowed %s)", validation::allowedWords(c).c_str());
    }
    if (!c.words.empty()) std::printf(": %s", c.words.c_str());
    std::printf("\n");
  }
}

/// Tables of the vehicle, or why they are not its own: the first thing that a gate can refuse.
struct Tables {
  std::optional<vehicle::ForceTable> arm;
  std::optional<vehicle::WingTable> wing;
  std::string refusal;
};

Tables tablesOf(const vehicle::Vehicle& vehicle) {
  Tables tables;
  try {
    tables.arm = vehicle::armTableOf(vehicle);
    tables.wing = vehicle::wingTableOf(vehicle, *tables.arm);
  } catch (const common::FileError& e) {
    tables.refusal = e.what();
  }
  return tables;
}

validation::Validation run(const Options& options, const vehicle::Vehicle& vehicle, const Tables& tables) {
  std::vector<validation::PlanFile> plans;
  for (const std::string& path : options.plans) plans.push_back(validation::loadPlan(path));
  validation::ValidationSettings settings = options.settings;
  settings.volumetric = !options.no_volumetric;
  settings.extrapolate = !options.one_size;
  const InterruptGuard guard;
  validation::ValidationHooks hooks;
  hooks.folder = options.folder + "/trials";
  hooks.cancelled = InterruptGuard::interrupted;
  if (!options.quiet) {
    hooks.progress = [](int done, int all, const std::string& what) {
      std::fprintf(stderr, all == 0 ? "%s\n" : "%s (%d of %d)\n", what.c_str(), done, all);
    };
  }
  validation::Validation found = validation::validate(vehicle, *tables.arm, tables.wing, plans, settings, hooks);
  found.checks.insert(found.checks.begin(), validation::yesOrNo("tables of this vehicle's arm", true,
                                                                "provenance, units, force against energy, travel"));
  return found;
}

void requireOutputs(const Options& options, const vehicle::Vehicle& vehicle) {
  common::OutputFiles files;
  files.reads({vehicle.file, vehicle.arm.density_file, vehicle.arm.table_file, vehicle.wing.layout_file,
               vehicle.wing.table_file},
              "a file of the vehicle");
  if (!options.settings.body.empty()) files.reads(options.settings.body, "the body");
  files.reads(options.plans, "a plan");
  files.fills(options.folder, "--output");
  for (const char* name : {"report.html", "validation.json"}) files.writes(options.folder + "/" + name, "--output");
}

int validateVehicle(const Options& options) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(options.vehicle_file);
  requireOutputs(options, vehicle);
  common::makeFolder(options.folder);
  const Tables tables = tablesOf(vehicle);
  validation::Validation found;
  if (tables.refusal.empty()) {
    found = run(options, vehicle, tables);
  } else {
    found.checks.push_back(validation::yesOrNo("tables of this vehicle's arm", false, tables.refusal));
  }
  if (found.cancelled) {
    std::fprintf(stderr, "stopped; the same command goes on with the trials that are done\n");
    return 1;
  }
  const std::string& body = options.settings.body;
  const validation::ReportHead head{vehicle.name,
                                    vehicle.file,
                                    vehicle.arm.table_file,
                                    body.empty() ? vehicle.arm.density_file : body,
                                    "snapwing validate " + options.vehicle_file,
                                    common::version()};
  const std::string page = options.folder + "/report.html";
  common::writeFileAtomically(page,
                              validation::reportHtml(found, tables.arm ? *tables.arm : vehicle::ForceTable{}, head));
  common::writeFileAtomically(options.folder + "/validation.json", validation::reportJson(found, head));
  printChecks(found.checks);
  const char* verdict = found.passed() ? "passed" : found.undecided() ? "NOT decided" : "NOT passed";
  std::printf("%s: %s; %s\n", vehicle.name.c_str(), verdict, page.c_str());
  if (found.undecided()) {
    const validation::ValidationSettings& s = options.settings;
    std::printf("to decide: the same with smaller cells, --cell-size %g (planar)", s.planar_cell / 2);
    if (!options.no_volumetric) std::printf(", --solid-cell-size %g (volumetric)", s.solid_cell / 2);
    std::printf("\n");
  }
  return found.passed() ? 0 : found.undecided() ? UNDECIDED : 1;
}

}  // namespace

void addValidateCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  validation::ValidationSettings& s = options->settings;
  CLI::App* command = app.add_subcommand(
      "validate", "test a vehicle's arm and plans on every rung: static curve, pulses on soft arms in time, accidents");
  command->add_option("vehicle", options->vehicle_file, "vehicle file [YAML]")->required();
  command->add_option("-o,--output", options->folder, "folder for report.html, validation.json and trials")->required();
  command->add_option("--plan", options->plans,
                      "plan [JSON] of `snapwing plan --json`, may be given again; default: one each way is planned");
  command->add_option("--body", s.body,
                      "density file [CSV] of the arm as it was made, for the solids; default: the vehicle's");
  command->add_option("--weakest", s.weakest, "vehicles of each plan that the planner finds weakest")
      ->check(wholeNumber(0, 500))
      ->capture_default_str();
  command->add_option("--samples", s.samples, "vehicles drawn from the uncertainty box for each plan")
      ->check(wholeNumber(0, 10000))
      ->capture_default_str();
  command
      ->add_option("--cell-size", s.planar_cell,
                   "of the planar rung [m]; its curve and shortest pulse are judged on half of that, too")
      ->check(realNumber(1e-4, 0.02, "m"))
      ->capture_default_str();
  command->add_flag("--one-cell-size", options->one_size,
                    "judge the planar rung on --cell-size alone, without an error bar: a quick look");
  command->add_option("--solid-cell-size", s.solid_cell, "of the volumetric rung [m]")
      ->check(realNumber(1e-4, 0.02, "m"))
      ->capture_default_str();
  command->add_flag("--no-volumetric", options->no_volumetric, "leave the solids out");
  command->add_option("--step", s.step, "of time on the soft rungs [s]")
      ->check(realNumber(1e-5, 0.02, "s"))
      ->capture_default_str();
  command->add_option("--threads", s.threads, "trials side by side; the result is the same for any number")
      ->check(wholeNumber(1, 256))
      ->capture_default_str();
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  command->footer(
      "Exit code: 0 passed, 1 a check failed (named) or stopped, 2 bad input, 3 none failed, but one is undecided. The "
      "same command goes on with a run that was stopped.");
  command->callback([options, &exit_code] { exit_code = validateVehicle(*options); });
}

}  // namespace snapwing::tools
