#include "snapwing/motion/trial_record.h"

#include <hdf5.h>

#include <array>
#include <sstream>

#include "snapwing/common/checkpoint_bytes.h"
#include "snapwing/common/hdf5_file.h"
#include "snapwing/common/program_code.h"

namespace snapwing::motion {

namespace {

using common::hdf5::check;
using common::hdf5::Handle;

struct Column {
  const char *name, *unit;
  double AxisSample::*value;
};

constexpr std::array<Column, 26> COLUMNS{{{"time", "s", &AxisSample::time},
                                          {"travel", "m", &AxisSample::travel},
                                          {"travel_rate", "m/s", &AxisSample::travel_rate},
                                          {"arm_rotation", "rad", &AxisSample::arm_rotation},
                                          {"wing_left", "rad", &AxisSample::wing_left},
                                          {"wing_right", "rad", &AxisSample::wing_right},
                                          {"hub_twist", "rad", &AxisSample::hub_twist},
                                          {"tilt", "rad", &AxisSample::tilt},
                                          {"housing_tilt", "rad", &AxisSample::housing_tilt},
                                          {"drift", "m", &AxisSample::drift},
                                          {"turn_rate", "rad/s", &AxisSample::turn_rate},
                                          {"centre_off", "m", &AxisSample::centre_off},
                                          {"ring_position", "m", &AxisSample::ring_position},
                                          {"ring_speed", "m/s", &AxisSample::ring_speed},
                                          {"centre_speed", "m/s", &AxisSample::centre_speed},
                                          {"thrust", "N", &AxisSample::thrust},
                                          {"kinetic_energy", "J", &AxisSample::kinetic},
                                          {"stored_energy", "J", &AxisSample::stored},
                                          {"work", "J", &AxisSample::work},
                                          {"loss", "J", &AxisSample::loss},
                                          {"imbalance", "J", &AxisSample::imbalance},
                                          {"relative_kinetic_energy", "J", &AxisSample::relative_kinetic},
                                          {"strain", "1", &AxisSample::strain},
                                          {"mean_strain", "1", &AxisSample::mean_strain},
                                          {"step", "s", &AxisSample::step},
                                          {"min_det_f", "1", &AxisSample::min_det_f}}};

void writeArray(hid_t group, const std::string& name, const std::vector<double>& values, const std::string& unit,
                const std::string& path) {
  const hsize_t size = values.size();
  Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, path, "make a space");
  Handle set(H5Dcreate2(group, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
             path, "make the dataset " + name);
  if (size > 0) {
    check(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path, "write " + name);
  }
  common::hdf5::writeAttribute(set, "unit", unit, path);
}

const std::string MAGIC = "snapwing trial checkpoint 9\n";

std::string program() { return common::programOf(&MAGIC); }

using common::BytesReader;
using common::BytesWriter;

/// Numbers of a run beside its vectors, for both directions.
template <class Visit>
void eachNumber(AxisRun& run, const Visit& visit) {
  MotionState& s = run.state;
  for (double* value : {&s.time, &s.last_step, &s.next_step, &s.kinetic, &s.stored, &run.calm_since}) visit(*value);
  AxisOutcome& o = run.outcome;
  for (double* value : {&o.snap_time, &o.peak_travel, &o.least_travel, &o.end_travel, &o.peak_speed, &o.end_speed,
                        &o.settle_time, &o.largest_imbalance, &o.largest_strain, &o.largest_mean_strain}) {
    visit(*value);
  }
}

/// Vectors of a state, for both directions.
template <class State>
auto vectorsOf(State& s) {
  return std::array{&s.z, &s.y, &s.v, &s.acceleration, &s.mean_rate, &s.mean_rate_change, &s.multipliers, &s.history};
}

void putRotations(BytesWriter& writer, const MotionState& s) {
  writer.number(s.references ? static_cast<double>(s.references->rotation.size()) : 0);
  if (!s.references) return;
  for (const Eigen::Matrix3d& r : s.references->rotation) writer.numbers(r.data(), r.size());
}

void takeRotations(BytesReader& reader, MotionState& s) {
  const std::size_t count = reader.count();
  if (count == 0) return;
  auto references = std::make_shared<solver::References>();
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> read = reader.numbers();
    read.resize(9);
    references->rotation.emplace_back(Eigen::Map<const Eigen::Matrix3d>(read.data()));
  }
  s.references = std::move(references);
}

void put(BytesWriter& writer, const AxisRun& run) {
  AxisRun copy = run;
  eachNumber(copy, [&](double& value) { writer.number(value); });
  for (const int value : {static_cast<int>(run.outcome.start_mode), static_cast<int>(run.outcome.start_held),
                          run.outcome.steps, run.outcome.iterations, run.outcome.factorizations}) {
    writer.number(value);
  }
  for (const Eigen::VectorXd* values : vectorsOf(run.state)) writer.numbers(values->data(), values->size());
  putRotations(writer, run.state);
  writer.number(static_cast<double>(run.samples.size()));
  for (const AxisSample& sample : run.samples) {
    for (const Column& column : COLUMNS) writer.number(sample.*column.value);
    writer.number(sample.iterations);
  }
}

AxisRun take(BytesReader& reader) {
  AxisRun run;
  run.begun = true;
  eachNumber(run, [&](double& value) { value = reader.number(); });
  run.outcome.start_mode = static_cast<vehicle::Mode>(reader.integer());
  run.outcome.start_held = reader.integer() != 0;
  for (int* value : {&run.outcome.steps, &run.outcome.iterations, &run.outcome.factorizations}) {
    *value = reader.integer();
  }
  for (Eigen::VectorXd* values : vectorsOf(run.state)) {
    const std::vector<double> read = reader.numbers();
    *values = Eigen::Map<const Eigen::VectorXd>(read.data(), static_cast<Eigen::Index>(read.size()));
  }
  takeRotations(reader, run.state);
  const std::size_t samples = reader.count();
  for (std::size_t k = 0; k < samples; ++k) {
    AxisSample& sample = run.samples.emplace_back();
    for (const Column& column : COLUMNS) sample.*column.value = reader.number();
    sample.iterations = reader.integer();
  }
  return run;
}

}  // namespace

std::string seriesCsv(const std::vector<AxisSample>& samples) {
  std::ostringstream text;
  text.precision(9);
  for (const Column& column : COLUMNS) {
    std::string unit = column.unit;
    if (const auto slash = unit.find('/'); slash != std::string::npos) unit.replace(slash, 1, "_per_");
    text << column.name << (unit == "1" ? "" : "_" + unit) << ',';
  }
  text << "iterations\n";
  for (const AxisSample& sample : samples) {
    for (const Column& column : COLUMNS) text << sample.*column.value << ',';
    text << sample.iterations << '\n';
  }
  return text.str();
}

void saveSeries(const std::vector<AxisSample>& samples, const TrialVehicle& vehicle,
                const std::map<std::string, std::string>& provenance, const std::string& path) {
  common::hdf5::writeFile(path, [&](hid_t file) {
    for (const Column& column : COLUMNS) {
      std::vector<double> values;
      for (const AxisSample& sample : samples) values.push_back(sample.*column.value);
      writeArray(file, column.name, values, column.unit, path);
    }
    Handle group(H5Gcreate2(file, "static_curve", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path,
                 "make a group");
    vehicle::ForceTable table = vehicle.staticTable();
    for (std::vector<double>* column : {&table.force, &table.kinetic_mass, &table.coupled_mass}) {
      for (double& value : *column) value *= table.arm_count;
    }
    writeArray(group, "travel", table.travel, "m", path);
    writeArray(group, "force", table.force, "N", path);
    writeArray(group, "rotation", table.rotation, "rad", path);
    writeArray(group, "kinetic_mass", table.kinetic_mass, "kg", path);
    writeArray(group, "coupled_mass", table.coupled_mass, "kg", path);
    common::hdf5::writeProvenance(file, provenance, path);
  });
}

void saveTrialCheckpoint(const AxisRun& run, const std::string& hash, const std::string& path) {
  BytesWriter writer;
  put(writer, run);
  common::saveCheckpointBytes(writer.bytes(), MAGIC, program(), hash, path);
}

AxisRun loadTrialCheckpoint(const std::string& path, const std::string& hash) {
  BytesReader reader(common::loadCheckpointBytes(path, MAGIC, program(), hash, "another trial or vehicle"), path);
  return take(reader);
}

}  // namespace snapwing::motion
