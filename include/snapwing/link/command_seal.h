#pragma once
/// Seal of the commands that reach flight_link_node over ROS, where every host that gets through to one of its ports
/// can speak. Code = HMAC-SHA-512-256 over a label, the vehicle's id, what is commanded, and the newest bridge status
/// that the commander had heard. Age is judged by the door: by its own monotonic clock, from the moment at which it
/// published that status. No clock of the commander counts, nor ROS's.

#include <array>
#include <cstdint>
#include <deque>
#include <string>

#include "snapwing/link/bridge_types.h"
#include "snapwing/link/sealing.h"

namespace snapwing::link {

struct CommandSeal {
  std::int64_t session = 0;        ///< of the bridge
  std::int64_t status_number = 0;  ///< newest status heard
  std::int64_t nonce = 0;          ///< random
  std::array<std::uint8_t, 32> code{};
  bool missing() const { return code == std::array<std::uint8_t, 32>{}; }
};

/// What is sealed: a verb, a zero byte, the values in little endian.
std::string armContent(bool arm);
std::string resetContent();
std::string pulseContent(std::uint32_t id, const PulseShape& shape);

/// The commander's side. Give it the newest status heard.
class CommandSealer {
 public:
  CommandSealer(const Key& key, std::string vehicle_id) : key_(key), vehicle_id_(std::move(vehicle_id)) {}
  CommandSeal seal(const std::string& content, std::int64_t session, std::int64_t status_number) const;

 private:
  friend class CommandDoor;
  std::array<std::uint8_t, 32> code(const std::string& content, const CommandSeal& seal) const;
  Key key_;
  std::string vehicle_id_;
};

/// The node's side. Pure: times are given.
class CommandDoor {
 public:
  CommandDoor(const Key& key, const std::string& vehicle_id) : sealer_(key, vehicle_id) {}

  /// A status is about to be published. @param now  [s] monotonic
  void noteStatus(std::int64_t session, std::int64_t number, double now);
  /// Judges a command, and remembers it: the same one is not let in again.
  /// @param max_age  [s] since the status that it names was published
  /// @return why it is refused; empty if it may pass
  std::string judge(const std::string& content, const CommandSeal& seal, double max_age, double now);

  static constexpr double LONGEST_AGE = 1.0;  ///< [s] no max_age grants more

 private:
  struct Published {
    std::int64_t number = 0;
    double time = -1e9;
  };
  struct Used {
    std::array<std::uint8_t, 32> code;
    double time;
  };
  CommandSealer sealer_;
  std::int64_t session_ = 0;
  std::array<Published, 128> published_{};
  std::deque<Used> used_;
};

}  // namespace snapwing::link
