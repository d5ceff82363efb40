#include "snapwing/common/hdf5_file.h"

#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/common/output_file.h"

namespace snapwing::common::hdf5 {

Handle::Handle(hid_t id, herr_t (*close)(hid_t), const std::string& path, const std::string& what)
    : id_(id), close_(close) {
  if (id_ < 0) throw FileError(path, "HDF5: cannot " + what);
}

QuietErrors::QuietErrors() {
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietErrors::~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

void check(herr_t status, const std::string& path, const std::string& what) {
  if (status < 0) throw FileError(path, "HDF5: cannot " + what);
}

void writeAttribute(hid_t object, const std::string& name, const std::string& text, const std::string& path) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, path, "make a type");
  check(H5Tset_size(type, text.size() + 1), path, "size a type");
  Handle space(H5Screate(H5S_SCALAR), H5Sclose, path, "make a space");
  Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, path,
                   "make the attribute " + name);
  check(H5Awrite(attribute, type, text.c_str()), path, "write the attribute " + name);
}

std::string readAttribute(hid_t object, const std::string& name, const std::string& path) {
  Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, path, "find the attribute " + name);
  Handle type(H5Aget_type(attribute), H5Tclose, path, "read the type of " + name);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0) {
    throw FileError(path, "attribute " + name + " is no text");
  }
  std::string text(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, text.data()), path, "read the attribute " + name);
  return text.substr(0, text.find('\0'));
}

void writeProvenance(hid_t file, const std::map<std::string, std::string>& entries, const std::string& path) {
  Handle group(H5Gcreate2(file, "provenance", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path, "make a group");
  for (const auto& [name, text] : entries) writeAttribute(group, name, text, path);
}

std::map<std::string, std::string> readProvenance(hid_t file, const std::string& path) {
  Handle group(H5Gopen2(file, "provenance", H5P_DEFAULT), H5Gclose, path, "find the group provenance");
  std::vector<std::string> names;
  const auto add_name = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->push_back(name);
    return 0;
  };
  check(H5Aiterate2(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, add_name, &names), path, "list the provenance");
  std::map<std::string, std::string> entries;
  for (const std::string& name : names) entries[name] = readAttribute(group, name, path);
  return entries;
}

void writeFile(const std::string& path, const std::function<void(hid_t file)>& fill) {
  QuietErrors quiet;
  std::string bytes;
  {
    Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, path, "make settings");
    check(H5Pset_fapl_core(access, std::size_t{1} << 18, 0), path, "keep the file in memory");
    Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, path, "make the file in memory");
    fill(file);
    check(H5Fflush(file, H5F_SCOPE_GLOBAL), path, "flush the file");
    const ssize_t size = H5Fget_file_image(file, nullptr, 0);
    if (size <= 0) throw FileError(path, "HDF5: cannot tell the file's size");
    bytes.resize(static_cast<std::size_t>(size));
    if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size)
      throw FileError(path, "HDF5: cannot copy the file");
  }
  writeFileAtomically(path, bytes);
}

}  // namespace snapwing::common::hdf5
