#include "snapwing/vehicle/table_origin.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/vehicle/force_curve_file.h"
#include "table_consistency.h"

namespace snapwing::vehicle {

namespace {

constexpr char MEASURED[] = "measured";

std::string toText(double value, int digits = 10) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

/// Geometry and elastic constants that a curve depends on.
std::string armInputs(const Vehicle& vehicle) {
  const ArmSettings& a = vehicle.arm;
  std::string text;
  for (const double value :
       {a.domain_length, a.domain_height, a.leg_width, a.bar_height, a.leg_thickness, a.bar_thickness, a.pin_x, a.pin_y,
        a.clamp_y_low, a.clamp_y_high, vehicle.material.youngs_modulus.value, vehicle.material.poisson_ratio.value}) {
    text += toText(value, 17) + ";";
  }
  return text;
}

std::string anew(const Vehicle& vehicle, const std::string& path) {
  return "; `snapwing curve " + vehicle.file + " -o " + path + "` computes it again";
}

const std::string* find(const std::map<std::string, std::string>& map, const std::string& key) {
  const auto found = map.find(key);
  return found == map.end() ? nullptr : &found->second;
}

/// What the table says of one input, against what the vehicle file says now.
struct Noted {
  const char* key;      ///< of the provenance
  const char* setting;  ///< of the vehicle file
};

constexpr Noted NOTED[] = {{"density_sha256", "arm.density_file"},
                           {"youngs_modulus_pa", "material.youngs_modulus"},
                           {"poisson_ratio", "material.poisson_ratio"},
                           {"mass_density_kg_m3", "material.mass_density"},
                           {"arm_count", "arm.count"}};

std::string shorter(const std::string& value) { return value.size() == 64 ? "sha256 " + value.substr(0, 12) : value; }

[[noreturn]] void refuse(const Vehicle& vehicle, const std::string& path, const std::string& setting,
                         const std::string& table_has, const std::string& vehicle_has) {
  throw common::FileError(path, "belongs to another arm: it was computed for " + setting + " " + shorter(table_has) +
                                    ", and " + vehicle.file + " has " + shorter(vehicle_has) + anew(vehicle, path));
}

std::string wingRemedy(const Vehicle& vehicle) {
  return "; `snapwing design wing SETTINGS.yaml -o FOLDER` with motion.table: " + vehicle.arm.table_file +
         " makes it again";
}

}  // namespace

void noteOrigin(const Vehicle& vehicle, const std::string& density, std::map<std::string, std::string>* provenance) {
  auto& p = *provenance;
  p["vehicle"] = vehicle.name;
  p["youngs_modulus_pa"] = toText(vehicle.material.youngs_modulus.value);
  p["poisson_ratio"] = toText(vehicle.material.poisson_ratio.value);
  p["mass_density_kg_m3"] = toText(vehicle.material.mass_density.value);
  p["arm_count"] = std::to_string(vehicle.arm.count);
  p["vehicle_sha256"] = vehicle.sha256;
  p["density_sha256"] = common::sha256(density);
  p["inputs_sha256"] = common::sha256(armInputs(vehicle) + density);
}

void requireFileOf(const Vehicle& vehicle, const std::string& key, const std::string& path, const std::string& remedy) {
  if (std::filesystem::is_regular_file(path)) return;
  throw common::SettingError(vehicle.file, key, "a file that is not there (" + path + ")",
                             "a file, by a path relative to the folder of the vehicle file; " + remedy +
                                 "; `snapwing vehicle new` copies a vehicle with all that it names");
}

std::string densityBytesOf(const Vehicle& vehicle) {
  requireFileOf(vehicle, "arm.density_file", vehicle.arm.density_file, "`snapwing design arm` makes one");
  return common::readFile(vehicle.arm.density_file);
}

void requireOrigin(const ForceTable& table, const Vehicle& vehicle, const std::string& path) {
  if (const std::string* origin = find(table.provenance, "origin"); origin && *origin == MEASURED) {
    if (table.arm_count != vehicle.arm.count) {
      refuse(vehicle, path, "arm.count", std::to_string(table.arm_count), std::to_string(vehicle.arm.count));
    }
    return;
  }
  std::map<std::string, std::string> now;
  noteOrigin(vehicle, densityBytesOf(vehicle), &now);
  if (!find(table.provenance, "density_sha256") || !find(table.provenance, "inputs_sha256")) {
    throw common::FileError(path,
                            "does not say which arm it was computed for" + anew(vehicle, path) +
                                "; a measured one says origin = measured among the attributes of its group provenance");
  }
  for (const Noted& noted : NOTED) {
    const std::string* was = find(table.provenance, noted.key);
    if (was && *was != now.at(noted.key)) refuse(vehicle, path, noted.setting, *was, now.at(noted.key));
  }
  if (table.arm_count != vehicle.arm.count) {
    refuse(vehicle, path, "arm.count", std::to_string(table.arm_count), std::to_string(vehicle.arm.count));
  }
  if (table.provenance.at("inputs_sha256") == now.at("inputs_sha256")) return;
  throw common::FileError(
      path,
      "belongs to another arm: it has this density, but was computed for other lengths (domain, leg, bar, "
      "thicknesses, pin or clamp) than `arm` of " +
          vehicle.file + " has now" + anew(vehicle, path));
}

void requireOrigin(const WingTable& wing, const ForceTable& arm, const Vehicle& vehicle) {
  const std::string& path = vehicle.wing.table_file;
  // A wing's table of 0.4 mm steps is 4e-4 rad off between its rows; the arms of two designs differ by far more.
  constexpr double ROTATION_ALLOWED = 2e-3, LENGTH_ALLOWED = 1e-5;
  const auto differs = [&](const std::string& what, double has, const std::string& place, double wanted) {
    throw common::FileError(path, "belongs to another arm: " + what + " is " + toText(has, 5) + place +
                                      ", and of the vehicle's arm it is " + toText(wanted, 5) + wingRemedy(vehicle));
  };
  if (wing.hasBlade()) {
    const double radius = vehicle.geometry.housing_radius + vehicle.arm.pin_x, below = vehicle.geometry.axle_below_ring;
    if (std::abs(wing.axle[0] - radius) > LENGTH_ALLOWED) differs("the axle's radius [m]", wing.axle[0], "", radius);
    if (std::abs(wing.axle[1] + below) > LENGTH_ALLOWED) differs("the axle's height [m]", wing.axle[1], "", -below);
  }
  for (std::size_t k = 0; k < arm.travel.size(); ++k) {
    const double u = arm.travel[k];
    if (u < wing.travel.front() || u > wing.travel.back()) continue;
    const double noted = wing.at(wing.arm_rotation, u);
    if (std::abs(noted - arm.rotation[k]) <= ROTATION_ALLOWED) continue;
    differs("the arm's rotation [rad]", noted, " at u = " + toText(u, 5) + " m", arm.rotation[k]);
  }
}

namespace {

ForceTable checkedTable(const Vehicle& vehicle, const std::string& asked, ForceTable (*load)(const std::string&)) {
  const std::string& path = asked.empty() ? vehicle.arm.table_file : asked;
  if (asked.empty()) {
    requireFileOf(vehicle, "arm.table_file", path, "`snapwing curve " + vehicle.file + " -o " + path + "` computes it");
  }
  ForceTable table = load(path);
  requireOrigin(table, vehicle, path);
  requireConsistent(table, path);
  requireTravelOf(table, vehicle, path);
  requireMassOf(table, vehicle, path);
  return table;
}

}  // namespace

ForceTable armTableOf(const Vehicle& vehicle, const std::string& asked) {
  return checkedTable(vehicle, asked, loadForceTable);
}

ForceTable armCurveOf(const Vehicle& vehicle, const std::string& asked) {
  return checkedTable(vehicle, asked, loadForceCurve);
}

std::optional<WingTable> wingTableOf(const Vehicle& vehicle, const ForceTable& arm) {
  if (!vehicle.hasWing()) return std::nullopt;
  const std::string remedy = "`snapwing design wing` makes one, and a vehicle without wings leaves out the key wing";
  requireFileOf(vehicle, "wing.layout_file", vehicle.wing.layout_file, remedy);
  requireFileOf(vehicle, "wing.table_file", vehicle.wing.table_file, remedy);
  WingTable wing = loadWingTable(vehicle.wing.table_file);
  requireOrigin(wing, arm, vehicle);
  return wing;
}

}  // namespace snapwing::vehicle
