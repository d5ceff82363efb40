// HDF5 file of a wing table: one 1-D dataset per column with the attribute "unit", provenance as attributes of a group.
#include <hdf5.h>

#include "snapwing/common/error.h"
#include "snapwing/common/hdf5_file.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::vehicle {

using common::hdf5::check;
using common::hdf5::Handle;
using common::hdf5::QuietErrors;
using common::hdf5::readAttribute;
using common::hdf5::writeAttribute;

namespace {

constexpr char FORMAT[] = "snapwing_wing_table_3";

void writeColumn(hid_t file, const char* name, const char* unit, const std::vector<double>& values,
                 const std::string& path) {
  const hsize_t size = values.size();
  Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, path, "make a space");
  Handle settings(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path, "make settings");
  check(H5Pset_obj_track_times(settings, false), path, "leave the clock out");  // same input, same bytes
  Handle set(H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, settings, H5P_DEFAULT), H5Dclose, path,
             std::string("make the dataset ") + name);
  if (size > 0) {
    check(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path, "write a column");
  }
  writeAttribute(set, "unit", unit, path);
}

void readColumn(hid_t file, const char* name, const char* unit, std::vector<double>* values, const std::string& path) {
  Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, path, std::string("find the dataset ") + name);
  const std::string found = readAttribute(set, "unit", path);
  if (found != unit)
    throw common::FileError(path, std::string(name) + " is in '" + found + "'; allowed: '" + unit + "'");
  values->resize(common::hdf5::sizeOf(set, name, path));
  if (!values->empty()) common::hdf5::readAll(set, H5T_NATIVE_DOUBLE, values->data(), name, path);
}

void write(WingTable table, hid_t file, const std::string& path) {
  writeAttribute(file, "format", FORMAT, path);
  forEachColumn(&table, [&](const char* name, const char* unit, std::vector<double>* values) {
    writeColumn(file, name, unit, *values, path);
  });
  common::hdf5::writeProvenance(file, table.provenance, path);
}

}  // namespace

void saveWingTable(const WingTable& table, const std::string& path) {
  table.validate();
  common::hdf5::writeFile(path, [&](hid_t file) { write(table, file, path); });
}

WingTable loadWingTable(const std::string& path) {
  QuietErrors quiet;
  Handle file(common::hdf5::openFile(path), H5Fclose, path, "open the file as HDF5");
  const std::string format = readAttribute(file, "format", path);
  if (format != FORMAT) {
    throw common::FileError(path, "format is '" + format + "'; allowed: '" + FORMAT +
                                      "'; make the table again with `snapwing design wing`");
  }
  WingTable table;
  forEachColumn(&table, [&](const char* name, const char* unit, std::vector<double>* values) {
    readColumn(file, name, unit, values, path);
  });
  table.provenance = common::hdf5::readProvenance(file, path);
  try {
    table.validate();
  } catch (const common::Error& e) {
    throw common::FileError(path, e.what());
  }
  return table;
}

}  // namespace snapwing::vehicle
