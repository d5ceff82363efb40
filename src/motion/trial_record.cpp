#include "snapwing/motion/trial_record.h"

#include <hdf5.h>

#include <array>
#include <cstring>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/hdf5_file.h"
#include "snapwing/common/output_file.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/provenance.h"

namespace snapwing::motion {

namespace {

using common::hdf5::check;
using common::hdf5::Handle;

struct Column {
  const char *name, *unit;
  double AxisSample::*value;
};

constexpr std::array<Column, 15> COLUMNS{{{"time", "s", &AxisSample::time},
                                          {"travel", "m", &AxisSample::travel},
                                          {"travel_rate", "m/s", &AxisSample::travel_rate},
                                          {"arm_rotation", "rad", &AxisSample::arm_rotation},
                                          {"ring_position", "m", &AxisSample::ring_position},
                                          {"ring_speed", "m/s", &AxisSample::ring_speed},
                                          {"centre_speed", "m/s", &AxisSample::centre_speed},
                                          {"thrust", "N", &AxisSample::thrust},
                                          {"kinetic_energy", "J", &AxisSample::kinetic},
                                          {"stored_energy", "J", &AxisSample::stored},
                                          {"work", "J", &AxisSample::work},
                                          {"loss", "J", &AxisSample::loss},
                                          {"imbalance", "J", &AxisSample::imbalance},
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

const std::string MAGIC = "snapwing trial checkpoint 1\n";
constexpr std::size_t DIGITS = 64;

class Writer {
 public:
  void number(double value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value)); }
  void vector(const Eigen::VectorXd& values) {
    number(static_cast<double>(values.size()));
    bytes_.append(reinterpret_cast<const char*>(values.data()), sizeof(double) * values.size());
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Reader {
 public:
  Reader(const std::string& bytes, const std::string& path) : bytes_(bytes), path_(path) {}
  double number() {
    double value = 0;
    take(&value, sizeof(value));
    return value;
  }
  std::size_t count() {
    const double value = number();
    if (!(value >= 0 && value <= static_cast<double>(bytes_.size()))) damaged();
    return static_cast<std::size_t>(value);
  }
  Eigen::VectorXd vector() {
    Eigen::VectorXd values(count());
    take(values.data(), sizeof(double) * values.size());
    return values;
  }

 private:
  void take(void* to, std::size_t size) {
    if (at_ + size > bytes_.size()) damaged();
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  [[noreturn]] void damaged() const { throw common::FileError(path_, "the checkpoint is damaged"); }

  const std::string& bytes_;
  const std::string& path_;
  std::size_t at_ = 0;
};

/// Numbers of a run beside its vectors, for both directions.
template <class Visit>
void eachNumber(AxisRun& run, const Visit& visit) {
  MotionState& s = run.state;
  for (double* value : {&s.time, &s.last_step, &s.next_step, &s.kinetic, &s.stored, &run.calm_since}) visit(*value);
  AxisOutcome& o = run.outcome;
  for (double* value : {&o.snap_time, &o.peak_travel, &o.least_travel, &o.end_travel, &o.peak_speed, &o.end_speed,
                        &o.settle_time, &o.largest_imbalance}) {
    visit(*value);
  }
}

void put(Writer& writer, const AxisRun& run) {
  AxisRun copy = run;
  eachNumber(copy, [&](double& value) { writer.number(value); });
  for (const int value : {static_cast<int>(run.outcome.start_mode), static_cast<int>(run.outcome.start_held),
                          run.outcome.steps, run.outcome.iterations, run.outcome.factorizations}) {
    writer.number(value);
  }
  for (const Eigen::VectorXd* values : {&run.state.z, &run.state.y, &run.state.v, &run.state.acceleration}) {
    writer.vector(*values);
  }
  writer.number(static_cast<double>(run.samples.size()));
  for (const AxisSample& sample : run.samples) {
    for (const Column& column : COLUMNS) writer.number(sample.*column.value);
    writer.number(sample.iterations);
  }
}

AxisRun take(Reader& reader) {
  AxisRun run;
  run.begun = true;
  eachNumber(run, [&](double& value) { value = reader.number(); });
  run.outcome.start_mode = static_cast<vehicle::Mode>(static_cast<int>(reader.number()));
  run.outcome.start_held = reader.number() != 0;
  for (int* value : {&run.outcome.steps, &run.outcome.iterations, &run.outcome.factorizations}) {
    *value = static_cast<int>(reader.number());
  }
  for (Eigen::VectorXd* values : {&run.state.z, &run.state.y, &run.state.v, &run.state.acceleration}) {
    *values = reader.vector();
  }
  const std::size_t samples = reader.count();
  for (std::size_t k = 0; k < samples; ++k) {
    AxisSample& sample = run.samples.emplace_back();
    for (const Column& column : COLUMNS) sample.*column.value = reader.number();
    sample.iterations = static_cast<int>(reader.number());
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

void saveSeries(const std::vector<AxisSample>& samples, const StaticCurve& curve, double whole,
                const std::map<std::string, std::string>& provenance, const std::string& path) {
  common::hdf5::writeFile(path, [&](hid_t file) {
    for (const Column& column : COLUMNS) {
      std::vector<double> values;
      for (const AxisSample& sample : samples) values.push_back(sample.*column.value);
      writeArray(file, column.name, values, column.unit, path);
    }
    Handle group(H5Gcreate2(file, "static_curve", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path,
                 "make a group");
    std::vector<double> travel, force;
    for (const StaticPoint& point : curve.points()) {
      travel.push_back(point.control);
      force.push_back(whole * point.force);
    }
    writeArray(group, "travel", travel, "m", path);
    writeArray(group, "force", force, "N", path);
    common::hdf5::writeProvenance(file, provenance, path);
  });
}

void saveTrialCheckpoint(const AxisRun& run, const std::string& hash, const std::string& path) {
  Writer writer;
  put(writer, run);
  common::writeFileAtomically(path, MAGIC + hash + common::sha256(writer.bytes()) + writer.bytes());
}

AxisRun loadTrialCheckpoint(const std::string& path, const std::string& hash) {
  const std::string file = common::readFile(path);
  if (file.size() < MAGIC.size() + 2 * DIGITS || file.compare(0, MAGIC.size(), MAGIC) != 0) {
    throw common::FileError(path, "no checkpoint of a trial of this version");
  }
  if (file.compare(MAGIC.size(), DIGITS, hash) != 0) {
    throw common::FileError(path, "the checkpoint belongs to another trial or vehicle; remove it to start anew");
  }
  const std::string bytes = file.substr(MAGIC.size() + 2 * DIGITS);
  if (file.compare(MAGIC.size() + DIGITS, DIGITS, common::sha256(bytes)) != 0) {
    throw common::FileError(path, "the checkpoint is damaged");
  }
  Reader reader(bytes, path);
  return take(reader);
}

}  // namespace snapwing::motion
