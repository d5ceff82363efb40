// `snapwing predict`: what one pulse does to the nominal vehicle, by the reduced model.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.h"
#include "numbers.h"
#include "prediction_text.h"
#include "snapwing/common/error.h"
#include "snapwing/common/json_text.h"
#include "snapwing/common/provenance.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/validation/prediction_json.h"
#include "snapwing/vehicle/force_curve_file.h"
#include "snapwing/vehicle/table_origin.h"
#include "trial_options.h"

namespace snapwing::tools {

namespace {

constexpr int LARGEST_COUNT = 10000000;  ///< steps of one prediction

struct PredictOptions {
  std::string vehicle_file, table_file, json_file, csv_file, start;
  vehicle::Pulse pulse;
  double step = rom::LumpedSettings().step;
  TrialOptions trial;
};

/// One row per step; the header names the units.
class TrajectoryCsv {
 public:
  TrajectoryCsv() {
    text_ << "time_s,travel_m,travel_rate_m_per_s,ring_position_m,ring_speed_m_per_s,centre_speed_m_per_s,thrust_N\n";
    text_.precision(9);
  }
  void add(const rom::LumpedState& s) {
    text_ << s.time << ',' << s.travel << ',' << s.travelRate() << ',' << s.position << ',' << s.ring_speed << ','
          << s.centre_speed << ',' << s.thrust << '\n';
  }
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

int predict(const PredictOptions& options) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(options.vehicle_file);
  const std::string table_file = chooseTable(vehicle, options.table_file);
  checkFiles(vehicle, table_file, {{options.csv_file, "--csv"}, {options.json_file, "--json"}});
  const vehicle::ForceTable table = vehicle::armCurveOf(vehicle, options.table_file);
  const vehicle::Mode start = vehicle::modeFromName(options.start);
  const vehicle::Trial trial = options.trial.trial(vehicle);
  rom::LumpedSettings settings;
  settings.step = options.step;
  const double steps = (options.pulse.whole() + trial.horizon) / options.step;
  if (steps > LARGEST_COUNT) {
    throw common::Error("--step makes " + std::to_string(std::llround(steps)) +
                        " steps of the pulse and --horizon; "
                        "allowed: at most " +
                        std::to_string(LARGEST_COUNT));
  }
  const rom::LumpedModel model = rom::LumpedModel::fromVehicle(vehicle, table, vehicle::realise(vehicle, table),
                                                               settings, vehicle::wingTableOf(vehicle, table));

  TrajectoryCsv csv;
  rom::LumpedObserver observer;
  if (!options.csv_file.empty()) {
    observer = [&csv](const rom::LumpedState& state) {
      csv.add(state);
      return true;
    };
  }
  const auto begin = std::chrono::steady_clock::now();
  rom::SnapPrediction prediction = model.predict(start, options.pulse, vehicle.radio, trial, observer);
  prediction.compute_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  if (!options.csv_file.empty()) common::writeFileAtomically(options.csv_file, csv.text());
  if (!options.json_file.empty()) {
    nlohmann::ordered_json json = {{"inputs", validation::inputsJson(vehicle, table_file)},
                                   {"trial", validation::trialJson(trial)},
                                   {"pulse", validation::pulseJson(options.pulse)},
                                   {"prediction", validation::predictionJson(prediction)}};
    common::writeFileAtomically(options.json_file, common::jsonText(json));
  }
  std::printf("%s, %s, wings %s: throttle %.3f (%.1f %% of full thrust) %s\n", vehicle.name.c_str(),
              vehicle::mountName(trial.mount).c_str(), model.wingsAct(trial) ? "on" : "off", options.pulse.throttle,
              100.0 * model.thrustFraction(vehicle.radio, options.pulse.throttle),
              validation::pulseTimes(options.pulse).c_str());
  std::printf("%s\n", predictionLine(prediction).c_str());
  if (!prediction.start_held)
    std::printf("note: mode %s is not an equilibrium under the loads before the pulse\n", options.start.c_str());
  return prediction.end_mode == vehicle::Mode::UNKNOWN ? 1 : 0;
}

}  // namespace

void addPredictCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<PredictOptions>();
  CLI::App* command = app.add_subcommand("predict", "Predict what a thrust pulse does, with the reduced model");
  command->add_option("vehicle", options->vehicle_file, "vehicle file [YAML]")->required();
  command->add_option("--from", options->start, "mode at the start: F or Q")->required();
  command->add_option("--throttle", options->pulse.throttle, "stick travel [0 .. 1]")
      ->required()
      ->check(realNumber(0, 1, "1"));
  command->add_option("--duration", options->pulse.duration, "of the command [s]")
      ->required()
      ->check(realNumber(0, 60, "s"));
  addHoldTo(*command, options->pulse.hold_throttle, options->pulse.hold_duration);
  options->trial.addTo(*command);
  command->add_option("--table", options->table_file, "force table [HDF5]; default: the vehicle file's");
  command->add_option("--step", options->step, "largest time step [s]")
      ->check(realNumber(1e-7, 0.01, "s"))
      ->capture_default_str();
  command->add_option("--json", options->json_file, "write the prediction here");
  command->add_option("--csv", options->csv_file, "write the trajectory here, one row a step");
  command->footer("Exit code: 0 settled in F or Q, 1 not settled within the horizon, 2 bad input.");
  command->callback([options, &exit_code] { exit_code = predict(*options); });
}

}  // namespace snapwing::tools
