#include "snapwing/design/array_file.h"

#include <hdf5.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <vector>

#include "snapwing/common/error.h"

namespace snapwing::design {

namespace {

class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& path, const std::string& what) : id_(id), close_(close) {
    if (id_ < 0) throw common::FileError(path, "HDF5: cannot " + what);
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: a handle is meant to be used as the library's id

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void check(herr_t status, const std::string& path, const std::string& what) {
  if (status < 0) throw common::FileError(path, "HDF5: cannot " + what);
}

void write(const ArrayFile& file, const std::string& path) {
  const Handle h5(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose, path, "create");
  for (const auto& [name, values] : file.arrays) {
    const hsize_t size = static_cast<hsize_t>(values.size());
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, path, "make a space");
    const Handle set(H5Dcreate2(h5, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose, path, "make " + name);
    if (size > 0) check(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path, "write");
  }
  for (const auto& [name, text] : file.notes) {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, path, "make a type");
    check(H5Tset_size(type, text.size() + 1), path, "size a type");
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose, path, "make a space");
    const Handle attribute(H5Acreate2(h5, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, path,
                           "make the note " + name);
    check(H5Awrite(attribute, type, text.c_str()), path, "write the note " + name);
  }
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
  const std::string temporary = path + ".part" + std::to_string(::getpid());
  write(file, temporary);
  if (std::rename(temporary.c_str(), path.c_str()) != 0) {
    std::remove(temporary.c_str());
    throw common::FileError(path, "cannot be written");
  }
}

ArrayFile loadArrays(const std::string& path) {
  if (!std::filesystem::exists(path)) throw common::FileError(path, "does not exist");
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
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
  for (const std::string& name : notes) {
    const Handle attribute(H5Aopen(h5, name.c_str(), H5P_DEFAULT), H5Aclose, path, "open " + name);
    const Handle type(H5Aget_type(attribute), H5Tclose, path, "read the type of " + name);
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0) continue;
    std::string text(H5Tget_size(type), '\0');
    check(H5Aread(attribute, type, text.data()), path, "read " + name);
    file.notes[name] = text.substr(0, text.find('\0'));
  }
  return file;
}

}  // namespace snapwing::design
