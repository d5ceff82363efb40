#pragma once
/// Clients that ask the radio bridge "are you there?", and the answer of the next status. Pure: no clock, no
/// allocation.
///
/// A hello carries no session, since its sender may not know one yet, so that a recorded one has a good seal for ever.
/// It must have no effect all the same: the challenges of one sender rise, and a sender that is heard keeps its place.

#include <array>
#include <cstdint>

namespace snapwing::link {

class Greetings {
 public:
  static constexpr std::size_t PLACES = 8;  ///< as many as link_status_t answers
  static constexpr double LIFE = 0.5;       ///< [s] of silence after which a sender's place may be another's

  struct Greeting {
    std::int64_t sender = 0, challenge = 0;  ///< 0 = nobody
    double time = -1e9;                      ///< [s]
  };

  /// @param now  [s] monotonic. @return false if it has no effect: repeated, older than the last, or no place is free
  bool take(std::int64_t sender, std::int64_t challenge, double now);
  /// Newest challenge of each sender.
  const std::array<Greeting, PLACES>& all() const { return places_; }

 private:
  std::array<Greeting, PLACES> places_{};
};

}  // namespace snapwing::link
