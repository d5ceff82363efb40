#include "snapwing/common/checkpoint_bytes.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "snapwing/common/error.h"
#include "snapwing/common/json_text.h"
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

namespace {

constexpr std::size_t DIGITS = 64;

/// Finds damage, for a small part of the time of a hash that withstands intent: four sums, each over every fourth word
/// of eight bytes. Each step is one to one, so a change within one word always shows.
std::string checksum(const std::string& bytes) {
  constexpr std::uint64_t ODD = 0x9e3779b97f4a7c15;
  constexpr std::size_t LANES = 4, BLOCK = LANES * sizeof(std::uint64_t);
  std::array<std::uint64_t, LANES> sum;
  for (std::size_t k = 0; k < LANES; ++k) sum[k] = bytes.size() + k;
  const auto add = [&sum](const char* block, std::size_t size) {
    std::array<std::uint64_t, LANES> word = {};
    std::memcpy(word.data(), block, size);
    for (std::size_t k = 0; k < LANES; ++k) {
      const std::uint64_t next = (sum[k] ^ word[k]) * ODD;
      sum[k] = next << 29 | next >> 35;
    }
  };
  std::size_t at = 0;
  for (; at + BLOCK <= bytes.size(); at += BLOCK) add(bytes.data() + at, BLOCK);
  add(bytes.data() + at, bytes.size() - at);
  char digits[DIGITS + 1];
  std::snprintf(digits, sizeof(digits), "%016llx%016llx%016llx%016llx", static_cast<unsigned long long>(sum[0]),
                static_cast<unsigned long long>(sum[1]), static_cast<unsigned long long>(sum[2]),
                static_cast<unsigned long long>(sum[3]));
  return digits;
}

/// Its line up to the version, the last word.
std::string withoutVersion(const std::string& kind) { return kind.substr(0, kind.rfind(' ') + 1); }

/// Takes the first line from the file. @return the line with its end; empty if the file has none
std::string takeLine(std::string* file) {
  const std::size_t end = file->find('\n');
  if (end == std::string::npos) return {};
  std::string line = file->substr(0, end + 1);
  file->erase(0, end + 1);
  return line;
}

}  // namespace

OtherProgramError::OtherProgramError(const std::string& path, const std::string& wrote, const std::string& reads)
    : FileError(path, "was written by another program (" + wrote + ", this is " + reads + ")") {}

void saveCheckpointBytes(const std::string& bytes, const std::string& kind, const std::string& program,
                         const std::string& owner, const std::string& path) {
  writeFileAtomically(path, kind + program + "\n" + owner + checksum(bytes) + bytes);
}

std::string loadCheckpointBytes(const std::string& path, const std::string& kind, const std::string& program,
                                const std::string& owner, const std::string& what) {
  std::string rest = readFile(path);
  const std::string found = takeLine(&rest);
  if (found != kind) {
    if (withoutVersion(found) != withoutVersion(kind)) throw FileError(path, "no checkpoint of this kind");
    throw OtherProgramError(path, "whose checkpoints have another format", program);
  }
  std::string wrote = takeLine(&rest);
  if (wrote.empty() || rest.size() < 2 * DIGITS) throw FileError(path, "the checkpoint is damaged");
  wrote.pop_back();
  if (wrote != program) throw OtherProgramError(path, shownBytes(wrote), program);
  if (rest.compare(0, DIGITS, owner) != 0) {
    throw FileError(path, "the checkpoint belongs to " + what + "; remove it to start again");
  }
  std::string bytes = rest.substr(2 * DIGITS);
  if (rest.compare(DIGITS, DIGITS, checksum(bytes)) != 0) throw FileError(path, "the checkpoint is damaged");
  return bytes;
}

}  // namespace snapwing::common
