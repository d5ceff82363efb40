#include "snapwing/design/array_file.h"

#include <hdf5.h>

#include <filesystem>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/common/hdf5_file.h"

namespace snapwing::design {

using common::hdf5::check;
using common::hdf5::Handle;
using common::hdf5::QuietErrors;
using common::hdf5::readAttribute;
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

herr_t collectNotes(hid_t, const char* name, const H5A_info_t*, void* data) {
  static_cast<std::vector<std::string>*>(data)->emplace_back(name);
  return 0;
}

}  // namespace

void saveArrays(const ArrayFile& file, const std::string& path) {
  common::hdf5::writeFile(path, [&](hid_t h5) { write(file, h5, path); });
}

ArrayFile loadArrays(const std::string& path) {
  if (!std::filesystem::exists(path)) throw common::FileError(path, "does not exist");
  QuietErrors quiet;
  const Handle h5(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, path, "open (no HDF5 file?)");
  ArrayFile file;
  std::vector<std::string> names, notes;
  check(H5Literate(h5, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names), path, "list");
  check(H5Aiterate2(h5, H5_INDEX_NAME, H5_ITER_INC, nullptr, collectNotes, &notes), path, "list notes");
  for (const std::string& name : names) {
    const Handle set(H5Dopen2(h5, name.c_str(), H5P_DEFAULT), H5Dclose, path, "open " + name);
    const Handle space(H5Dget_space(set), H5Sclose, path, "read the size of " + name);
    Eigen::VectorXd values(H5Sget_simple_extent_npoints(space));
    if (values.size() > 0) {
      check(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path, "read " + name);
    }
    file.arrays[name] = values;
  }
  for (const std::string& name : notes) file.notes[name] = readAttribute(h5, name, path);
  return file;
}

}  // namespace snapwing::design
