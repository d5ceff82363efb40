// HDF5 layout: one 1-D dataset per array with the attribute "unit", group "shapes" with flat arrays, and one string
// attribute per provenance entry on the group "provenance"; where trials taught something, also a group "motion".
#include <hdf5.h>

#include <functional>
#include <optional>
#include <utility>

#include "snapwing/common/error.h"
#include "snapwing/common/hdf5_file.h"
#include "snapwing/vehicle/force_curve_file.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/motion_columns.h"

namespace snapwing::vehicle {

using common::hdf5::check;
using common::hdf5::Handle;
using common::hdf5::QuietErrors;
using common::hdf5::readAttribute;
using common::hdf5::writeAttribute;

namespace {

constexpr int FORMAT_VERSION = 2;

template <class T>
hid_t memoryType();
template <>
hid_t memoryType<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t memoryType<int>() {
  return H5T_NATIVE_INT;
}

template <class T>
void writeArray(hid_t file, const std::string& name, const std::vector<T>& values, const std::string& unit,
                const std::string& path) {
  const hsize_t size = values.size();
  Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, path, "make a space");
  Handle settings(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path, "make settings");
  check(H5Pset_obj_track_times(settings, false), path, "leave the clock out");  // same input, same bytes
  if (size > 1000) {
    check(H5Pset_chunk(settings, 1, &size), path, "set chunks");
    check(H5Pset_shuffle(settings), path, "set shuffling");
    check(H5Pset_deflate(settings, 6), path, "set compression");
  }
  const hid_t type = memoryType<T>();
  Handle set(H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, settings, H5P_DEFAULT), H5Dclose, path,
             "make the dataset " + name);
  if (size > 0) check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path, "write " + name);
  writeAttribute(set, "unit", unit, path);
}

template <class T>
std::vector<T> readArray(hid_t file, const std::string& name, const std::string& unit, const std::string& path) {
  Handle set(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, path, "find the dataset " + name);
  const std::string found = readAttribute(set, "unit", path);
  if (found != unit) throw common::FileError(path, "'" + name + "' is in '" + found + "'; allowed: '" + unit + "'");
  std::vector<T> values(common::hdf5::sizeOf(set, name, path));
  if (!values.empty()) common::hdf5::readAll(set, memoryType<T>(), values.data(), name, path);
  return values;
}

using Loops = std::vector<std::vector<std::array<double, 2>>>;

void append(const Loops& loops, std::vector<double>* flat) {
  for (const auto& loop : loops) {
    for (const auto& point : loop) flat->insert(flat->end(), point.begin(), point.end());
  }
}

void writeShapes(hid_t file, const ArmShapes& shapes, const std::string& path) {
  std::vector<int> sizes;
  for (const auto& loop : shapes.rest) sizes.push_back(static_cast<int>(loop.size()));
  std::vector<double> rest, moved;
  append(shapes.rest, &rest);
  for (const Loops& loops : shapes.moved) append(loops, &moved);
  Handle group(H5Gcreate2(file, "shapes", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path, "make a group");
  writeArray(group, "loop_sizes", sizes, "1", path);
  writeArray(group, "rest", rest, "m", path);
  writeArray(group, "moved", moved, "m", path);
}

Loops takeLoops(const std::vector<int>& sizes, const double** next) {
  Loops loops;
  for (const int size : sizes) {
    loops.emplace_back(size);
    for (auto& point : loops.back()) {
      point = {(*next)[0], (*next)[1]};
      *next += 2;
    }
  }
  return loops;
}

ArmShapes readShapes(hid_t file, std::size_t points, const std::string& path) {
  Handle group(H5Gopen2(file, "shapes", H5P_DEFAULT), H5Gclose, path, "find the group shapes");
  const auto sizes = readArray<int>(group, "loop_sizes", "1", path);
  const auto rest = readArray<double>(group, "rest", "m", path);
  const auto moved = readArray<double>(group, "moved", "m", path);
  std::size_t total = 0;
  for (const int size : sizes) {
    if (size < 0) throw common::FileError(path, "shapes/loop_sizes holds a negative size");
    total += 2 * static_cast<std::size_t>(size);
  }
  if (rest.size() != total || (!moved.empty() && moved.size() != total * points)) {
    throw common::FileError(path, "the shapes' sizes do not fit together");
  }
  ArmShapes shapes;
  const double* next = rest.data();
  shapes.rest = takeLoops(sizes, &next);
  next = moved.data();
  for (std::size_t k = 0; k < points && !moved.empty(); ++k) shapes.moved.push_back(takeLoops(sizes, &next));
  return shapes;
}

void writeTable(const ForceTable& t, hid_t file, const std::string& path) {
  writeArray<int>(file, "format_version", {FORMAT_VERSION}, "1", path);
  writeArray<int>(file, "arm_count", {t.arm_count}, "1", path);
  writeArray(file, "travel", t.travel, "m", path);
  writeArray(file, "force", t.force, "N", path);
  writeArray(file, "stiffness", t.stiffness, "N/m", path);
  writeArray(file, "energy", t.energy, "J", path);
  writeArray(file, "rotation", t.rotation, "rad", path);
  writeArray(file, "min_det_f", t.min_det_f, "1", path);
  writeArray(file, "stable", t.stable, "1", path);
  writeArray(file, "iterations", t.iterations, "1", path);
  writeArray(file, "kinetic_mass", t.kinetic_mass, "kg", path);
  writeArray(file, "coupled_mass", t.coupled_mass, "kg", path);
  writeArray<double>(file, "mass", {t.mass}, "kg", path);
  writeArray(file, "force_back", t.force_back, "N", path);
  writeShapes(file, t.shapes, path);
  common::hdf5::writeProvenance(file, t.provenance, path);
}

std::optional<MotionColumns> readMotion(hid_t file, std::size_t points, const std::string& path) {
  const htri_t there = H5Lexists(file, "motion", H5P_DEFAULT);
  if (there <= 0) return std::nullopt;
  Handle group(H5Gopen2(file, "motion", H5P_DEFAULT), H5Gclose, path, "find the group motion");
  MotionColumns motion;
  motion.effective_mass = readArray<double>(group, "effective_mass", "kg", path);
  motion.static_mass = readArray<double>(group, "static_mass", "kg", path);
  motion.damping = readArray<double>(group, "damping", "N s/m", path);
  const auto covered = readArray<double>(group, "covered", "m", path);
  if (covered.size() != 2) throw common::FileError(path, "motion/covered does not have two travels");
  motion.covered_from = covered[0], motion.covered_to = covered[1];
  motion.validate(points);
  return motion;
}

ForceTable load(const std::string& path, bool with_shapes, std::optional<MotionColumns>* motion = nullptr) {
  QuietErrors quiet;
  Handle file(common::hdf5::openFile(path), H5Fclose, path, "open the file as HDF5");
  const auto format = readArray<int>(file, "format_version", "1", path);
  if (format != std::vector<int>{FORMAT_VERSION}) {
    throw common::FileError(
        path, "format_version is " + (format.empty() ? "missing" : std::to_string(format[0])) +
                  "; allowed: " + std::to_string(FORMAT_VERSION) +
                  ", which holds the arm's inertia; make the table again with `snapwing curve VEHICLE.yaml "
                  "-o TABLE.h5` (the shipped ones: scripts/make_tables)");
  }
  ForceTable t;
  const auto arms = readArray<int>(file, "arm_count", "1", path);
  if (arms.size() != 1) throw common::FileError(path, "arm_count is not a single number");
  t.arm_count = arms[0];
  t.travel = readArray<double>(file, "travel", "m", path);
  t.force = readArray<double>(file, "force", "N", path);
  t.stiffness = readArray<double>(file, "stiffness", "N/m", path);
  t.energy = readArray<double>(file, "energy", "J", path);
  t.rotation = readArray<double>(file, "rotation", "rad", path);
  t.min_det_f = readArray<double>(file, "min_det_f", "1", path);
  t.stable = readArray<int>(file, "stable", "1", path);
  t.iterations = readArray<int>(file, "iterations", "1", path);
  t.kinetic_mass = readArray<double>(file, "kinetic_mass", "kg", path);
  t.coupled_mass = readArray<double>(file, "coupled_mass", "kg", path);
  const auto mass = readArray<double>(file, "mass", "kg", path);
  if (mass.size() != 1) throw common::FileError(path, "mass is not a single number");
  t.mass = mass[0];
  t.force_back = readArray<double>(file, "force_back", "N", path);
  if (with_shapes) t.shapes = readShapes(file, t.travel.size(), path);
  t.provenance = common::hdf5::readProvenance(file, path);
  try {
    t.validate();
    std::optional<MotionColumns> taught = readMotion(file, t.travel.size(), path);
    if (motion != nullptr) *motion = std::move(taught);
  } catch (const common::FileError&) {
    throw;
  } catch (const common::Error& e) {
    throw common::FileError(path, e.what());
  }
  return t;
}

}  // namespace

void saveForceTable(const ForceTable& table, const std::string& path) {
  table.validate();
  common::hdf5::writeFile(path, [&](hid_t file) { writeTable(table, file, path); });
}

ForceTable loadForceTable(const std::string& path) { return load(path, true); }

std::optional<MotionColumns> loadMotionColumns(const std::string& path) {
  std::optional<MotionColumns> motion;
  load(path, false, &motion);
  return motion;
}

ForceTable loadForceCurve(const std::string& path) { return load(path, false); }

}  // namespace snapwing::vehicle
