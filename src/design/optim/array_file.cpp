#include "array_file.h"

#include <hdf5.h>

#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/common/hdf5_file.h"

namespace snapwing::design {

using common::hdf5::check;
using common::hdf5::Handle;
using common::hdf5::QuietErrors;
using common::hdf5::writeAttribute;

namespace {

void write(const ArrayFile& file, hid_t h5, const std::string& path) {
  for (const auto& [name, values] : file.arrays) {
    const hsize_t size = static_cast<hsize_t>(values.size());
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, path, "make a space");
    const Handle set(H5Dcreate2(h5, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose, path, "make " + name);
    if (size > 0) check(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path, "write");
  }
  for (const auto& [name, text] : file.notes) writeAttribute(h5, name, text, path);
}

herr_t collect(hid_t, const char* name, const H5L_info_t*, void* data) {
  static_cast<std::vector<std::string>*>(data)->emplace_back(name);
  return 0;
}

}  // namespace

void saveArrays(const ArrayFile& file, const std::string& path) {
  common::hdf5::writeFile(path, [&](hid_t h5) { write(file, h5, path); });
}

ArrayFile loadArrays(const std::string& path) {
  QuietErrors quiet;
  const Handle h5(common::hdf5::openFile(path), H5Fclose, path, "open (no HDF5 file?)");
  ArrayFile file;
  std::vector<std::string> names;
  check(H5Literate(h5, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names), path, "list");
  for (const std::string& name : names) {
    const Handle set(H5Dopen2(h5, name.c_str(), H5P_DEFAULT), H5Dclose, path, "open " + name);
    Eigen::VectorXd values(static_cast<Eigen::Index>(common::hdf5::sizeOf(set, name, path)));
    if (values.size() > 0) common::hdf5::readAll(set, H5T_NATIVE_DOUBLE, values.data(), name, path);
    file.arrays[name] = values;
  }
  file.notes = common::hdf5::readNotes(h5, path);
  return file;
}

}  // namespace snapwing::design
