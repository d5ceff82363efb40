#include "snapwing/link/sealing.h"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

constexpr char LABEL[] = "snapwing link 1";
constexpr std::size_t DIGITS = 64;

static_assert(crypto_auth_KEYBYTES == std::tuple_size<Key>::value, "key size of crypto_auth");
static_assert(crypto_auth_BYTES == sizeof(snapwing_lcm::sealed_t::mac), "code size of crypto_auth");

void startSodium() {
  if (sodium_init() < 0) throw common::Error("libsodium cannot start");
}

/// Code over label, channel (both with their terminating zero) and payload.
void authenticate(const Key& key, const std::string& channel, const std::uint8_t* payload, std::size_t size,
                  std::uint8_t* mac) {
  crypto_auth_hmacsha512256_state state;
  crypto_auth_hmacsha512256_init(&state, key.data(), key.size());
  crypto_auth_hmacsha512256_update(&state, reinterpret_cast<const unsigned char*>(LABEL), sizeof LABEL);
  crypto_auth_hmacsha512256_update(&state, reinterpret_cast<const unsigned char*>(channel.c_str()), channel.size() + 1);
  crypto_auth_hmacsha512256_update(&state, payload, size);
  crypto_auth_hmacsha512256_final(&state, mac);
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

bool Sealer::seal(const std::string& channel, const std::uint8_t* payload, std::size_t size,
                  snapwing_lcm::sealed_t& out) const {
  if (size > sizeof out.payload) return false;
  out.version = snapwing_lcm::sealed_t::VERSION;
  out.payload_size = static_cast<int>(size);
  std::memset(out.payload, 0, sizeof out.payload);
  std::memcpy(out.payload, payload, size);
  authenticate(key_, channel, payload, size, out.mac);
  return true;
}

bool Sealer::verify(const std::string& channel, const snapwing_lcm::sealed_t& sealed) const {
  if (sealed.version != snapwing_lcm::sealed_t::VERSION || sealed.payload_size < 0) return false;
  const auto size = static_cast<std::size_t>(sealed.payload_size);
  if (size > sizeof sealed.payload) return false;
  std::array<std::uint8_t, sizeof sealed.mac> mac{};
  authenticate(key_, channel, sealed.payload, size, mac.data());
  return sodium_memcmp(mac.data(), sealed.mac, mac.size()) == 0;
}

}  // namespace snapwing::link
