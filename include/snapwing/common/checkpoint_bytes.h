#pragma once
/// Bytes of checkpoints: numbers in the machine's own representation, so that a resumed run has the same bits. A file
/// begins with its kind, the program that wrote it, a hash of the inputs that it belongs to, and a hash of its bytes.

#include <string>
#include <utility>
#include <vector>

#include "snapwing/common/error.h"

namespace snapwing::common {

/// The checkpoint is valid but was written by another program: the run starts again and reports why.
class OtherProgramError : public FileError {
 public:
  /// @param wrote, reads  their names, of programOf()
  OtherProgramError(const std::string& path, const std::string& wrote, const std::string& reads);
};

class BytesWriter {
 public:
  void number(double value);
  /// Writes the count, then the values.
  void numbers(const double* values, std::size_t count);
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads the output of a BytesWriter in the same order. @throws FileError naming the file if it is too short
class BytesReader {
 public:
  /// @param path  of the file, for messages
  BytesReader(std::string bytes, std::string path) : bytes_(std::move(bytes)), path_(std::move(path)) {}
  double number();
  int integer() { return static_cast<int>(number()); }
  /// A count of items; refused if larger than the number of bytes.
  std::size_t count();
  /// Reads what BytesWriter::numbers wrote.
  std::vector<double> numbers();

 private:
  void take(void* to, std::size_t size);
  [[noreturn]] void damaged() const;

  std::string bytes_, path_;
  std::size_t at_ = 0;
};

/// Writes atomically. @param kind  first line of the file, whose last word is its version
/// @param program  of programOf(); @param owner  hash of the inputs, 64 digits. @throws FileError
void saveCheckpointBytes(const std::string& bytes, const std::string& kind, const std::string& program,
                         const std::string& owner, const std::string& path);
/// Reads such a file. @param what  end of the message for another owner, e.g. "another scene or to other settings"
/// @throws OtherProgramError if another program wrote it
/// @throws FileError if it is missing, of another kind, has another owner, or is damaged
std::string loadCheckpointBytes(const std::string& path, const std::string& kind, const std::string& program,
                                const std::string& owner, const std::string& what);

}  // namespace snapwing::common
