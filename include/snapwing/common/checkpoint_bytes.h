#pragma once
/// Bytes of checkpoints: numbers as the machine has them, since a resumed run must have the same bits. A file begins
/// with its kind, the program that wrote it, a hash of what it belongs to and one of its bytes.

#include <string>
#include <utility>
#include <vector>

#include "snapwing/common/error.h"

namespace snapwing::common {

/// A checkpoint of another program: nothing is wrong with it, but the run begins anew and says why.
class OtherProgramError : public FileError {
 public:
  /// @param wrote, reads  their names, of programOf()
  OtherProgramError(const std::string& path, const std::string& wrote, const std::string& reads);
};

class BytesWriter {
 public:
  void number(double value);
  /// With their count before them.
  void numbers(const double* values, std::size_t count);
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads what a BytesWriter wrote, in its order. @throws FileError naming the file if there is less
class BytesReader {
 public:
  /// @param path  of the file, for messages
  BytesReader(std::string bytes, std::string path) : bytes_(std::move(bytes)), path_(std::move(path)) {}
  double number();
  int integer() { return static_cast<int>(number()); }
  /// A count of things that each take at least a byte.
  std::size_t count();
  /// What numbers() wrote.
  std::vector<double> numbers();

 private:
  void take(void* to, std::size_t size);
  [[noreturn]] void damaged() const;

  std::string bytes_, path_;
  std::size_t at_ = 0;
};

/// @param kind  first line of the file, whose last word is its version; @param program  of programOf();
/// @param owner  64 digits. @throws FileError
void saveCheckpointBytes(const std::string& bytes, const std::string& kind, const std::string& program,
                         const std::string& owner, const std::string& path);
/// @param what  it must belong to, for the message, e.g. "another scene or to other settings"
/// @throws OtherProgramError if another program wrote it
/// @throws FileError if it is of another kind, belongs to something else or is damaged
std::string loadCheckpointBytes(const std::string& path, const std::string& kind, const std::string& program,
                                const std::string& owner, const std::string& what);

}  // namespace snapwing::common
