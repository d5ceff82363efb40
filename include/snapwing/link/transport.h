#pragma once
/// Lines to a flight controller: TCP socket, serial port, pseudo-terminal. Nothing blocks, nothing queues: a frame goes
/// out whole and now, or not at all, so that an unblocked line never delivers stale thrust.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "snapwing/common/loan.h"

namespace snapwing::link {

enum class Parity { NONE, EVEN };

/// How a serial line is set; other lines ignore it.
struct LineSettings {
  int baud = 115200;
  Parity parity = Parity::NONE;
  int stop_bits = 1;
  /// Zeros end a frame that was cut, and mean nothing between frames. Not so with SBUS, which ends it by a pause.
  bool padding = true;
};

class Transport : public common::Lender {
 public:
  virtual ~Transport() = default;

  /// Opens, or continues to open, if not connected. Cheap; call once per frame.
  /// @param now  [s] monotonic; attempts are spaced by a quarter of a second
  virtual void maintain(double now) = 0;
  bool connected() const { return connected_; }
  /// For poll(); -1 if closed.
  int descriptor() const { return descriptor_; }

  /// @return bytes read, 0 if none; a broken line closes
  std::size_t read(std::uint8_t* out, std::size_t capacity);
  /// Nothing waits on the line any more. Thrust goes out only then, so that at most one frame of it can be stale.
  bool empty() const { return connected_ && rest_size_ == 0 && backlog() <= emptyLimit(); }
  /// Sends all of it or nothing. A rest that the kernel did not take is sent first next time; until then, and while
  /// more than the kind's limit of bytes wait in the kernel, frames are dropped. Blocked for longer than a tenth of a
  /// second, the line is flushed (serial) or closed (socket).
  /// @return true if the whole frame was handed to the kernel
  bool write(const std::uint8_t* bytes, std::size_t size, double now);
  void close();
  /// Sends what is left of a frame that the line took in part, if it takes more now.
  void finish() {
    if (connected_) sendRest();
  }
  /// Throws away what the line has not taken yet; a socket is closed for that. A frame cut by it is filled up.
  void discard();
  /// Number of times that a connection came about.
  int connections() const { return connections_; }
  /// errno of the last attempt to open or of the loss; 0 = none, or ended by the far end.
  int lastError() const { return last_error_; }
  /// Where to keep the number of bytes of a frame that may be on the line in part; the guardian fills them up.
  void publishOpenBytes(std::shared_ptr<std::atomic<std::uint32_t>> where) { open_bytes_ = std::move(where); }

  static constexpr double BLOCKED_LIMIT = 0.1;  ///< [s]
  static constexpr std::size_t PADDING = 32;    ///< [bytes] more than any frame sent here

 protected:
  void opened(bool padding);
  /// Attempt or line failed with this errno.
  void failed(int error) { last_error_ = error; }
  /// write(2), to be replaced in tests of lines that take only a part.
  virtual long send(const std::uint8_t* bytes, std::size_t size);
  /// Bytes that the kernel holds and the line has not taken.
  virtual int backlog() const = 0;
  virtual int backlogLimit() const { return 64; }  ///< [bytes] two frames
  virtual int emptyLimit() const { return 0; }     ///< [bytes] what counts as nothing
  /// Throws away what waits in the kernel. @return false if that is only possible by closing
  virtual bool flush() = 0;

  int descriptor_ = -1;
  bool connected_ = false;
  double next_attempt_ = -1e9;

 private:
  bool sendRest();
  bool blocked(double now);
  void setRest(std::size_t size);
  std::uint8_t rest_[512] = {};
  std::size_t rest_size_ = 0;
  double blocked_since_ = -1;
  int connections_ = 0;
  int last_error_ = 0;
  bool padding_ = true;
  std::shared_ptr<std::atomic<std::uint32_t>> open_bytes_ = std::make_shared<std::atomic<std::uint32_t>>(0);
};

/// A port of TCP or UDP, 0 .. 65535 in digits; none if the text is anything else.
std::optional<int> portNumber(const std::string& text);

/// @param where  "tcp:HOST:PORT", "serial:/dev/NAME" (also a pseudo-terminal's name), or "pty:LINK": makes a
///               pseudo-terminal and a symbolic link to its far end, in place of nothing but such a link
/// @throws common::SettingError if not understood, common::Error if the host is not found
std::unique_ptr<Transport> makeTransport(const std::string& where, const LineSettings& settings);

/// Opens a pseudo-terminal in raw mode. @return its master; the slave's name in `slave`
/// @throws common::Error
int openPseudoTerminal(std::string& slave);

/// Sets any baud rate (termios2), raw mode. @return false with errno if the line refuses
bool configureSerial(int descriptor, const LineSettings& settings);

}  // namespace snapwing::link
