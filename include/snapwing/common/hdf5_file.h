#pragma once
/// Common parts of all HDF5 files of snapwing: handles that close themselves, errors with the file's name, text
/// attributes. For source files that include <hdf5.h> anyway; no other header includes this one.

#include <hdf5.h>

#include <functional>
#include <map>
#include <string>

namespace snapwing::common::hdf5 {

/// Owns an HDF5 handle.
class Handle {
 public:
  /// @param id     returned by the library; negative = failed
  /// @param close  function that closes it
  /// @param path, what  file and action for the message. @throws FileError if `id` is negative
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& path, const std::string& what);
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: a handle is meant to be used as the library's id

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Suppresses HDF5's own error output during its lifetime.
struct QuietErrors {
  QuietErrors();
  ~QuietErrors();
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// @throws FileError "HDF5: cannot <what>" if the library reported a failure
void check(herr_t status, const std::string& path, const std::string& what);

/// Opens a file for reading. The caller should hold QuietErrors.
/// @throws FileError if it is missing, no regular file (a pipe has no random access), locked by a writer or no HDF5
hid_t openFile(const std::string& path);

/// Number of elements of a one-dimensional dataset. @throws FileError for another rank, or an implausible number
std::size_t sizeOf(hid_t dataset, const std::string& name, const std::string& path);

/// Reads a whole dataset. @param values  room for all elements of `type`, a type in memory
/// @throws FileError; where this library has not the filter that the data were written with, the filter's name
void readAll(hid_t dataset, hid_t type, void* values, const std::string& name, const std::string& path);

/// Text attribute of a group or dataset. @throws FileError
void writeAttribute(hid_t object, const std::string& name, const std::string& text, const std::string& path);
/// Reads a text attribute as written by snapwing or h5py, of fixed or variable length. @throws FileError otherwise
std::string readAttribute(hid_t object, const std::string& name, const std::string& path);

/// Writes the group `provenance`, one text attribute per entry. @throws FileError
void writeProvenance(hid_t file, const std::map<std::string, std::string>& entries, const std::string& path);
/// All attributes of an object as text; a single number is converted, an empty attribute is "". @throws FileError
std::map<std::string, std::string> readNotes(hid_t object, const std::string& path);
/// @throws FileError if the group is missing or an entry is neither one text nor one number
std::map<std::string, std::string> readProvenance(hid_t file, const std::string& path);

/// Calls `fill` on a file in memory, then writes its bytes by writeFileAtomically. HDF5 therefore never encounters a
/// full disk, after which it cannot close a file. Its own error output is suppressed. @throws FileError, and what
/// `fill` throws
void writeFile(const std::string& path, const std::function<void(hid_t file)>& fill);

}  // namespace snapwing::common::hdf5
