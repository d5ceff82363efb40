#include "snapwing/validation/kept_results.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "snapwing/common/json_text.h"
#include "snapwing/common/output_file.h"

namespace snapwing::validation {

namespace {

using nlohmann::ordered_json;

/// NaN is null in the file.
double numberOf(const ordered_json& j) { return j.is_number() ? j.get<double>() : std::nan(""); }

RungOutcome outcomeOf(const ordered_json& j) {
  RungOutcome o;
  o.failure = j.at("failure").get<std::string>();
  const std::string end = j.at("end_mode").get<std::string>();
  o.end = end == vehicle::modeName(vehicle::Mode::UNKNOWN) ? vehicle::Mode::UNKNOWN : vehicle::modeFromName(end);
  o.snapped = j.at("snapped").get<bool>();
  o.snap_time = numberOf(j.at("snap_time"));
  o.peak_travel = numberOf(j.at("peak_travel"));
  o.least_travel = numberOf(j.at("least_travel"));
  o.margin = numberOf(j.at("energy_margin"));
  o.imbalance = numberOf(j.at("imbalance"));
  o.min_det_f = numberOf(j.at("min_det_f"));
  o.strain = numberOf(j.at("strain"));
  o.mean_strain = numberOf(j.at("mean_strain"));
  o.threshold = numberOf(j.at("threshold"));
  o.cpu_seconds = numberOf(j.at("cpu_seconds"));
  o.time = j.at("time").get<std::vector<double>>();
  o.travel = j.at("travel").get<std::vector<double>>();
  o.thrust = j.at("thrust").get<std::vector<double>>();
  return o;
}

/// What the file holds; none if it is not there or damaged: computed anew then, and replaced.
std::optional<ordered_json> wholeOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  ordered_json whole = ordered_json::parse(in, nullptr, false);
  const bool good = whole.is_object() && whole.contains("key") && whole["key"].is_string() &&
                    whole.contains("outcome") && whole["outcome"].is_object();
  return good ? std::optional(whole) : std::nullopt;
}

/// Program that left it, as text for people; empty: it does not say.
std::string writerOf(const ordered_json& whole) {
  const auto found = whole.find("program");
  return found != whole.end() && found->is_string() ? common::shownBytes(found->get<std::string>()) : std::string();
}

}  // namespace

KeptResults::KeptResults(std::string folder, std::string program)
    : folder_(std::move(folder)), program_(std::move(program)) {
  common::makeFolder(folder_);
}

std::string KeptResults::path(const std::string& name) const { return folder_ + "/" + name + ".json"; }

std::optional<ordered_json> KeptResults::load(const std::string& name, const std::string& key) const {
  std::optional<ordered_json> whole = wholeOf(path(name));
  if (!whole || (*whole)["key"].get<std::string>() != key || writerOf(*whole) != program_) return std::nullopt;
  return std::move((*whole)["outcome"]);
}

std::string KeptResults::otherProgram(const std::string& name, const std::string& key) const {
  const std::optional<ordered_json> whole = wholeOf(path(name));
  // Earlier programs counted their version into the key and said no more.
  if (!whole || writerOf(*whole) == program_) return {};
  const bool old = !whole->contains("program");
  if (!old && (*whole)["key"].get<std::string>() != key) return {};
  return "left by another program (" + (old ? "an earlier one" : writerOf(*whole)) + ", this is " + program_ + ")";
}

std::optional<ordered_json> KeptResults::loadAny(const std::string& name) const {
  std::optional<ordered_json> whole = wholeOf(path(name));
  if (!whole) return std::nullopt;
  return std::move((*whole)["outcome"]);
}

void KeptResults::save(const std::string& name, const std::string& key, const ordered_json& result) const {
  common::writeFileAtomically(path(name),
                              common::jsonText(ordered_json{{"key", key}, {"program", program_}, {"outcome", result}}));
}

void KeptResults::forget(const std::string& name) const { std::filesystem::remove(path(name)); }

ordered_json keptOutcome(const RungOutcome& o) {
  return {{"failure", o.failure},         {"end_mode", vehicle::modeName(o.end)},
          {"snapped", o.snapped},         {"snap_time", o.snap_time},
          {"peak_travel", o.peak_travel}, {"least_travel", o.least_travel},
          {"energy_margin", o.margin},    {"imbalance", o.imbalance},
          {"min_det_f", o.min_det_f},     {"strain", o.strain},
          {"mean_strain", o.mean_strain}, {"threshold", o.threshold},
          {"cpu_seconds", o.cpu_seconds}, {"time", o.time},
          {"travel", o.travel},           {"thrust", o.thrust}};
}

bool readOutcome(const ordered_json& kept, RungOutcome* outcome) {
  try {
    *outcome = outcomeOf(kept);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace snapwing::validation
