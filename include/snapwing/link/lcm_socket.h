#pragma once
/// LCM's short message, one UDP multicast datagram, sent and received without liblcm (docs/decisions.md says why):
/// no thread of its own, no fragments, no default route needed on the loopback.
///
///   bytes | what
///   ------+-----------------------------------------
///   4     | "LC02", big endian like all of it
///   4     | number of the datagram, of the sender
///   1..64 | channel's name, ends with a zero byte
///   rest  | the message's LCM encoding

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>

namespace snapwing::link {

struct LcmDatagram {
  std::string_view channel;  ///< these point into the bytes that were parsed
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

enum class LcmKind {
  MESSAGE,
  FRAGMENT,  ///< piece of a long message: none of ours is, so it is dropped before anything is gathered
  MALFORMED,
};
/// @param out  filled for MESSAGE only
LcmKind parseLcmDatagram(const std::uint8_t* bytes, std::size_t size, LcmDatagram& out);

/// Longest datagram that is sent or taken: one packet on every usual line. [bytes]
constexpr std::size_t LCM_DATAGRAM_LIMIT = 1400;
constexpr std::size_t LCM_CHANNEL_LIMIT = 63;

/// Not thread-safe: one socket for each thread.
class LcmSocket {
 public:
  /// @param url  "udpm://GROUP:PORT?ttl=N". ttl=0 uses the loopback interface and hears nothing else; above 0 the
  ///             interface that the machine's routes choose.
  /// @throws common::SettingError if not understood, common::Error if the network refuses
  explicit LcmSocket(const std::string& url);
  ~LcmSocket();
  LcmSocket(const LcmSocket&) = delete;
  LcmSocket& operator=(const LcmSocket&) = delete;

  /// @return false if too long or not taken by the network
  bool publish(std::string_view channel, const std::uint8_t* data, std::size_t size);
  /// Waits until something arrives or the time is over. @param timeout  [s]
  bool wait(double timeout) const;
  /// Next message that has arrived; does not wait. It lives until the next call. @return false if there is none
  bool receive(LcmDatagram& out);
  int descriptor() const { return descriptor_; }
  /// Dropped unread.
  std::int64_t fragments() const { return fragments_.load(std::memory_order_relaxed); }
  std::int64_t malformed() const { return malformed_.load(std::memory_order_relaxed); }

 private:
  void open(std::uint32_t group, std::uint16_t port, int ttl);

  int descriptor_ = -1;
  std::uint32_t group_ = 0;  ///< network byte order
  std::uint16_t port_ = 0;   ///< network byte order
  std::uint32_t number_ = 0;
  std::atomic<std::int64_t> fragments_{0}, malformed_{0};  ///< read by other threads too
  std::array<std::uint8_t, LCM_DATAGRAM_LIMIT + 1> buffer_{};
};

}  // namespace snapwing::link
