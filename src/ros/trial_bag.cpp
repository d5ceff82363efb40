#include "trial_bag.h"

#include <rosbag/bag.h>
#include <sensor_msgs/JointState.h>
#include <snapwing/ModeState.h>
#include <snapwing/VehicleTruth.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "conversions.h"
#include "snapwing/common/error.h"
#include "snapwing/common/output_file.h"
#include "snapwing/vehicle/table_origin.h"
#include "topics.h"
#include "vehicle_picture.h"
#include "wing_picture.h"

namespace snapwing::nodes {

namespace {

struct Column {
  const char* name;
  std::vector<double> TrialSeries::*values;
};

constexpr Column COLUMNS[] = {{"time_s", &TrialSeries::time},
                              {"travel_m", &TrialSeries::travel},
                              {"travel_rate_m_per_s", &TrialSeries::travel_rate},
                              {"arm_rotation_rad", &TrialSeries::arm_rotation},
                              {"wing_left_rad", &TrialSeries::wing_left},
                              {"wing_right_rad", &TrialSeries::wing_right},
                              {"ring_position_m", &TrialSeries::ring_position},
                              {"ring_speed_m_per_s", &TrialSeries::ring_speed},
                              {"thrust_N", &TrialSeries::thrust}};

std::ifstream opened(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw common::FileError(path, "cannot be read; `snapwing trial TRIAL.yaml -o FOLDER` makes it");
  return file;
}

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
  return cells;
}

void readColumns(const std::string& path, TrialSeries& out) {
  std::ifstream file = opened(path);
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> head = cellsOf(line);
  std::vector<std::pair<std::size_t, std::vector<double>*>> wanted;
  for (const Column& column : COLUMNS) {
    const auto at = std::find(head.begin(), head.end(), column.name);
    if (at == head.end()) throw common::FileError(path, std::string("has no column ") + column.name);
    wanted.emplace_back(at - head.begin(), &(out.*column.values));
  }
  for (int number = 2; std::getline(file, line); ++number) {
    const std::vector<std::string> cells = cellsOf(line);
    const std::string place = "line " + std::to_string(number);
    if (cells.size() != head.size()) throw common::FileError(path, place + " has not as many values as the first one");
    for (const auto& [index, values] : wanted) {
      char* end = nullptr;
      values->push_back(std::strtod(cells[index].c_str(), &end));
      if (end == cells[index].c_str() || *end != '\0') {
        throw common::FileError(path, place + ": '" + cells[index] + "' is not a number");
      }
    }
    const std::size_t rows = out.time.size();
    if (!std::isfinite(out.time.back()) || out.time.back() < 0 ||
        (rows > 1 && out.time[rows - 1] <= out.time[rows - 2]))
      throw common::FileError(path, place + ": time_s must be at least 0 and grow from row to row");
  }
  if (out.time.empty()) throw common::FileError(path, "has no rows");
}

/// The trial's rows as messages.
class Rows {
 public:
  explicit Rows(TrialSeries series)
      : series_(std::move(series)),
        vehicle_(vehicle::loadVehicle(series_.vehicle_file)),
        table_(vehicle::armTableOf(vehicle_)),
        wing_(series_.wings ? vehicle::wingTableOf(vehicle_, table_) : std::nullopt),
        picture_(vehicle_, table_, {}),
        barrier_(std::isfinite(series_.barrier) ? series_.barrier : vehicle::curveFeatures(table_).barrier_travel) {
    if (wing_ && !wing_->hasBlade()) throw common::FileError(vehicle_.wing.table_file, "has no blade");
    if (wing_) picture_.useWing(*wing_);
    if (wing_) completeWings();
  }

  void writeTo(rosbag::Bag& bag) const {
    double drawn = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < series_.time.size(); ++k) {
      const ros::Time stamp(BAG_BEGIN + series_.time[k]);
      bag.write("/tf", stamp, frames(k, stamp));
      bag.write("/joint_states", stamp, joints(k, stamp));
      bag.write(std::string("/") + topics::MODE_STATE, stamp, modeState(k, stamp));
      bag.write(std::string("/") + topics::TRUTH, stamp, truth(k, stamp));
      if (k + 1 < series_.time.size() && series_.time[k] - drawn < 1 / MARKER_RATE - 1e-9) continue;
      drawn = series_.time[k];
      bag.write(std::string("/") + topics::MARKERS, stamp, markers(k, stamp));
    }
  }

 private:
  /// Where the trial has no angles of its own (rung lumped), the wings follow the table.
  void completeWings() {
    const double sign = std::copysign(1.0, wing_->wing_angle.back());
    for (std::size_t k = 0; k < series_.time.size(); ++k) {
      for (std::vector<double>* angles : {&series_.wing_left, &series_.wing_right}) {
        double& angle = (*angles)[k];
        if (std::isnan(angle)) angle = sign * wing_->at(wing_->wing_angle, series_.travel[k]);
      }
    }
  }
  vehicle::Mode modeAt(std::size_t k) const {
    return series_.travel[k] < barrier_ ? vehicle::Mode::FIXED_WING : vehicle::Mode::QUADROTOR;
  }
  tf2_msgs::TFMessage frames(std::size_t k, const ros::Time& stamp) const {
    const PictureSettings names;
    geometry_msgs::TransformStamped ring, housing;
    ring.header.stamp = housing.header.stamp = stamp;
    ring.header.frame_id = "map";
    ring.child_frame_id = housing.header.frame_id = names.ring_frame;
    housing.child_frame_id = names.housing_frame;
    ring.transform.rotation.w = housing.transform.rotation.w = 1;
    ring.transform.translation.z = series_.ring_position[k];
    housing.transform.translation.z = picture_.housingHeight(series_.travel[k]);
    tf2_msgs::TFMessage message;
    message.transforms = {ring, housing};
    return message;
  }
  sensor_msgs::JointState joints(std::size_t k, const ros::Time& stamp) const {
    sensor_msgs::JointState message;
    message.header.stamp = stamp;
    message.name = {"travel", "arm"};
    message.position = {series_.travel[k], series_.arm_rotation[k]};
    if (wing_) {
      message.name.insert(message.name.end(), {"wing_left", "wing_right"});
      message.position.insert(message.position.end(), {series_.wing_left[k], series_.wing_right[k]});
    }
    return message;
  }
  ModeState modeState(std::size_t k, const ros::Time& stamp) const {
    ModeState message;
    message.header.stamp = stamp;
    message.header.frame_id = PictureSettings().ring_frame;
    message.mode = toMessage(modeAt(k));
    message.probability_fixed_wing = modeAt(k) == vehicle::Mode::FIXED_WING ? 1 : 0;
    message.probability_quadrotor = 1 - message.probability_fixed_wing;
    message.travel = series_.travel[k];
    message.wing_angle =
        wing_ ? 0.5 * (series_.wing_left[k] + series_.wing_right[k]) : std::numeric_limits<double>::quiet_NaN();
    message.reading_age = std::numeric_limits<double>::quiet_NaN();
    return message;
  }
  VehicleTruth truth(std::size_t k, const ros::Time& stamp) const {
    VehicleTruth message;
    message.header.stamp = stamp;
    message.mode = toMessage(modeAt(k));
    message.travel = series_.travel[k];
    message.travel_rate = series_.travel_rate[k];
    message.position = series_.ring_position[k];
    message.speed = series_.ring_speed[k];
    message.thrust = series_.thrust[k];
    message.arm_rotation = series_.arm_rotation[k];
    return message;
  }
  visualization_msgs::MarkerArray markers(std::size_t k, const ros::Time& stamp) const {
    PictureState state;
    state.stamp = stamp;
    state.travel = series_.travel[k];
    state.mode = modeAt(k);
    char numbers[80];
    std::snprintf(numbers, sizeof numbers, "\n%.3f s   u = %.1f mm", series_.time[k], 1e3 * series_.travel[k]);
    state.label = series_.name + numbers;
    const double full = vehicle_.rotors.count * vehicle_.rotors.max_thrust.value;
    state.thrust.assign(static_cast<std::size_t>(vehicle_.rotors.count), series_.thrust[k] / full);
    if (wing_) {
      state.wing_left = travelOfWingAngle(*wing_, series_.wing_left[k]);
      state.wing_right = travelOfWingAngle(*wing_, series_.wing_right[k]);
    }
    return picture_.draw(state);
  }

  TrialSeries series_;
  vehicle::Vehicle vehicle_;
  vehicle::ForceTable table_;
  std::optional<vehicle::WingTable> wing_;
  VehiclePicture picture_;
  double barrier_;
};

}  // namespace

TrialSeries readTrialSeries(const std::string& folder) {
  TrialSeries out;
  readColumns(folder + "/series.csv", out);
  const std::string path = folder + "/summary.json";
  std::ifstream file = opened(path);
  try {
    const nlohmann::json summary = nlohmann::json::parse(file);
    out.name = summary.at("trial").get<std::string>();
    out.vehicle_file = summary.at("inputs").at("vehicle_file").get<std::string>();
    const nlohmann::json model = summary.value("model", nlohmann::json::object());
    // A soft rung says what it moved; the lumped one has wings where the surroundings let them act.
    const bool on = summary.at("surroundings").value("wings", "") != "off" &&
                    summary.at("surroundings").value("mount", "") != "boom";
    out.wings = model.empty() ? on : model.contains("linkage") && !model.at("linkage").is_null();
    out.barrier = model.empty() ? std::numeric_limits<double>::quiet_NaN() : model.at("static_barrier").get<double>();
  } catch (const nlohmann::json::exception& e) {
    throw common::FileError(path, std::string("is not a summary of a trial: ") + e.what());
  }
  return out;
}

std::string writeTrialBag(const std::string& folder) {
  const Rows rows(readTrialSeries(folder));
  const std::string path = folder + "/run.bag", part = path + ".part";
  common::OutputFiles files;
  files.reads({folder + "/series.csv", folder + "/summary.json"}, "a file of the trial");
  files.writes(path, "run.bag");
  try {
    rosbag::Bag bag(part, rosbag::bagmode::Write);
    bag.setCompression(rosbag::compression::LZ4);
    rows.writeTo(bag);
    bag.close();
    std::filesystem::rename(part, path);
  } catch (const rosbag::BagException& e) {
    throw common::FileError(path, e.what());
  } catch (const std::filesystem::filesystem_error& e) {
    throw common::FileError(path, e.what());
  }
  return path;
}

}  // namespace snapwing::nodes
