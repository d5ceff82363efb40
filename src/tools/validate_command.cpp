// `snapwing validate`: plans and arm of a vehicle on every rung, and a gate that can say no.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "commands.h"
#include "curve_options.h"
#include "snapwing/pipeline/validate_vehicle.h"
#include "time_shown.h"
#include "validation_options.h"

namespace snapwing::tools {

namespace {

struct Options {
  std::string vehicle_file, folder;
  std::vector<std::string> plans;
  ValidationOptions validation;
  bool quiet = false;
};

void printChecks(const std::vector<validation::Check>& checks) {
  for (const validation::Check& c : checks) {
    if (c.verdict == validation::Verdict::REPORTED) continue;
    std::printf("%-4s  %s\n", validation::verdictName(c.verdict).c_str(), pipeline::checkLine(c).c_str());
  }
}

int validateVehicle(const Options& options) {
  pipeline::ValidateJob job;
  job.vehicle_file = options.vehicle_file;
  job.folder = options.folder;
  job.plans = options.plans;
  job.settings = options.validation.settings();
  job.command = "snapwing validate " + options.vehicle_file;
  const InterruptGuard guard;
  job.cancelled = InterruptGuard::interrupted;
  job.note = [](const std::string& why) { std::fprintf(stderr, "snapwing validate: %s\n", why.c_str()); };
  TimeShown time;
  if (!options.quiet) {
    job.progress = [&time](int done, int all, const std::string& what) {
      std::fprintf(stderr, all == 0 ? "%s\n" : "%s (%d of %d%s)\n", what.c_str(), done, all,
                   all == 0 ? "" : time.after(static_cast<double>(done) / all).c_str());
    };
  }
  const pipeline::VehicleValidation answer = pipeline::validateVehicle(job);
  const validation::Validation& found = answer.found;
  if (found.cancelled) {
    std::fprintf(stderr, "stopped; the same command resumes after the trials that are done\n");
    return 1;
  }
  printChecks(found.checks);
  const char* verdict = found.passed() ? "passed" : found.undecided() ? "NOT decided" : "NOT passed";
  std::printf("%s: %s; %s\n", answer.vehicle.c_str(), verdict, answer.report_file.c_str());
  if (found.undecided()) options.validation.printRemedy();
  return pipeline::exitCodeOf(validation::verdictOf(found.checks));
}

}  // namespace

void addValidateCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "validate",
      "Check a vehicle's arm and plans at every rung: static curve, pulses on soft arms in time, accidents");
  command->add_option("vehicle", options->vehicle_file, "vehicle file [YAML]")->required();
  command->add_option("-o,--output", options->folder, "folder for report.html, validation.json and trials")->required();
  command->add_option("--plan", options->plans,
                      "plan [JSON] of `snapwing plan --json`, may be given again; default: those that the vehicle "
                      "file names, else one each way is planned");
  options->validation.addTo(*command);
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  command->footer(
      "Exit code: 0 passed, 1 a check failed (named) or stopped, 2 bad input, 3 none failed, but one is undecided. The "
      "same command goes on with a run that was stopped.");
  command->callback([options, &exit_code] { exit_code = validateVehicle(*options); });
}

}  // namespace snapwing::tools
