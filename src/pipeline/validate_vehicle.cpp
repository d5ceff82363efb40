#include "snapwing/pipeline/validate_vehicle.h"

#include <cmath>
#include <cstdio>
#include <optional>
#include <sstream>
#include <tuple>

#include "snapwing/common/error.h"
#include "snapwing/common/folder_lock.h"
#include "snapwing/common/output_file.h"
#include "snapwing/common/provenance.h"
#include "snapwing/validation/report.h"
#include "snapwing/vehicle/table_origin.h"

namespace snapwing::pipeline {

namespace {

using validation::Verdict;

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

/// Those of the job, else those that the vehicle file names.
std::vector<std::string> planFiles(const ValidateJob& job, const vehicle::Vehicle& vehicle) {
  if (!job.plans.empty()) return job.plans;
  std::vector<std::string> files;
  for (const auto& [key, file, start] : {std::tuple("results.plan_f_to_q", vehicle.results.plan_f_to_q, "F"),
                                         std::tuple("results.plan_q_to_f", vehicle.results.plan_q_to_f, "Q")}) {
    if (file.empty()) continue;
    vehicle::requireFileOf(vehicle, key, file,
                           "`snapwing plan " + vehicle.file + " --from " + start + " --json " + file + "` makes it");
    files.push_back(file);
  }
  return files;
}

validation::Validation run(const ValidateJob& job, const vehicle::Vehicle& vehicle, const Tables& tables,
                           const std::vector<std::string>& files) {
  std::vector<validation::PlanFile> plans;
  for (const std::string& path : files) plans.push_back(validation::loadPlan(path));
  validation::ValidationHooks hooks;
  hooks.folder = job.folder + "/trials";
  hooks.cancelled = job.cancelled;
  hooks.note = job.note;
  hooks.progress = job.progress;
  validation::Validation found = validation::validate(vehicle, *tables.arm, tables.wing, plans, job.settings, hooks);
  found.checks.insert(found.checks.begin(), validation::yesOrNo("tables of this vehicle's arm", true,
                                                                "provenance, units, force against energy, travel"));
  return found;
}

void requireOutputs(const ValidateJob& job, const vehicle::Vehicle& vehicle, const std::vector<std::string>& plans) {
  common::OutputFiles files;
  files.reads({vehicle.file, vehicle.arm.density_file, vehicle.arm.table_file, vehicle.wing.layout_file,
               vehicle.wing.table_file},
              "a file of the vehicle");
  if (!job.settings.body.empty()) files.reads(job.settings.body, "the body");
  files.reads(plans, "a plan");
  files.fills(job.folder, "--output");
  for (const char* name : {"report.html", "validation.json"}) files.writes(job.folder + "/" + name, "--output");
}

}  // namespace

VehicleValidation validateVehicle(const ValidateJob& job) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(job.vehicle_file);
  const std::vector<std::string> plans = planFiles(job, vehicle);
  requireOutputs(job, vehicle, plans);
  common::makeFolder(job.folder);
  const common::FolderLock lock(job.folder);
  const Tables tables = tablesOf(vehicle);
  VehicleValidation out;
  out.vehicle = vehicle.name;
  out.report_file = job.folder + "/report.html";
  if (tables.refusal.empty()) {
    out.found = run(job, vehicle, tables, plans);
  } else {
    out.found.checks.push_back(validation::yesOrNo("tables of this vehicle's arm", false, tables.refusal));
  }
  if (out.found.cancelled) return out;
  const std::string& body = job.settings.body;
  const validation::ReportHead head{vehicle.name,
                                    vehicle.file,
                                    vehicle.sha256,
                                    vehicle.arm.table_file,
                                    body.empty() ? vehicle.arm.density_file : body,
                                    job.command,
                                    common::version()};
  const vehicle::ForceTable none;
  common::writeFileAtomically(out.report_file,
                              validation::reportHtml(out.found, tables.arm ? *tables.arm : none, head));
  common::writeFileAtomically(job.folder + "/validation.json", validation::reportJson(out.found, head));
  return out;
}

std::string settingsText(const validation::ValidationSettings& s) {
  std::ostringstream text;
  text.precision(17);
  text << "planar " << s.planar_cell << (s.extrapolate ? ", two sizes" : ", one size");
  if (s.volumetric) text << ", volumetric " << s.solid_cell;
  text << ", weakest " << s.weakest << ", samples " << s.samples << " from " << s.first_sample << ", step " << s.step;
  return text.str();
}

std::string checkLine(const validation::Check& c) {
  std::string line = c.name;
  const auto add = [&line](const char* format, double value) {
    char text[40];
    std::snprintf(text, sizeof text, format, value);
    line += text;
  };
  if (std::isfinite(c.value)) add(": %.4g", c.value);
  if (c.error > 0) add(" +- %.2g", c.error);
  if (std::isfinite(c.value)) line += " " + c.unit;
  const bool bounded = !std::isnan(c.low) || !std::isnan(c.high);
  if (c.verdict != Verdict::PASS && bounded) line += " (allowed " + validation::allowedWords(c) + ")";
  return c.words.empty() ? line : line + ": " + c.words;
}

int exitCodeOf(Verdict verdict) {
  if (verdict == Verdict::UNDECIDED) return 3;
  return verdict == Verdict::FAIL ? 1 : 0;
}

}  // namespace snapwing::pipeline
