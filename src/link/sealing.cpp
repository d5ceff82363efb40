#include "snapwing/link/sealing.h"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

constexpr char LABEL[] = "snapwing link 2";
constexpr std::size_t DIGITS = 64;

static_assert(crypto_auth_KEYBYTES == std::tuple_size<Key>::value, "key size of crypto_auth");
static_assert(crypto_auth_BYTES == sizeof(snapwing_lcm::sealed_t::mac), "code size of crypto_auth");

void startSodium() {
  if (sodium_init() < 0) throw common::Error("libsodium cannot start");
}

}  // namespace

void createKeyFile(const std::string& path) {
  startSodium();
  Key key;
  randombytes_buf(key.data(), key.size());
  std::array<char, DIGITS + 2> text{};
  sodium_bin2hex(text.data(), DIGITS + 1, key.data(), key.size());
  text[DIGITS] = '\n';
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) throw common::FileError(path, std::string("cannot create key: ") + std::strerror(errno));
  const bool written = write(file, text.data(), DIGITS + 1) == static_cast<ssize_t>(DIGITS + 1) && fsync(file) == 0;
  close(file);
  if (!written) {
    unlink(path.c_str());
    throw common::FileError(path, "cannot write key");
  }
}

Key loadKeyFile(const std::string& path) {
  startSodium();
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    throw common::FileError(path, std::string("cannot read key: ") + std::strerror(errno) +
                                      " (make one with `radio_bridge --create-key FILE`)");
  }
  struct stat info {};
  std::array<char, DIGITS + 2> text{};
  const bool known = fstat(file, &info) == 0;
  const ssize_t got = read(file, text.data(), text.size());
  close(file);
  if (!known || (info.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    throw common::FileError(path, "key is open to group or others; allowed: permissions 0600");
  }
  Key key;
  std::size_t size = 0;
  const bool right_length =
      got == static_cast<ssize_t>(DIGITS) || (got == static_cast<ssize_t>(DIGITS + 1) && text[DIGITS] == '\n');
  if (!right_length || sodium_hex2bin(key.data(), key.size(), text.data(), DIGITS, nullptr, &size, nullptr) != 0 ||
      size != key.size()) {
    throw common::FileError(path, "not a key: 64 hexadecimal digits expected");
  }
  return key;
}

std::string defaultKeyFile(const std::string& vehicle_id) {
  const char* home = std::getenv("HOME");
  std::string name = vehicle_id;
  std::replace(name.begin(), name.end(), '/', '_');
  return std::string(home != nullptr ? home : "/root") + "/.ros/snapwing_link_" + name + ".key";
}

std::array<std::uint8_t, 32> authenticationCode(const Key& key, std::string_view label,
                                                std::initializer_list<std::string_view> parts) {
  crypto_auth_hmacsha512256_state state;
  crypto_auth_hmacsha512256_init(&state, key.data(), key.size());
  const auto add = [&state](const void* bytes, std::size_t size) {
    crypto_auth_hmacsha512256_update(&state, static_cast<const unsigned char*>(bytes), size);
  };
  const auto addPart = [&add](std::string_view part) {
    std::array<std::uint8_t, 8> length{};  // little endian
    for (std::size_t i = 0; i < length.size(); ++i) length[i] = static_cast<std::uint8_t>(part.size() >> 8 * i);
    add(length.data(), length.size());
    add(part.data(), part.size());
  };
  addPart(label);
  for (const std::string_view part : parts) addPart(part);
  std::array<std::uint8_t, 32> code{};
  crypto_auth_hmacsha512256_final(&state, code.data());
  return code;
}

bool sameCode(const std::array<std::uint8_t, 32>& a, const std::array<std::uint8_t, 32>& b) {
  return sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

Sealer::Sealer(const Key& key, const std::string& vehicle_id) : key_(key), vehicle_id_(vehicle_id) {
  startSodium();
  const bool good = std::all_of(vehicle_id.begin(), vehicle_id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::strchr("_-./", c) != nullptr;
  });
  if (good && !vehicle_id.empty() && vehicle_id.size() <= sizeof snapwing_lcm::sealed_t::vehicle) return;
  throw common::SettingError("radio link", "vehicle_id", vehicle_id,
                             "1 to 32 characters: letters, digits, '_', '-', '.', '/'");
}

std::array<std::uint8_t, 32> Sealer::code(const std::string& channel, const snapwing_lcm::sealed_t& sealed) const {
  const auto text = [](const std::uint8_t* bytes, std::size_t size) {
    return std::string_view(reinterpret_cast<const char*>(bytes), size);
  };
  return authenticationCode(key_, LABEL,
                            {text(sealed.vehicle, sizeof sealed.vehicle), channel,
                             text(sealed.payload, static_cast<std::size_t>(sealed.payload_size))});
}

bool Sealer::seal(const std::string& channel, const std::uint8_t* payload, std::size_t size,
                  snapwing_lcm::sealed_t& out) const {
  if (size > sizeof out.payload) return false;
  out.version = snapwing_lcm::sealed_t::VERSION;
  out.payload_size = static_cast<int>(size);
  std::memset(out.vehicle, 0, sizeof out.vehicle);
  std::memcpy(out.vehicle, vehicle_id_.data(), vehicle_id_.size());
  std::memset(out.payload, 0, sizeof out.payload);
  std::memcpy(out.payload, payload, size);
  const auto mac = code(channel, out);
  std::copy(mac.begin(), mac.end(), out.mac);
  return true;
}

bool Sealer::verify(const std::string& channel, const snapwing_lcm::sealed_t& sealed) const {
  if (sealed.version != snapwing_lcm::sealed_t::VERSION || sealed.payload_size < 0) return false;
  if (static_cast<std::size_t>(sealed.payload_size) > sizeof sealed.payload) return false;
  std::array<std::uint8_t, sizeof sealed.vehicle> own{};
  std::copy(vehicle_id_.begin(), vehicle_id_.end(), own.begin());
  if (std::memcmp(own.data(), sealed.vehicle, own.size()) != 0) return false;
  std::array<std::uint8_t, sizeof sealed.mac> theirs{};
  std::copy(std::begin(sealed.mac), std::end(sealed.mac), theirs.begin());
  return sameCode(code(channel, sealed), theirs);
}

Envelope Sealer::open(const std::string& channel, const void* bytes, std::size_t size,
                      snapwing_lcm::sealed_t& sealed) const {
  const bool decoded = size <= 4096 && sealed.decode(bytes, 0, static_cast<int>(size)) == static_cast<int>(size);
  if (decoded && verify(channel, sealed)) return Envelope::GOOD;
  const int version = claimedVersion(bytes, size);
  if (version != 0 && version != snapwing_lcm::sealed_t::VERSION) return Envelope::OTHER_VERSION;
  const std::string theirs = decoded ? vehicleOf(sealed) : "";
  return !theirs.empty() && theirs != vehicle_id_ ? Envelope::OTHER_VEHICLE : Envelope::BAD;
}

int Sealer::claimedVersion(const void* bytes, std::size_t size) {
  constexpr std::size_t FINGERPRINT = 8, LEAST = 256;
  constexpr int SENSIBLE = 1000;
  if (size < LEAST) return 0;
  int version = 0;
  for (std::size_t i = FINGERPRINT; i < FINGERPRINT + 4; ++i) {
    const int byte = static_cast<const std::uint8_t*>(bytes)[i];
    if (version > SENSIBLE) return 0;
    version = version << 8 | byte;
  }
  return version >= 1 && version <= SENSIBLE ? version : 0;
}

std::string vehicleOf(const snapwing_lcm::sealed_t& sealed) {
  std::string name;
  for (const std::uint8_t byte : sealed.vehicle) {
    if (byte == 0) break;
    name += byte > ' ' && byte < 127 ? static_cast<char>(byte) : '?';
  }
  return name;
}

}  // namespace snapwing::link
