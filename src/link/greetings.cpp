#include "greetings.h"

#include <algorithm>

namespace snapwing::link {

bool Greetings::take(std::int64_t sender, std::int64_t challenge, double now) {
  if (sender == 0 || challenge == 0) return false;
  auto place = std::find_if(places_.begin(), places_.end(), [sender](const Greeting& g) { return g.sender == sender; });
  if (place == places_.end()) {
    place = std::min_element(places_.begin(), places_.end(),
                             [](const Greeting& a, const Greeting& b) { return a.time < b.time; });
    if (now - place->time <= LIFE) return false;
  } else if (challenge <= place->challenge) {
    return false;
  }
  *place = {sender, challenge, now};
  return true;
}

}  // namespace snapwing::link
