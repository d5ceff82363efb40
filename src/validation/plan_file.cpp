#include "snapwing/validation/plan_file.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/json_text.h"
#include "snapwing/common/output_file.h"
#include "snapwing/validation/prediction_json.h"

namespace snapwing::validation {

namespace {

using nlohmann::json;

/// One object of the file, read strictly: what is missing or of another kind is named.
class Object {
 public:
  Object(const json& from, std::string file, std::string prefix)
      : from_(from), file_(std::move(file)), prefix_(std::move(prefix)) {}

  Object at(const std::string& key) const {
    const json& found = child(key, "an object");
    if (!found.is_object()) fail(key, found.dump(), "an object");
    return {found, file_, prefix_ + key + "."};
  }
  std::string text(const std::string& key) const {
    const json& found = child(key, "text");
    if (!found.is_string()) fail(key, found.dump(), "text");
    return found.get<std::string>();
  }
  bool boolean(const std::string& key) const {
    const json& found = child(key, "true or false");
    if (!found.is_boolean()) fail(key, found.dump(), "true or false");
    return found.get<bool>();
  }
  double number(const std::string& key, double low, double high, const std::string& unit) const {
    std::ostringstream range;
    range << low << " .. " << high << " " << unit;
    const json& found = child(key, range.str());
    if (!found.is_number()) fail(key, found.dump(), range.str());
    const double value = found.get<double>();
    if (!(value >= low && value <= high)) fail(key, found.dump(), range.str());
    return value;
  }
  bool has(const std::string& key) const { return from_.contains(key); }

 private:
  const json& child(const std::string& key, const std::string& allowed) const {
    if (!from_.contains(key)) fail(key, "", allowed);
    return from_.at(key);
  }
  [[noreturn]] void fail(const std::string& key, const std::string& value, const std::string& allowed) const {
    throw common::SettingError(file_, prefix_ + key, value, allowed);
  }
  const json& from_;
  std::string file_, prefix_;
};

vehicle::Trial readTrial(const Object& from) {
  vehicle::Trial trial;
  trial.mount = vehicle::mountFromName(from.text("mount"));
  trial.wings = vehicle::wingsFromName(from.text("wings"));
  trial.gravity = from.number("gravity", -100, 100, "m/s2");
  trial.initial_speed = from.number("initial_speed", -200, 200, "m/s");
  trial.horizon = from.number("horizon", 0.01, 60, "s");
  if (from.has("push")) trial.push = from.number("push", -1000, 1000, "N");
  if (from.has("initial_thrust_fraction")) {
    trial.initial_thrust_fraction = from.number("initial_thrust_fraction", 0, 1, "1");
  }
  if (from.has("final_thrust_fraction")) {
    trial.final_thrust_fraction = from.number("final_thrust_fraction", 0, 1, "1");
  }
  trial.validate();
  return trial;
}

json parse(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw common::FileError(path, "cannot be read");
  try {
    json whole = json::parse(in);
    if (!whole.is_object()) throw common::FileError(path, "is not a JSON object; make it with snapwing plan --json");
    return whole;
  } catch (const json::exception& e) {
    throw common::FileError(path, std::string("is no JSON: ") + e.what());
  }
}

}  // namespace

std::string PlanFile::name() const { return start == vehicle::Mode::FIXED_WING ? "F -> Q" : "Q -> F"; }

std::string PlanFile::word() const { return start == vehicle::Mode::FIXED_WING ? "f_to_q" : "q_to_f"; }

PlanFile loadPlan(const std::string& path) {
  const json whole = parse(path);
  const Object root(whole, path, "");
  const Object plan = root.at("plan"), inputs = root.at("inputs"), pulse = plan.at("pulse");
  if (!plan.boolean("accepted")) {
    throw common::SettingError(path, "plan.accepted", "false (" + plan.text("reason") + ")",
                               "true: a plan that was refused cannot be validated");
  }
  PlanFile out;
  out.file = path;
  out.start = vehicle::modeFromName(plan.text("start_mode"));
  out.pulse = {pulse.number("throttle", 0, 1, "1"), pulse.number("duration", 0, 60, "s")};
  if (pulse.has("hold_throttle") || pulse.has("hold_duration")) {
    out.pulse.hold_throttle = pulse.number("hold_throttle", 0, 1, "1");
    out.pulse.hold_duration = pulse.number("hold_duration", 0, 60, "s");
    out.pulse.validateHold();
  }
  out.trial = readTrial(root.at("trial"));
  out.worst_margin = plan.number("worst_margin", -1e6, 1e6, "barriers");
  out.vehicle_sha256 = inputs.text("vehicle_sha256");
  out.table_sha256 = inputs.text("table_sha256");
  return out;
}

namespace {

nlohmann::ordered_json planJson(const planning::TransitionPlan& plan) {
  nlohmann::ordered_json influences = nlohmann::ordered_json::array();
  for (const auto& effect : plan.influences) {
    influences.push_back(
        {{"name", effect.name}, {"low_margin", effect.low_margin}, {"high_margin", effect.high_margin}});
  }
  nlohmann::ordered_json worst_coordinates;
  const std::vector<std::string> names = planning::plannerCoordinateNames();
  for (std::size_t i = 0; i < plan.worst_coordinates.size(); ++i)
    worst_coordinates[names[i]] = plan.worst_coordinates[i];
  return {{"start_mode", vehicle::modeName(plan.start_mode)},
          {"target_mode", vehicle::modeName(plan.target_mode)},
          {"accepted", plan.accepted},
          {"reason", plan.reason},
          {"pulse", pulseJson(plan.pulse)},
          {"thrust_fraction", plan.thrust_fraction},
          {"worst_margin", plan.worst_margin},
          {"share_switched", plan.share_switched},
          {"realisations", plan.realisations},
          {"vertex_margin", plan.vertex_margin},
          {"evaluations", plan.evaluations},
          {"predictions", plan.predictions},
          {"compute_seconds", plan.compute_seconds},
          {"nominal", predictionJson(plan.nominal)},
          {"worst", predictionJson(plan.worst)},
          {"worst_coordinates", worst_coordinates},
          {"influences", influences}};
}

nlohmann::ordered_json accidentsJson(const std::vector<planning::AccidentMargin>& margins) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& m : margins) {
    list.push_back({{"name", m.name},
                    {"explanation", m.explanation},
                    {"mode", vehicle::modeName(m.mode)},
                    {"unit", m.unit},
                    {"limit", m.limit},
                    {"occurs", m.occurs},
                    {"holds", m.holds}});
  }
  return list;
}

}  // namespace

void savePlan(const std::string& path, const vehicle::Vehicle& vehicle, const std::string& table_file,
              const vehicle::Trial& trial, const planning::TransitionPlan& plan,
              const std::vector<planning::AccidentMargin>* accidents) {
  nlohmann::ordered_json json = {
      {"inputs", inputsJson(vehicle, table_file)}, {"trial", trialJson(trial)}, {"plan", planJson(plan)}};
  if (accidents) json["accidents"] = accidentsJson(*accidents);
  common::writeFileAtomically(path, common::jsonText(json));
}

}  // namespace snapwing::validation
