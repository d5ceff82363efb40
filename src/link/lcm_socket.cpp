#include "snapwing/link/lcm_socket.h"

#include <arpa/inet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <regex>

#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

constexpr std::uint32_t SHORT_MESSAGE = 0x4c433032;  ///< "LC02"
constexpr std::uint32_t FRAGMENT = 0x4c433033;       ///< "LC03"
constexpr std::size_t HEAD = 8;
constexpr int RECEIVE_BUFFER = 1 << 20;  ///< [bytes] a burst while the reader is held up; the kernel may give less

std::uint32_t bigEndian(const std::uint8_t* bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | bytes[i];
  return value;
}

void putBigEndian(std::uint32_t value, std::uint8_t* bytes) {
  for (int i = 3; i >= 0; --i, value >>= 8) bytes[i] = static_cast<std::uint8_t>(value);
}

[[noreturn]] void badUrl(const std::string& url) {
  throw common::SettingError("LCM network", "lcm_url", url,
                             "udpm://GROUP:PORT?ttl=N with a multicast address (224.0.0.0 to 239.255.255.255), a port "
                             "within [1, 65535] and ttl within [0, 255]");
}

}  // namespace

LcmKind parseLcmDatagram(const std::uint8_t* bytes, std::size_t size, LcmDatagram& out) {
  if (size < HEAD + 1) return LcmKind::MALFORMED;
  const std::uint32_t magic = bigEndian(bytes);
  if (magic == FRAGMENT) return LcmKind::FRAGMENT;
  if (magic != SHORT_MESSAGE) return LcmKind::MALFORMED;
  const std::uint8_t* name = bytes + HEAD;
  const std::size_t room = std::min(size - HEAD, LCM_CHANNEL_LIMIT + 1);
  const auto* end = static_cast<const std::uint8_t*>(std::memchr(name, 0, room));
  if (end == nullptr || end == name) return LcmKind::MALFORMED;
  out.channel = {reinterpret_cast<const char*>(name), static_cast<std::size_t>(end - name)};
  out.data = end + 1;
  out.size = static_cast<std::size_t>(bytes + size - out.data);
  return LcmKind::MESSAGE;
}

LcmSocket::LcmSocket(const std::string& url) {
  static const std::regex FORM(R"(udpm://([0-9.]{7,15}):([0-9]{1,5})(?:\?ttl=([0-9]{1,3}))?)");
  std::smatch parts;
  in_addr group{};
  if (!std::regex_match(url, parts, FORM) || inet_pton(AF_INET, parts[1].str().c_str(), &group) != 1) badUrl(url);
  const int port = std::stoi(parts[2]);
  const int ttl = parts[3].matched ? std::stoi(parts[3]) : 0;  // liblcm's default as well
  if (!IN_MULTICAST(ntohl(group.s_addr)) || port < 1 || port > 65535 || ttl > 255) badUrl(url);
  try {
    open(group.s_addr, htons(static_cast<std::uint16_t>(port)), ttl);
  } catch (...) {
    if (descriptor_ >= 0) close(descriptor_);
    throw;
  }
}

LcmSocket::~LcmSocket() { close(descriptor_); }

void LcmSocket::open(std::uint32_t group, std::uint16_t port, int ttl) {
  group_ = group;
  port_ = port;
  descriptor_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor_ < 0) throw common::Error(std::string("LCM: no socket: ") + std::strerror(errno));
  const auto set = [this](int level, int name, const auto& value, const char* what) {
    if (setsockopt(descriptor_, level, name, &value, sizeof value) == 0) return;
    throw common::Error(std::string("LCM: ") + what + ": " + std::strerror(errno));
  };
  set(SOL_SOCKET, SO_REUSEADDR, 1, "cannot share the port");
  setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &RECEIVE_BUFFER, sizeof RECEIVE_BUFFER);  // less will do as well
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_port = port;
  here.sin_addr.s_addr = group;  // nothing but the group's datagrams
  if (bind(descriptor_, reinterpret_cast<const sockaddr*>(&here), sizeof here) != 0) {
    throw common::Error(std::string("LCM: cannot bind: ") + std::strerror(errno));
  }
  ip_mreqn membership{};
  membership.imr_multiaddr.s_addr = group;
  if (ttl == 0) {
    membership.imr_address.s_addr = htonl(INADDR_LOOPBACK);
    membership.imr_ifindex = static_cast<int>(if_nametoindex("lo"));
    set(IPPROTO_IP, IP_MULTICAST_IF, membership, "cannot send on the loopback interface");
  }
  // Only what comes by the interface joined here, not by one that another program of this machine has joined.
  set(IPPROTO_IP, IP_MULTICAST_ALL, 0, "cannot restrict the interface");
  set(IPPROTO_IP, IP_ADD_MEMBERSHIP, membership,
      ttl == 0 ? "cannot join the group" : "cannot join the group (no route?)");
  set(IPPROTO_IP, IP_MULTICAST_TTL, ttl, "cannot set ttl");
  set(IPPROTO_IP, IP_MULTICAST_LOOP, 1, "cannot hear this machine");
}

bool LcmSocket::publish(std::string_view channel, const std::uint8_t* data, std::size_t size) {
  std::array<std::uint8_t, LCM_DATAGRAM_LIMIT> bytes;
  const std::size_t head = HEAD + channel.size() + 1;
  if (channel.empty() || channel.size() > LCM_CHANNEL_LIMIT || size > bytes.size() - head) return false;
  putBigEndian(SHORT_MESSAGE, bytes.data());
  putBigEndian(number_++, bytes.data() + 4);
  std::memcpy(bytes.data() + HEAD, channel.data(), channel.size());
  bytes[head - 1] = 0;
  std::memcpy(bytes.data() + head, data, size);
  sockaddr_in there{};
  there.sin_family = AF_INET;
  there.sin_port = port_;
  there.sin_addr.s_addr = group_;
  const ssize_t sent = sendto(descriptor_, bytes.data(), head + size, MSG_NOSIGNAL,
                              reinterpret_cast<const sockaddr*>(&there), sizeof there);
  return sent == static_cast<ssize_t>(head + size);
}

bool LcmSocket::wait(double timeout) const {
  pollfd waiting{descriptor_, POLLIN, 0};
  return poll(&waiting, 1, static_cast<int>(std::ceil(1000.0 * timeout))) > 0;
}

bool LcmSocket::receive(LcmDatagram& out) {
  while (true) {
    const ssize_t got = recv(descriptor_, buffer_.data(), buffer_.size(), 0);
    if (got < 0 && (errno == EINTR || errno == ECONNREFUSED)) continue;
    if (got < 0) return false;
    const auto size = static_cast<std::size_t>(got);
    const bool too_long = size > LCM_DATAGRAM_LIMIT;
    const LcmKind kind = parseLcmDatagram(buffer_.data(), size, out);
    if (kind == LcmKind::MESSAGE && !too_long) return true;
    ++(kind == LcmKind::FRAGMENT ? fragments_ : malformed_);
  }
}

}  // namespace snapwing::link
