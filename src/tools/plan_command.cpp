// `snapwing plan`: the pulse that switches the mode for every vehicle in the uncertainty box, or why there is none.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <sstream>

#include "commands.h"
#include "numbers.h"
#include "prediction_text.h"
#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/planning/accident_margins.h"
#include "snapwing/planning/pulse_planner.h"
#include "snapwing/validation/plan_file.h"
#include "snapwing/validation/prediction_json.h"
#include "snapwing/vehicle/force_curve_file.h"
#include "snapwing/vehicle/table_origin.h"
#include "trial_options.h"

namespace snapwing::tools {

namespace {

struct PlanOptions {
  std::string vehicle_file, table_file, json_file, map_file, start;
  int map_size = 41;
  bool accidents = false, quiet = false;
  planning::PlannerSettings settings;
  TrialOptions trial;
};

std::string mapCsv(const planning::OutcomeMap& map) {
  std::ostringstream text;
  text << "throttle,duration_s,share_switched,worst_margin\n";
  text.precision(6);
  for (const planning::OutcomeCell& cell : map.cells) {
    text << cell.throttle << ',' << cell.duration << ',' << cell.share << ',' << cell.worst_margin << '\n';
  }
  return text.str();
}

void printPlan(const planning::TransitionPlan& plan) {
  if (!plan.accepted) {
    std::printf("refused: %s\n", plan.reason.c_str());
    if (plan.realisations == 0) return;
  } else {
    std::printf("plan %s -> %s: throttle %.3f (%.1f %% of full thrust) %s\n",
                vehicle::modeName(plan.start_mode).c_str(), vehicle::modeName(plan.target_mode).c_str(),
                plan.pulse.throttle, 100.0 * plan.thrust_fraction, validation::pulseTimes(plan.pulse).c_str());
  }
  std::printf("worst margin %+.3f, %.1f %% of %d vehicles switch; %d pulses, %ld trials in %.2f s\n", plan.worst_margin,
              100.0 * plan.share_switched, plan.realisations, plan.evaluations, plan.predictions, plan.compute_seconds);
  std::printf("nominal: %s\nworst:   %s\n", predictionLine(plan.nominal).c_str(), predictionLine(plan.worst).c_str());
  std::printf("with every uncertain number at its bad end at once the margin is %+.3f\n", plan.vertex_margin);
}

void printAccidents(const std::vector<planning::AccidentMargin>& margins, bool wings) {
  std::printf("what may change the mode by accident (nominal vehicle in flight, wings %s):\n", wings ? "on" : "off");
  for (const auto& m : margins) {
    if (std::isinf(m.limit)) {
      std::printf("  %-34s no limit found    ", m.name.c_str());
    } else {
      std::printf("  %-34s limit %8.2f %-4s", m.name.c_str(), m.limit, m.unit.c_str());
    }
    if (!std::isnan(m.occurs)) std::printf(" met %6.2f %-4s %s", m.occurs, m.unit.c_str(), m.holds ? "holds" : "FLIPS");
    std::printf("\n");
  }
}

/// The map takes minutes where the plan takes seconds: it says how far it is.
void writeMap(const PlanOptions& options, const planning::PulsePlanner& planner, vehicle::Mode start,
              const vehicle::Trial& trial) {
  const bool shown = !options.quiet;
  const auto progress = [shown](int done, int all) {
    if (!shown || (100 * done / all == 100 * (done - 1) / all && done > 1)) return;
    std::fprintf(stderr, "\routcome map: %d of %d pulses%s", done, all, done == all ? "\n" : " ");
    std::fflush(stderr);
  };
  const planning::OutcomeMap map = planner.map(start, trial, options.map_size, options.map_size, progress);
  common::writeFileAtomically(options.map_file, mapCsv(map));
}

int plan(const PlanOptions& options) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(options.vehicle_file);
  const std::string table_file = chooseTable(vehicle, options.table_file);
  checkFiles(vehicle, table_file, {{options.json_file, "--json"}, {options.map_file, "--map"}});
  const vehicle::ForceTable table = vehicle::armCurveOf(vehicle, options.table_file);
  const vehicle::Mode start = vehicle::modeFromName(options.start);
  if (start != vehicle::Mode::FIXED_WING && options.settings.hold_duration > 0) {
    throw common::Error("--hold-duration is given with --from " + options.start +
                        "; allowed: with --from F only, F is reached by a cut");
  }
  const vehicle::Trial trial = options.trial.trial(vehicle);
  const std::optional<vehicle::WingTable> wing = vehicle::wingTableOf(vehicle, table);
  const planning::PulsePlanner planner(vehicle, table, options.settings, wing);

  const auto begin = std::chrono::steady_clock::now();
  planning::TransitionPlan result = planner.plan(start, trial);
  result.compute_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const bool wings = wing && trial.wings.value_or(true);
  std::vector<planning::AccidentMargin> accidents;
  if (options.accidents) accidents = planning::accidentMargins(vehicle, table, wings ? wing : std::nullopt);
  if (!options.map_file.empty()) writeMap(options, planner, start, trial);
  if (!options.json_file.empty()) {
    validation::savePlan(options.json_file, vehicle, table_file, trial, result,
                         options.accidents ? &accidents : nullptr);
  }
  printPlan(result);
  if (options.accidents) printAccidents(accidents, wings);
  return result.accepted ? 0 : 1;
}

}  // namespace

void addPlanCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<PlanOptions>();
  planning::PlannerSettings& s = options->settings;
  CLI::App* command = app.add_subcommand("plan", "Find a pulse that switches the mode over the whole uncertainty");
  command->add_option("vehicle", options->vehicle_file, "vehicle file [YAML]")->required();
  command->add_option("--from", options->start, "mode at the start: F or Q")->required();
  addHoldTo(*command, s.hold_throttle, s.hold_duration);
  options->trial.addTo(*command);
  command->add_option("--table", options->table_file, "force table [HDF5]; default: the vehicle file's");
  command->add_option("--samples", s.verify_samples, "fresh vehicles that check the plan")
      ->check(wholeNumber(1, 1000000))
      ->capture_default_str();
  command->add_option("--search-samples", s.search_samples, "vehicles during the search")
      ->check(wholeNumber(1, 100000))
      ->capture_default_str();
  command->add_option("--required-margin", s.required_margin, "worst margin of an accepted plan [barriers]")
      ->check(realNumber(0, 100, "barriers"))
      ->capture_default_str();
  command->add_option("--enough-margin", s.enough_margin, "margin from which a shorter pulse is better [barriers]")
      ->check(realNumber(0, 100, "barriers"))
      ->capture_default_str();
  command->add_option("--required-share", s.required_share, "share of the vehicles that must switch")
      ->check(realNumber(0, 1, "1", true))
      ->capture_default_str();
  command->add_option("--throttle-max", s.throttle_max, "largest stick travel")
      ->check(realNumber(0, 1, "1", true))
      ->capture_default_str();
  command->add_option("--duration-max", s.duration_max, "longest pulse [s]")
      ->check(realNumber(0, 10, "s", true))
      ->capture_default_str();
  command->add_option("--threads", s.threads, "the result is the same for any number")
      ->check(wholeNumber(1, 256))
      ->capture_default_str();
  command->add_flag("--accidents", options->accidents, "also report what may flip the mode by accident");
  command->add_option("--json", options->json_file, "write the plan here");
  command->add_option("--map", options->map_file, "write the outcome map here [CSV]: share and worst margin");
  command->add_option("--map-size", options->map_size, "pulses along each side of the map")
      ->check(wholeNumber(2, 500))
      ->capture_default_str();
  command->add_flag("-q,--quiet", options->quiet, "No progress of the map");
  command->footer("Exit code: 0 a safe pulse was found, 1 refused with a reason, 2 bad input.");
  command->callback([options, &exit_code] { exit_code = plan(*options); });
}

}  // namespace snapwing::tools
