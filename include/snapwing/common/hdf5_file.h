#pragma once
/// What every HDF5 file of snapwing shares: handles that close themselves, errors with the file's name, text
/// attributes. For source files that include <hdf5.h> anyway; no other header includes this one.

#include <hdf5.h>

#include <functional>
#include <map>
#include <string>

namespace snapwing::common::hdf5 {

/// Closes an HDF5 handle at the end of its life.
class Handle {
 public:
  /// @param id    what the library returned; negative = failed
  /// @param path  file, and @param what action, for the message of the FileError thrown if `id` is negative
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& path, const std::string& what);
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: a handle is meant to be used as the library's id

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Keeps HDF5 from printing its own errors while it lives.
struct QuietErrors {
  QuietErrors();
  ~QuietErrors();
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// @throws FileError "HDF5: cannot <what>" if the library reported failure
void check(herr_t status, const std::string& path, const std::string& what);

/// Opens a file for reading. HDF5 prints nothing from then on where the caller holds QuietErrors.
/// @throws FileError if it is missing, no plain file (a pipe cannot be searched), locked by a writer or no HDF5
hid_t openFile(const std::string& path);

/// Number of elements of a dataset of one dimension. @throws FileError for another rank or more than can be meant
std::size_t sizeOf(hid_t dataset, const std::string& name, const std::string& path);

/// Reads a whole dataset. @param values  room for all elements of `type`, a type in memory
/// @throws FileError; where this library has not the filter that the data were written with, the filter's name
void readAll(hid_t dataset, hid_t type, void* values, const std::string& name, const std::string& path);

/// Text attribute of a group or dataset. @throws FileError
void writeAttribute(hid_t object, const std::string& name, const std::string& text, const std::string& path);
/// Reads what snapwing and h5py write: one text of fixed or variable length. @throws FileError for anything else
std::string readAttribute(hid_t object, const std::string& name, const std::string& path);

/// Group `provenance` of a file, one text attribute per entry. @throws FileError
void writeProvenance(hid_t file, const std::map<std::string, std::string>& entries, const std::string& path);
/// All attributes of an object as text; one number is written out, "" stands for none. @throws FileError
std::map<std::string, std::string> readNotes(hid_t object, const std::string& path);
/// @throws FileError if the group is missing or an entry is neither one text nor one number
std::map<std::string, std::string> readProvenance(hid_t file, const std::string& path);

/// Has `fill` make a file in memory, then writes its bytes as writeFileAtomically does: HDF5 itself never meets a full
/// disk, after which it cannot even close a file. It prints nothing meanwhile. @throws FileError, also what `fill`
/// throws
void writeFile(const std::string& path, const std::function<void(hid_t file)>& fill);

}  // namespace snapwing::common::hdf5
