// `snapwing vehicle new` starts a vehicle of one's own from another one; `snapwing vehicle check` reads a vehicle and
// all that it names.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "commands.h"
#include "snapwing/common/error.h"
#include "snapwing/common/output_file.h"
#include "snapwing/common/provenance.h"
#include "snapwing/validation/plan_file.h"
#include "snapwing/validation/prediction_json.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/table_origin.h"
#include "snapwing/vehicle/vehicle.h"
#include "snapwing/vehicle/vehicle_text.h"

namespace snapwing::tools {

namespace {

namespace fs = std::filesystem;

struct NewOptions {
  std::string file, from = "arris_x220";
  std::vector<std::string> without;
};

struct CheckOptions {
  std::string file;
  bool path = false;
};

/// Folders that may hold config/: of the installed package, and those above the program (a build in its source).
std::vector<fs::path> shippedFolders() {
  std::error_code none;
  std::vector<fs::path> folders;
  fs::path folder = fs::read_symlink("/proc/self/exe", none).parent_path();
  for (int level = 0; level < 8 && folder.has_relative_path(); ++level, folder = folder.parent_path()) {
    folders.push_back(folder);
    folders.push_back(folder / "share" / "snapwing");
  }
  return folders;
}

/// A file as named, or the shipped vehicle of that name.
fs::path sourceFile(const std::string& from) {
  if (fs::is_regular_file(from)) return from;
  for (const fs::path& folder : shippedFolders()) {
    const fs::path shipped = folder / "config" / "vehicles" / (from + ".yaml");
    if (fs::is_regular_file(shipped)) return shipped;
  }
  throw common::Error("--from is '" + from + "'; allowed: a vehicle file, or the name of a shipped one (arris_x220)");
}

/// The design that comes with the package, for the arm of the new vehicle.
std::optional<fs::path> shippedDesign() {
  for (const fs::path& folder : shippedFolders()) {
    const fs::path design = folder / "config" / "designs" / "arm_default.yaml";
    if (fs::is_regular_file(design)) return design;
  }
  return std::nullopt;
}

/// One file that a vehicle names: copied into the folder of the new one if it is there.
struct Part {
  const char *section, *key;
  std::string source, name;
};

void copyFile(const fs::path& from, const fs::path& to) {
  common::makeFolder(to.parent_path().string());
  common::writeFileAtomically(to.string(), common::readFile(from.string()));
}

int makeNew(const NewOptions& options) {
  const fs::path source = sourceFile(options.from), target = fs::absolute(options.file), folder = target.parent_path();
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(source.string());
  if (fs::exists(target)) throw common::FileError(options.file, "is there already; allowed: a new file");
  std::vector<std::string> without = options.without;
  without.emplace_back("results");  // of the other vehicle
  std::string text = vehicle::withoutKeys(common::readFile(source.string()), without);
  std::vector<Part> parts = {{"arm", "density_file", vehicle.arm.density_file, "arm/density.csv"},
                             {"arm", "table_file", vehicle.arm.table_file, "arm/table.h5"}};
  const bool wing =
      vehicle.hasWing() && std::find(options.without.begin(), options.without.end(), "wing") == options.without.end();
  if (wing) {
    parts.push_back({"wing", "layout_file", vehicle.wing.layout_file, "wing/wing.yaml"});
    parts.push_back({"wing", "table_file", vehicle.wing.table_file, "wing/wing_table.h5"});
  }
  for (const Part& part : parts) {
    if (fs::exists(folder / part.name)) {
      throw common::FileError((folder / part.name).string(),
                              "is there already; allowed: a folder of the vehicle's own");
    }
  }
  const std::string name = target.stem() == "vehicle" ? folder.filename().string() : target.stem().string();
  text = vehicle::withValue(text, "name", "name", name);
  for (const Part& part : parts) {
    text = vehicle::withValue(text, part.section, part.key, part.name);
    if (fs::is_regular_file(part.source)) copyFile(part.source, folder / part.name);
  }
  copyFile(source, target);  // makes the folder
  common::writeFileAtomically(target.string(), text);
  std::printf("%s: vehicle '%s', a copy of %s with the files that it names\n", options.file.c_str(), name.c_str(),
              source.filename().c_str());
  const fs::path design = folder / "arm_design.yaml";
  if (const auto shipped = shippedDesign(); shipped && !fs::exists(design)) {
    std::string settings = common::readFile(shipped->string());
    settings = vehicle::withValue(settings, "name", "name", name + "_arm");
    settings = vehicle::withValue(settings, "vehicle", "vehicle", target.filename().string());
    common::writeFileAtomically(design.string(), settings);
    std::printf("%s: settings of `snapwing design arm` for it\n",
                design.lexically_relative(fs::current_path()).c_str());
  }
  vehicle::loadVehicle(target.string());
  return 0;
}

/// One plan that the file names.
void printPlan(const vehicle::Vehicle& vehicle, const char* name, const std::string& file) {
  if (file.empty()) return;
  try {
    const validation::PlanFile plan = validation::loadPlan(file);
    const bool own = plan.vehicle_sha256 == vehicle.sha256;
    std::printf("plan %s: throttle %.3f %s%s\n", name, plan.pulse.throttle, validation::pulseTimes(plan.pulse).c_str(),
                own ? "" : ", but of another version of this file: plan again");
  } catch (const common::Error& e) {
    std::printf("plan %s: none: %s\n", name, e.what());
  }
}

/// What is known of the results that the file names.
void printResults(const vehicle::Vehicle& vehicle) {
  printPlan(vehicle, "F -> Q", vehicle.results.plan_f_to_q);
  printPlan(vehicle, "Q -> F", vehicle.results.plan_q_to_f);
  const std::string& file = vehicle.results.validation;
  if (file.empty()) return;
  std::string words = "not done";
  if (fs::is_regular_file(file)) {
    const nlohmann::json json = nlohmann::json::parse(common::readFile(file), nullptr, false);
    const bool read = json.is_object();
    const auto holds = [&](const char* key) { return read && json.contains(key) && json[key] == true; };
    words = holds("passed") ? "passed" : holds("undecided") ? "NOT decided" : "NOT passed";
    const bool own = read && json.contains("vehicle_sha256") && json["vehicle_sha256"] == vehicle.sha256;
    if (!own) words = "of another version of this file: validate again";
  }
  std::printf("validation: %s\n", words.c_str());
}

int check(const CheckOptions& options) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(options.file);
  const vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  const bool wing = vehicle::wingTableOf(vehicle, table).has_value();
  const std::string path = fs::canonical(options.file).string();
  if (options.path) {  // for a launch file: nothing else on this line
    std::printf("%s", path.c_str());
    return 0;
  }
  const vehicle::CurveFeatures f = vehicle::curveFeatures(table);
  std::printf("%s: vehicle '%s', %.3f kg, %d arms, %s, %s\n", path.c_str(), vehicle.name.c_str(),
              vehicle.masses.total.value, vehicle.arm.count, wing ? "wings" : "no wings",
              vehicle.boom.given ? "a boom" : "no boom");
  std::printf("all arms: peak %.3f N at %.1f mm, valley %.3f N at %.1f mm", f.peak_force, 1e3 * f.peak_travel,
              f.valley_force, 1e3 * f.valley_travel);
  std::printf(f.bistable ? ", second equilibrium at %.1f mm\n" : ", not bistable\n", 1e3 * f.second_travel);
  printResults(vehicle);
  return f.bistable ? 0 : 1;
}

}  // namespace

void addVehicleCommand(CLI::App& app, int& exit_code) {
  CLI::App* group = app.add_subcommand("vehicle", "Start a vehicle of your own, or check one");
  group->require_subcommand(1);
  auto made = std::make_shared<NewOptions>();
  CLI::App* command =
      group->add_subcommand("new", "Copy a vehicle file with all that it names into a folder of its own");
  command->add_option("file", made->file, "Vehicle file to write, e.g. my_vehicle/vehicle.yaml [YAML]")->required();
  command->add_option("--from", made->from, "Vehicle file, or name of a shipped one")->capture_default_str();
  command->add_option("--without", made->without, "Parts that the new vehicle has not")
      ->check(CLI::IsMember({"wing", "boom", "battery"}))
      ->delimiter(',');
  command->callback([made, &exit_code] { exit_code = makeNew(*made); });

  auto checked = std::make_shared<CheckOptions>();
  command = group->add_subcommand("check", "Read a vehicle file and all that it names, and compare them");
  command->add_option("file", checked->file, "Vehicle file [YAML]")->required();
  command->add_flag("--path", checked->path, "Print nothing but the absolute path of the file");
  command->footer("Exit code: 0 good, 1 the arm is not bistable, 2 bad input.");
  command->callback([checked, &exit_code] { exit_code = check(*checked); });
}

}  // namespace snapwing::tools
