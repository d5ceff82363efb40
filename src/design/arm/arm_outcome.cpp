#include "snapwing/design/arm/arm_outcome.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "snapwing/common/error.h"
#include "snapwing/common/json_text.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/design_program.h"
#include "snapwing/vehicle/table_origin.h"

namespace snapwing::design {

namespace {

using nlohmann::json;

json orNull(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

double numberOrNan(const json& j) { return j.is_number() ? j.get<double>() : std::numeric_limits<double>::quiet_NaN(); }

json describe(const ArmCheckCase& c) {
  json j = {{"name", c.name},     {"cell_size_m", c.cell_size}, {"outline_moved_m", c.offset},
            {"traced", c.traced}, {"message", c.message},       {"bistable", c.bistable}};
  if (!c.traced) return j;
  const vehicle::CurveFeatures& f = c.features;
  j["peak"] = {{"travel_m", orNull(f.peak_travel)}, {"force_N", orNull(f.peak_force)}};
  j["valley"] = {{"travel_m", orNull(f.valley_travel)}, {"force_N", orNull(f.valley_force)}};
  j["barrier_m"] = orNull(f.barrier_travel);
  j["second_equilibrium_m"] = orNull(f.second_travel);
  j["barrier_forward_J"] = orNull(f.barrier_forward);
  j["barrier_back_J"] = orNull(f.barrier_back);
  j["hysteresis_over_peak"] = orNull(c.hysteresis_share);
  j["rotation_second_rad"] = orNull(c.rotation_second);
  j["rotation_end_rad"] = orNull(c.rotation_end);
  j["unstable_points"] = c.unstable_points;
  return j;
}

json describe(const ArmDesignSettings& s, const ArmRun& run) {
  return {{"method", s.optimizer},
          {"status", nameOf(run.result.status)},
          {"message", run.result.message},
          {"iterations", run.history.size()},
          {"evaluations", run.evaluations},
          {"objective", orNull(run.result.objective)},
          {"violation", orNull(run.result.violation)},
          {"seconds", run.seconds},
          {"cpu_seconds", run.cpu_seconds},
          {"volume", run.volume},
          {"mass_kg_in_the_optimiser", run.mass},
          {"grey", run.grey},
          {"traced_from_rest", run.retraces},
          {"travels_m", run.travels},
          {"forces_per_arm_N", run.forces}};
}

json describe(const ArmPartsReport& parts, double area) {
  return {{"arm_volume_m3", parts.volume}, {"arm_mass_kg", parts.mass},      {"bounding_box_m", parts.extent},
          {"triangles", parts.triangles},  {"watertight", parts.watertight}, {"outline_area_m2", area}};
}

json reportOf(const ArmDesignSettings& s, const ArmCheck& check) {
  json j;
  j["name"] = s.name;
  j["inputs_sha256"] = s.hash();
  j["snapwing_version"] = common::version();
  j["program"] = designProgram();
  j["forces_are"] = "totals of " + std::to_string(s.copies) + " copies";
  j["bistable"] = check.bistable ? "yes" : "no";
  j["all_targets_met"] = check.all_met;
  for (const ArmTarget& t : check.targets) {
    j["targets"].push_back({{"name", t.name},
                            {"wanted", t.wanted},
                            {"low", orNull(t.low)},
                            {"high", orNull(t.high)},
                            {"extrapolated", t.converged},
                            {"met", t.met()},
                            {"verdict", nameOf(t.verdict)}});
  }
  for (const ArmCheckCase& c : check.cases) j["cases"].push_back(describe(c));
  return j;
}

std::string curveFile(const ArmCheckCase& c) {
  std::string name = c.name;
  for (char& letter : name) letter = letter == ' ' || letter == ',' ? '_' : letter;
  return "curve_" + name + ".h5";
}

/// The curve of a case, or the extrapolated one. @return what was written
vehicle::ForceTable saveCurve(const ArmDesignSettings& s, const ArmOutcome& outcome, vehicle::ForceTable table,
                              const std::string& name, const std::string& rung, const std::string& file) {
  table.provenance = {{"case", name},
                      {"rung", rung},
                      {"inputs_sha256", s.hash()},  // of a scene; an arm says what its own curve depends on
                      {"command", "snapwing design arm"},
                      {"snapwing_version", common::version()}};
  const std::string density = common::readFile(name == "grey" ? outcome.densityFile() : outcome.bodyFile());
  table.provenance["density_sha256"] = common::sha256(density);
  if (!s.user_scene) vehicle::noteOrigin(s.vehicle, density, &table.provenance);
  table.provenance["design_sha256"] = s.hash();
  vehicle::saveForceTable(table, file);
  return table;
}

/// The body and the table that a vehicle file should name. @return what of them is there
json saveForVehicle(const ArmDesignSettings& s, const ArmCheck& check, ArmOutcome& outcome) {
  const ArmCheckCase* finest = check.reference();
  if (!finest) return json::object();
  saveDensityCsv(check.body, "printed body of arm design '" + s.name + "', inputs " + s.hash(), outcome.bodyFile());
  const bool limit = !check.table.travel.empty();
  vehicle::ForceTable table = limit ? check.table : finest->table;
  table.arm_count = s.copies;
  outcome.table = saveCurve(s, outcome, table, limit ? "extrapolated" : finest->name,
                            limit ? std::string(finest->rung) + ", extrapolated to small cells" : finest->rung,
                            outcome.tableFile());
  return {{"table", "table.h5"}, {"body", "body.csv"}};
}

/// Check, curves, parts, report.
void finish(const ArmDesignSettings& s, const mpm::DensityField& field, const ArmRun* run, const ArmJob& job,
            ArmOutcome& outcome) {
  saveDensityCsv(field, "density of arm design '" + s.name + "', inputs " + s.hash(), outcome.densityFile());
  const ArmShape shape(field);
  const ArmCheck check = checkArm(s, shape, field, job.checking);
  if (!check.complete) {
    outcome.status = OptimizerStatus::CANCELLED, outcome.message = "cancelled while checking";
    return;
  }
  if (job.checked) job.checked(check);
  outcome.bistable = check.bistable, outcome.all_met = check.all_met;
  json report = reportOf(s, check);
  report.update(saveForVehicle(s, check, outcome));
  for (const ArmCheckCase& c : check.cases) {
    if (c.traced) saveCurve(s, outcome, c.table, c.name, c.rung, job.folder + "/" + curveFile(c));
  }
  if (!shape.empty() && s.user_scene) saveOutline(shape, job.folder + "/parts");
  if (!shape.empty() && !s.user_scene) {
    const ArmPartsReport parts = saveArmParts(s.vehicle, shape, job.folder + "/parts");
    report["parts"] = describe(parts, shape.area());
    if (job.printed) job.printed(parts);
  }
  if (run) report["optimizer"] = describe(s, *run);
  common::writeFileAtomically(job.folder + "/report.json", common::jsonText(report));
}

ArmOutcome outcomeOf(const ArmRun& run, const ArmJob& job) {
  ArmOutcome outcome;
  outcome.folder = job.folder;
  outcome.optimized = true;
  outcome.status = run.result.status;
  outcome.message = run.result.message;
  outcome.objective = run.result.objective;
  outcome.violation = run.result.violation;
  outcome.iterations = static_cast<int>(run.history.size());
  return outcome;
}

}  // namespace

std::vector<std::string> armOutcomeFiles() {
  return {"density.csv", "body.csv", "table.h5", "report.json", "history.csv", "history.h5", "checkpoint.h5"};
}

ArmOutcome designArm(const ArmDesignSettings& settings, const ArmJob& job) {
  common::makeFolder(job.folder);
  ArmRunOptions options;
  options.folder = job.folder;
  options.resume = job.resume;
  options.progress = job.progress;
  options.warning = job.warning;
  const ArmRun run = runArmDesign(settings, options);
  if (job.optimized) job.optimized(run);
  ArmOutcome outcome = outcomeOf(run, job);
  if (outcome.status != OptimizerStatus::CANCELLED) finish(settings, run.field, &run, job, outcome);
  return outcome;
}

ArmOutcome finishArmDesign(const ArmDesignSettings& settings, const ArmRun& run, const ArmJob& job) {
  ArmOutcome outcome = outcomeOf(run, job);
  finish(settings, run.field, &run, job, outcome);
  return outcome;
}

ArmOutcome checkArmDensity(const ArmDesignSettings& settings, const mpm::DensityField& field, const ArmJob& job) {
  common::makeFolder(job.folder);
  ArmOutcome outcome;
  outcome.folder = job.folder;
  finish(settings, field, nullptr, job, outcome);
  return outcome;
}

std::string storedArmFolder(const ArmDesignSettings& settings, const std::string& store) {
  return store + "/" + settings.hash();
}

std::optional<ArmOutcome> loadArmOutcome(const ArmDesignSettings& settings, const std::string& folder) {
  const std::string path = folder + "/report.json";
  if (!std::filesystem::exists(path)) return std::nullopt;
  const json report = json::parse(common::readFile(path), nullptr, false);
  if (report.is_discarded() || !report.is_object()) throw common::FileError(path, "is not a report of an arm design");
  if (report.value("inputs_sha256", "") != settings.hash()) return std::nullopt;
  if (report.value("program", "") != designProgram()) return std::nullopt;
  ArmOutcome outcome;
  outcome.folder = folder;
  outcome.bistable = report.value("bistable", "") == "yes";
  outcome.all_met = report.value("all_targets_met", false);
  if (const auto run = report.find("optimizer"); run != report.end()) {
    outcome.optimized = true;
    outcome.status = optimizerStatusOf(run->value("status", ""));
    outcome.message = run->value("message", "");
    outcome.objective = numberOrNan((*run)["objective"]);
    outcome.violation = numberOrNan((*run)["violation"]);
    outcome.iterations = run->value("iterations", 0);
  }
  if (report.contains("table"))
    outcome.table = vehicle::loadForceTable(folder + "/" + report["table"].get<std::string>());
  return outcome;
}

}  // namespace snapwing::design
