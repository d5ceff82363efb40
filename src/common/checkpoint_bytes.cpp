#include "snapwing/common/checkpoint_bytes.h"

#include <cstring>

#include "snapwing/common/error.h"
#include "snapwing/common/output_file.h"
#include "snapwing/common/provenance.h"

namespace snapwing::common {

void BytesWriter::number(double value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value)); }

void BytesWriter::numbers(const double* values, std::size_t count) {
  number(static_cast<double>(count));
  bytes_.append(reinterpret_cast<const char*>(values), sizeof(double) * count);
}

double BytesReader::number() {
  double value = 0;
  take(&value, sizeof(value));
  return value;
}

std::size_t BytesReader::count() {
  const double value = number();
  if (!(value >= 0 && value <= static_cast<double>(bytes_.size()))) damaged();
  return static_cast<std::size_t>(value);
}

std::vector<double> BytesReader::numbers() {
  std::vector<double> values(count());
  take(values.data(), sizeof(double) * values.size());
  return values;
}

void BytesReader::take(void* to, std::size_t size) {
  if (at_ + size > bytes_.size()) damaged();
  if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
  at_ += size;
}

void BytesReader::damaged() const { throw FileError(path_, "the checkpoint is damaged"); }

void saveCheckpointBytes(const std::string& bytes, const std::string& kind, const std::string& owner,
                         const std::string& path) {
  writeFileAtomically(path, kind + owner + sha256(bytes) + bytes);
}

std::string loadCheckpointBytes(const std::string& path, const std::string& kind, const std::string& owner,
                                const std::string& what) {
  constexpr std::size_t DIGITS = 64;
  const std::string file = readFile(path);
  if (file.size() < kind.size() + 2 * DIGITS || file.compare(0, kind.size(), kind) != 0) {
    throw FileError(path, "no checkpoint of this version");
  }
  if (file.compare(kind.size(), DIGITS, owner) != 0) {
    throw FileError(path, "the checkpoint belongs to " + what + "; remove it to start again");
  }
  std::string bytes = file.substr(kind.size() + 2 * DIGITS);
  if (file.compare(kind.size() + DIGITS, DIGITS, sha256(bytes)) != 0) {
    throw FileError(path, "the checkpoint is damaged");
  }
  return bytes;
}

}  // namespace snapwing::common
