#include "snapwing/common/hdf5_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/common/output_file.h"
#include "snapwing/common/plain_text.h"

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

namespace {

/// True if another program holds the file open for writing: HDF5 locks it then, and its own message says nothing of it.
bool lockedByAWriter(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool locked = flock(file, LOCK_SH | LOCK_NB) < 0 && errno == EWOULDBLOCK;
  close(file);
  return locked;
}

/// What HDF5 itself found wrong when it tried to open a file, as far as it helps a user; else empty.
std::string whyNotOpened() {
  bool truncated = false;
  const auto look = [](unsigned, const H5E_error2_t* error, void* found) -> herr_t {
    if (error->min_num == H5E_TRUNCATED) *static_cast<bool*>(found) = true;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, look, &truncated);
  return truncated ? "is cut off: it is shorter than its own header says" : "";
}

}  // namespace

hid_t openFile(const std::string& path) {
  std::error_code none;
  const std::filesystem::file_status status = std::filesystem::status(path, none);
  if (!std::filesystem::exists(status)) throw FileError(path, "does not exist");
  if (!std::filesystem::is_regular_file(status))
    throw FileError(path, "is not a regular file; HDF5 is read from files only");
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file >= 0) return file;
  if (const std::string why = whyNotOpened(); !why.empty()) throw FileError(path, why);
  if (lockedByAWriter(path)) {
    throw FileError(path, "is locked: another program has it open for writing; allowed: a file that no program writes");
  }
  if (std::filesystem::file_size(path, none) == 0) throw FileError(path, "is empty");
  if (access(path.c_str(), R_OK) != 0) throw FileError(path, "cannot be read: " + std::string(std::strerror(errno)));
  throw FileError(path, "is not an HDF5 file, or is truncated within its header");
}

std::size_t sizeOf(hid_t dataset, const std::string& name, const std::string& path) {
  constexpr hssize_t MOST = 100000000;  // what a damaged header may claim is no reason to ask for memory
  const Handle space(H5Dget_space(dataset), H5Sclose, path, "read the size of " + name);
  const hssize_t size = H5Sget_simple_extent_npoints(space);
  if (H5Sget_simple_extent_ndims(space) != 1 || size < 0) throw FileError(path, "'" + name + "' is not a 1-D array");
  if (size > MOST) {
    throw FileError(path,
                    "'" + name + "' has " + std::to_string(size) + " elements; allowed: 0 .. " + std::to_string(MOST));
  }
  return static_cast<std::size_t>(size);
}

namespace {

/// Name of a filter that the data need and this library has not; "" if it has all.
std::string missingFilter(hid_t dataset, const std::string& path) {
  const Handle settings(H5Dget_create_plist(dataset), H5Pclose, path, "read the settings of a dataset");
  for (int i = 0; i < H5Pget_nfilters(settings); ++i) {
    std::array<char, 64> name{};
    std::size_t values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(settings, static_cast<unsigned>(i), nullptr, &values, nullptr,
                                               name.size(), name.data(), nullptr);
    if (filter >= 0 && H5Zfilter_avail(filter) <= 0) {
      name.back() = 0;
      return name[0] != 0 ? name.data() : "number " + std::to_string(filter);
    }
  }
  return "";
}

}  // namespace

void readAll(hid_t dataset, hid_t type, void* values, const std::string& name, const std::string& path) {
  if (H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0) return;
  const std::string filter = missingFilter(dataset, path);
  if (filter.empty()) check(-1, path, "read " + name);
  throw FileError(path, "'" + name + "' is compressed by the filter '" + filter +
                            "', which this HDF5 library has not; allowed: none, deflate ('gzip' in h5py), shuffle");
}

namespace {

/// One attribute with its type and the number of its elements.
class Attribute {
 public:
  Attribute(hid_t object, const std::string& name, const std::string& path)
      : name_(name),
        path_(path),
        id_(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, path, "find the attribute " + name),
        type_(H5Aget_type(id_), H5Tclose, path, "read the type of " + name),
        space_(H5Aget_space(id_), H5Sclose, path, "read the size of " + name),
        count_(H5Sget_simple_extent_npoints(space_)) {}

  bool empty() const { return count_ == 0; }
  bool isText() const { return H5Tget_class(type_) == H5T_STRING && count_ == 1; }
  bool isNumber() const {
    const H5T_class_t kind = H5Tget_class(type_);
    return (kind == H5T_INTEGER || kind == H5T_FLOAT) && count_ == 1;
  }
  std::string text() const { return H5Tis_variable_str(type_) > 0 ? variableText() : fixedText(); }
  double number() const {
    double value = 0;
    check(H5Aread(id_, H5T_NATIVE_DOUBLE, &value), path_, "read the attribute " + name_);
    return value;
  }

 private:
  std::string fixedText() const {
    std::string text(H5Tget_size(type_), '\0');
    check(H5Aread(id_, type_, text.data()), path_, "read the attribute " + name_);
    text.resize(std::min(text.find('\0'), text.size()));
    if (H5Tget_strpad(type_) == H5T_STR_SPACEPAD) text.resize(text.find_last_not_of(' ') + 1);
    return text;
  }
  std::string variableText() const {
    char* text = nullptr;
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, path_, "make a type");
    check(H5Tset_size(type, H5T_VARIABLE), path_, "size a type");
    check(H5Tset_cset(type, H5Tget_cset(type_)), path_, "set the encoding of a type");
    check(H5Aread(id_, type, &text), path_, "read the attribute " + name_);
    const std::string result = text != nullptr ? text : "";
    H5free_memory(text);
    return result;
  }

  const std::string &name_, &path_;
  Handle id_, type_, space_;
  hssize_t count_;
};

}  // namespace

std::string readAttribute(hid_t object, const std::string& name, const std::string& path) {
  const Attribute attribute(object, name, path);
  if (!attribute.isText()) throw FileError(path, "attribute " + name + " is not text");
  return attribute.text();
}

std::map<std::string, std::string> readNotes(hid_t object, const std::string& path) {
  std::vector<std::string> names;
  const auto add_name = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->push_back(name);
    return 0;
  };
  check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, add_name, &names), path, "list the attributes");
  std::map<std::string, std::string> notes;
  for (const std::string& name : names) {
    const Attribute attribute(object, name, path);
    const bool good = attribute.empty() || attribute.isText() || attribute.isNumber();
    if (!good) throw FileError(path, "attribute " + name + " is neither one text nor one number");
    notes[name] = attribute.empty() ? "" : attribute.isText() ? attribute.text() : toText(attribute.number());
  }
  return notes;
}

void writeProvenance(hid_t file, const std::map<std::string, std::string>& entries, const std::string& path) {
  Handle group(H5Gcreate2(file, "provenance", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path, "make a group");
  for (const auto& [name, text] : entries) writeAttribute(group, name, text, path);
}

std::map<std::string, std::string> readProvenance(hid_t file, const std::string& path) {
  Handle group(H5Gopen2(file, "provenance", H5P_DEFAULT), H5Gclose, path, "find the group provenance");
  return readNotes(group, path);
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
    if (size <= 0) throw FileError(path, "HDF5: cannot determine the file's size");
    bytes.resize(static_cast<std::size_t>(size));
    if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size)
      throw FileError(path, "HDF5: cannot copy the file");
  }
  writeFileAtomically(path, bytes);
}

}  // namespace snapwing::common::hdf5
