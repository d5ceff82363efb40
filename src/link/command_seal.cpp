#include "snapwing/link/command_seal.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "snapwing/link/clock.h"

namespace snapwing::link {
namespace {

constexpr char LABEL[] = "snapwing ROS command 2";

/// Appends the value's bytes, little endian.
template <class Value>
void put(std::string& out, Value value) {
  static_assert(sizeof(Value) <= 8);
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof value);
  for (std::size_t i = 0; i < sizeof value; ++i) out += static_cast<char>(bits >> 8 * i & 0xFFU);
}

std::string verb(const char* name) { return std::string(name) + '\0'; }

}  // namespace

std::string armContent(bool arm) {
  std::string content = verb("arm");
  put(content, static_cast<std::uint8_t>(arm ? 1 : 0));
  return content;
}

std::string resetContent() { return verb("reset"); }

std::string pulseContent(std::uint32_t id, const PulseShape& shape) {
  std::string content = verb("pulse");
  put(content, id);
  put(content, shape.throttle);
  put(content, shape.duration);
  put(content, shape.hold_throttle);
  put(content, shape.hold_duration);
  put(content, static_cast<std::uint8_t>(shape.mixed ? 1 : 0));
  put(content, shape.pitch);
  return content;
}

std::array<std::uint8_t, 32> CommandSealer::code(const std::string& content, const CommandSeal& seal) const {
  std::string when;
  put(when, seal.session);
  put(when, seal.status_number);
  put(when, seal.nonce);
  return authenticationCode(key_, LABEL, {vehicle_id_, content, when});
}

CommandSeal CommandSealer::seal(const std::string& content, std::int64_t session, std::int64_t status_number) const {
  CommandSeal seal;
  seal.session = session;
  seal.status_number = status_number;
  seal.nonce = randomId();
  seal.code = code(content, seal);
  return seal;
}

void CommandDoor::noteStatus(std::int64_t session, std::int64_t number, double now) {
  if (session != session_) published_ = {};
  session_ = session;
  published_[static_cast<std::size_t>(number) % published_.size()] = {number, now};
}

std::string CommandDoor::judge(const std::string& content, const CommandSeal& seal, double max_age, double now) {
  if (seal.missing()) return "it has no seal: use link_command, or seal it with the link's key";
  if (!sameCode(sealer_.code(content, seal), seal.code)) {
    return "its seal is wrong: made with another key or for another vehicle, or the command was changed";
  }
  if (seal.session != session_) return "it was sealed for another run of the radio bridge";
  const Published& answered = published_[static_cast<std::size_t>(seal.status_number) % published_.size()];
  if (seal.status_number <= 0 || answered.number != seal.status_number) {
    return "it names a link status that was not published here lately";
  }
  const double age = now - answered.time;
  const double limit = std::min(max_age, LONGEST_AGE);
  if (!(age >= 0 && age <= limit)) {
    return "it is " + std::to_string(std::lround(1e3 * age)) + " ms old, allowed are " +
           std::to_string(std::lround(1e3 * limit));
  }
  while (!used_.empty() && now - used_.front().time > LONGEST_AGE) used_.pop_front();
  const bool used = std::any_of(used_.begin(), used_.end(), [&seal](const Used& one) { return one.code == seal.code; });
  if (used) return "it was used before";
  used_.push_back({seal.code, now});
  return "";
}

}  // namespace snapwing::link
